//! S8: the plain product series in the umbra.

use super::super::bench::{Bench, Figure};
use super::super::ground::Ground;
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use halflight_sh::{ExpWorkspace, coefficients, irradiance_weights};

const ORDER: usize = 4;
/// Degrees that are tried, and those of which alternation is asked: past the first few, before the paper's 30.
const DEGREES: std::ops::RangeInclusive<usize> = 1..=200;
const ALTERNATING: std::ops::RangeInclusive<usize> = 10..=30;

const SIGNS: &str = "odd degrees too dark and even ones too bright in the umbra, degrees 10 to 30";
const CONVERGED: &str = "least degree from which on the umbra errs by less than 0.01";
const AT_21: &str = "error of PS-21 in the umbra, of open irradiance";
const AT_30: &str = "error of PS-30 in the umbra, of open irradiance";

pub(crate) const S8: Row = Row {
    id: "S8",
    place: "Fig. 9 and §9",
    claim: "PS-p shows bright and dark spots in the umbra alternately as p is even or odd, and converges only after p = 30",
    paper: &[(CONVERGED, "> 30")],
    needs: "",
    measure,
    judge,
};

fn measure(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let mut logs = Ground::new(bench, "bunny-studio", 4.0, 128, 63)?.logs(ORDER);
    logs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // The umbra: the hundredth of shadowed receivers with the lowest mean log.
    logs.truncate((logs.len() / 100).max(1));
    let errors: Vec<f64> = DEGREES.map(|degree| error(&logs, degree)).collect();
    let at = |degree: usize| errors[degree - DEGREES.start()];
    let signs = ALTERNATING.filter(|&degree| (at(degree) > 0.0) == (degree % 2 == 0)).count();
    let converged = DEGREES.rev().find(|&degree| at(degree).abs() >= 0.01).map_or(1, |last| last + 1);
    let of = |name: &str, unit, value| Figure::exact(name, unit, value, logs.len());
    Ok(vec![
        of(SIGNS, "%", 100.0 * signs as f64 / ALTERNATING.count() as f64),
        of(CONVERGED, "", converged as f64),
        of(AT_21, "", at(21)),
        of(AT_30, "", at(30)),
    ])
}

/// Mean error of PS-p's irradiance under a uniform sky of radiance 1 against the eigen-exponential, in double precision.
fn error(logs: &[Vec<f32>], degree: usize) -> f64 {
    let mut exp = ExpWorkspace::<f64>::new(ORDER);
    let mut weights = [0.0; coefficients(ORDER)];
    irradiance_weights(ORDER, [0.0, 0.0, 1.0], &mut weights);
    let (mut series, mut exact) = (weights, weights);
    let error = |log: &Vec<f32>| {
        let log: Vec<f64> = log.iter().map(|value| f64::from(*value)).collect();
        exp.product_series(degree, &log, &mut series);
        exp.eigen(&log, &mut exact);
        let apart = series.iter().zip(&exact).zip(&weights);
        apart.map(|((a, b), weight)| weight * (a - b)).sum::<f64>()
    };
    logs.iter().map(error).sum::<f64>() / logs.len() as f64
}

fn judge(figures: &Figures<'_>) -> Option<Judgement> {
    let [signs, converged, at_21, at_30] = figures.values([SIGNS, CONVERGED, AT_21, AT_30])?;
    let why = format!(
        "The sign follows the degree's parity at {}% of degrees from 10 to 30; the umbra under the bunny errs by {} at p = 21 and {} at \
         p = 30, and by less than 0.01 from p = {} on.",
        number(signs),
        number(at_21),
        number(at_30),
        number(converged)
    );
    Some(Judgement { verdict: Verdict::of(&[signs == 100.0, converged > 30.0]), why })
}
