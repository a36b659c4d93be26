//! One frame of every registered method: `update`, `evaluate` and `read`, at its defaults, on the first of a few small scenes
//! that it serves. A new method is measured as soon as it is registered.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use halflight_contract::{Backend, Cache, Job, Method, NoMeter, Output, Params, Quantity, Request, Support};
use halflight_scenes::{Rgb, Scene};

const SCENES: [&str; 3] = ["spheres-60@0.25", "bunny-studio@0.25", "trench"];

fn frames(criterion: &mut Criterion) {
    let scenes = SCENES.map(|name| halflight_scenes::find(name).expect("a shipped scene"));
    let mut group = criterion.benchmark_group("frame");
    for method in halflight_registry::methods() {
        let params = Params::defaults(method.info().params);
        let (quantity, backend) = (Quantity::Direct, Backend::Cpu);
        let serves = |scene: &&Scene| {
            let request = Request { quantity, backend, params: &params };
            !matches!(method.supports(&scene.facts(), &request), Support::Skip(_))
        };
        let scene = scenes.iter().find(serves);
        let scene = scene.unwrap_or_else(|| panic!("{}: add a small scene that it serves", method.info().id));
        frame(&mut group, method, scene, &params);
    }
}

fn frame(
    group: &mut criterion::BenchmarkGroup<'_, criterion::measurement::WallTime>,
    method: &'static dyn Method,
    scene: &Scene,
    params: &Params,
) {
    let cache = Cache::in_memory();
    let job = Job::new(scene, params, 1, Backend::Cpu, &cache);
    let mut prepared = method.prepare(&job, &mut NoMeter).expect("a shipped scene can be prepared");
    let frame = scene.frame(0);
    let mut radiance = vec![Rgb::ZERO; frame.receivers.len()];
    group.throughput(Throughput::Elements(frame.receivers.valid.iter().filter(|valid| **valid).count() as u64));
    group.bench_function(format!("{} · {}", method.info().id, scene.name), |bencher| {
        bencher.iter(|| {
            prepared.update(&frame, &mut NoMeter).expect("a frame of the scene");
            prepared.evaluate(&frame, Quantity::Direct, &mut NoMeter).expect("direct light");
            prepared.read(Output::Radiance(&mut radiance), &mut NoMeter).expect("as many as receivers");
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).without_plots();
    targets = frames
}
criterion_main!(benches);
