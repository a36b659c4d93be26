//! Writes `docs/horizons.md`: how far every way of finding horizons lies from the exact ones of the surface.
//!
//! `cargo run --release -p halflight-horizons --example deviation > docs/horizons.md`

use std::f64::consts::FRAC_PI_4;

use halflight_horizons::study::{self, Errors, FIGURE_9, FIGURE_10, Truth};
use halflight_horizons::{Border, Horizons, March, Pyramid, Reconstruction, Settings, Storage, Sweep};

const SIDE: usize = 512;
const ANGLES: [f32; 4] = [0.1, 1.9, 3.4, 5.0];
const STRIDE: usize = 13;

fn main() {
    print!("{}", include_str!("deviation/head.md"));
    sizes();
    trench();
    let fields = study::fields(SIDE);
    let exact = fields.each_ref().map(|(name, field)| {
        let horizons = halflight_references::horizon::Horizons::new(field);
        (*name, Truth::new(field, &ANGLES, STRIDE, |vertex, azimuth| horizons.at_vertex(vertex, azimuth)))
    });
    ways(&exact);
    figure_10(&exact);
    figure_9(&exact);
}

fn sizes() {
    println!(
        "## Levels and memory\n\nMultiples of the field's own heights; held bytes with padding (B-spline in the plane or not alike).\n"
    );
    println!(
        "| n | k | N | decimated | `Decimated` held | `Octaves` held | `Full` held |\n|---|---|---|---|---|---|---|"
    );
    for (side, k) in [(256, 1), (256, 2), (256, 4), (256, 8), (512, 4), (1024, 4)] {
        let size = study::size(side, k);
        let held = size.held.map(|(_, ratio)| format!("{ratio:.2}")).join(" | ");
        println!("| {side} | {k} | {} | {:.2} | {held} |", size.levels, size.decimated);
    }
}

fn trench() {
    println!("\n## Walls of a 45° trench, seen from its bottom\n\nDegrees, 512 vertices across.\n");
    println!(
        "| k, o | linear, bilinear | B-spline, bilinear | linear, B-spline | B-spline, B-spline |\n|---|---|---|---|---|"
    );
    for (k, o) in [(4, 0.0), (4, 1.0), (4, 2.0), (4, 3.0), (4, 4.0), (8, 8.0)] {
        let seen = |reconstruction| {
            study::trench_wall(FRAC_PI_4, SIDE, &mut study::pyramid(k, o, reconstruction)).to_degrees()
        };
        println!("| {k}, {o} | {} |", FIGURE_9.map(|r| format!("{:.1}", seen(r))).join(" | "));
    }
}

/// A pyramid over a field that ends at its border.
fn open(k: usize, o: f32, reconstruction: Reconstruction) -> Box<dyn Horizons> {
    Box::new(study::pyramid(k, o, reconstruction).with_border(Border::Open))
}

fn ways(exact: &[(&str, Truth<'_>)]) {
    println!("\n## Every way\n\nRoot mean square error, degrees; in brackets the mean error.\n");
    let [nearest, _, linear, splines] = FIGURE_9;
    let decimated = Settings { storage: Storage::Decimated, ..Settings::default() };
    let ways: [(&str, Box<dyn Horizons>); 12] = [
        ("pyramid 4, 2, B-splines", open(4, 2.0, splines)),
        ("the same by decimated levels", Box::new(Pyramid::new(decimated).with_border(Border::Open))),
        ("the same, border drawn out", Box::new(study::pyramid(4, 2.0, splines))),
        ("pyramid 4, 2, linear, B-spline (environment)", open(4, 2.0, linear)),
        ("pyramid 4, 4, B-splines", open(4, 4.0, splines)),
        ("pyramid 4, 4, linear, bilinear", open(4, 4.0, nearest)),
        ("the same, border drawn out", Box::new(study::pyramid(4, 4.0, nearest))),
        ("pyramid 8, 8, linear, bilinear", open(8, 8.0, nearest)),
        ("march of 145", Box::new(March::default().with_border(Border::Open))),
        ("the same, border drawn out", Box::<March>::default()),
        ("march of 1160", Box::new(March::new(1160).with_border(Border::Open))),
        ("sweep", Box::new(Sweep::new())),
    ];
    let cell = |errors: Errors| format!("{:.2} ({:+.2})", errors.rmse.to_degrees(), errors.bias.to_degrees());
    table("horizons", exact, ways, cell);
}

fn figure_10(exact: &[(&str, Truth<'_>)]) {
    println!("\n## Fig. 10: levels an octave and level offset\n\nRoot mean square error, degrees.\n");
    for (name, reconstruction) in
        [("B-spline in both", FIGURE_9[3]), ("B-spline in scale, bilinear in the plane", FIGURE_9[1])]
    {
        println!("{name}:\n");
        let rows = FIGURE_10.map(|(k, o)| (format!("{k}, {o}"), open(k, o, reconstruction)));
        table("k, o", exact, rows, |errors| format!("{:.2}", errors.rmse.to_degrees()));
        println!();
    }
}

fn figure_9(exact: &[(&str, Truth<'_>)]) {
    println!("## Fig. 9: reconstructions at (4, 4)\n");
    println!("Root mean square error / root mean square second difference of the horizons, degrees.\n");
    let name = |r: Reconstruction| format!("{:?} in scale, {:?} in the plane", r.scale, r.plane);
    let rows = FIGURE_9.map(|r| (name(r), open(4, 4.0, r)));
    table("reconstruction", exact, rows, |errors| {
        format!("{:.2} / {:.3}", errors.rmse.to_degrees(), errors.roughness.to_degrees())
    });
}

fn table<N: AsRef<str>>(
    head: &str,
    exact: &[(&str, Truth<'_>)],
    rows: impl IntoIterator<Item = (N, Box<dyn Horizons>)>,
    cell: impl Fn(Errors) -> String,
) {
    let names: Vec<&str> = exact.iter().map(|(name, _)| *name).collect();
    println!("| {head} | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()));
    for (name, mut horizons) in rows {
        let cells: Vec<String> = exact.iter().map(|(_, truth)| cell(truth.errors(&mut *horizons))).collect();
        println!("| {} | {} |", name.as_ref(), cells.join(" | "));
    }
}
