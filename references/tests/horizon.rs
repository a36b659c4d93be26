//! The exact horizon of a height field against closed forms, brute force and rays at the same triangles.

mod support;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3, Vec2, Vec3};
use halflight_references::horizon::{Horizons, sky_irradiance};
use halflight_scenes::HeightField;
use halflight_trace::{Geometry, World};
use proptest::prelude::*;

/// A field about the origin.
fn field(size: [usize; 2], cell: [f32; 2], height: impl Fn(f64, f64) -> f64) -> HeightField {
    let [columns, rows] = size;
    let cell = Vec2::from(cell);
    let origin = -0.5 * Vec2::new((columns - 1) as f32, (rows - 1) as f32) * cell;
    let vertex = |index: usize| {
        let at = origin + Vec2::new((index % columns) as f32, (index / columns) as f32) * cell;
        height(f64::from(at.x), f64::from(at.y)) as f32
    };
    HeightField::new(size, origin, cell, (0..columns * rows).map(vertex).collect())
}

/// The heights under vertices, by index.
fn indexed([columns, rows]: [usize; 2], cell: [f32; 2], height: impl Fn(usize, usize) -> f32) -> HeightField {
    let heights = (0..columns * rows).map(|index| height(index % columns, index / columns)).collect();
    HeightField::new([columns, rows], Vec2::new(3.0, -2.0), Vec2::from(cell), heights)
}

/// White noise in `[0, 1)`.
fn noise(seed: u32) -> impl Fn(usize, usize) -> f32 {
    move |i, j| {
        let mut z = (i as u32).wrapping_mul(0x9e37_79b9) ^ (j as u32).wrapping_mul(0x85eb_ca6b) ^ seed;
        for _ in 0..3 {
            z = (z ^ (z >> 16)).wrapping_mul(0x45d9_f3b5);
        }
        (z >> 8) as f32 / (1 << 24) as f32
    }
}

/// Rough at every scale.
fn rough(size: [usize; 2], cell: [f32; 2]) -> HeightField {
    let octaves = [(0.11, 4.0), (0.27, 2.0), (0.61, 1.0), (1.3, 0.6), (2.9, 0.3)];
    field(size, cell, |x, y| {
        octaves
            .iter()
            .map(|(f, a)| a * ((f * x + 0.3 * a).sin() * (1.1 * f * y - a).cos() + (0.7 * f * (x + y)).sin()))
            .sum()
    })
}

fn fields() -> Vec<(&'static str, HeightField)> {
    let size = [25, 19];
    vec![
        ("rough", rough(size, [1.0, 1.0])),
        ("rough, oblong cells", rough([19, 25], [0.7, 1.9])),
        ("trench", field(size, [1.0, 1.5], |x, _| (x.abs() - 1.0).clamp(0.0, 5.0))),
        ("cone", field(size, [1.0, 1.0], |x, y| (6.0 - x.hypot(y)).max(0.0))),
        ("steps", field(size, [0.5, 0.5], |x, y| (x / 2.0).floor() + (y / 1.5).floor())),
        ("noise", indexed(size, [1.0, 1.0], noise(3))),
        ("steep noise", indexed(size, [1.0, 0.4], |i, j| 30.0 * noise(9)(i, j))),
        ("two rows", indexed([9, 2], [1.0, 1.0], noise(5))),
        ("one cell", indexed([2, 2], [2.0, 1.0], noise(6))),
    ]
}

/// Azimuths at which half-lines run along grid lines or diagonals, and others.
fn azimuths(field: &HeightField) -> Vec<f64> {
    let diagonal = f64::from(field.cell().y).atan2(f64::from(field.cell().x));
    let along = (0..4).flat_map(|quarter| {
        let turn = f64::from(quarter) * FRAC_PI_2;
        [turn, if quarter % 2 == 0 { turn + diagonal } else { turn + FRAC_PI_2 - diagonal }]
    });
    along.chain((0..13).map(|i| 0.1 + TAU * f64::from(i) / 13.0)).collect()
}

/// The horizon by dense samples of the surface along the half-line: from below, and the closer the more samples.
fn by_samples(field: &HeightField, from: DVec2, azimuth: f64, samples: usize) -> f64 {
    let step = DVec2::from_angle(azimuth) / field.cell().as_dvec2();
    let last = DVec2::new((field.columns() - 1) as f64, (field.rows() - 1) as f64);
    let height = field.surface(from.x, from.y);
    let far = last.length() * f64::from(field.cell().max_element());
    let mut steepest = 0f64;
    for sample in 1..=samples {
        let distance = far * sample as f64 / samples as f64;
        let at = from + distance * step;
        if at.clamp(DVec2::splat(-1e-9), last + 1e-9) != at {
            break;
        }
        steepest = steepest.max((field.surface(at.x, at.y) - height) / distance);
    }
    steepest.atan()
}

