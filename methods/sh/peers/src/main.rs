//! All basis functions at directions, by `halflight-sh` and by the packages that registries hold, in one interleaved run:
//! `cargo run --release --manifest-path methods/sh/peers/Cargo.toml`.
//!
//! Peers: crates `sphrs` and `spherical-harmonics`, and PyPI's `sphericart` where `HALFLIGHT_PYTHON` (or `python3`) has it and
//! `numpy`. Prints nanoseconds a direction, medians over rounds, ratios to the first with their quartiles, and the largest
//! difference to `halflight-sh` in `f64` (up to the sign of functions, which conventions differ in).

mod sphericart;

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

use halflight_sh::{Batch, Block, LANES, Simd, coefficients, evaluate};
use rand::RngCore;
use sphericart::Sphericart;
use sphrs::{Coordinates, HarmonicsSet, RealSH};

const ROUNDS: usize = 31;
/// Directions of one timing.
const DIRECTIONS: usize = 10_000;

/// Times all directions once, in seconds.
type Timer = Box<dyn FnMut() -> f64>;

struct Peer {
    name: String,
    time: Timer,
    /// The largest difference to the truth.
    error: f64,
    times: Vec<f64>,
}

fn directions() -> Vec<[f64; 3]> {
    let golden = (5f64.sqrt() - 1.0) * PI;
    let one = |k: usize| {
        let z = 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64;
        let (radius, phi) = ((1.0 - z * z).sqrt(), golden * k as f64);
        [radius * phi.cos(), radius * phi.sin(), z]
    };
    (0..DIRECTIONS).map(one).collect()
}

/// The largest difference of magnitudes: conventions may differ in sign.
fn difference(order: usize, directions: &[[f64; 3]], mut values: impl FnMut(usize) -> Vec<f64>) -> f64 {
    let mut want = vec![0.0; coefficients(order)];
    let mut worst = 0.0f64;
    for (k, &s) in directions.iter().enumerate().step_by(37) {
        evaluate(order, s, &mut want);
        for (got, want) in values(k).iter().zip(&want) {
            worst = worst.max((got.abs() - want.abs()).abs());
        }
    }
    worst
}

fn timer(mut all: impl FnMut() + 'static) -> Timer {
    Box::new(move || {
        let start = Instant::now();
        all();
        start.elapsed().as_secs_f64()
    })
}

fn ours(order: usize, s: &[[f64; 3]]) -> Vec<Peer> {
    let single: Vec<[f32; 3]> = s.iter().map(|s| s.map(|x| x as f32)).collect();
    let mut out = vec![0.0f32; coefficients(order)];
    let error = difference(order, s, |k| {
        evaluate(order, single[k], &mut out);
        out.iter().map(|&x| f64::from(x)).collect()
    });
    let all = single.clone();
    let one = timer(move || all.iter().for_each(|s| evaluate(order, black_box(*s), black_box(&mut out))));
    let mut peers = vec![Peer { name: "halflight-sh, one".into(), time: one, error, times: Vec::new() }];
    let blocks: Vec<[Block<f32>; 3]> = single
        .chunks_exact(LANES)
        .map(|group| std::array::from_fn(|axis| Block(std::array::from_fn(|lane| group[lane][axis]))))
        .collect();
    for batch in Simd::ALL.into_iter().filter_map(|simd| Batch::with_simd(order, simd)) {
        let mut out = vec![Block::<f32>::ZERO; coefficients(order) * blocks.len()];
        batch.evaluate(&blocks, &mut out);
        let error = difference(order, s, |k| {
            let vector = &out[k / LANES * coefficients(order)..][..coefficients(order)];
            vector.iter().map(|block| f64::from(block.0[k % LANES])).collect()
        });
        let blocks = blocks.clone();
        let time = timer(move || batch.evaluate(black_box(&blocks), black_box(&mut out)));
        peers.push(Peer { name: format!("halflight-sh, batch, {:?}", batch.simd()), time, error, times: Vec::new() });
    }
    peers
}

