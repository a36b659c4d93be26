//! Horizons of fields of any size, shape and height; and what must not change them.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec2;
use halflight_horizons::{
    Azimuth, Border, Horizons, March, Plane, Points, Purpose, Pyramid, Reconstruction, Scale, Settings, Storage, Sweep,
};
use halflight_scenes::HeightField;
use halflight_sh_kernels::Simd;
use proptest::prelude::*;

/// Every kind of horizons, by the instructions of one set.
fn kinds(simd: Simd) -> Vec<Box<dyn Horizons>> {
    let mut all: Vec<Box<dyn Horizons>> = vec![Box::new(March::on(31, simd)), Box::new(Sweep::on(simd))];
    let settings = [
        (1, 0.0, Scale::Linear, Plane::Bilinear, Storage::Decimated),
        (3, 0.5, Scale::BSpline, Plane::BSpline, Storage::Decimated),
        (4, 2.0, Scale::BSpline, Plane::BSpline, Storage::Octaves),
        (8, 8.0, Scale::Linear, Plane::BSpline, Storage::Octaves),
        (2, 2.0, Scale::BSpline, Plane::Bilinear, Storage::Full),
    ];
    all.push(Box::new(March::on(31, simd).with_border(Border::Open)));
    all.push(Box::new(Pyramid::on(Settings::default(), simd).with_border(Border::Open)));
    for (levels_per_octave, offset, scale, plane, storage) in settings {
        let reconstruction = Reconstruction { scale, plane };
        all.push(Box::new(Pyramid::on(Settings { levels_per_octave, offset, reconstruction, storage }, simd)));
    }
    all
}

fn best() -> Vec<Box<dyn Horizons>> {
    kinds(Simd::best())
}

fn key(angle: f32) -> Azimuth {
    Azimuth { angle, purpose: Purpose::Key }
}

/// Elevations at all vertices under all azimuths.
fn everywhere(horizons: &dyn Horizons, [columns, rows]: [usize; 2], azimuths: usize) -> Vec<f32> {
    let vertices = || (0..rows).flat_map(|j| (0..columns).map(move |i| [i as f32, j as f32]));
    let (x, y): (Vec<f32>, Vec<f32>) = vertices().map(|[x, y]| (x, y)).unzip();
    let mut out = vec![f32::NAN; x.len() * azimuths];
    horizons.elevations(Points { x: &x, y: &y }, 0..azimuths, &mut out);
    out
}

/// A number in `[0, 1)` by another.
fn mixed(number: usize, seed: u32) -> f32 {
    let bits = (number as u32 ^ seed).wrapping_mul(0x9e37_79b1);
    let bits = (bits ^ bits >> 15).wrapping_mul(0x85eb_ca77);
    (bits >> 8) as f32 / (1 << 24) as f32
}

fn any_field() -> impl Strategy<Value = HeightField> {
    let side = || prop_oneof![2..4_usize, 2..40_usize, 60..70_usize];
    let power = || -6.0..6.0_f32;
    let kind = 0..3_u32;
    (side(), side(), power(), -0.5..0.5_f32, power(), any::<u32>(), kind).prop_map(
        |(columns, rows, cell, shape, rise, seed, kind)| {
            let cell = Vec2::new(10.0_f32.powf(cell + shape), 10.0_f32.powf(cell - shape));
            let scale = 10.0_f32.powf(rise) * cell.x;
            let height = |vertex: usize| match kind {
                0 => mixed(vertex, seed),
                1 => mixed(vertex, seed).round(), // vertical cliffs
                _ => (vertex % columns) as f32 / columns as f32 + 0.1 * mixed(vertex, seed),
            };
            let heights = (0..columns * rows).map(|vertex| scale * height(vertex)).collect();
            HeightField::new([columns, rows], Vec2::new(-3.0, 8.0), cell, heights)
        },
    )
}

/// Each looks at many fields' vertices by many kinds of horizons.
fn cases() -> u32 {
    std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(40)
}

