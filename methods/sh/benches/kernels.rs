//! Single calls of the kernels that methods lean on, by criterion: `cargo bench -p halflight-sh --bench kernels`.
//! `ratios` compares them with other implementations.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use halflight_sh::{coefficients, evaluate, gamma, rotate_zonal};
use std::hint::black_box;

fn kernels(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sh");
    for order in [3, 4, 6] {
        let vector = |phase: f32| (0..coefficients(order)).map(|i| (i as f32 + phase).cos()).collect::<Vec<f32>>();
        let (a, b, mut out) = (vector(0.3), vector(0.7), vector(0.0));
        let axis = [0.36, 0.48, 0.8];
        group.bench_function(BenchmarkId::new("product", order), |bencher| {
            let gamma = gamma(order);
            bencher.iter(|| gamma.product(black_box(&a), black_box(&b), &mut out));
        });
        group.bench_function(BenchmarkId::new("evaluate", order), |bencher| {
            bencher.iter(|| evaluate(order, black_box(axis), &mut out));
        });
        group.bench_function(BenchmarkId::new("rotate zonal", order), |bencher| {
            bencher.iter(|| rotate_zonal(order, black_box(&a[..order]), black_box(axis), &mut out));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(30).without_plots();
    targets = kernels
}
criterion_main!(benches);
