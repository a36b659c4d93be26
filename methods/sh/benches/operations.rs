//! Every operation at every order, in both precisions, on every instruction set of the machine:
//! `cargo bench -p halflight-sh --bench operations`, with a filter such as `product/batch` behind it.
//!
//! Names are operation/form/precision/order. A batch is 48 vectors, so that all stays in the first cache and no two
//! buffers lie a multiple of 4 KiB apart; the rate is that of vectors.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use halflight_sh::{
    Batch, BatchExp, BatchLog, Block, CircleTable, ExpWorkspace, LANES, Real, Rotation, Simd, SquaringRule, Work,
    blocks_for, circle_log, coefficients, evaluate, gamma, log_eigen, pack, rotate_z, rotate_zonal,
};

const VECTORS: usize = 3 * LANES;

/// A turn about a skew axis.
const TURN: [[f64; 3]; 3] = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];

fn vector<T: Real>(order: usize, phase: f64) -> Vec<T> {
    (0..coefficients(order)).map(|i| T::from_f64((i as f64 + phase).cos())).collect()
}

/// The sum of the logs of two circles of 37°.
fn log<T: Real>(order: usize) -> Vec<T> {
    let (mut zonal, mut lobe) = (vec![0.0; order], vec![0.0; coefficients(order)]);
    circle_log(order, 0.8, &mut zonal);
    rotate_zonal(order, &zonal, [0.48, 0.6, 0.64], &mut lobe);
    lobe.iter().map(|&x| T::from_f64(2.0 * x)).collect()
}

/// Times `call`, which handles `vectors` vectors.
fn time<T, R>(criterion: &mut Criterion, name: &str, order: usize, vectors: usize, mut call: impl FnMut() -> R) {
    let precision = if size_of::<T>() == 4 { "f32" } else { "f64" };
    let mut group = criterion.benchmark_group(format!("{name}/{precision}"));
    group.throughput(Throughput::Elements(vectors as u64));
    group.bench_function(BenchmarkId::from_parameter(order), |bencher| bencher.iter(&mut call));
}

fn one<T: Real>(criterion: &mut Criterion, order: usize) {
    let (a, b, f) = (vector::<T>(order, 0.3), vector::<T>(order, 1.1), log::<T>(order));
    let mut out = a.clone();
    let direction = [0.48, 0.6, 0.64].map(T::from_f64);
    let tensor = gamma(order);
    time::<T, _>(criterion, "product/sparse loop", order, 1, || tensor.product(black_box(&a), &b, &mut out));
    time::<T, _>(criterion, "square/sparse loop", order, 1, || tensor.square(black_box(&a), &mut out));
    for batch in Simd::ALL.into_iter().filter_map(|simd| Batch::with_simd(order, simd)) {
        let form = format!("one {:?}", batch.simd());
        let name = |operation: &str| format!("{operation}/{form}");
        time::<T, _>(criterion, &name("product"), order, 1, || batch.single_product(black_box(&a), &b, &mut out));
        time::<T, _>(criterion, &name("square"), order, 1, || batch.single_square(black_box(&a), &mut out));
        time::<T, _>(criterion, &name("triple product"), order, 1, || {
            black_box(batch.single_triple_product(black_box(&a), &b, &f));
        });
    }
    time::<T, _>(criterion, "evaluate/one", order, 1, || evaluate(order, black_box(direction), &mut out));
    let mut zonal = vec![T::ONE; order];
    time::<T, _>(criterion, "zonal rotation/one", order, 1, || {
        rotate_zonal(order, &zonal, black_box(direction), &mut out)
    });
    let rotation = Rotation::new(order, TURN);
    time::<T, _>(criterion, "general rotation/one", order, 1, || rotation.apply(black_box(&a), &mut out));
    time::<T, _>(criterion, "rotation about z/one", order, 1, || rotate_z(order, T::ONE, black_box(&a), &mut out));
    let (table, sine) = (CircleTable::log(order), T::from_f64(0.4));
    time::<T, _>(criterion, "circle log/table", order, 1, || table.lookup(black_box(sine), &mut zonal));
    let (mut exp, rule) = (ExpWorkspace::<T>::new(order), SquaringRule::default());
    time::<T, _>(criterion, "exp PS-21/one", order, 1, || exp.product_series(21, black_box(&f), &mut out));
    time::<T, _>(criterion, "exp PS*-2/one", order, 1, || exp.scaled_series(2, rule, black_box(&f), &mut out));
    time::<T, _>(criterion, "exp PS*-5/one", order, 1, || exp.scaled_series(5, rule, black_box(&f), &mut out));
    time::<T, _>(criterion, "exp OL/one", order, 1, || exp.optimal_linear(black_box(&f), &mut out));
    time::<T, _>(criterion, "exp HYB/one", order, 1, || exp.hybrid(rule, black_box(&f), &mut out));
    time::<T, _>(criterion, "exp eigen/one", order, 1, || exp.eigen(black_box(&f), &mut out));
}

