//! Writes `docs/horizons.md`: how far every way of finding horizons lies from the exact ones of the surface.
//!
//! `cargo run --release -p halflight-horizons --example deviation > docs/horizons.md`

use std::f64::consts::FRAC_PI_4;

use halflight_horizons::study::{self, Errors, FIGURE_9, FIGURE_10, Truth};
use halflight_horizons::{Horizons, March, Plane, Pyramid, Reconstruction, Scale, Settings, Storage, Sweep};

const SIDE: usize = 512;
const ANGLES: [f32; 4] = [0.1, 1.9, 3.4, 5.0];
const STRIDE: usize = 13;

const SPLINES: Reconstruction = Reconstruction { scale: Scale::BSpline, plane: Plane::BSpline };

fn main() {
    println!("{}", include_str!("deviation/head.md"));
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

fn ways(exact: &[(&str, Truth<'_>)]) {
    println!("\n## Root mean square error, degrees\n\nIn brackets the mean error.\n");
    let octaves = |k, o, reconstruction| Box::new(study::pyramid(k, o, reconstruction)) as Box<dyn Horizons>;
    let decimated = Settings { storage: Storage::Decimated, ..Settings::default() };
    let linear = Reconstruction { scale: Scale::Linear, plane: Plane::BSpline };
    let nearest = Reconstruction { scale: Scale::Linear, plane: Plane::Bilinear };
    let ways: [(&str, Box<dyn Horizons>); 8] = [
        ("pyramid 4, 2, B-splines", octaves(4, 2.0, SPLINES)),
        ("the same by decimated levels", Box::new(Pyramid::new(decimated))),
        ("pyramid 4, 2, linear, B-spline (environment)", octaves(4, 2.0, linear)),
        ("pyramid 4, 4, B-splines", octaves(4, 4.0, SPLINES)),
        ("pyramid 4, 4, linear, bilinear", octaves(4, 4.0, nearest)),
        ("pyramid 8, 8, linear, bilinear", octaves(8, 8.0, nearest)),
        ("march of 145", Box::new(March::default())),
        ("sweep", Box::new(Sweep::new())),
    ];
    table("horizons", exact, ways, |errors| {
        format!("{:.2} ({:+.2})", errors.rmse.to_degrees(), errors.bias.to_degrees())
    });
}

fn figure_10(exact: &[(&str, Truth<'_>)]) {
    println!("\n## Fig. 10: root mean square error, degrees, by levels an octave and level offset\n");
    for (name, reconstruction) in
        [("B-spline in both", FIGURE_9[3]), ("B-spline in scale, bilinear in the plane", FIGURE_9[1])]
    {
        println!("{name}:\n");
        let rows = FIGURE_10
            .map(|(k, o)| (format!("{k}, {o}"), Box::new(study::pyramid(k, o, reconstruction)) as Box<dyn Horizons>));
        table("k, o", exact, rows, |errors| format!("{:.2}", errors.rmse.to_degrees()));
        println!();
    }
}

fn figure_9(exact: &[(&str, Truth<'_>)]) {
    println!(
        "## Fig. 9: error and roughness of the reconstructions at (4, 4)\n\nRoot mean square error / root mean square second difference of the horizons, degrees.\n"
    );
    let rows = FIGURE_9.map(|r| {
        (
            format!("{:?} in scale, {:?} in the plane", r.scale, r.plane),
            Box::new(study::pyramid(4, 4.0, r)) as Box<dyn Horizons>,
        )
    });
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
