//! Horizons against closed forms and the exact horizon of the surface.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec2;
use halflight_horizons::study::{self, FIGURE_9, FIGURE_10, Truth};
use halflight_horizons::{
    Azimuth, Border, Horizons, March, Plane, Points, Purpose, Pyramid, Reconstruction, Scale, Settings, Storage, Sweep,
};
use halflight_scenes::HeightField;

/// A field of unit cells by a function of its vertices' grid coordinates.
fn field([columns, rows]: [usize; 2], height: impl Fn(f64, f64) -> f64) -> HeightField {
    with_cell([columns, rows], Vec2::ONE, height)
}

fn with_cell([columns, rows]: [usize; 2], cell: Vec2, height: impl Fn(f64, f64) -> f64) -> HeightField {
    let vertices = (0..rows).flat_map(|j| (0..columns).map(move |i| (i as f64, j as f64)));
    HeightField::new([columns, rows], Vec2::ZERO, cell, vertices.map(|(i, j)| height(i, j) as f32).collect())
}

fn key(angle: f32) -> Azimuth {
    Azimuth { angle, purpose: Purpose::Key }
}

fn all_variants() -> Vec<Settings> {
    let each = |scale, plane, storage| Settings {
        reconstruction: Reconstruction { scale, plane },
        storage,
        ..Settings::default()
    };
    let scales = [Scale::Linear, Scale::BSpline];
    let planes = [Plane::Bilinear, Plane::BSpline];
    let both = |storage| scales.into_iter().flat_map(move |s| planes.into_iter().map(move |p| each(s, p, storage)));
    [Storage::Decimated, Storage::Octaves, Storage::Full].into_iter().flat_map(both).collect()
}

/// Elevation at a point.
fn at(horizons: &dyn Horizons, point: [f32; 2], azimuth: usize) -> f32 {
    let mut out = [f32::NAN];
    horizons.elevations(Points { x: &[point[0]], y: &[point[1]] }, azimuth..azimuth + 1, &mut out);
    out[0]
}

/// Elevations at all vertices, row by row.
fn everywhere(horizons: &dyn Horizons, size: [usize; 2], azimuth: usize) -> Vec<f32> {
    let vertices = || (0..size[1]).flat_map(|j| (0..size[0]).map(move |i| (i, j)));
    let x: Vec<f32> = vertices().map(|(i, _)| i as f32).collect();
    let y: Vec<f32> = vertices().map(|(_, j)| j as f32).collect();
    let mut out = vec![f32::NAN; x.len()];
    horizons.elevations(Points { x: &x, y: &y }, azimuth..azimuth + 1, &mut out);
    out
}

#[test]
fn a_ramp_is_seen_under_its_slope() {
    let slope = 0.7;
    let cell = Vec2::new(2.0, 0.5);
    let ramp = with_cell([64, 256], cell, |i, _| slope * 2.0 * i);
    let azimuths: Vec<Azimuth> = (0..16).map(|step| key(step as f32 * TAU / 16.0)).collect();
    let mut all: Vec<Box<dyn Horizons>> = vec![Box::new(March::default()), Box::new(Sweep::new())];
    all.extend(all_variants().into_iter().map(|settings| Box::new(Pyramid::new(settings)) as Box<dyn Horizons>));
    for (number, horizons) in all.iter_mut().enumerate() {
        horizons.update(&ramp, &azimuths);
        for (index, azimuth) in azimuths.iter().enumerate() {
            let expected = (slope as f32 * azimuth.angle.cos()).atan().max(0.0);
            let found = at(&**horizons, [32.0, 128.0], index);
            assert!((found - expected).abs() < 2e-4, "{number}, {azimuth:?}: {found} for {expected}");
        }
    }
}

#[test]
fn a_bump_keeps_its_centroid_through_all_levels() {
    let size = [96, 64];
    let centre = [41.3, 30.7];
    let bump = field(size, |i, j| (-((i - centre[0]).powi(2) + (j - centre[1]).powi(2)) / (2.0 * 8.0 * 8.0)).exp());
    let mut pyramid = Pyramid::new(Settings::default());
    pyramid.update(&bump, &[]);
    let mut checked = 0;
    for level in 0..pyramid.levels() {
        let [columns, rows] = pyramid.level_size(level);
        let (mut mass, mut moment) = (0.0, [0.0; 2]);
        for j in 0..rows {
            for (i, height) in pyramid.level_row(level, j).iter().enumerate() {
                // Of the rectangle's centre, in the field's grid coordinates.
                let at = [(i, columns, 0), (j, rows, 1)]
                    .map(|(at, count, axis)| (at as f64 + 0.5) * size[axis] as f64 / count as f64 - 0.5);
                mass += f64::from(*height);
                moment = [0, 1].map(|axis| moment[axis] + f64::from(*height) * at[axis]);
            }
        }
        // Until a sample is as wide as the bump.
        if columns >= 12 {
            checked += 1;
            for axis in 0..2 {
                assert!(
                    (moment[axis] / mass - centre[axis]).abs() < 0.15,
                    "level {level}, {:?}",
                    moment.map(|m| m / mass)
                );
            }
        }
    }
    assert!(checked > 10);
}

