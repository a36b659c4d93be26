//! Where each exponential leaves its domain: errors and the overlap guard against the length of what is exponentiated.

use halflight_sh::{ExpWorkspace, SymmetricEigen, coefficients, project_binary_bound};

use crate::inputs::{Numbers, blockers};
use crate::measure::exponentials::variants;
use crate::operation::EIGEN;
use crate::oracle::{Oracle, SQRT_4_PI};
use crate::vector::{convert, distance, norm, scaled};

/// Directions of a family.
const DIRECTIONS: usize = 24;

/// Results beyond this are not compared: `f32` ends, and variants stop at 1e30.
const LARGEST_LOG: f64 = 64.0;

/// Degree of the rule for exponentials of functions.
const SMOOTH_DEGREE: usize = 63;

/// What is exponentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Sums of the logs of up to 8 circles of up to 35°.
    Blockers,
    /// Normally distributed coefficients, with the mean that makes 0 the highest value.
    Random,
}

impl Family {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Blockers, Self::Random];

    /// As tables print it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blockers => "blockers",
            Self::Random => "random",
        }
    }

    /// Vectors whose bands above 0 have length 1.
    fn directions(self, order: usize, smooth: &Oracle) -> Vec<Vec<f64>> {
        let mut numbers = Numbers::new(90);
        let mut one = |k: usize| {
            let mut f = match self {
                Self::Blockers => blockers(order, &mut numbers, 1 + k % 8),
                Self::Random => numbers.vector(order),
            };
            if self == Self::Random {
                f[0] = 0.0;
                f[0] = -SQRT_4_PI * smooth.values(&f).into_iter().fold(f64::MIN, f64::max);
            }
            let length = norm(&f[1..]);
            scaled(&f, 1.0 / length)
        };
        (0..DIRECTIONS).map(&mut one).collect()
    }
}

/// One variant at one length, in `f32`. Errors that cannot be told, because results leave `f32`, are NaN.
#[derive(Clone, Debug)]
pub struct Step {
    /// The order.
    pub order: usize,
    /// The variant.
    pub variant: &'static str,
    /// What was exponentiated.
    pub family: Family,
    /// The length of the bands above 0.
    pub length: f64,
    /// Error relative to the whole product series, of the middle input and of the worst.
    pub series: [f64; 2],
    /// Error relative to the projection of the exponential function, of the middle input.
    pub exact: f64,
    /// Distance from the projection of the visibility `min(exp f, 1)` as a share of the open sky, of the middle input: as
    /// computed, and after the guard.
    pub guarding: [f64; 2],
    /// The share of inputs on which the guard acts.
    pub guarded: f64,
    /// Inputs whose result is not finite.
    pub not_finite: usize,
}

/// One vector with what its exponentials should be.
struct Truth {
    f: Vec<f64>,
    /// The whole series; `None` if out of range.
    series: Option<Vec<f64>>,
    /// The projection; `None` if out of range.
    exact: Option<Vec<f64>>,
    /// The projection of what is at most 1.
    visibility: Vec<f64>,
}

/// A direction's decomposition, from which the truth of every multiple follows.
struct Ray {
    f: Vec<f64>,
    eigen: SymmetricEigen,
    values: Vec<f64>,
}

impl Ray {
    fn new(oracle: &Oracle, smooth: &Oracle, f: Vec<f64>) -> Self {
        let mut eigen = SymmetricEigen::new();
        eigen.decompose(f.len(), &oracle.matrix(&f));
        let values = smooth.values(&f);
        Self { f, eigen, values }
    }

    fn truth(&self, smooth: &Oracle, length: f64) -> Truth {
        let one = || {
            let mut one = vec![0.0; self.f.len()];
            one[0] = SQRT_4_PI;
            one
        };
        let top = self.values.iter().fold(f64::MIN, |m, x| m.max(*x));
        let series = (length * self.eigen.largest() < LARGEST_LOG).then(|| {
            let mut out = one();
            self.eigen.apply(&mut out, |value| (length * value).exp());
            out
        });
        let exact = (length * top < LARGEST_LOG)
            .then(|| smooth.project(&self.values.iter().map(|x| (length * x).exp()).collect::<Vec<_>>()));
        let visibility = smooth.project(&self.values.iter().map(|x| (length * x).min(0.0).exp()).collect::<Vec<_>>());
        Truth { f: scaled(&self.f, length), series, exact, visibility }
    }
}

/// Lengths at which every variant is tried.
fn lengths() -> impl Iterator<Item = f64> {
    (-6..=26).map(|k| 2f64.powf(0.5 * f64::from(k))).chain([10.0, 100.0, 1e3, 1e4])
}

/// Lengths at which the eigen exponential is tried, whose error is rounding.
const DECADES: [f64; 5] = [1.0, 10.0, 100.0, 1e3, 1e4];

/// What `variant` is called that sums the series in `f64`.
pub(crate) const WHOLE_SERIES: &str = "whole series";

