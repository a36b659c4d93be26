//! Nanoseconds a receiver and direction by each way of finding horizons, and of making what it looks at, in time of one thread: all
//! vertices of a fractal, row by row.
//!
//! `cargo bench -p halflight-horizons --bench horizons -- [SIDE]`; the kinds are timed in turns, the least and the median of the
//! rounds are printed.

use halflight_horizons::{
    Azimuth, Horizons, March, Plane, Points, Purpose, Pyramid, Reconstruction, Scale, Settings, Storage, Sweep, study,
};

fn main() {
    let side = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(256);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("a pool of one thread").install(|| compare(side));
}

/// Seconds that this thread has run: others' load delays it less than it delays the clock.
fn seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    text.split_whitespace().next().and_then(|field| field.parse::<f64>().ok()).expect("nanoseconds") * 1e-9
}

fn compare(side: usize) {
    let pyramid = |scale, plane, storage| -> Box<dyn Horizons> {
        let reconstruction = Reconstruction { scale, plane };
        Box::new(Pyramid::new(Settings { reconstruction, storage, ..Settings::default() }))
    };
    let (knots, spline) = (Scale::Linear, Scale::BSpline);
    let mut kinds: Vec<(&str, Box<dyn Horizons>)> = vec![
        ("pyramid, B-spline in both", pyramid(spline, Plane::BSpline, Storage::Decimated)),
        ("pyramid, linear, B-spline in the plane", pyramid(knots, Plane::BSpline, Storage::Decimated)),
        ("pyramid, B-spline, bilinear", pyramid(spline, Plane::Bilinear, Storage::Decimated)),
        ("pyramid, linear, bilinear", pyramid(knots, Plane::Bilinear, Storage::Decimated)),
        ("pyramid, B-spline in both, octaves", pyramid(spline, Plane::BSpline, Storage::Octaves)),
        ("pyramid, linear, B-spline, octaves", pyramid(knots, Plane::BSpline, Storage::Octaves)),
        ("pyramid, B-spline in both, brought back", pyramid(spline, Plane::BSpline, Storage::Full)),
        ("pyramid, linear, B-spline, brought back", pyramid(knots, Plane::BSpline, Storage::Full)),
        ("march", Box::new(March::default())),
        ("sweep", Box::new(Sweep::new())),
    ];
    let azimuths: Vec<Azimuth> =
        (0..16).map(|step| Azimuth { angle: 0.1 + 0.39 * step as f32, purpose: Purpose::Key }).collect();
    // Two fields in turns, so that every update is a whole one.
    let fields = [1, 2].map(|seed| study::fractal(side, seed));
    let vertices = side * side;
    let mut times = vec![[Vec::new(), Vec::new()]; kinds.len()];
    let x: Vec<f32> = (0..side).map(|i| i as f32).collect();
    let mut out = vec![0.0; side * azimuths.len()];
    for round in 0..7 {
        for ((_, horizons), times) in kinds.iter_mut().zip(&mut times) {
            let start = seconds();
            horizons.update(&fields[round % 2], &azimuths);
            times[0].push(seconds() - start);
            let start = seconds();
            for row in 0..side {
                horizons.elevations(Points { x: &x, y: &vec![row as f32; side] }, 0..azimuths.len(), &mut out);
            }
            times[1].push(seconds() - start);
        }
    }
    println!("{side} x {side}, {} azimuths", azimuths.len());
    println!(
        "| horizons | update, ms | look, ns a receiver and direction | median | bytes held | samples | bytes read |"
    );
    println!("|---|---|---|---|---|---|---|");
    for ((name, horizons), [update, look]) in kinds.iter().zip(&mut times) {
        let least = |times: &mut Vec<f64>| {
            times.sort_by(f64::total_cmp);
            [times[0], times[times.len() / 2]]
        };
        let (update, look) =
            (least(update)[0] * 1e3, least(look).map(|t| t * 1e9 / (vertices * azimuths.len()) as f64));
        let work = horizons.work(0);
        println!(
            "| {name} | {update:.2} | {:.2} | {:.2} | {} | {} | {:.1} |",
            look[0],
            look[1],
            horizons.footprint(),
            work.samples,
            work.bytes
        );
    }
}