#[test]
fn a_narrow_wall_stands_in_its_azimuth() {
    let (angle, at) = (0.7_f64, 40.0);
    let foot = [64.0 + at * angle.cos(), 64.0 + at * angle.sin()];
    let wall = field([129, 129], |i, j| if (i - foot[0]).hypot(j - foot[1]) < 2.5 { 30.0 } else { 0.0 });
    let azimuths: Vec<Azimuth> = (0..256).map(|step| key(step as f32 * TAU / 256.0)).collect();
    let mut all: Vec<Box<dyn Horizons>> = vec![Box::new(March::default()), Box::new(Sweep::new())];
    all.extend(all_variants().into_iter().map(|settings| Box::new(Pyramid::new(settings)) as Box<dyn Horizons>));
    for (number, horizons) in all.iter_mut().enumerate() {
        horizons.update(&wall, &azimuths);
        let seen: Vec<f32> = (0..256).map(|index| at_middle(&**horizons, index)).collect();
        let mean = |axis: fn(f32) -> f32| seen.iter().zip(&azimuths).map(|(s, a)| s * axis(a.angle)).sum::<f32>();
        let found = mean(f32::sin).atan2(mean(f32::cos));
        assert!((found - angle as f32).abs() < 0.025, "{number}: {found}");
    }
}

fn at_middle(horizons: &dyn Horizons, azimuth: usize) -> f32 {
    at(horizons, [64.0, 64.0], azimuth)
}

#[test]
fn beyond_the_border_lies_what_is_said() {
    // A ramp that climbs towards +x: seen from near its upper end, along it and at 45° to it.
    let ramp = field([64, 64], |i, _| i);
    let azimuths = [key(0.0), key(TAU / 8.0), key(TAU / 4.0 + 1.0)];
    let see = |mut horizons: Box<dyn Horizons>| {
        horizons.update(&ramp, &azimuths);
        [at(&*horizons, [63.0, 20.0], 0), at(&*horizons, [20.0, 63.0], 1), at(&*horizons, [20.0, 0.0], 1)]
    };
    let slope = TAU.cos().atan2(2.0_f32.sqrt());
    // On the upper border nothing is above it; on the side, the drawn out field climbs on.
    for (extended, open) in [
        (see(Box::<March>::default()), see(Box::new(March::default().with_border(Border::Open)))),
        (
            see(Box::new(study::pyramid(4, 4.0, FIGURE_9[0]))),
            see(Box::new(study::pyramid(4, 4.0, FIGURE_9[0]).with_border(Border::Open))),
        ),
    ] {
        assert!(extended[0].abs() < 1e-5 && open[0].abs() < 1e-5, "{extended:?}, {open:?}");
        assert!((extended[1] - slope).abs() < 0.01 && open[1].abs() < 1e-5, "{extended:?}, {open:?}");
        assert!((extended[2] - slope).abs() < 0.01 && (open[2] - slope).abs() < 0.01, "{extended:?}, {open:?}");
    }
    assert!(see(Box::new(Sweep::new()))[1].abs() < 1e-5);
}

#[test]
fn levels_and_memory_are_those_of_the_paper() {
    // §4: N = k log2 n + 1, and 3.4 times the field's memory at k = 4.
    for (side, levels) in [(256, 33), (512, 37), (1024, 41)] {
        let size = study::size(side, 4);
        assert_eq!(size.levels, levels);
        assert!((size.decimated - 1.0 / (1.0 - 2.0_f64.powf(-0.5))).abs() < 0.02, "{size:?}");
        let [(_, decimated), (_, octaves), (_, full)] = size.held;
        assert!(decimated < 4.5 && octaves < 16.5 && full > levels as f64, "{size:?}");
    }
}

#[test]
fn errors_fall_along_figure_10_and_all_ways_are_near() {
    let field = study::fractal(128, 1);
    let exact = halflight_references::horizon::Horizons::new(&field);
    let truth = Truth::new(&field, &[0.4, 2.0, 4.1], 5, |vertex, azimuth| exact.at_vertex(vertex, azimuth));
    let [_, _, (_, cone), ..] = study::fields(128);
    let exact = halflight_references::horizon::Horizons::new(&cone);
    let of_cone = Truth::new(&cone, &[0.4, 2.0, 4.1], 5, |vertex, azimuth| exact.at_vertex(vertex, azimuth));
    let pyramids = FIGURE_10.map(|(k, o)| of_cone.errors(&mut study::pyramid(k, o, FIGURE_9[3])).rmse);
    assert!(pyramids.is_sorted_by(|softer, closer| softer > closer), "{pyramids:?}");
    let [closest, march, sweep] = [
        truth.errors(&mut study::pyramid(8, 8.0, FIGURE_9[0]).with_border(Border::Open)),
        truth.errors(&mut March::default().with_border(Border::Open)),
        truth.errors(&mut Sweep::new()),
    ];
    for errors in [closest, march, sweep] {
        assert!(errors.rmse.to_degrees() < 3.0 && errors.bias.abs().to_degrees() < 0.8, "{errors:?}");
    }
}

