//! Prints times of products and of other operations in interleaved runs, with their ratios to well-compiled scalar code and
//! to the published crate `sphrs`: `cargo bench -p halflight-sh --bench ratios`, with orders after `--` for these alone.
//!
//! Each round times every kernel once; a ratio is the median over rounds of the ratio within a round, with its quartiles.

mod baseline;

use std::hint::black_box;
use std::time::Instant;

use baseline::plain_product;
use halflight_sh::{
    Batch, BatchExp, Block, ExpWorkspace, LANES, Real, Rotation, Simd, SquaringRule, Work, circle_log, coefficients,
    evaluate, gamma, rotate_zonal,
};
use sphrs::{Coordinates, HarmonicsSet, RealSH};

const ROUNDS: usize = 41;
/// Groups of 16 vectors; batches of four would lie 4 KiB apart at order 4, where stores look like later loads' data.
const BLOCKS: usize = 3;
/// Products that one timing takes.
const PRODUCTS: usize = 16 * BLOCKS * LANES;

/// A rotation by about 60°.
const TURN: [[f64; 3]; 3] =
    [[2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], [2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0], [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]];

struct Kernel {
    name: String,
    run: Box<dyn FnMut()>,
    /// Nanoseconds a product, round by round.
    times: Vec<f64>,
}

fn kernel(name: &str, per_call: usize, mut call: impl FnMut() + 'static) -> Kernel {
    let run = Box::new(move || (0..PRODUCTS / per_call).for_each(|_| call()));
    Kernel { name: name.into(), run, times: Vec::new() }
}

fn vector<T: Real>(order: usize, phase: f64) -> Vec<T> {
    (0..coefficients(order)).map(|i| T::from_f64((i as f64 + phase).cos())).collect()
}

fn blocks<T: Real>(order: usize, phase: f64) -> Vec<Block<T>> {
    (0..BLOCKS).flat_map(|_| vector(order, phase).into_iter().map(Block::splat)).collect()
}

fn batched<T: Real>(batch: Batch, name: &str) -> [Kernel; 2] {
    let (a, b) = (blocks::<T>(batch.order(), 0.3), blocks::<T>(batch.order(), 1.1));
    let (mut product, mut square) = (a.clone(), a.clone());
    let c = a.clone();
    [
        kernel(&format!("{name} product"), BLOCKS * LANES, move || {
            batch.product(black_box(&a), black_box(&b), &mut product);
        }),
        kernel(&format!("{name} square"), BLOCKS * LANES, move || batch.square(black_box(&c), &mut square)),
    ]
}

fn kernels(order: usize) -> Vec<Kernel> {
    let (a, b) = (vector::<f32>(order, 0.3), vector::<f32>(order, 1.1));
    let pair = move || (a.clone(), b.clone(), a.clone());
    let mut list = Vec::new();
    if (2..=6).contains(&order) {
        let (a, b, mut out) = pair();
        list.push(kernel("plain scalar", 1, move || plain_product(order, black_box(&a), black_box(&b), &mut out)));
    }
    let (a, b, mut out) = pair();
    list.push(kernel("sparse loop", 1, move || gamma(order).product(black_box(&a), black_box(&b), &mut out)));
    for batch in Simd::ALL.into_iter().filter_map(|simd| Batch::with_simd(order, simd)) {
        let name = format!("{:?}", batch.simd());
        let (a, b, mut out) = pair();
        list.push(kernel(&format!("{name} single"), 1, move || {
            batch.single_product(black_box(&a), black_box(&b), &mut out);
        }));
        list.extend(batched::<f32>(batch, &name));
        list.extend(batched::<f64>(batch, &format!("{name} f64")));
        let [a, b] = [0.3, 1.1].map(|phase| vector::<f32>(order, phase).repeat(BLOCKS * LANES));
        let mut out = a.clone();
        list.push(kernel(&format!("{name} vectors"), BLOCKS * LANES, move || {
            batch.product_vectors(black_box(&a), black_box(&b), &mut out);
        }));
    }
    list
}

