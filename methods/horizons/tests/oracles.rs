//! Horizons against closed forms and the exact horizon of the surface.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec2;
use halflight_horizons::{
    Azimuth, Horizons, March, Plane, Points, Purpose, Pyramid, Reconstruction, Scale, Settings, Storage, Sweep,
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
