//! Horizons without wedges: time at equal error, bytes, borders.

use std::time::Instant;

use halflight_horizons::study::{self, FIGURE_9, Truth};
use halflight_horizons::{Azimuth, Border, Horizons, March, Points, Purpose, Pyramid, Settings, Storage, Sweep};
use halflight_references::horizon;
use halflight_scenes::{HeightField, Shape};

const SIDE: usize = 256;
const ROUNDS: usize = 5;
const AZIMUTHS: usize = 16;
/// Samples of the marches that others are held against.
const MARCHES: [usize; 4] = [145, 290, 580, 1160];

fn azimuths() -> Vec<Azimuth> {
    let angle = |step: usize| 0.1 + 0.39 * step as f32;
    (0..AZIMUTHS).map(|step| Azimuth { angle: angle(step), purpose: Purpose::Key }).collect()
}

/// Truth under some azimuths at every `stride`th vertex.
fn truth(field: &HeightField, stride: usize) -> Truth<'_> {
    let exact = horizon::Horizons::new(field);
    let angles: Vec<f32> = azimuths().iter().step_by(4).map(|azimuth| azimuth.angle).collect();
    Truth::new(field, &angles, stride, |vertex, azimuth| exact.at_vertex(vertex, azimuth))
}

fn ways() -> Vec<(String, Box<dyn Horizons>)> {
    let [nearest, _, linear, splines] = FIGURE_9;
    let open = |pyramid: Pyramid| Box::new(pyramid.with_border(Border::Open)) as Box<dyn Horizons>;
    let mut ways = vec![
        ("pyramid 4, 2, B-splines (key light)".to_owned(), open(study::pyramid(4, 2.0, splines))),
        ("pyramid 4, 2, linear, B-spline (sky)".to_owned(), open(study::pyramid(4, 2.0, linear))),
        ("pyramid 4, 4, linear, bilinear".to_owned(), open(study::pyramid(4, 4.0, nearest))),
        ("pyramid 8, 8, linear, bilinear".to_owned(), open(study::pyramid(8, 8.0, nearest))),
        ("sweep".to_owned(), Box::new(Sweep::new())),
    ];
    for samples in MARCHES {
        ways.push((format!("march of {samples}"), Box::new(March::new(samples).with_border(Border::Open))));
    }
    ways
}

/// Looks from all vertices under all azimuths.
fn look(horizons: &dyn Horizons, side: usize, out: &mut [f32]) {
    let x: Vec<f32> = (0..side).map(|i| i as f32).collect();
    for row in 0..side {
        horizons.elevations(Points { x: &x, y: &vec![row as f32; side] }, 0..AZIMUTHS, out);
    }
}

/// Time and error of every way, and the march's time at the same error.
pub(crate) fn costs() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("a pool of one thread").install(on_one_thread);
}

fn on_one_thread() {
    let fields = [1, 2].map(|seed| study::fractal(SIDE, seed));
    let [(_, terrain), ..] = study::fields(SIDE);
    let (rough, smooth) = (truth(&fields[0], SIDE / 32), truth(&terrain, SIDE / 32));
    let mut ways = ways();
    let mut times = vec![Vec::new(); ways.len()];
    let mut out = vec![0.0; SIDE * AZIMUTHS];
    for round in 0..2 * ROUNDS {
        for ((_, horizons), times) in ways.iter_mut().zip(&mut times) {
            let start = Instant::now();
            horizons.update(&fields[round % 2], &azimuths());
            look(&**horizons, SIDE, &mut out);
            times.push(start.elapsed().as_secs_f64() * 1e9 / (SIDE * SIDE * AZIMUTHS) as f64);
        }
    }
    let rows: Vec<(String, [f64; 2], [f64; 2])> = ways
        .iter_mut()
        .zip(&mut times)
        .map(|((name, horizons), times)| {
            times.sort_by(f64::total_cmp);
            let errors = [&rough, &smooth].map(|truth| truth.errors(&mut **horizons).rmse.to_degrees());
            (name.clone(), [times[0], times[times.len() / 2]], errors)
        })
        .collect();
    let marches = &rows[rows.len() - MARCHES.len()..];
    println!(
        "Nanoseconds of one thread a receiver and direction, update included, {SIDE} × {SIDE} vertices, {AZIMUTHS} azimuths, least and median of {} rounds \
         in turns; root mean square errors in degrees; and how many times as long a march takes that errs as much, by the power law between the \
         marches listed, or the nearest two.\n",
        2 * ROUNDS
    );
    println!(
        "| horizons | ns, least | ns, median | error, fractal | error, terrain | march at that error, fractal | terrain |\n|---|---|---|---|---|---|---|"
    );
    for (name, [least, median], errors) in &rows {
        let ratio = |field: usize| {
            let points: Vec<[f64; 2]> = marches.iter().map(|(_, times, errors)| [errors[field], times[0]]).collect();
            time_at(&points, errors[field]) / least
        };
        println!(
            "| {name} | {least:.1} | {median:.1} | {:.2} | {:.2} | {:.1}× | {:.1}× |",
            errors[0],
            errors[1],
            ratio(0),
            ratio(1)
        );
    }
}