#[test]
fn an_environment_is_seen_without_the_spline() {
    let field = study::fractal(64, 2);
    let mut pyramid = Pyramid::new(Settings::default());
    let azimuths = [key(1.0), Azimuth { purpose: Purpose::Environment, ..key(1.0) }];
    pyramid.update(&field, &azimuths);
    let mut linear = vec![0.0; 2];
    pyramid.elevations_by(Scale::Linear, Points { x: &[20.0, 33.5], y: &[31.0, 2.0] }, 0..1, &mut linear);
    let mut both = vec![0.0; 4];
    pyramid.elevations(Points { x: &[20.0, 33.5], y: &[31.0, 2.0] }, 0..2, &mut both);
    assert_eq!(linear, both[2..]);
    assert_ne!(linear, both[..2]);
}

#[test]
fn march_and_sweep_match_the_trench() {
    // Walls of 45° along x at either side of a floor; seen from its middle line.
    let angle = 45.0_f64.to_radians();
    let trench = field([512, 65], |_, j| angle.tan() * (j - 32.0).abs());
    let azimuths: Vec<Azimuth> = (0..32).map(|step| key(step as f32 * TAU / 32.0)).collect();
    let (mut march, mut sweep) = (March::new(145), Sweep::new());
    march.update(&trench, &azimuths);
    sweep.update(&trench, &azimuths);
    for (index, azimuth) in azimuths.iter().enumerate() {
        let expected = (angle.tan() as f32 * azimuth.angle.sin().abs()).atan();
        // Lines that miss the bottom's vertices see it from a little up either wall.
        let mut found = vec![(at(&march, [256.0, 32.0], index), 1e-4), (at(&sweep, [256.0, 32.0], index), 1e-2)];
        if (0.01..3.13).contains(&azimuth.angle) {
            // From up the wall that is looked at.
            found.extend([(at(&march, [256.0, 40.0], index), 1e-4), (at(&sweep, [256.0, 40.0], index), 1e-4)]);
        }
        for (found, slack) in found {
            assert!((found - expected).abs() < slack, "{azimuth:?}: {found} for {expected}");
        }
    }
}

#[test]
fn a_shadow_begins_where_the_horizon_is_above_the_light() {
    let size = [70, 50];
    let rough = field(size, |i, j| 6.0 * (i * 0.37).sin() * (j * 0.23).cos() + (i * j * 0.7).sin());
    let mut march = March::default();
    march.update(&rough, &[key(0.4), key(2.5)]);
    let vertices = || (0..size[1]).flat_map(|j| (0..size[0]).map(move |i| [i as f32, j as f32]));
    let (x, y): (Vec<f32>, Vec<f32>) = vertices().map(|[x, y]| (x, y)).unzip();
    for (azimuth, elevation) in [(0, 0.05), (0, 0.6), (1, 0.3), (1, 1.2)] {
        let mut hidden = vec![true; x.len()];
        march.hidden(Points { x: &x, y: &y }, azimuth, elevation, &mut hidden);
        let expected: Vec<bool> =
            everywhere(&march, size, azimuth).iter().map(|horizon| *horizon > elevation).collect();
        assert!(elevation > 1.0 || expected.iter().any(|hidden| *hidden));
        assert_eq!(hidden, expected, "{azimuth}, {elevation}");
    }
}

#[test]
fn nothing_looks_below_the_horizon_or_above_the_zenith() {
    let cliff = field([40, 30], |i, j| if i > 20.0 && j > 10.0 { 1e6 } else { 0.0 });
    let azimuths = [key(0.3), key(2.0)];
    let mut all: Vec<Box<dyn Horizons>> = vec![Box::new(March::default()), Box::new(Sweep::new())];
    all.extend(all_variants().into_iter().map(|settings| Box::new(Pyramid::new(settings)) as Box<dyn Horizons>));
    for horizons in &mut all {
        horizons.update(&cliff, &azimuths);
        for azimuth in 0..2 {
            let found = everywhere(&**horizons, [40, 30], azimuth);
            assert!(found.iter().all(|elevation| (0.0..=FRAC_PI_2).contains(elevation)));
        }
    }
}