fn sphrs(order: usize, s: &[[f64; 3]]) -> Peer {
    let single: Vec<[f32; 3]> = s.iter().map(|s| s.map(|x| x as f32)).collect();
    let set = HarmonicsSet::new(order - 1, RealSH::Spherical);
    let at = |[x, y, z]: [f32; 3]| Coordinates::cartesian(x, y, z);
    let error = difference(order, s, |k| set.eval(&at(single[k])).into_iter().map(f64::from).collect());
    let all = move || single.iter().for_each(|s| drop(black_box(set.eval(&at(black_box(*s))))));
    Peer { name: "sphrs".into(), time: timer(all), error, times: Vec::new() }
}

/// `spherical-harmonics` evaluates within projections only: of one "random" sample, whose two numbers place it.
struct Placed {
    numbers: [u32; 2],
    next: usize,
}

impl Placed {
    fn new([x, y, z]: [f64; 3]) -> Self {
        // From 1 - cos θ over 2 and φ over a turn; the high 24 bits count.
        let bits = |unit: f64| ((unit * f64::from(1 << 24)) as u32).min((1 << 24) - 1) << 8;
        Self { numbers: [bits(0.5 * (1.0 + z)), bits((y.atan2(x) / TAU).rem_euclid(1.0))], next: 0 }
    }
}

impl RngCore for Placed {
    fn next_u32(&mut self) -> u32 {
        self.next += 1;
        self.numbers[(self.next - 1) % 2]
    }
    fn next_u64(&mut self) -> u64 {
        self.next_u32().into()
    }
    fn fill_bytes(&mut self, _: &mut [u8]) {}
    fn try_fill_bytes(&mut self, _: &mut [u8]) -> Result<(), rand::Error> {
        Ok(())
    }
}

fn spherical_harmonics(order: usize, s: &[[f64; 3]]) -> Peer {
    let value = 1.0 / (4.0 * PI) as f32;
    let bands = order as i32 - 1;
    let at = move |s: [f64; 3]| spherical_harmonics::project_fn(bands, 1, &mut Placed::new(s), |_, _| value);
    let error = difference(order, s, |k| at(s[k]).into_iter().map(f64::from).collect());
    let s = s.to_vec();
    let all = move || s.iter().for_each(|s| drop(black_box(at(black_box(*s)))));
    Peer { name: "spherical-harmonics".into(), time: timer(all), error, times: Vec::new() }
}

fn quantile(sorted: &[f64], q: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * q).round() as usize]
}

fn main() {
    let s = directions();
    println!("| order | package | ns a direction | times as fast as `sphrs` (quartiles) | largest difference |");
    println!("|---|---|---|---|---|");
    for order in 2..=8 {
        let mut peers = vec![sphrs(order, &s), spherical_harmonics(order, &s)];
        peers.extend(ours(order, &s));
        for precision in ["float32", "float64"] {
            if let Some((peer, values)) = Sphericart::start(order, precision, &s) {
                let error = difference(order, &s, |k| values[k / 37].clone());
                let (name, mut peer) = (format!("sphericart, {precision}"), peer);
                peers.push(Peer { name, time: Box::new(move || peer.time()), error, times: Vec::new() });
            }
        }
        for round in 0..=ROUNDS {
            for Peer { time, times, .. } in &mut peers {
                let seconds = time();
                if round > 0 {
                    times.push(seconds * 1e9 / DIRECTIONS as f64);
                }
            }
        }
        for Peer { name, error, times, .. } in &peers {
            let mut ratios: Vec<f64> = peers[0].times.iter().zip(times).map(|(base, time)| base / time).collect();
            let mut times = times.clone();
            ratios.sort_by(f64::total_cmp);
            times.sort_by(f64::total_cmp);
            let [low, middle, high] = [0.25, 0.5, 0.75].map(|q| quantile(&ratios, q));
            let time = quantile(&times, 0.5);
            println!("| {order} | {name} | {time:.2} | {middle:.1} ({low:.1}–{high:.1}) | {error:.0e} |");
        }
    }
}
