//! Where the forms of the product cross: `cargo bench -p halflight-sh-forms`; with `-- --plots ../plots` it draws those of the page, too.
//!
//! Prints nanoseconds a product in `f32`, the least of interleaved rounds, and each form's largest error relative to
//! ‖a‖‖b‖ over lobes times themselves, which err most, and vectors without pattern; the generated code of `halflight-sh`
//! stands beside, to order 8.

mod plot;

use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

use halflight_sh::{Batch, Block, LANES};
use halflight_sh_forms::{Form, Fourier, MAX_ORDER, Rings, Sparse};

const ROUNDS: usize = 25;

/// Pairs whose products are compared.
const PAIRS: usize = 24;

type Product = Box<dyn FnMut(&[f32], &[f32], &mut [f32])>;

/// A way to multiply one pair, or sixteen.
struct Kernel {
    name: &'static str,
    product: Product,
    /// One call on the pair that is timed, and the vectors that it multiplies.
    call: Box<dyn FnMut()>,
    vectors: usize,
}

/// What was measured of a kernel at an order.
struct Point {
    name: &'static str,
    order: usize,
    nanoseconds: f64,
    error: f64,
}

fn vector(order: usize, phase: f64) -> Vec<f32> {
    (0..order * order).map(|i| (1.7 * i as f64 + phase).sin() as f32).collect()
}

/// A narrow lobe: its coefficients are the basis functions at its axis, of which `sphrs` has those of bands up to 10.
fn lobe(order: usize, k: usize) -> Vec<f32> {
    use sphrs::{Coordinates, RealSH, SHEval};
    let z = 1.0 - (2 * k + 1) as f64 / PAIRS as f64;
    let (radius, phi) = ((1.0 - z * z).sqrt(), 2.4 * k as f64);
    let s = Coordinates::cartesian(radius * phi.cos(), radius * phi.sin(), z);
    let functions = (0..order.min(11) as i64).flat_map(|l| (-l..=l).map(move |m| (l, m)));
    let mut out: Vec<f32> = functions.map(|(l, m)| RealSH::Spherical.eval(l, m, &s) as f32).collect();
    out.resize(order * order, 0.0);
    out
}

fn norm(v: impl Iterator<Item = f64>) -> f64 {
    v.map(|x| x * x).sum::<f64>().sqrt()
}

fn form(name: &'static str, order: usize, make: fn(usize) -> Product) -> Kernel {
    let (a, b) = (vector(order, 0.3), vector(order, 1.1));
    let (mut timed, mut out) = (make(order), a.clone());
    let call = Box::new(move || timed(black_box(&a), black_box(&b), &mut out));
    Kernel { name, product: make(order), call, vectors: 1 }
}

fn of(mut form: impl Form<f32> + 'static) -> Product {
    Box::new(move |a, b, out| form.product(a, b, out))
}

fn batch(order: usize) -> Kernel {
    let batch = Batch::new(order);
    let blocks = |v: &[f32]| v.iter().map(|&c| Block::splat(c)).collect::<Vec<_>>();
    let (a, b) = (blocks(&vector(order, 0.3)), blocks(&vector(order, 1.1)));
    let mut many = a.clone();
    let call = Box::new(move || batch.product(black_box(&a), black_box(&b), &mut many));
    let product = move |a: &[f32], b: &[f32], out: &mut [f32]| {
        let mut many = blocks(a);
        batch.product(&blocks(a), &blocks(b), &mut many);
        out.iter_mut().zip(&many).for_each(|(out, block)| *out = block.0[0]);
    };
    Kernel { name: "generated, batch", product: Box::new(product), call, vectors: LANES }
}

fn kernels(order: usize) -> Vec<Kernel> {
    let mut kernels = vec![
        form("sparse loop", order, |order| of(Sparse::new(order))),
        form("rings", order, |order| of(Rings::new(order))),
        form("Fourier", order, |order| of(Fourier::new(order))),
    ];
    if order <= halflight_sh::MAX_ORDER {
        kernels.push(form("generated, one pair", order, |order| {
            Box::new(move |a, b, out| halflight_sh::product(order, a, b, out))
        }));
        kernels.push(batch(order));
    }
    kernels
}

fn errors(order: usize, kernels: &mut [Kernel]) -> Vec<f64> {
    let mut exact = Sparse::<f64>::new(order);
    let mut worst = vec![0.0f64; kernels.len()];
    for k in 0..PAIRS {
        let (lobe, a, b) = (lobe(order, k), vector(order, k as f64), vector(order, 0.7 * k as f64 + 0.5));
        for (a, b) in [(&lobe, &lobe), (&a, &b)] {
            let [wide_a, wide_b] = [a, b].map(|v| v.iter().map(|&x| f64::from(x)).collect::<Vec<_>>());
            let mut want = wide_a.clone();
            exact.product(&wide_a, &wide_b, &mut want);
            let scale = norm(wide_a.into_iter()) * norm(wide_b.into_iter());
            let mut out = a.clone();
            for (worst, kernel) in worst.iter_mut().zip(kernels.iter_mut()) {
                (kernel.product)(a, b, &mut out);
                let error = norm(out.iter().zip(&want).map(|(x, y)| f64::from(*x) - y)) / scale;
                *worst = worst.max(error);
            }
        }
    }
    worst
}

fn measure(order: usize) -> Vec<Point> {
    let mut kernels = kernels(order);
    let errors = errors(order, &mut kernels);
    let repeats = 4_000_000 / order.pow(5) + 4;
    let mut least = vec![f64::MAX; kernels.len()];
    for _ in 0..ROUNDS {
        for (least, Kernel { call, vectors, .. }) in least.iter_mut().zip(&mut kernels) {
            let start = Instant::now();
            (0..repeats).for_each(|_| call());
            *least = least.min(start.elapsed().as_secs_f64() * 1e9 / (repeats * *vectors) as f64);
        }
    }
    let points = kernels.iter().zip(least).zip(errors);
    points.map(|((kernel, nanoseconds), error)| Point { name: kernel.name, order, nanoseconds, error }).collect()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let folder = args.iter().position(|arg| arg == "--plots").and_then(|k| args.get(k + 1)).map(PathBuf::from);
    let names = ["sparse loop", "rings", "Fourier", "generated, one pair", "generated, batch"];
    println!("| order | {} |\n|---|---|---|---|---|---|", names.join(" | "));
    let mut points = Vec::new();
    for order in 2..=MAX_ORDER {
        let found = measure(order);
        let cell = |name: &&str| {
            let point = found.iter().find(|point| point.name == *name);
            point.map_or("–".to_owned(), |p| format!("{:.1} ns, {:.1e}", p.nanoseconds, p.error))
        };
        println!("| {order} | {} |", names.iter().map(cell).collect::<Vec<_>>().join(" | "));
        points.extend(found);
    }
    if let Some(folder) = folder
        && let Err(error) = plot::draw(&folder, &names, &points)
    {
        eprintln!("{}: {error}", folder.display());
    }
}
