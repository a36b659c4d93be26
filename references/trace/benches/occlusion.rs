//! Rays a second against a bumpy sphere of 72 000 triangles: incoherent segments and bundles of 64 from one receiver,
//! any hit and closest hit, in one level and in two.

use std::f32::consts::{PI, TAU};
use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{Quat, Vec3};
use halflight_trace::{Body, Geometry, Instance, Ray, World};

mod random;
use random::Random;

const BANDS: u32 = 134;
const RAYS: usize = 4096;
const BUNDLE: usize = 64;

/// A surface folded enough that rays from it meet it again.
fn bumpy_sphere() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let sectors = 2 * BANDS;
    let position = |band: u32, sector: u32| {
        let (polar, azimuth) = (PI * band as f32 / BANDS as f32, TAU * sector as f32 / sectors as f32);
        let radius = 1.0 + 0.2 * (9.0 * polar).sin() * (8.0 * azimuth).cos() * polar.sin();
        Vec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos()) * radius
    };
    let positions = (0..=BANDS).flat_map(|band| (0..sectors).map(move |sector| position(band, sector))).collect();
    let at = |band: u32, sector: u32| band * sectors + sector % sectors;
    let quads = (0..BANDS).flat_map(|band| (0..sectors).map(move |sector| (band, sector)));
    let halves = |(band, sector)| {
        let [a, b] = [at(band, sector), at(band + 1, sector)];
        let [c, d] = [at(band + 1, sector + 1), at(band, sector + 1)];
        [[a, b, c], [a, c, d]]
    };
    (positions, quads.flat_map(halves).collect())
}

fn incoherent(random: &mut Random) -> Vec<Ray> {
    let mut ray = |_| {
        let origin = random.direction() * 1.3;
        let direction = (random.direction() * random.unit() - origin).normalize();
        Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    };
    (0..RAYS).map(&mut ray).collect()
}

/// Points on the surface, each with cosine-distributed directions about its normal.
fn receivers(random: &mut Random, positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<(Vec3, Vec<Vec3>)> {
    let mut receiver = |_| {
        let index = (random.unit() * triangles.len() as f32) as usize;
        let [a, b, c] = triangles[index].map(|i| positions[i as usize]);
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or(a.normalize());
        let directions = (0..BUNDLE).map(|_| (normal + 0.999 * random.direction()).normalize());
        ((a + b + c) / 3.0, directions.collect())
    };
    (0..RAYS / BUNDLE).map(&mut receiver).collect()
}

fn occlusion(criterion: &mut Criterion) {
    let (positions, triangles) = bumpy_sphere();
    let geometry = [Geometry::Triangles { positions: &positions, triangles: &triangles }];
    let world = World::build(&geometry);
    let mut random = Random(1);
    let rays = incoherent(&mut random);
    let receivers = receivers(&mut random, &positions, &triangles);
    let mut group = criterion.benchmark_group("trace");
    group.throughput(Throughput::Elements(RAYS as u64));
    // In chunks too small to be shared between threads: a rate of one core.
    let mut blocked = [false; BUNDLE];
    group.bench_function("occluded/incoherent", |bencher| {
        bencher.iter(|| rays.chunks(BUNDLE).for_each(|chunk| world.occluded(black_box(chunk), &mut blocked)));
    });
    let mut occluded_from = |name: &str, world: &World| {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for (origin, directions) in &receivers {
                    world.occluded_from(*origin, 1e-4, black_box(directions), &mut blocked);
                }
            });
        });
    };
    let body = Arc::new(Body::build(&geometry));
    let carried = |places: u32| {
        let place = |i| Instance::new(body.clone(), Quat::IDENTITY, Vec3::X * 3.0 * i as f32, i);
        World::new(Arc::new(Body::build(&[])), &(0..places).map(place).collect::<Vec<_>>())
    };
    occluded_from("occluded/receivers", &world);
    occluded_from("occluded/receivers, one instance", &carried(1));
    occluded_from("occluded/receivers, 64 instances", &carried(64));
    let mut hits = [None; BUNDLE];
    group.bench_function("closest/incoherent", |bencher| {
        bencher.iter(|| rays.chunks(BUNDLE).for_each(|chunk| world.closest(black_box(chunk), &mut hits)));
    });
    group.finish();
    criterion.bench_function("trace/build", |bencher| bencher.iter(|| World::build(black_box(&geometry))));
    criterion.bench_function("trace/refit", |bencher| bencher.iter(|| body.refit(black_box(&geometry))));
}

criterion_group!(benches, occlusion);
criterion_main!(benches);
