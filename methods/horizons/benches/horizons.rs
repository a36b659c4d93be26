//! What a horizon costs by each way of finding it, and how far off it is: nanoseconds of one thread a receiver and direction, over
//! all vertices of a fractal under 16 azimuths, row by row, and the error there. Borders are open unless said. Borders are open unless said.
//!
//! `cargo bench -p halflight-horizons --bench horizons -- [SIDE]`; the ways are timed in turns, the least and the median of the
//! rounds are printed.

use halflight_horizons::study::{self, FIGURE_9, Truth};
use halflight_horizons::{Azimuth, Border, Horizons, March, Points, Purpose, Pyramid, Settings, Storage, Sweep};
use halflight_references::horizon;
use halflight_sh_kernels::Simd;

const ROUNDS: usize = 7;
/// Updates of a round, so that the scheduler's clock resolves them.
const UPDATES: usize = 12;

fn main() {
    let side = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(256);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("a pool of one thread").install(|| compare(side));
}

fn ways() -> Vec<(String, Box<dyn Horizons>)> {
    let [nearest, _, linear, splines] = FIGURE_9;
    let pyramid = |levels_per_octave, offset, reconstruction, storage| Settings {
        levels_per_octave,
        offset,
        reconstruction,
        storage,
    };
    let mut all: Vec<(String, Box<dyn Horizons>)> = Vec::new();
    let settings = [
        ("B-splines", pyramid(1, 1.0, splines, Storage::Octaves)),
        ("B-splines", pyramid(2, 2.0, splines, Storage::Octaves)),
        ("B-splines", pyramid(4, 2.0, splines, Storage::Octaves)),
        ("B-splines, decimated", pyramid(4, 2.0, splines, Storage::Decimated)),
        ("B-splines, full", pyramid(4, 2.0, splines, Storage::Full)),
        ("linear, B-spline", pyramid(4, 2.0, linear, Storage::Octaves)),
        ("linear, B-spline, decimated", pyramid(4, 2.0, linear, Storage::Decimated)),
        ("linear, B-spline, full", pyramid(4, 2.0, linear, Storage::Full)),
        ("B-splines", pyramid(4, 4.0, splines, Storage::Octaves)),
        ("linear, bilinear", pyramid(4, 4.0, nearest, Storage::Octaves)),
        ("linear, bilinear", pyramid(8, 8.0, nearest, Storage::Octaves)),
    ];
    for (name, settings) in settings {
        let name = format!("pyramid {}, {}, {name}", settings.levels_per_octave, settings.offset);
        all.push((name, Box::new(Pyramid::new(settings).with_border(Border::Open))));
    }
    let drawn_out = pyramid(4, 2.0, splines, Storage::Octaves);
    all.push(("pyramid 4, 2, B-splines, border drawn out".into(), Box::new(Pyramid::new(drawn_out))));
    for simd in [Simd::Portable, Simd::Avx2].into_iter().filter(|simd| simd.is_available()) {
        let name = format!("pyramid 4, 2, B-splines, {simd:?}");
        all.push((name, Box::new(Pyramid::on(Settings::default(), simd).with_border(Border::Open))));
    }
    for samples in [145, 580, 1160] {
        all.push((format!("march of {samples}"), Box::new(March::new(samples).with_border(Border::Open))));
    }
    all.push(("sweep".into(), Box::new(Sweep::new())));
    all
}

/// Seconds that this thread has run: others' load delays it less than it delays the clock.
fn seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    text.split_whitespace().next().and_then(|field| field.parse::<f64>().ok()).expect("nanoseconds") * 1e-9
}

fn compare(side: usize) {
    let angles: Vec<f32> = (0..16).map(|step| 0.1 + 0.39 * step as f32).collect();
    let azimuths: Vec<Azimuth> = angles.iter().map(|angle| Azimuth { angle: *angle, purpose: Purpose::Key }).collect();
    // Two fields in turns, so that every update is a whole one.
    let fields = [1, 2].map(|seed| study::fractal(side, seed));
    let exact = horizon::Horizons::new(&fields[0]);
    let truth = Truth::new(&fields[0], &angles[..4], side / 32, |vertex, azimuth| exact.at_vertex(vertex, azimuth));
    let mut ways = ways();
    let mut times = vec![[Vec::new(), Vec::new()]; ways.len()];
    let x: Vec<f32> = (0..side).map(|i| i as f32).collect();
    let mut out = vec![0.0; side * azimuths.len()];
    for _ in 0..ROUNDS {
        for ((_, horizons), times) in ways.iter_mut().zip(&mut times) {
            let start = seconds();
            for turn in 0..UPDATES {
                horizons.update(&fields[turn % 2], &azimuths);
            }
            times[0].push((seconds() - start) / UPDATES as f64);
            let start = seconds();
            for row in 0..side {
                horizons.elevations(Points { x: &x, y: &vec![row as f32; side] }, 0..azimuths.len(), &mut out);
            }
            times[1].push(seconds() - start);
        }
    }
    println!(
        "| {side} x {side}, 16 azimuths | error, degrees | update | look, least | median | sum | bytes held | bytes read |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for ((name, horizons), times) in ways.iter_mut().zip(&mut times) {
        let nanoseconds = |times: &mut Vec<f64>| {
            times.sort_by(f64::total_cmp);
            [times[0], times[times.len() / 2]].map(|time| time * 1e9 / (side * side * azimuths.len()) as f64)
        };
        let [update, look] = times.each_mut().map(nanoseconds);
        let (held, read) = (horizons.footprint() as f64, horizons.work(0).bytes);
        let error = truth.errors(&mut **horizons).rmse.to_degrees();
        println!(
            "| {name} | {error:.2} | {:.2} | {:.2} | {:.2} | {:.1} | {:.1} MB | {read:.0} |",
            update[0],
            look[0],
            look[1],
            update[0] + look[0],
            held * 1e-6
        );
    }
}
