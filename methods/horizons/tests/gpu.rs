//! The pyramid on a graphics processor: known horizons, and those of the CPU's. These tests fail where there is no adapter, one in software
//! at least.
#![cfg(feature = "gpu")]

use std::f32::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use glam::Vec2;
use halflight_contract::{Backend, NoMeter};
use halflight_gpu::{Gpu, Resident, Revision};
use halflight_horizons::{
    Azimuth, Border, GpuPyramid, Horizons, Made, Plane, Points, Purpose, Pyramid, Reconstruction, Scale, Settings,
    Storage, place,
};
use halflight_scenes::HeightField;

/// A rounding of `f32`.
const ROUNDING: f32 = f32::EPSILON / 2.0;

/// Pyramids of each kind that there is.
fn variants() -> Vec<(Settings, Border)> {
    let settings = |levels_per_octave, offset, scale, plane, storage| Settings {
        levels_per_octave,
        offset,
        reconstruction: Reconstruction { scale, plane },
        storage,
    };
    vec![
        (Settings::default(), Border::Extend),
        (Settings::default(), Border::Open),
        (settings(3, 0.5, Scale::Linear, Plane::Bilinear, Storage::Octaves), Border::Extend),
        (settings(2, 2.0, Scale::BSpline, Plane::Bilinear, Storage::Full), Border::Open),
        (settings(1, 0.0, Scale::Linear, Plane::BSpline, Storage::Full), Border::Extend),
        (settings(8, 9.0, Scale::BSpline, Plane::BSpline, Storage::Octaves), Border::Open),
    ]
}

fn device() -> Arc<Gpu> {
    Gpu::shared(Backend::GPU).expect("an adapter")
}

fn on_gpu((settings, border): (Settings, Border), edit: &dyn Fn(String) -> String) -> GpuPyramid {
    GpuPyramid::new(&device(), settings, border, edit).expect("compiles")
}

/// Elevations at points, azimuth after azimuth.
fn look(pyramid: &GpuPyramid, field: &HeightField, [x, y]: [&[f32]; 2], azimuths: usize) -> Vec<f32> {
    let (gpu, count) = (device(), x.len());
    let size = [field.columns(), field.rows()];
    let at: Vec<[u32; 4]> = x.iter().zip(y).map(|(x, y)| place([*x, *y], size)).collect();
    let [mut places, mut elevations] = ["places", "elevations"].map(Resident::new);
    places.upload(&gpu, &mut NoMeter, &at).expect("fits");
    elevations.reserve(&gpu, (4 * count * azimuths) as u64).expect("fits");
    let buffers = pyramid.buffers(places.whole(), elevations.whole());
    gpu.run(&[pyramid.pass(&buffers, count as u64)], &mut NoMeter).expect("runs");
    gpu.download(&elevations, count * azimuths, &mut NoMeter).expect("downloads")
}

fn update(pyramid: &mut GpuPyramid, field: &HeightField, revision: u64, azimuths: &[Azimuth]) -> Made {
    pyramid.update(field, Revision(revision), azimuths, &mut NoMeter).expect("fits")
}

/// A number in `[0, 1)` by another.
fn mixed(number: usize) -> f32 {
    let bits = (number as u32 ^ 77).wrapping_mul(0x9e37_79b1);
    let bits = (bits ^ bits >> 15).wrapping_mul(0x85eb_ca77);
    (bits >> 8) as f32 / (1 << 24) as f32
}

fn field(size: [usize; 2], cell: [f32; 2], height: impl Fn(usize, usize) -> f32) -> HeightField {
    let heights = (0..size[0] * size[1]).map(|vertex| height(vertex % size[0], vertex / size[0])).collect();
    HeightField::new(size, Vec2::new(-3.0, 8.0), cell.into(), heights)
}

/// Hills with cliffs and noise.
fn rough(size: [usize; 2], cell: [f32; 2], rise: f32) -> HeightField {
    field(size, cell, |i, j| {
        let (x, y) = (i as f32, j as f32);
        let hills = (0.31 * x).sin() * (0.23 * y + 0.4).cos() + f32::from(u8::from((i / 7 + j / 9) % 2 == 0));
        rise * (hills + 0.3 * mixed(i + 1000 * j))
    })
}

/// All vertices, and points anywhere.
fn points(field: &HeightField) -> [Vec<f32>; 2] {
    let [columns, rows] = [field.columns(), field.rows()];
    let vertices = (0..columns * rows).map(|vertex| [(vertex % columns) as f32, (vertex / columns) as f32]);
    let anywhere = (0..60).map(|i| [mixed(i) * columns as f32 - 0.3, mixed(i + 500) * rows as f32 - 0.3]);
    let beyond = [[f32::NAN, 1.0], [-1e30, f32::INFINITY], [f32::MAX, 0.5]];
    let all: Vec<[f32; 2]> = vertices.chain(anywhere).chain(beyond).collect();
    [0, 1].map(|axis| all.iter().map(|point| point[axis]).collect())
}