fn vertices(field: &HeightField) -> impl Iterator<Item = [usize; 2]> {
    let (columns, rows) = (field.columns(), field.rows());
    (0..rows).flat_map(move |j| (0..columns).map(move |i| [i, j]))
}

#[test]
fn agrees_with_dense_samples_of_the_surface() {
    let (mut cases, mut missed) = (0, 0);
    for (name, field) in fields() {
        let horizons = Horizons::new(&field);
        for (at, azimuth) in
            vertices(&field).step_by(7).flat_map(|at| azimuths(&field).into_iter().map(move |a| (at, a)))
        {
            let from = DVec2::new(at[0] as f64, at[1] as f64);
            let (exact, sampled) = (horizons.at_vertex(at, azimuth), by_samples(&field, from, azimuth, 3000));
            assert!(sampled < exact + 1e-9, "{name} {at:?} {azimuth}: {exact} below {sampled}");
            cases += 1;
            missed += usize::from(exact - sampled > 0.02);
        }
    }
    assert!(missed * 200 < cases, "samples passed by {missed} of {cases} horizons");
}

/// Rays from all vertices just above the horizon that something blocks, just below it that nothing blocks, and how many pairs.
fn strays(field: &HeightField, triangles: &[[u32; 3]]) -> [usize; 3] {
    let positions = &field.mesh().positions;
    let world = World::build(&[Geometry::Triangles { positions, triangles }]);
    let reach = positions.iter().map(|p| p.length()).fold(0.0, f32::max);
    // Seen from no nearer than a third of a cell, this start shifts the surface by less than the margin.
    let lift = 2.0 * f32::EPSILON * reach;
    let margin = f64::from(6.0 * lift / field.cell().min_element());
    let horizons = Horizons::new(field);
    let mut strays = [0; 3];
    let inner = |[i, j]: &[usize; 2]| (1..field.columns() - 1).contains(i) && (1..field.rows() - 1).contains(j);
    for at in vertices(field) {
        let origin = field.position(at[0], at[1]) + lift * Vec3::Z;
        // Rounding may take a ray along the border off the field.
        let azimuths = azimuths(field).into_iter().enumerate().filter(|(i, _)| *i >= 8 || inner(&at));
        for (_, azimuth) in azimuths {
            let horizon = horizons.at_vertex(at, azimuth);
            let ray = |elevation: f64| {
                let (sin, cos) = elevation.sin_cos();
                DVec3::new(cos * azimuth.cos(), cos * azimuth.sin(), sin).as_vec3()
            };
            let mut blocked = [false; 2];
            world.occluded_from(origin, 0.0, &[ray(horizon + margin), ray(horizon - margin)], &mut blocked);
            strays[0] += usize::from(blocked[0]);
            strays[1] += usize::from(horizon > margin && !blocked[1]);
            strays[2] += 1;
        }
    }
    strays
}

#[test]
fn separates_rays_that_hit_the_surface_from_rays_that_do_not() {
    for (name, field) in fields() {
        let [above, below, pairs] = strays(&field, &field.mesh().triangles);
        assert_eq!([above, below], [0, 0], "{name}: of {pairs} pairs");
        assert!(pairs > 30);
    }
}

#[test]
fn a_swapped_diagonal_is_found_out() {
    let field = indexed([15, 12], [1.0, 1.0], |i, j| 2.0 * noise(4)(i, j));
    let cut = |[[a, b, c], [_, _, d]]: &[[u32; 3]; 2]| [[*a, *b, *d], [*b, *c, *d]];
    let (cells, _) = field.mesh().triangles.as_chunks::<2>();
    let swapped: Vec<[u32; 3]> = cells.iter().flat_map(cut).collect();
    let [above, below, pairs] = strays(&field, &swapped);
    assert!(above > pairs / 10 && below > pairs / 10, "{above} and {below} of {pairs}");
}

#[test]
fn a_ramp_has_the_closed_form_at_every_point() {
    let slope = 0.7;
    let field = field([21, 17], [1.0, 0.5], |x, _| slope * x);
    let horizons = Horizons::new(&field);
    for azimuth in azimuths(&field) {
        let expected = (f64::from(slope as f32) * azimuth.cos()).atan().max(0.0);
        for at in vertices(&field) {
            let interior = (1..20).contains(&at[0]) && (1..16).contains(&at[1]);
            let found = horizons.at_vertex(at, azimuth);
            assert!(!interior || (found - expected).abs() < 1e-6, "{at:?} {azimuth}: {found}, expected {expected}");
        }
        let between = horizons.at_point(DVec2::new(0.123, -0.456), azimuth);
        assert!((between - expected).abs() < 1e-6, "{azimuth}: {between}, expected {expected}");
    }
}

