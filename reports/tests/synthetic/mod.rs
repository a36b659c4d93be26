//! A results directory of made-up pictures, scored for real.

use glam::Vec3;
use halflight_metrics as metrics;
use halflight_results::{
    Calibration, Cell, Environment, Failure, Key, Layout, Phase, Picture, Record, ReferencePicture, Run, Score, Skip,
    Storage, Store, Times, Timing,
};
use std::path::Path;

/// The standard error of the made-up truth.
pub(crate) const NOISE: f32 = 2e-3;

/// Fills a results directory: two scenes of pictures of this width, one of a list of receivers, skips and failures.
pub(crate) fn fill(dir: &Path, width: usize) -> Store {
    let mut store = Store::open(dir).unwrap();
    for (scene, softness) in [("bunny under bl_studio", 0.9), ("teapot under bl_sunset", 0.25)] {
        let layout = Layout::Image { width, height: width * 3 / 4 };
        let truth = picture(layout, softness, 0.0);
        let light = picture(layout, softness * 1.3, 0.0);
        run(
            &mut store,
            cell(scene, "sh-product/ordered", 4),
            &picture(layout, softness * 1.6, 0.08),
            4.1e7,
            &truth,
            &light,
        );
        for (order, blur) in [(3, 2.2), (4, 1.7), (6, 1.35)] {
            let nanoseconds = 1.3e6 * f64::from(order * order);
            let x = picture(layout, softness * blur, 0.02);
            run(&mut store, cell(scene, "shexp/hyb", order), &x, nanoseconds, &truth, &light);
        }
        let exact = picture(layout, softness, 2e-4);
        run(&mut store, cell(scene, "shexp/eigen", 4), &exact, 2.1e8, &truth, &light);
        let skipped = cell(scene, "horizon-wedges/partial", 4);
        store.append(Record::Skip(Skip { cell: skipped, reason: "the scene is no height field".into() })).unwrap();
    }
    let layout = Layout::List(400);
    let truth = picture(layout, 0.5, 0.0);
    run(&mut store, cell("sphere over a plane", "shexp/hyb", 4), &picture(layout, 0.6, 0.01), 3e5, &truth, &truth);
    let failed = cell("sphere over a plane", "shexp/eigen", 4);
    let error = "receiver 7: <script>alert('no')</script> & a NaN".to_owned();
    store.append(Record::Failure(Failure { cell: failed, error })).unwrap();
    store
}

fn cell(scene: &str, method: &str, order: u32) -> Cell {
    Cell {
        scene: scene.into(),
        scene_hash: Key::of_bytes(scene.as_bytes()).to_string(),
        method: method.into(),
        revision: "0123456789abcdef".into(),
        params: [("order".to_owned(), order.into()), ("self_shadow".to_owned(), "paper".into())].into(),
        backend: "cpu".into(),
        quantity: "direct".into(),
        ..Cell::default()
    }
}

/// A checkered ground with a soft round shadow below a sky without receivers; `stain` darkens one side.
fn picture(layout: Layout, softness: f32, stain: f32) -> Picture {
    let (width, height) = layout.size();
    let at = |i: usize| {
        let (x, y) = ((i % width) as f32 / width as f32 - 0.5, (i / width) as f32 / height as f32);
        let depth = (y - 0.2).max(0.0) * 1.3 + 0.02;
        let (u, v) = (x / depth * 0.6, 0.4 / depth);
        let tile = if ((u * 6.0).floor() + (v * 6.0).floor()) as i32 % 2 == 0 { 1.0 } else { 0.7 };
        let d = ((u * u + (v - 0.8) * (v - 0.8)).sqrt() - 0.35) / (0.25 * softness);
        let open = 1.0 - 0.85 / (1.0 + (4.0 * d).exp());
        Vec3::new(0.95, 0.85, 0.7) * tile * open * 0.4 + Vec3::new(0.0, 0.01, 0.03) - stain * (x + 0.2) * open
    };
    let count = width * height;
    let valid = (0..count).map(|i| height == 1 || i / width > height / 5).collect();
    Picture { layout, radiance: (0..count).map(|i| at(i).max(Vec3::ZERO)).collect(), valid }
}