fn azimuths() -> Vec<Azimuth> {
    let angles = [0.0, 0.4, TAU / 4.0, 2.0, 3.3, TAU * 0.75, 5.1];
    let purposes = [Purpose::Key, Purpose::Environment];
    angles.iter().flat_map(|&angle| purposes.map(|purpose| Azimuth { angle, purpose })).collect()
}

/// How far two backends may be apart in the tangent of an elevation.
///
/// Bringing back and looking take at most 40 operations a height, a level of the pyramid 6, whose roundings the next averages, so that all
/// levels give twice those of one at most. Roundings are as good as independent (Higham and Mary 2019): N of them, each of at most `u` of
/// the highest height, add up to more than 4√N·u with a probability of 1e-4. Two heights on two backends are compared.
///
/// Along a run of up to 256 receivers or samples the CPU steps from one to the next, and at points apart it adds in `f32`: a place is off
/// by as many roundings as there are samples. A slope changes by that much of what the field rises within a sample, which is no farther
/// than the distance.
fn apart(field: &HeightField) -> f32 {
    let [columns, rows] = [field.columns(), field.rows()];
    let highest = field.heights().iter().fold(0.0, |highest: f32, height| highest.max(height.abs()));
    let nearest = field.cell().min_element();
    let heights = 4.0 * (2.0 * 2.0 * (2.0 * 6.0 + 40.0f32)).sqrt() * ROUNDING * highest / nearest;
    let steps = (0..columns * rows).flat_map(|vertex| {
        let (i, j) = (vertex % columns, vertex / columns);
        let here = field.height(i, j);
        [field.height((i + 1).min(columns - 1), j), field.height(i, (j + 1).min(rows - 1))]
            .map(|next| (next - here).abs())
    });
    let steepest = steps.fold(0.0, f32::max) / nearest;
    let places = (2 * columns.min(256) + 4 * columns.max(rows)) as f32 * ROUNDING;
    heights + 2.0 * places * steepest
}

/// Arctangents, and sums of a few: each is off by 10 roundings of at most a right angle.
const ANGLES: f32 = 4.0 * 4.5 * ROUNDING * FRAC_PI_2;

/// The greatest distance between backends.
fn compare(field: &HeightField, variant: (Settings, Border), edit: &dyn Fn(String) -> String) -> f32 {
    let (azimuths, [x, y]) = (azimuths(), points(field));
    let mut gpu = on_gpu(variant, edit);
    update(&mut gpu, field, 1, &azimuths);
    let found = look(&gpu, field, [&x, &y], azimuths.len());
    let mut cpu = Pyramid::new(variant.0).with_border(variant.1);
    cpu.update(field, &azimuths);
    let mut expected = vec![f32::NAN; found.len()];
    cpu.elevations(Points { x: &x, y: &y }, 0..azimuths.len(), &mut expected);
    assert!(found.iter().all(|elevation| (0.0..=FRAC_PI_2).contains(elevation)), "{variant:?}");
    found.iter().zip(&expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f32::max)
}

fn as_it_is(text: String) -> String {
    text
}

#[test]
fn horizons_are_those_of_the_cpu() {
    let sizes = [[2, 2], [2, 37], [41, 2], [17, 23], [64, 48], [70, 33]];
    for (number, size) in sizes.into_iter().enumerate() {
        let cell = [[1.0, 1.0], [0.5, 1.5], [2.0, 0.25]][number % 3];
        let field = rough(size, cell, 2.0);
        let allowed = apart(&field) + ANGLES;
        for variant in variants() {
            let found = compare(&field, variant, &as_it_is);
            println!("{size:?}, {variant:?}: {found:.1e} apart, {allowed:.1e} allowed");
            assert!(found <= allowed, "{size:?}, {variant:?}: {found:e} > {allowed:e}");
        }
    }
}

/// Where all slopes are steeper than a million, angles differ by less than a millionth of what slopes do, and those that a spline is made
/// of by their roundings alone. Along a border that is drawn out slopes are 0 but for roundings, which are as steep as any there.
#[test]
fn heights_and_cells_of_any_size_are_seen_as_on_the_cpu() {
    for (cell, rise) in [(1e-6, 1e6), (1e6, 1e-6), (1e-6, 1e-6), (1e6, 1e6), (1.0, 0.0)] {
        let field = rough([33, 20], [cell, cell], rise);
        for variant in variants() {
            let found = compare(&field, variant, &as_it_is);
            let allowed = match (rise / cell > 1.0, variant.1) {
                (true, Border::Open) => 0.0,
                (true, Border::Extend) => FRAC_PI_2,
                (false, _) => apart(&field),
            };
            assert!(found <= allowed.max(ANGLES), "cell {cell}, rise {rise}, {variant:?}: {found:e} > {allowed:e}");
        }
    }
}

