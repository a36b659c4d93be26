//! Products, squares and rotations as shaders compute them, at every order: against tables in `f64`, and a number planted in each.
#![cfg(feature = "gpu")]

use std::ops::{Range, RangeInclusive};

use halflight_contract::NoMeter;
use halflight_gpu::{Access, Gpu, Pass, Resident};
use halflight_sh::{coefficients, gamma, rotate_zonal, wgsl};

/// Pairs of vectors.
const PAIRS: usize = 64;

const SHADER: &str = "
@group(0) @binding(0) var<storage, read> tables: array<f32>;
@group(0) @binding(1) var<storage, read> given: array<array<Vector, 2>>;
@group(0) @binding(2) var<storage, read_write> results: array<array<Vector, 3>>;

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) i: u32) {
    let a = given[i][0];
    let b = given[i][1];
    var zonal: Zonal;
    for (var l = 0u; l < ORDER; l++) {
        zonal[l] = a[l];
    }
    results[i][0] = product(a, b);
    results[i][1] = square(a);
    results[i][2] = rotate_zonal(zonal, direction(b[0]));
}

fn direction(x: f32) -> vec3f {
    let across = sqrt(1f - x * x);
    return vec3f(0.6f * across, 0.8f * across, x);
}
";

/// What a shader's text computes of pairs of vectors: products, squares of the first, rotations of its first values.
fn computed(gpu: &Gpu, order: usize, text: &str, given: &[f32]) -> Vec<f32> {
    let meter = &mut NoMeter;
    let [mut tables, mut pairs, mut results] = ["tables", "pairs", "results"].map(Resident::new);
    tables.upload(gpu, meter, &wgsl::tables(order)).expect("fits");
    pairs.upload(gpu, meter, given).expect("fits");
    let size = 3 * PAIRS * coefficients(order);
    results.reserve(gpu, 4 * size as u64).expect("fits");
    let access = [Access::Read, Access::Read, Access::Write];
    let pipeline = gpu.pipeline("algebra", text, &access).expect("compiles");
    let buffers = [tables.whole(), pairs.whole(), results.whole()];
    let pass = Pass { name: "algebra", pipeline: &pipeline, buffers: &buffers, threads: PAIRS as u64 };
    gpu.run(&[pass], meter).expect("runs");
    gpu.download(&results, size, meter).expect("as many")
}

/// The same in `f64`.
fn expected(order: usize, given: &[f32]) -> Vec<f64> {
    let (size, gamma) = (coefficients(order), gamma(order));
    let given: Vec<f64> = given.iter().map(|value| f64::from(*value)).collect();
    let mut all = Vec::new();
    for pair in given.chunks_exact(2 * size) {
        let (a, b) = pair.split_at(size);
        let across = (1.0 - b[0] * b[0]).sqrt();
        let [mut product, mut square, mut turned] = [0; 3].map(|_| vec![0.0; size]);
        gamma.product(a, b, &mut product);
        gamma.product(a, a, &mut square);
        rotate_zonal(order, &a[..order], [0.6 * across, 0.8 * across, b[0]], &mut turned);
        all.extend([product, square, turned].concat());
    }
    all
}

/// Vectors of values in [−0.9, 0.9].
fn pairs(order: usize) -> Vec<f32> {
    (0..2 * PAIRS * coefficients(order)).map(|i| 0.9 * (2.399 * i as f32 + 0.7 * (i % 7) as f32).sin()).collect()
}

/// Where the texts of products, squares and rotations lie among what is generated, each with its table if it has one.
fn functions(text: &str) -> [Range<usize>; 3] {
    let first = |names: &[&str]| names.iter().filter_map(|name| text.find(name)).min().expect("is generated");
    let product = first(&["const PRODUCT", "fn product"]);
    let [square, turn] = [first(&["const SQUARE", "fn square"]), first(&["fn rotate_zonal"])];
    let end = turn + text[turn..].find("\n}").expect("a function ends");
    [product..square, square..turn, turn..end]
}

/// The text with three numbers of each function larger by a twentieth.
fn planted(text: &str) -> String {
    let mut faulty = text.to_owned();
    for function in functions(text).into_iter().rev() {
        let numbers: Vec<Range<usize>> = numbers(&text[function.clone()]).collect();
        for quarter in [3, 2, 1] {
            let number = &numbers[quarter * numbers.len() / 4];
            let place = function.start + number.start..function.start + number.end;
            let value: f32 = text[place.clone()].parse().expect("a number");
            faulty.replace_range(place, &format!("{:?}", 1.05 * value));
        }
    }
    faulty
}

/// Where numbers with a point that end in `f` stand.
fn numbers(text: &str) -> impl Iterator<Item = Range<usize>> {
    let ends = text.match_indices('f').map(|(end, _)| end);
    ends.filter_map(|end| {
        let digits = text[..end].bytes().rev().take_while(|byte| byte.is_ascii_digit() || *byte == b'.').count();
        text[end - digits..end].contains('.').then_some(end - digits..end)
    })
}

/// The largest distance of products, squares and rotations from what is expected, over what roundings may add up to.
///
/// A product of rings costs 3n sums one after another on values that are at most the vectors' norms, 0.9n each, a rotation n; a
/// rounding is u of those, and N independent ones add up to more than 4√N·u with a probability of 1e-4 (Higham and Mary 2019).
fn errors(order: usize, found: &[f32], expected: &[f64]) -> [f64; 3] {
    let n = order as f64;
    let allowed = 4.0 * (3.0 * n).sqrt() * f64::from(f32::EPSILON) / 2.0 * (0.9 * n).powi(2).max(1.0);
    let size = coefficients(order);
    let mut errors = [0.0; 3];
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = &mut errors[i / size % 3];
        *error = f64::max(*error, (f64::from(*found) - expected).abs() / allowed);
    }
    errors
}

fn check(orders: RangeInclusive<usize>) {
    let gpu = Gpu::open(0).unwrap_or_else(|error| panic!("tests of the GPU need an adapter: {error}"));
    for order in orders {
        let (text, given) = (wgsl::algebra(order) + SHADER, pairs(order));
        let expected = expected(order, &given);
        let right = errors(order, &computed(&gpu, order, &text, &given), &expected);
        let wrong = errors(order, &computed(&gpu, order, &planted(&text), &given), &expected);
        println!("order {order}: {right:.2?} of what is allowed, {wrong:.0?} with wrong numbers");
        assert!(right.iter().all(|error| *error <= 1.0), "order {order}: {right:?}");
        assert!(wrong.iter().all(|error| *error > 10.0), "order {order}: {wrong:?}");
    }
}

#[test]
fn orders_1_to_7_are_right_and_a_wrong_number_is_seen() {
    check(1..=7);
}

/// Beside the others: a software adapter compiles it as long as all of them.
#[test]
fn order_8_is_right_and_a_wrong_number_is_seen() {
    check(8..=8);
}