/// The steps of an order and a family.
pub(crate) fn steps(order: usize, family: Family) -> Vec<Step> {
    if order == 1 {
        return Vec::new(); // there is nothing but the mean
    }
    let (oracle, smooth) = (Oracle::new(order), Oracle::of_degree(order, SMOOTH_DEGREE));
    let rays: Vec<Ray> = family.directions(order, &smooth).into_iter().map(|f| Ray::new(&oracle, &smooth, f)).collect();
    let mut exp = ExpWorkspace::<f32>::new(order);
    let mut out = Vec::new();
    for length in lengths() {
        let truths: Vec<Truth> = rays.iter().map(|ray| ray.truth(&smooth, length)).collect();
        let mut add = |variant, results: Vec<Vec<f32>>| {
            out.push(step(order, variant, family, length, &truths, results));
        };
        for (operation, single, _) in variants::<f32>() {
            if operation.name != EIGEN.name || DECADES.contains(&length) {
                let mut one = |truth: &Truth| {
                    let mut out = vec![0.0f32; coefficients(order)];
                    single(&mut exp, &convert(&truth.f), &mut out);
                    out
                };
                add(operation.name, truths.iter().map(&mut one).collect());
            }
        }
        let series = |truth: &Truth| match &truth.series {
            Some(series) => convert(series),
            None => vec![1e30; coefficients(order)],
        };
        add(WHOLE_SERIES, truths.iter().map(series).collect());
    }
    out.sort_by(|a, b| a.variant.cmp(b.variant).then(a.length.total_cmp(&b.length)));
    out
}

fn step(
    order: usize,
    variant: &'static str,
    family: Family,
    length: f64,
    truths: &[Truth],
    mut results: Vec<Vec<f32>>,
) -> Step {
    let errors = |of: fn(&Truth) -> &Option<Vec<f64>>| -> Vec<f64> {
        let one = |(got, truth): (&Vec<f32>, &Truth)| {
            of(truth).as_ref().map_or(f64::NAN, |want| distance(got, want) / norm(want))
        };
        results.iter().zip(truths).map(one).collect()
    };
    let (series, exact) = (errors(|t| &t.series), errors(|t| &t.exact));
    let off = |results: &[Vec<f32>]| {
        let one = |(got, truth): (&Vec<f32>, &Truth)| distance(got, &truth.visibility) / SQRT_4_PI;
        middle(&results.iter().zip(truths).map(one).collect::<Vec<_>>())
    };
    let before = off(&results);
    let not_finite = results.iter().filter(|result| result.iter().any(|x| !x.is_finite())).count();
    let guarded = results.iter_mut().map(|result| project_binary_bound(order, result)).filter(|&acted| acted).count();
    Step {
        order,
        variant,
        family,
        length,
        series: [middle(&series), worst(&series)],
        exact: middle(&exact),
        guarding: [before, off(&results)],
        guarded: guarded as f64 / truths.len() as f64,
        not_finite,
    }
}

/// The median; NaN if there is any.
fn middle(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    if sorted.iter().any(|x| x.is_nan()) { f64::NAN } else { sorted[sorted.len() / 2] }
}

fn worst(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, &x| if x.is_nan() || m.is_nan() { f64::NAN } else { m.max(x) })
}

/// For every variant the length up to which it keeps 10% of the whole series for every sum of blockers, at orders 2 to 8.
pub static STATED_DOMAINS: &[(&str, [f64; 7])] = &[
    ("exp PS-8", [2.8, 4.0, 4.0, 2.8, 2.8, 2.8, 2.0]),
    ("exp PS-21", [5.6, 11.0, 10.0, 8.0, 5.6, 5.6, 5.6]),
    ("exp PS*-2", [180.0, 16.0, 11.0, 11.0, 10.0, 8.0, 8.0]),
    ("exp PS*-5", [180.0, 16.0, 11.0, 11.0, 10.0, 8.0, 8.0]),
    ("exp OL", [4.0, 1.0, 1.4, 1.0, 1.0, 1.0, 1.0]),
    ("exp HYB", [180.0, 5.6, 10.0, 5.6, 5.6, 5.6, 5.6]),
    ("exp eigen", [100.0; 7]),
];

/// Where one variant ends, for one order and family.
#[derive(Clone, Debug)]
pub struct Domain {
    /// The order.
    pub order: usize,
    /// The variant.
    pub variant: &'static str,
    /// What was exponentiated.
    pub family: Family,
    /// The longest length up to which no input errs by more than 10% of the whole series.
    pub every: f64,
    /// The longest up to which half of the inputs err by less.
    pub half: f64,
    /// The shortest at which half of the inputs err by more than ten times the series: it has diverged. Infinite if never.
    pub diverges: f64,
    /// The longest up to which half of the inputs err by less than 10% of the exact exponential's projection.
    pub exact: f64,
    /// The share of inputs on which the guard acts at lengths 1, 10, 100, 1000 and 10000.
    pub guarded: [f64; 5],
}

impl Domain {
    /// What is stated of [`Domain::every`]; 0 where nothing is.
    pub fn stated(&self) -> f64 {
        let lengths = STATED_DOMAINS.iter().find(|(name, _)| *name == self.variant).map(|(_, lengths)| lengths);
        if self.family == Family::Blockers { lengths.map_or(0.0, |lengths| lengths[self.order - 2]) } else { 0.0 }
    }
}

/// Draws the ends out of the steps.
pub(crate) fn domains(steps: &[Step]) -> Vec<Domain> {
    let groups = steps.chunk_by(|a, b| (a.order, a.variant, a.family) == (b.order, b.variant, b.family));
    groups
        .map(|group| {
            let last = |keeps: &dyn Fn(&Step) -> bool| {
                let inside = group.iter().take_while(|step| keeps(step)).last();
                inside.map_or(0.0, |step| step.length)
            };
            let diverged = group.iter().find(|step| step.series[0] > 10.0);
            let guarded =
                |length: f64| group.iter().find(|step| step.length == length).map_or(f64::NAN, |step| step.guarded);
            Domain {
                order: group[0].order,
                variant: group[0].variant,
                family: group[0].family,
                every: last(&|step| step.series[1] <= 0.1),
                half: last(&|step| step.series[0] <= 0.1),
                diverges: diverged.map_or(f64::INFINITY, |step| step.length),
                exact: last(&|step| step.exact <= 0.1),
                guarded: DECADES.map(guarded),
            }
        })
        .collect()
}
