//! Where the forms of the product cross: `cargo bench -p halflight-sh-forms`.
//!
//! Prints nanoseconds a product of one pair in `f32`, the least of interleaved rounds, and the error of each form against the
//! sparse loop in `f64`; the generated code of `halflight-sh` stands beside, to order 8.

use std::hint::black_box;
use std::time::Instant;

use halflight_sh::{Batch, Block, LANES};
use halflight_sh_forms::{Form, Fourier, MAX_ORDER, Rings, Sparse};

const ROUNDS: usize = 25;

struct Kernel {
    name: &'static str,
    /// Vectors that one call multiplies.
    vectors: usize,
    run: Box<dyn FnMut()>,
    times: Vec<f64>,
    error: f64,
}

fn vector(order: usize, phase: f64) -> Vec<f64> {
    (0..order * order).map(|i| (1.7 * i as f64 + phase).sin()).collect()
}

fn norm(v: impl Iterator<Item = f64>) -> f64 {
    v.map(|x| x * x).sum::<f64>().sqrt()
}

fn main() {
    println!(
        "| order | sparse loop | rings | Fourier | generated, one pair | generated, batch | errors of rings, Fourier |"
    );
    println!("|---|---|---|---|---|---|---|");
    for order in 2..=MAX_ORDER {
        let (a, b) = (vector(order, 0.3), vector(order, 1.1));
        let [wide_a, wide_b] = [&a, &b].map(|v| v.iter().map(|&x| f64::from(x as f32)).collect::<Vec<_>>());
        let mut want = a.clone();
        Sparse::<f64>::new(order).product(&wide_a, &wide_b, &mut want);
        let scale = norm(wide_a.iter().copied()) * norm(wide_b.iter().copied());
        let [a, b] = [a, b].map(|v| v.iter().map(|&x| x as f32).collect::<Vec<_>>());

        let mut kernels = vec![
            form("sparse", Sparse::new(order), &a, &b, &want, scale),
            form("rings", Rings::new(order), &a, &b, &want, scale),
            form("fourier", Fourier::new(order), &a, &b, &want, scale),
        ];
        if order <= halflight_sh::MAX_ORDER {
            let (x, y, mut out) = (a.clone(), b.clone(), a.clone());
            let one = move || halflight_sh::product(order, black_box(&x), black_box(&y), &mut out);
            kernels.push(Kernel { name: "one", vectors: 1, run: Box::new(one), times: Vec::new(), error: 0.0 });
            let batch = Batch::new(order);
            let [x, y] = [&a, &b].map(|v| v.iter().map(|&c| Block::splat(c)).collect::<Vec<_>>());
            let mut out = x.clone();
            let many = move || batch.product(black_box(&x), black_box(&y), &mut out);
            kernels.push(Kernel { name: "batch", vectors: LANES, run: Box::new(many), times: Vec::new(), error: 0.0 });
        }
        let repeats = 4_000_000 / order.pow(5) + 4;
        for round in 0..=ROUNDS {
            for Kernel { run, times, vectors, .. } in &mut kernels {
                let start = Instant::now();
                (0..repeats).for_each(|_| run());
                let time = start.elapsed().as_secs_f64() * 1e9 / (repeats * *vectors) as f64;
                if round > 0 {
                    times.push(time);
                }
            }
        }
        let mut cells = vec!["–".to_owned(); 5];
        for (cell, Kernel { times, .. }) in cells.iter_mut().zip(&kernels) {
            *cell = format!("{:.1}", times.iter().copied().fold(f64::MAX, f64::min));
        }
        let errors: Vec<String> = kernels[1..3].iter().map(|k| format!("{} {:.1e}", k.name, k.error)).collect();
        println!("| {order} | {} | {} |", cells.join(" | "), errors.join(", "));
    }
}

fn form(
    name: &'static str,
    mut form: impl Form<f32> + 'static,
    a: &[f32],
    b: &[f32],
    want: &[f64],
    scale: f64,
) -> Kernel {
    let (a, b, mut out) = (a.to_vec(), b.to_vec(), a.to_vec());
    form.product(&a, &b, &mut out);
    let error = norm(out.iter().zip(want).map(|(x, y)| f64::from(*x) - y)) / scale;
    let run = Box::new(move || form.product(black_box(&a), black_box(&b), &mut out));
    Kernel { name, vectors: 1, run, times: Vec::new(), error }
}