#[test]
fn a_trench_has_the_closed_form() {
    // Of walls at 40° from the middle, and with a floor, from its middle.
    let rise = 40f64.to_radians().tan();
    let steep = field([41, 9], [1.0, 1.0], |x, _| rise * x.abs());
    let floor = field([41, 401], [1.0, 1.0], |x, _| (rise * (x.abs() - 4.0)).clamp(0.0, rise * 6.0));
    for azimuth in (0..360).map(|degree| f64::from(degree).to_radians()) {
        let across = azimuth.cos().abs();
        let found = Horizons::new(&steep).at_vertex([20, 4], azimuth);
        if across > 0.02 {
            let expected = (rise * across).atan();
            assert!((found - expected).abs() < 1e-6, "{azimuth}: {found}, expected {expected}");
        }
        // The rim is 10 m away, which a way reaches within the 200 m to either end.
        let found = Horizons::new(&floor).at_vertex([20, 200], azimuth);
        if across > 0.06 {
            let expected = (rise * 6.0 / 10.0 * across).atan();
            assert!((found - expected).abs() < 1e-6, "{azimuth}: {found}, expected {expected}");
        }
    }
}

#[test]
fn a_wall_and_a_cone_have_their_closed_forms() {
    let wall = indexed([31, 61], [1.0, 1.0], |i, _| if i == 20 { 5.0 } else { 0.0 });
    for azimuth in (-60..=60).map(|degree| f64::from(degree).to_radians()) {
        for column in [3, 10, 19] {
            let away = 20.0 - column as f64;
            if away * azimuth.tan().abs() < 30.0 {
                let found = Horizons::new(&wall).at_vertex([column, 30], azimuth);
                assert!((found - (5.0 * azimuth.cos() / away).atan()).abs() < 1e-12, "{column} {azimuth}");
            }
        }
    }
    // A cone of height 8 and slope 1 seen from 20 m: rays that touch it have a double root.
    let (height, slope, away) = (8.0, 1.0, 20.0);
    let cone = field([401, 401], [0.125, 0.125], |x, y| (height - slope * x.hypot(y)).max(0.0));
    let base = (height / (slope * away)).asin();
    for step in -12..12 {
        let azimuth = base * (f64::from(step) + 0.5) / 10.0;
        let tangent = (height * azimuth.cos()
            - azimuth.sin().abs() * (slope * slope * away * away - height * height).sqrt())
            / away;
        let expected = if azimuth.abs() < base { tangent.atan() } else { 0.0 };
        let found = Horizons::new(&cone).at_point(DVec2::new(-away, 0.0), azimuth);
        // The triangles cut off at most a cell²·slope/(8 r) of the flank at radius r, and less than a cell of the base.
        assert!((found - expected).abs() < 3e-4, "{azimuth}: {found}, expected {expected}");
    }
}

/// Horizons at all vertices of a field for azimuths `2πk/12 + shift`.
fn all(field: &HeightField, shift: f64) -> Vec<f64> {
    let azimuths: Vec<f64> = (0..12).map(|k| TAU * f64::from(k) / 12.0 + shift).collect();
    Horizons::new(field).at_vertices(&azimuths)
}

fn differ(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The horizons of a turned field, put back where those of the field are: vertex `(i, j)` lies at `turned(i, j)` there, and
/// azimuth `k` is `quarters` quarter turns on.
fn put_back(
    horizons: &[f64],
    [columns, rows]: [usize; 2],
    turned_columns: usize,
    turned: impl Fn(usize, usize) -> [usize; 2],
    azimuth: impl Fn(usize) -> usize,
) -> Vec<f64> {
    let mut back = Vec::new();
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let [i, j] = turned(i, j);
        back.extend((0..12).map(|k| horizons[(j * turned_columns + i) * 12 + azimuth(k) % 12]));
    }
    back
}

#[test]
fn turning_mirroring_and_moving_the_field_does_so_to_its_horizons() {
    let size @ [columns, rows] = [14, 11];
    let (cell, shift) = ([1.0, 0.75], 0.2);
    let general = indexed(size, cell, |i, j| 4.0 * noise(2)(i, j));
    let horizons = all(&general, shift);

    let half = indexed(size, cell, |i, j| general.height(columns - 1 - i, rows - 1 - j));
    let back = put_back(&all(&half, shift), size, columns, |i, j| [columns - 1 - i, rows - 1 - j], |k| k + 6);
    assert!(differ(&back, &horizons) < 1e-12);

    // Mirrored at x = y, azimuth a becomes 90° − a.
    let transposed = indexed([rows, columns], [cell[1], cell[0]], |i, j| general.height(j, i));
    let back = put_back(&all(&transposed, -shift), size, rows, |i, j| [j, i], |k| 12 + 3 - k);
    assert!(differ(&back, &horizons) < 1e-12);

    let moved = general.translated(Vec3::new(100.0, -50.0, 64.0));
    assert!(differ(&all(&moved, shift), &horizons) < 2e-5, "heights rounded at 64 m");

    // A quarter turn swaps the diagonals, which shows where cells are not plane.
    let turn = |field: &HeightField| {
        let turned = indexed([rows, columns], [cell[1], cell[0]], |i, j| field.height(j, rows - 1 - i));
        put_back(&all(&turned, shift), size, rows, |i, j| [rows - 1 - j, i], |k| k + 3)
    };
    let plane_cells = indexed(size, cell, |i, j| 4.0 * (noise(2)(i, 0) + noise(7)(0, j)));
    assert!(differ(&turn(&plane_cells), &all(&plane_cells, shift)) < 1e-6);
    assert!(differ(&turn(&general), &horizons) > 1e-2);
}

