//! Circles: visibility, log, and the eigen log.

use halflight_sh::{
    Block, CircleTable, ExpWorkspace, LANES, Real, circle_log, circle_visibility, gauss_legendre, log_eigen,
};

use crate::batches::batches;
use crate::inputs::{Class, log_visibility, positives, visibility};
use crate::operation::{CIRCLE, CIRCLE_LOG, LOG, REPRODUCTION};
use crate::oracle::{Oracle, basis};
use crate::tally::Tally;
use crate::vector::{distance, norm};

/// Circles that are compared.
const CIRCLES: usize = 1024;

/// The zonal visibility beside a circle by quadrature over the open part.
fn open_part(order: usize, cosine: f64) -> Vec<f64> {
    let (nodes, weights) = gauss_legendre(order + 1);
    let half = 0.5 * (cosine + 1.0);
    let mut out = vec![0.0; order];
    let mut y = vec![0.0; order * order];
    for (x, weight) in nodes.iter().zip(weights) {
        let z = half * (x + 1.0) - 1.0;
        basis(order, [(1.0 - z * z).max(0.0).sqrt(), 0.0, z], &mut y);
        let weight = std::f64::consts::TAU * half * weight;
        out.iter_mut().enumerate().for_each(|(l, sum)| *sum += weight * y[l * (l + 1)]);
    }
    out
}

/// Lookups of circles against sines over 0° to 90°: visibility against quadrature, the log against the function that the
/// table is made from, which [`logs`] judges.
pub(crate) fn tables<T: Real>(tally: &mut Tally) {
    let order = tally.order;
    let sines: Vec<f64> = (0..CIRCLES)
        .map(|k| T::from_f64((k as f64 / (CIRCLES - 1) as f64 * std::f64::consts::FRAC_PI_2).sin()).to_f64())
        .collect();
    let cosines = sines.iter().map(|sine| ((1.0 - sine) * (1.0 + sine)).sqrt());
    let (mut open, mut logs) = (Vec::new(), Vec::new());
    for cosine in cosines {
        open.push(open_part(order, cosine));
        let mut log = vec![0.0; order];
        circle_log(order, cosine, &mut log);
        logs.push(log);
    }
    let largest = |got: &[T], want: &[f64], scale: f64| {
        got.iter().zip(want).fold(0.0f64, |m, (g, w)| m.max((g.to_f64() - w).abs())) / scale
    };
    let scale = |log: &[f64]| log.iter().fold(1.0f64, |m, x| m.max(x.abs()));
    let mut out = vec![T::ZERO; order];
    for (operation, table, want) in
        [(&CIRCLE, CircleTable::visibility(order), &open), (&CIRCLE_LOG, CircleTable::log(order), &logs)]
    {
        let mut one = |(sine, want): (&f64, &Vec<f64>)| {
            table.lookup(T::from_f64(*sine), &mut out);
            largest(&out, want, if operation.name == CIRCLE.name { 1.0 } else { scale(want) })
        };
        let errors: Vec<f64> = sines.iter().zip(want).map(&mut one).collect();
        tally.add::<T>(operation, "table", Class::Structured, &errors);
    }
    let blocks: Vec<Block<T>> =
        sines.chunks(LANES).map(|group| Block(std::array::from_fn(|lane| T::from_f64(group[lane])))).collect();
    for (name, batch) in batches(order) {
        let mut out = vec![Block::<T>::ZERO; order * blocks.len()];
        let gather = |out: &[Block<T>], i: usize| -> Vec<T> {
            (0..order).map(|l| out[i / LANES * order + l].0[i % LANES]).collect()
        };
        batch.circle_visibilities(&blocks, &mut out);
        let errors: Vec<f64> = (0..CIRCLES).map(|i| largest(&gather(&out, i), &open[i], 1.0)).collect();
        tally.add::<T>(&CIRCLE, &name, Class::Structured, &errors);
        batch.circle_logs(&blocks, &mut out);
        let errors: Vec<f64> = (0..CIRCLES).map(|i| largest(&gather(&out, i), &logs[i], scale(&logs[i]))).collect();
        tally.add::<T>(&CIRCLE_LOG, &name, Class::Structured, &errors);
    }
}

/// The eigen log, of vectors and of circles, and how well the eigen exponential of it returns a circle.
pub(crate) fn logs(oracle: &Oracle, tally: &mut Tally) {
    let order = tally.order;
    for class in Class::ALL {
        let one = |g: &Vec<f64>| {
            let mut out = g.clone();
            log_eigen(order, g, &mut out);
            distance(&out, &oracle.log(g)) / norm(g)
        };
        tally.add::<f64>(&LOG, "one", class, &positives(order, class).iter().map(one).collect::<Vec<_>>());
    }
    let up = [0.0, 0.0, 1.0];
    let widest = (170.0 / order as f64).min(80.0);
    let unclipped = |k: usize| {
        let angle = (widest * (k + 1) as f64 / 24.0).to_radians();
        let mut zonal = vec![0.0; order];
        circle_visibility(order, angle.cos(), &mut zonal);
        let g = visibility(order, angle, up);
        distance(&log_visibility(order, angle, up), &oracle.log(&g)) / norm(&g)
    };
    tally.add::<f64>(&LOG, "circle", Class::Structured, &(0..24).map(unclipped).collect::<Vec<_>>());
    let mut exp = ExpWorkspace::<f64>::new(order);
    let returned = |k: usize| {
        let angle = f64::from(k as u32 + 1).to_radians();
        let (g, f) = (visibility(order, angle, up), log_visibility(order, angle, up));
        let mut out = g.clone();
        exp.eigen(&f, &mut out);
        distance(&out, &g) / norm(&g)
    };
    tally.add::<f64>(&REPRODUCTION, "one", Class::Structured, &(0..90).map(returned).collect::<Vec<_>>());
}