fn run(store: &mut Store, cell: Cell, x: &Picture, nanoseconds: f64, truth: &Picture, light: &Picture) {
    let image = store.write_picture(x).unwrap();
    let timing = |phase, base: f64, repeats: u32| Timing {
        phase,
        nanoseconds: (0..repeats).map(|i| base * (1.0 + 0.03 * f64::from(i * 7 % 5))).collect(),
    };
    let phases = [
        ("prepare".to_owned(), timing(Phase::Prepare, 2.5e8, 1)),
        ("update".to_owned(), timing(Phase::Update, 3.2e5, 5)),
        ("shade".to_owned(), timing(Phase::Shade, nanoseconds, 9)),
        ("gather".to_owned(), timing(Phase::Shade, nanoseconds * 0.7, 9)),
    ];
    let calibration = Calibration { compute: vec![1e6; 9], memory: vec![2e6; 9] };
    let times = Times { run: cell.key(), taken: 1_800_000_000, beside: 4, phases: phases.into(), calibration };
    let record = Run {
        cell: cell.clone(),
        receivers: x.radiance.len(),
        image: Some(image.clone()),
        approximate: (cell.method == "shexp/hyb").then(|| "blockers are spheres".to_owned()),
        shared: Default::default(),
        derived: [("sphere set of bunny, 64".to_owned(), 3.4e9), ("light in SH, order 8".to_owned(), 4.2e7)].into(),
        counters: [("blockers".to_owned(), 1_228_800), ("overlap guard".to_owned(), 310)].into(),
        footprint: vec![
            Storage { purpose: "tables".into(), host_bytes: 3 << 20, device_bytes: 0 },
            Storage { purpose: "spheres".into(), host_bytes: 1536, device_bytes: 0 },
        ],
        environment: Environment {
            cpu: "A Processor 2.5 GHz".into(),
            cores: 2,
            threads: 2,
            os: "linux x86_64".into(),
            rustc: "rustc 1.95.0".into(),
            profile: "release".into(),
            halflight: "0.1.0".into(),
        },
    };
    store.append(Record::Run(Box::new(record))).unwrap();
    store.append(Record::Times(Box::new(times))).unwrap();
    score(store, &cell, x, &image, "truth", truth);
    score(store, &cell, x, &image, "sh-light", light);
}

fn score(store: &mut Store, cell: &Cell, x: &Picture, image: &Key, id: &str, reference: &Picture) {
    let stored = ReferencePicture {
        layout: reference.layout,
        mean: reference.radiance.clone(),
        variance: vec![Vec3::splat(NOISE * NOISE); reference.radiance.len()],
        samples: vec![256; reference.radiance.len()],
        valid: reference.valid.clone(),
    };
    let layout = match reference.layout {
        Layout::Image { width, height } => metrics::Layout::Image { width, height },
        Layout::List(_) => metrics::Layout::List,
    };
    let tested = metrics::Picture { radiance: &x.radiance, valid: &x.valid, layout };
    let against = metrics::Picture { radiance: &stored.mean, valid: &stored.valid, layout };
    let scores = metrics::compare(&tested, &against, &stored.standard_error()).unwrap();
    let reference_image = store.write_reference(&stored).unwrap();
    let record = Score {
        run: cell.key(),
        image: image.clone(),
        reference: id.into(),
        reference_key: Key::of_bytes(format!("{id} of {}", cell.scene).as_bytes()),
        reference_image,
        metrics: metrics::VERSION,
        receivers: scores.receivers,
        resolved: scores.resolved,
        measures: scores.measures().map(|(name, value)| (name.to_owned(), value)).collect(),
    };
    store.append(Record::Score(record)).unwrap();
}