/// Evaluation and what blockers cost, one vector each; the first is the peer.
fn other_kernels(order: usize) -> Vec<Kernel> {
    let direction = [0.48f32, 0.6, 0.64];
    let mut list = Vec::new();
    let peer = HarmonicsSet::new(order - 1, RealSH::Spherical);
    list.push(kernel("sphrs evaluate", 1, move || {
        black_box(peer.eval(&Coordinates::cartesian(black_box(0.48f32), 0.6, 0.64)));
    }));
    let mut out = vector::<f32>(order, 0.0);
    list.push(kernel("evaluate", 1, move || evaluate(order, black_box(direction), &mut out)));
    let log: Vec<f32> = {
        let (mut zonal, mut log) = (vec![0.0f64; order], vec![0.0f64; coefficients(order)]);
        circle_log(order, 0.8, &mut zonal);
        rotate_zonal(order, &zonal, [0.48, 0.6, 0.64], &mut log);
        log.iter().map(|&x| 2.0 * x as f32).collect()
    };
    let (f, mut out, mut one) = (log.clone(), log.clone(), ExpWorkspace::<f32>::new(order));
    list.push(kernel("eigen", 1, move || {
        one.eigen(black_box(&f), &mut out);
    }));
    let (f, mut out, mut one) = (log.clone(), log.clone(), ExpWorkspace::<f32>::new(order));
    list.push(kernel("HYB", 1, move || {
        one.hybrid(SquaringRule::default(), black_box(&f), &mut out);
    }));
    list.push(kernel("a rotation's matrix", 1, move || {
        black_box(Rotation::new(order, black_box(TURN)));
    }));
    let (rotation, v, mut out) = (Rotation::new(order, TURN), log.clone(), log.clone());
    list.push(kernel("rotation", 1, move || rotation.apply(black_box(&v), &mut out)));
    for batch in Simd::ALL.into_iter().filter_map(|simd| Batch::with_simd(order, simd)) {
        let name = format!("{:?}", batch.simd());
        let (rotation, v, mut out) = (Rotation::new(order, TURN), blocks::<f32>(order, 0.3), blocks::<f32>(order, 0.3));
        list.push(kernel(&format!("{name} one rotation"), BLOCKS * LANES, move || {
            batch.rotate(&rotation, black_box(&v), &mut out);
        }));
        let turns = [TURN.map(|row| row.map(|entry| Block::splat(entry as f32))); BLOCKS];
        let (v, mut out) = (blocks::<f32>(order, 0.3), blocks::<f32>(order, 0.3));
        list.push(kernel(&format!("{name} own rotations"), BLOCKS * LANES, move || {
            batch.rotate_each(black_box(&turns), black_box(&v), &mut out);
        }));
        let directions = vec![direction.map(Block::splat); BLOCKS];
        let zonal = vec![Block::splat(0.7f32); BLOCKS * order];
        let (mut out, lanes) = (blocks::<f32>(order, 0.0), BLOCKS * LANES);
        let d = directions.clone();
        list.push(kernel(&format!("{name} evaluate"), lanes, move || batch.evaluate(black_box(&d), &mut out)));
        let (mut out, d, z) = (blocks::<f32>(order, 0.0), directions.clone(), zonal.clone());
        list.push(kernel(&format!("{name} zonal rotation"), lanes, move || {
            batch.rotate_zonal(black_box(&z), black_box(&d), &mut out);
        }));
        let (sines, mut zonal) = (vec![Block::splat(0.4f32); BLOCKS], zonal);
        let mut out = vec![Block::ZERO; coefficients(order)];
        list.push(kernel(&format!("{name} log blocker"), lanes, move || {
            batch.circle_logs(black_box(&sines), &mut zonal);
            batch.sum_zonal(&zonal, &directions, &mut out);
            black_box(&mut out).fill(Block::ZERO);
        }));
        let f: Vec<Block<f32>> = (0..BLOCKS).flat_map(|_| log.iter().map(|&x| Block::splat(x))).collect();
        let (mut out, mut exp, mut work) = (f.clone(), BatchExp::new(batch), vec![Work::default(); lanes]);
        let g = f.clone();
        list.push(kernel(&format!("{name} eigen"), lanes, move || {
            exp.eigen(black_box(&g), &mut out, &mut work);
        }));
        let (mut out, mut exp, mut work) = (f.clone(), BatchExp::new(batch), vec![Work::default(); lanes]);
        list.push(kernel(&format!("{name} HYB"), lanes, move || {
            exp.hybrid(SquaringRule::default(), black_box(&f), &mut out, &mut work);
        }));
        let (a, b) = (blocks::<f32>(order, 0.3), blocks::<f32>(order, 1.1));
        let mut out = a.clone();
        list.push(kernel(&format!("{name} product"), lanes, move || batch.product(black_box(&a), &b, &mut out)));
    }
    list
}

fn quantile(values: &[f64], q: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * q).round() as usize]
}

fn main() {
    let mut orders: Vec<usize> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    if orders.is_empty() {
        orders = (2..=8).collect();
    }
    for (order, mut list) in
        orders.into_iter().flat_map(|order| [(order, kernels(order)), (order, other_kernels(order))])
    {
        for round in 0..=ROUNDS {
            for Kernel { run, times, .. } in &mut list {
                let start = Instant::now();
                run();
                let time = start.elapsed().as_secs_f64() * 1e9 / PRODUCTS as f64;
                if round > 0 {
                    times.push(time);
                }
            }
        }
        println!(
            "order {order}: {} times as fast as (quartiles); nanoseconds a product, median and minimum",
            list[0].name
        );
        for Kernel { name, times, .. } in &list {
            let ratios: Vec<f64> = list[0].times.iter().zip(times).map(|(base, time)| base / time).collect();
            let [low, middle, high] = [0.25, 0.5, 0.75].map(|q| quantile(&ratios, q));
            let (median, least) = (quantile(times, 0.5), quantile(times, 0.0));
            println!("  {name:22} {middle:6.2} ({low:.2}–{high:.2}) {median:9.2} {least:9.2}");
        }
    }
}
