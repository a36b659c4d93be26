//! S2: what a blocker costs.

use super::super::bench::{Bench, Figure, Work, ratios};
use super::super::plain;
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use halflight_sh::{Batch, Block, LANES, coefficients, gamma};
use std::hint::black_box;

const ORDER: usize = 4;
/// Calls that one timing takes.
const CALLS: usize = 4000;

const SUMS: &str = "additions a blocker, sum of logs";
const PRODUCTS: &str = "multiply-adds a blocker, SH product";
const COUNTED: &str = "sum over product, operations";
const PLAIN: &str = "sum over product, time, one vector at a time";
const LANES_OF: &str = "sum over product, time, 16 vectors at a time";

pub(crate) const S2: Row = Row {
    id: "S2",
    place: "§1",
    claim: "At order 4 accumulating a blocker in log space costs less than 1/20 of accumulating it by an SH product",
    paper: &[(COUNTED, "< 0.05")],
    needs: "",
    measure,
    judge,
};

fn measure(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let size = coefficients(ORDER);
    let vector = |phase: f32| (0..size).map(|i| (i as f32 + phase).cos()).collect::<Vec<f32>>();
    let (a, b) = (vector(0.3), vector(1.1));
    let blocks = |v: &[f32]| v.iter().map(|x| Block::splat(*x)).collect::<Vec<Block<f32>>>();
    let (many_a, many_b, batch) = (blocks(&a), blocks(&b), Batch::new(ORDER));
    let (mut one, mut sum) = (a.clone(), a.clone());
    let (mut many, mut many_sum) = (many_a.clone(), many_a.clone());
    let mut works: [Work<'_>; 4] = [
        Box::new(|| {
            (0..CALLS).for_each(|_| plain::product(ORDER, black_box(&a), black_box(&b), &mut one));
            Ok(())
        }),
        Box::new(|| {
            (0..CALLS).for_each(|_| add(black_box(&mut sum), black_box(&b)));
            Ok(())
        }),
        Box::new(|| {
            (0..CALLS / LANES).for_each(|_| batch.product(black_box(&many_a), black_box(&many_b), &mut many));
            Ok(())
        }),
        Box::new(|| {
            (0..CALLS / LANES).for_each(|_| add_blocks(black_box(&mut many_sum), black_box(&many_b)));
            Ok(())
        }),
    ];
    let times = bench.interleaved(&mut works)?;
    drop(works);
    let per_call: Vec<Vec<f64>> = times.iter().map(|t| t.iter().map(|t| t / CALLS as f64).collect()).collect();
    let terms = gamma(ORDER).ordered_count();
    Ok(vec![
        Figure::exact(SUMS, "", size as f64, 1),
        Figure::exact(PRODUCTS, "", terms as f64, 1),
        Figure::exact(COUNTED, "", size as f64 / terms as f64, 1),
        Figure::median("SH product, one vector at a time", "ns", &per_call[0]),
        Figure::median("sum, one vector at a time", "ns", &per_call[1]),
        Figure::median(PLAIN, "", &ratios(&times[1], &times[0])),
        Figure::median("SH product, 16 vectors at a time, a vector", "ns", &per_call[2]),
        Figure::median("sum, 16 vectors at a time, a vector", "ns", &per_call[3]),
        Figure::median(LANES_OF, "", &ratios(&times[3], &times[2])),
    ])
}

#[inline(never)]
fn add(sum: &mut [f32], other: &[f32]) {
    sum.iter_mut().zip(other).for_each(|(sum, value)| *sum += value);
}

#[inline(never)]
fn add_blocks(sum: &mut [Block<f32>], other: &[Block<f32>]) {
    for (sum, value) in sum.iter_mut().zip(other) {
        sum.0.iter_mut().zip(&value.0).for_each(|(sum, value)| *sum += value);
    }
}

fn judge(figures: &Figures<'_>) -> Option<Judgement> {
    let counted = figures.value(COUNTED)?;
    let ([_, plain], lanes) = (figures.interval(PLAIN)?, figures.value(LANES_OF)?);
    let verdict = Verdict::of(&[counted < 0.05, plain < 0.05]);
    let why = format!(
        "{} additions stand against {} multiply-adds, 1/{}; in plain code the sum takes at most 1/{} of the product's time, and 1/{} \
         in lanes, where our product is cheaper by more than the sum is. What both share, finding and rotating the circle, is in S3.",
        number(figures.value(SUMS)?),
        number(figures.value(PRODUCTS)?),
        number(1.0 / counted),
        number(1.0 / plain),
        number(1.0 / lanes),
    );
    Some(Judgement { verdict, why })
}