fn many<T: Real>(criterion: &mut Criterion, batch: Batch) {
    let order = batch.order();
    let blocks = |v: Vec<T>| -> Vec<Block<T>> {
        let mut blocks = vec![Block::ZERO; blocks_for(order, VECTORS)];
        pack(order, &v.repeat(VECTORS), &mut blocks);
        blocks
    };
    let [a, b, f] = [vector(order, 0.3), vector(order, 1.1), log(order)].map(blocks);
    let mut out = a.clone();
    let form = format!("batch {:?}", batch.simd());
    let mut run = |operation: &str, call: &mut dyn FnMut()| {
        time::<T, _>(criterion, &format!("{operation}/{form}"), order, VECTORS, call);
    };
    run("product", &mut || batch.product(black_box(&a), &b, &mut out));
    run("square", &mut || batch.square(black_box(&a), &mut out));
    let [x, y] = [0.3, 1.1].map(|phase| vector::<T>(order, phase).repeat(VECTORS));
    let mut products = x.clone();
    run("product of vectors", &mut || batch.product_vectors(black_box(&x), &y, &mut products));
    let mut matrix = vec![T::ZERO; coefficients(order).pow(2)];
    gamma(order).product_matrix(&x[..coefficients(order)], &mut matrix);
    run("matrix product", &mut || batch.matrix_product(black_box(&matrix), &b, &mut out));
    let mut sums = vec![Block::ZERO; VECTORS / LANES];
    run("triple product", &mut || batch.triple_product(black_box(&a), &b, &f, &mut sums));
    let directions = vec![[0.48, 0.6, 0.64].map(|x| Block::splat(T::from_f64(x))); VECTORS / LANES];
    run("evaluate", &mut || batch.evaluate(black_box(&directions), &mut out));
    let mut zonal = vec![Block::splat(T::from_f64(0.7)); VECTORS / LANES * order];
    run("zonal rotation", &mut || batch.rotate_zonal(black_box(&zonal), &directions, &mut out));
    out.fill(Block::ZERO);
    let none = vec![Block::ZERO; zonal.len()];
    run("zonal rotation, added", &mut || {
        batch.sum_zonal(black_box(&none), &directions, &mut out[..coefficients(order)])
    });
    let rotation = Rotation::new(order, TURN);
    run("general rotation", &mut || batch.rotate(&rotation, black_box(&a), &mut out));
    let angles = vec![[0.6, 0.8].map(|x| Block::splat(T::from_f64(x))); VECTORS / LANES];
    run("rotation about z", &mut || batch.rotate_z(&angles, black_box(&a), &mut out));
    let sines = vec![Block::splat(T::from_f64(0.4)); VECTORS / LANES];
    run("circle visibility", &mut || batch.circle_visibilities(black_box(&sines), &mut zonal));
    run("circle log", &mut || batch.circle_logs(black_box(&sines), &mut zonal));
    let (mut exp, mut work, rule) =
        (BatchExp::<T>::new(batch), vec![Work::default(); VECTORS], SquaringRule::default());
    run("exp PS*-2", &mut || exp.scaled_series(2, rule, black_box(&f), &mut out, &mut work));
    run("exp PS*-5", &mut || exp.scaled_series(5, rule, black_box(&f), &mut out, &mut work));
    run("exp OL", &mut || exp.optimal_linear(black_box(&f), &mut out, &mut work));
    run("exp HYB", &mut || exp.hybrid(rule, black_box(&f), &mut out, &mut work));
    let (mut log, mut open) =
        (BatchLog::new(batch), f.iter().map(|_| Block::splat(T::from_f64(0.02))).collect::<Vec<_>>());
    open.iter_mut().step_by(coefficients(order)).for_each(|mean| *mean = Block::splat(T::from_f64(3.5)));
    run("eigen log", &mut || log.eigen(black_box(&open), &mut out));
}

fn operations(criterion: &mut Criterion) {
    for order in 2..=8 {
        one::<f32>(criterion, order);
        one::<f64>(criterion, order);
        for batch in Simd::ALL.into_iter().filter_map(|simd| Batch::with_simd(order, simd)) {
            many::<f32>(criterion, batch);
            many::<f64>(criterion, batch);
        }
        let g = {
            let mut g = log::<f64>(order).iter().map(|x| 0.2 * x).collect::<Vec<_>>();
            g[0] += 3.5;
            g
        };
        let mut out = g.clone();
        time::<f64, _>(criterion, "eigen log/one", order, 1, || log_eigen(order, black_box(&g), &mut out));
    }
}

/// Short: there are about a thousand.
fn brief() -> Criterion {
    Criterion::default()
        .sample_size(10)
        .nresamples(1000)
        .warm_up_time(Duration::from_millis(10))
        .measurement_time(Duration::from_millis(40))
}

criterion_group! { name = benches; config = brief(); targets = operations }
criterion_main!(benches);