/// The time at an error by the power law through the two points about it, from more to less error.
fn time_at(points: &[[f64; 2]], error: f64) -> f64 {
    let pair = points.windows(2).find(|pair| error >= pair[1][0]).unwrap_or(&points[points.len() - 2..]);
    let [from, to] = [pair[0], pair[1]].map(|point| point.map(f64::ln));
    let share = (error.ln() - from[0]) / (to[0] - from[0]);
    (from[1] + share * (to[1] - from[1])).exp()
}

/// What a frame moves and what is held.
pub(crate) fn bytes() {
    println!(
        "Megabytes that a frame moves at least, key light and sky, 19 azimuths, order 4: the field's heights read twice (to see what changed, and to copy), \
         levels written decimated and by octaves, heights looked at (each stored sample once an azimuth and step), entries of wedge tables (four of 64 B a wedge: \
         mostly out of nearer caches), receivers (coordinates, normal, albedo) and radiance. Held: the pyramid between frames.\n"
    );
    println!(
        "| n | field | levels | by octaves | looked at | tables | receivers | radiance | pyramid held |\n|---|---|---|---|---|---|---|---|---|"
    );
    for side in [256, 512, 1024, 4096] {
        let field = HeightField::new([side; 2], glam::Vec2::ZERO, glam::Vec2::ONE, vec![0.0; side * side]);
        let made = |storage| {
            let mut pyramid = Pyramid::new(Settings { storage, ..Settings::default() });
            pyramid.update(&field, &azimuths());
            (pyramid.footprint() as f64, pyramid.work(0).bytes)
        };
        let ((decimated, _), (held, looked)) = (made(Storage::Decimated), made(Storage::Octaves));
        let receivers = (side * side) as f64;
        let cells = [
            8.0 * receivers,
            decimated,
            held - decimated,
            19.0 * looked * receivers,
            receivers * (16.0 + 4.0) * 4.0 * 64.0,
            receivers * (8.0 + 12.0 + 12.0),
            12.0 * receivers,
            held,
        ];
        println!("| {side} | {} |", cells.map(|bytes| format!("{:.1}", bytes * 1e-6)).join(" | "));
    }
}

/// Errors with open borders and with those drawn out.
pub(crate) fn borders() {
    println!("Pyramid and march against exact horizons: root mean square error (mean) / roughness, degrees.\n");
    let scene = halflight_scenes::find("jacksboro-sunrise").expect("a shipped scene");
    let jacksboro = scene.objects.iter().find_map(|object| match &*object.shape {
        Shape::Heights(field) => Some(field.clone()),
        _ => None,
    });
    let fields = [
        ("trench", study::trench(SIDE, std::f64::consts::FRAC_PI_4)),
        ("fractal", study::fractal(SIDE, 1)),
        ("jacksboro", jacksboro.expect("a field")),
    ];
    println!("| horizons | trench | fractal | jacksboro |\n|---|---|---|---|");
    let [.., splines] = FIGURE_9;
    let truths = fields.each_ref().map(|(_, field)| truth(field, field.columns() / 32));
    for border in [Border::Open, Border::Extend] {
        let ways: [(&str, Box<dyn Horizons>); 2] = [
            ("pyramid 4, 2, B-splines", Box::new(study::pyramid(4, 2.0, splines).with_border(border))),
            ("march of 145", Box::new(March::default().with_border(border))),
        ];
        for (name, mut horizons) in ways {
            let cells = truths.each_ref().map(|truth| {
                let errors = truth.errors(&mut *horizons);
                let [rmse, bias, rough] = [errors.rmse, errors.bias, errors.roughness].map(f64::to_degrees);
                format!("{rmse:.2} ({bias:+.2}) / {rough:.3}")
            });
            println!("| {name}, {border:?} | {} |", cells.join(" | "));
        }
    }
}