#[test]
fn a_ramp_is_seen_under_its_slope() {
    let slope = 0.7;
    let ramp = field([64, 256], [2.0, 0.5], |i, _| slope * 2.0 * i as f32);
    let azimuths: Vec<Azimuth> =
        (0..16).map(|step| Azimuth { angle: step as f32 * TAU / 16.0, purpose: Purpose::Key }).collect();
    for (settings, _) in variants() {
        let mut pyramid = on_gpu((settings, Border::Extend), &as_it_is);
        update(&mut pyramid, &ramp, 1, &azimuths);
        let found = look(&pyramid, &ramp, [&[32.0], &[128.0]], azimuths.len());
        for (azimuth, found) in azimuths.iter().zip(found) {
            let expected = (slope * azimuth.angle.cos()).atan().max(0.0);
            assert!((found - expected).abs() < 2e-4, "{settings:?}, {azimuth:?}: {found} for {expected}");
        }
    }
}

/// What rests is not made again, and what moved is made as if anew.
#[test]
fn a_field_is_uploaded_when_it_changed() {
    #[derive(Default)]
    struct Uploaded(u64);
    impl halflight_contract::Meter for Uploaded {
        fn begin(&mut self, _: &'static str) {}
        fn end(&mut self) {}
        fn count(&mut self, counter: &'static str, amount: u64) {
            self.0 += if counter == "bytes uploaded" { amount } else { 0 };
        }
        fn progress(&mut self, _: &'static str, _: u64, _: u64) -> halflight_contract::Flow {
            halflight_contract::Flow::Continue
        }
        fn derived(&mut self, _: &'static str, _: u64) {}
    }
    let fields = [rough([40, 30], [1.0, 1.0], 1.0), rough([40, 30], [1.0, 1.0], 3.0)];
    let (azimuths, [x, y]) = (azimuths(), points(&fields[0]));
    let mut pyramid = on_gpu(variants()[0], &as_it_is);
    let bytes = |pyramid: &mut GpuPyramid, field, revision, azimuths: &[Azimuth]| {
        let mut meter = Uploaded::default();
        pyramid.update(field, Revision(revision), azimuths, &mut meter).expect("fits");
        meter.0
    };
    let heights = 4 * 40 * 30;
    assert!(bytes(&mut pyramid, &fields[0], 1, &azimuths) > heights);
    assert_eq!(bytes(&mut pyramid, &fields[0], 1, &azimuths), 0);
    assert_eq!(bytes(&mut pyramid, &fields[1], 2, &azimuths), heights);
    let moved = look(&pyramid, &fields[1], [&x, &y], azimuths.len());
    let mut fresh = on_gpu(variants()[0], &as_it_is);
    update(&mut fresh, &fields[1], 7, &azimuths);
    assert_eq!(moved, look(&fresh, &fields[1], [&x, &y], azimuths.len()));
    // Steps of 32 bytes for each of 23 distances.
    assert_eq!(bytes(&mut pyramid, &fields[1], 2, &azimuths[1..3]), 2 * 32 * pyramid.samples() as u64);
    let other = rough([20, 30], [1.0, 1.0], 1.0);
    update(&mut pyramid, &other, 2, &azimuths);
    let mut fresh = on_gpu(variants()[0], &as_it_is);
    update(&mut fresh, &other, 2, &azimuths);
    let [x, y] = points(&other);
    assert_eq!(
        look(&pyramid, &other, [&x, &y], azimuths.len()),
        look(&fresh, &other, [&x, &y], azimuths.len()),
        "a field of another size"
    );
}

#[test]
fn fields_too_long_for_whole_numbers_are_refused() {
    let mut pyramid = on_gpu(variants()[0], &as_it_is);
    let field = field([2, 40_000], [1.0, 1.0], |_, _| 0.0);
    let error = pyramid.update(&field, Revision(1), &azimuths(), &mut NoMeter).unwrap_err().to_string();
    assert!(error.contains("2 x 40000 vertices"), "{error}");
}

/// A wrong number in any of the shaders' files is seen.
#[test]
fn a_wrong_number_is_seen() {
    let field = rough([64, 48], [1.0, 1.5], 2.0);
    let allowed = apart(&field) + ANGLES;
    let (splines, bilinear) = (variants()[0], variants()[2]);
    let faults = [
        (splines, "TAPS / 2 - 1", "TAPS / 2"),                             // grids.wgsl
        (bilinear, "array(1f - t, t)", "array(0.99f - t, t)"),             // bilinear.wgsl
        (splines, "0.5f, -1f", "0.49f, -1f"),                              // b_spline.wgsl
        (splines, "* finer.size - to.size", "* finer.size - 2 * to.size"), // decimate.wgsl
        (splines, "* level_grid.size - field;", "* level_grid.size;"),     // bring_back.wgsl
        (splines, "rest + 0.5f", "rest + 0.6f"),                           // look.wgsl
        (splines, "1f / 48f", "1f / 47f"),
    ];
    for (variant, right, wrong) in faults {
        let planted = |text: String| text.replacen(right, wrong, 1);
        let found = compare(&field, variant, &planted);
        assert!(found > 2.0 * allowed, "{wrong} changes horizons by {found:e}, {allowed:e} are allowed");
    }
}