/// What rounding may do to an angle: that of heights and, along a run, of positions (by 256 times as much of a sample), over the
/// nearest distance.
fn rounding(field: &HeightField) -> f32 {
    let highest = field.heights().iter().fold(0.0, |highest: f32, height| highest.max(height.abs()));
    1e-5 + 256.0 * f32::EPSILON * highest / field.cell().min_element()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn horizons_lie_between_flat_and_upright(field in any_field(), angle in -7.0..7.0_f32, at in -100.0..100.0_f32) {
        let azimuths = [key(angle), key(angle + 1.3)];
        let points = Points { x: &[at, f32::MAX, 0.3, f32::NAN], y: &[-at, -1.0, f32::INFINITY, 0.5] };
        for horizons in &mut best() {
            horizons.update(&field, &azimuths);
            let mut found = everywhere(&**horizons, [field.columns(), field.rows()], 2);
            let mut apart = [f32::NAN; 8];
            horizons.elevations(points, 0..2, &mut apart);
            found.extend(apart);
            prop_assert!(found.iter().all(|elevation| (0.0..=FRAC_PI_2).contains(elevation)), "{found:?}");
        }
    }

    #[test]
    fn a_run_of_receivers_sees_what_each_sees_alone(field in any_field(), angle in 0.0..TAU, seed in any::<u32>()) {
        let azimuths = [key(angle), Azimuth { angle: angle + 2.0, purpose: Purpose::Environment }];
        let size = [field.columns(), field.rows()];
        for horizons in &mut best() {
            horizons.update(&field, &azimuths);
            let all = everywhere(&**horizons, size, 2);
            for pick in 0..20 {
                let vertex = (mixed(pick, seed) * (size[0] * size[1]) as f32) as usize;
                let point = Points { x: &[(vertex % size[0]) as f32], y: &[(vertex / size[0]) as f32] };
                let mut alone = [f32::NAN; 2];
                horizons.elevations(point, 0..2, &mut alone);
                for azimuth in 0..2 {
                    let together = all[azimuth * size[0] * size[1] + vertex];
                    prop_assert!((alone[azimuth] - together).abs() < rounding(&field), "{} for {together}", alone[azimuth]);
                }
            }
        }
    }

    #[test]
    fn instruction_sets_agree(field in any_field(), angle in 0.0..TAU) {
        let azimuths = [key(angle), key(-angle)];
        let see = |simd: Simd| -> Vec<Vec<f32>> {
            kinds(simd).iter_mut().map(|horizons| {
                horizons.update(&field, &azimuths);
                everywhere(&**horizons, [field.columns(), field.rows()], 2)
            }).collect()
        };
        let plain = see(Simd::Portable);
        for simd in Simd::ALL.into_iter().filter(|simd| simd.is_available()) {
            for (kind, (plain, found)) in plain.iter().zip(see(simd)).enumerate() {
                for (plain, found) in plain.iter().zip(found) {
                    prop_assert!((plain - found).abs() < rounding(&field), "{kind}, {simd:?}: {found} for {plain}, rounding {}", rounding(&field));
                }
            }
        }
    }

    #[test]
    fn what_changed_is_all_that_is_made_again(field in any_field(), from in 0.0..1.0_f32, part in 0.0..0.3_f32) {
        let size = [field.columns(), field.rows()];
        let first = (from * size[1] as f32) as usize;
        let end = (first + 1 + (part * size[1] as f32) as usize).min(size[1]);
        let mut heights = field.heights().to_vec();
        for (vertex, height) in heights.iter_mut().enumerate().take(end * size[0]).skip(first * size[0]) {
            *height += field.cell().x * mixed(vertex, 5);
        }
        let later = HeightField::new(size, field.origin(), field.cell(), heights);
        for (mut kept, mut fresh) in best().into_iter().zip(best()) {
            kept.update(&field, &[key(0.5)]);
            kept.update(&later, &[key(0.7), key(2.0)]);
            fresh.update(&later, &[key(0.7), key(2.0)]);
            prop_assert_eq!(everywhere(&*kept, size, 2), everywhere(&*fresh, size, 2));
            // Light that turns: one azimuth stays, in another place.
            kept.update(&later, &[key(2.0), key(1.1)]);
            fresh.update(&field, &[]);
            fresh.update(&later, &[key(2.0), key(1.1)]);
            prop_assert_eq!(everywhere(&*kept, size, 2), everywhere(&*fresh, size, 2));
        }
    }

    #[test]
    fn a_field_moved_and_raised_by_whole_numbers_is_seen_alike(columns in 2..40_usize, rows in 2..40_usize, seed in any::<u32>()) {
        let heights = |raise: f32| (0..columns * rows).map(|vertex| (64.0 * mixed(vertex, seed)).floor() + raise).collect();
        let low = HeightField::new([columns, rows], Vec2::ZERO, Vec2::ONE, heights(0.0));
        let high = HeightField::new([columns, rows], Vec2::new(100.0, -7.0), Vec2::ONE, heights(32.0));
        for horizons in &mut best() {
            horizons.update(&low, &[key(1.0)]);
            let expected = everywhere(&**horizons, [columns, rows], 1);
            horizons.update(&high, &[key(1.0)]);
            for (found, expected) in everywhere(&**horizons, [columns, rows], 1).iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-4, "{found} for {expected}");
            }
        }
    }

    #[test]
    fn a_field_turned_or_transposed_turns_or_transposes_what_is_seen(
        columns in 2..40_usize, rows in 2..40_usize, seed in any::<u32>(), step in 0..32_u32,
    ) {
        let angle = (step as f32 + 0.5) * TAU / 32.0;
        let cell = Vec2::new(1.5, 0.75);
        let height = |i: usize, j: usize| 3.0 * mixed(j * columns + i, seed);
        let make = |[columns, rows]: [usize; 2], cell: Vec2, height: &dyn Fn(usize, usize) -> f32| {
            let heights = (0..columns * rows).map(|vertex| height(vertex % columns, vertex / columns)).collect();
            HeightField::new([columns, rows], Vec2::ZERO, cell, heights)
        };
        let plain = make([columns, rows], cell, &height);
        // By a quarter turn vertex (i, j) goes to (rows − 1 − j, i).
        let turned = make([rows, columns], Vec2::new(cell.y, cell.x), &|i, j| height(j, rows - 1 - i));
        let transposed = make([rows, columns], Vec2::new(cell.y, cell.x), &|i, j| height(j, i));
        for (kind, horizons) in best().iter_mut().enumerate() {
            horizons.update(&plain, &[key(angle)]);
            let expected = everywhere(&**horizons, [columns, rows], 1);
            horizons.update(&turned, &[key(angle + FRAC_PI_2)]);
            let seen_turned = everywhere(&**horizons, [rows, columns], 1);
            horizons.update(&transposed, &[key(FRAC_PI_2 - angle)]);
            let seen_transposed = everywhere(&**horizons, [rows, columns], 1);
            for j in 0..rows {
                for i in 0..columns {
                    let expected = expected[j * columns + i];
                    let turned = seen_turned[i * rows + (rows - 1 - j)];
                    let transposed = seen_transposed[i * rows + j];
                    prop_assert!((turned - expected).abs() < 1e-3, "{kind} turned: {turned} for {expected}");
                    prop_assert!((transposed - expected).abs() < 1e-3, "{kind} transposed: {transposed} for {expected}");
                }
            }
        }
    }

    #[test]
    fn nothing_jumps_between_cells(field in any_field(), angle in 0.0..TAU, along in 0.0..1.0_f32) {
        // At half a thousandth of a cell either side of a line of the grid.
        let column = ((field.columns() - 1) as f32 * along).floor().max(1.0).min((field.columns() - 1) as f32);
        let row = (field.rows() - 1) as f32 * 0.37;
        let heights = field.heights();
        let [low, high] = [f32::min, f32::max].map(|pick| heights.iter().copied().reduce(pick).unwrap_or(0.0));
        // Two thousandths of what heights differ by at most, over the nearest distance.
        let most = 4e-3 * (high - low) / field.cell().min_element();
        for horizons in &mut best() {
            horizons.update(&field, &[key(angle)]);
            let mut out = [0.0; 2];
            horizons.elevations(Points { x: &[column - 5e-4, column + 5e-4], y: &[row; 2] }, 0..1, &mut out);
            prop_assert!((out[0] - out[1]).abs() < 4.0 * most + rounding(&field), "{out:?}");
        }
    }
}