#[test]
fn along_the_border_the_profile_of_the_border_counts() {
    let field = indexed([12, 9], [1.0, 0.5], |i, j| 3.0 * noise(8)(i, j));
    let horizons = Horizons::new(&field);
    let steepest = |profile: Vec<f32>, step: f64| {
        let seen = |(i, height): (usize, &f32)| (f64::from(*height) - f64::from(profile[0])) / (step * i as f64);
        profile.iter().enumerate().skip(1).map(seen).fold(0.0, f64::max).atan()
    };
    for row in [0, 8] {
        let (east, west) = ((0..12).map(|i| field.height(i, row)), (0..12).rev().map(|i| field.height(i, row)));
        assert!((horizons.at_vertex([0, row], 0.0) - steepest(east.collect(), 1.0)).abs() < 1e-9);
        assert!((horizons.at_vertex([11, row], PI) - steepest(west.collect(), 1.0)).abs() < 1e-9);
        assert!((horizons.at_vertex([11, row], -PI) - horizons.at_vertex([11, row], PI)).abs() < 1e-9);
    }
    for column in [0, 11] {
        let (north, south) = ((0..9).map(|j| field.height(column, j)), (0..9).rev().map(|j| field.height(column, j)));
        assert!((horizons.at_vertex([column, 0], FRAC_PI_2) - steepest(north.collect(), 0.5)).abs() < 1e-9);
        assert!((horizons.at_vertex([column, 8], -FRAC_PI_2) - steepest(south.collect(), 0.5)).abs() < 1e-9);
    }
    assert_eq!(horizons.at_vertex([11, 8], 0.3), 0.0, "beyond the corner there is nothing");
}

#[test]
fn irradiance_follows_from_horizons() {
    let around: Vec<f64> = (0..720).map(|k| TAU * f64::from(k) / 720.0).collect();
    let of = |normal: DVec3, horizon: &dyn Fn(f64) -> f64| {
        sky_irradiance(normal, &around.iter().map(|azimuth| horizon(*azimuth)).collect::<Vec<_>>())
    };
    assert!((of(DVec3::Z, &|_| 0.0) - 1.0).abs() < 1e-12);
    assert_eq!(of(DVec3::Z, &|_| FRAC_PI_2), 0.0);
    assert!((of(DVec3::Z, &|_| 0.4) - 0.4f64.cos().powi(2)).abs() < 1e-12);
    for degrees in [10.0, 45.0, 80.0, 90.0, 130.0, 180.0] {
        let angle = f64::to_radians(degrees);
        let normal = DVec3::new(angle.sin() * 0.6, angle.sin() * -0.8, angle.cos());
        let found = of(normal, &|_| 0.0);
        assert!((found - 0.5 * (1.0 + angle.cos())).abs() < 1e-4, "{degrees}: {found}");
    }
    // The bottom of an infinite trench sees a lune: cos α.
    let rise = 40f64.to_radians().tan();
    let trench = field([41, 9], [1.0, 1.0], |x, _| rise * x.abs());
    let horizons = Horizons::new(&trench);
    let found = of(DVec3::Z, &|azimuth| horizons.at_vertex([20, 4], azimuth));
    assert!((found - 40f64.to_radians().cos()).abs() < 2e-4, "{found}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn points_between_vertices_see_what_samples_see(seed: u32, u in 0.0..1.0, v in 0.0..1.0, azimuth in 0.0..TAU) {
        let field = indexed([11, 8], [1.0, 0.6], |i, j| 2.0 * noise(seed)(i, j));
        let grid = DVec2::new(10.0 * u, 7.0 * v);
        let position = field.origin().as_dvec2() + grid * field.cell().as_dvec2();
        let exact = Horizons::new(&field).at_point(position, azimuth);
        let sampled = by_samples(&field, grid, azimuth, 20_000);
        prop_assert!(sampled < exact + 1e-6 && exact - sampled < 0.02, "{} against {}", exact, sampled);
    }
}