#[test]
fn two_threads_equal_one() {
    let field = halflight_horizons::study::fractal(200, 4);
    let see = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut seen = Vec::new();
            for horizons in &mut best() {
                horizons.update(&field, &[key(0.4), key(3.0)]);
                seen.push(everywhere(&**horizons, [200, 200], 2));
            }
            seen
        })
    };
    assert_eq!(see(1), see(2));
}

#[test]
fn a_field_of_4096_vertices_a_side_takes_what_is_stated() {
    let side = 4096;
    let heights = (0..side * side).map(|vertex| mixed(vertex / 8, 1)).collect();
    let field = HeightField::new([side, side], Vec2::ZERO, Vec2::ONE, heights);
    let mut pyramid = Pyramid::new(Settings { storage: Storage::Decimated, ..Settings::default() });
    pyramid.update(&field, &[key(1.0)]);
    assert!(pyramid.footprint() < 240_000_000, "{}", pyramid.footprint());
    let mut seen = [f32::NAN; 2];
    pyramid.elevations(Points { x: &[0.0, 4095.0], y: &[0.0, 2047.5] }, 0..1, &mut seen);
    assert!(seen.iter().all(|elevation| (0.0..=FRAC_PI_2).contains(elevation)));
}

/// Registers that begin among the last samples of the last row read as far as it and its padding go.
#[test]
fn rows_of_any_width_are_read_to_their_end() {
    let azimuths: Vec<Azimuth> = (0..16).map(|i| key((i as f32 + 0.5) * TAU / 16.0)).collect();
    let reconstruction = Reconstruction { scale: Scale::BSpline, plane: Plane::BSpline };
    for columns in 100..132 {
        let heights = (0..3 * columns).map(|i| mixed(i, 7)).collect();
        let field = HeightField::new([columns, 3], Vec2::ZERO, Vec2::ONE, heights);
        for storage in [Storage::Decimated, Storage::Full] {
            let mut pyramid = Pyramid::new(Settings { levels_per_octave: 4, offset: 8.0, reconstruction, storage });
            pyramid.update(&field, &azimuths);
            assert!(everywhere(&pyramid, [columns, 3], 16).iter().all(|elevation| elevation.is_finite()));
        }
    }
}
