//! Pictures as EXR: bit-exact, content-addressed, checked on reading.

use glam::Vec3;
use halflight_results::{Key, Layout, Picture, PictureError, ReferencePicture, Store, StoreError};
use std::fs;
use std::path::Path;

// Values with no structure, subnormals and signed zeros among them.
fn noise(count: usize, salt: u32) -> Vec<Vec3> {
    let mut state = salt | 1;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        f32::from_bits((state >> 1) % 0x7f00_0000)
    };
    let mut values: Vec<Vec3> = (0..count).map(|_| Vec3::new(next(), next(), next())).collect();
    values[0] = Vec3::new(-0.0, f32::MIN_POSITIVE / 2.0, f32::MAX);
    values
}

fn picture(layout: Layout) -> Picture {
    let count = layout.receivers().unwrap();
    Picture { layout, radiance: noise(count, 7), valid: (0..count).map(|i| i % 3 != 1).collect() }
}

fn reference(layout: Layout) -> ReferencePicture {
    let count = layout.receivers().unwrap();
    ReferencePicture {
        layout,
        mean: noise(count, 1),
        variance: noise(count, 2),
        samples: (0..count as u32).map(|i| i * 65_537).collect(),
        valid: (0..count).map(|i| i % 2 == 0).collect(),
    }
}

fn bits(values: &[Vec3]) -> Vec<[u32; 3]> {
    values.iter().map(|v| v.to_array().map(f32::to_bits)).collect()
}

const LAYOUTS: [Layout; 4] =
    [Layout::Image { width: 37, height: 21 }, Layout::Image { width: 5, height: 1 }, Layout::List(5), Layout::List(1)];

#[test]
fn pictures_read_back_bit_for_bit_under_the_same_hash() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    for layout in LAYOUTS {
        let original = picture(layout);
        let hash = store.write_picture(&original).unwrap();
        let back = store.read_picture(&hash).unwrap();
        assert_eq!(bits(&back.radiance), bits(&original.radiance));
        assert_eq!((back.layout, &back.valid), (layout, &original.valid));
        assert_eq!(store.write_picture(&back).unwrap(), hash);
        assert_eq!(hash, Key::of_bytes(&fs::read(store.image_path(&hash)).unwrap()));
    }
    // A list and an image of the same shape are different pictures.
    assert_eq!(fs::read_dir(dir.path().join("images")).unwrap().count(), LAYOUTS.len());
}

#[test]
fn references_read_back_bit_for_bit_and_as_pictures() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    for layout in LAYOUTS {
        let original = reference(layout);
        let hash = store.write_reference(&original).unwrap();
        let back = store.read_reference(&hash).unwrap();
        assert_eq!(bits(&back.mean), bits(&original.mean));
        assert_eq!(bits(&back.variance), bits(&original.variance));
        assert_eq!((back.layout, &back.samples, &back.valid), (layout, &original.samples, &original.valid));
        assert_eq!(store.read_picture(&hash).unwrap(), original.picture());
    }
}

#[test]
fn standard_error_is_the_root_of_the_variance() {
    let mut reference = reference(Layout::List(2));
    reference.variance = vec![Vec3::new(4.0, 9.0, 0.0), Vec3::ONE];
    assert_eq!(reference.standard_error(), [Vec3::new(2.0, 3.0, 0.0), Vec3::ONE]);
}

#[test]
fn lengths_must_fit_the_layout() {
    let image = Layout::Image { width: 2, height: 2 };
    let short = Picture { layout: image, radiance: vec![Vec3::ONE; 4], valid: vec![true; 3] };
    assert!(matches!(short.to_exr(), Err(PictureError::Length { field: "valid", actual: 3, expected: 4, .. })));
    let none = Picture { layout: Layout::List(0), radiance: vec![], valid: vec![] };
    assert!(matches!(none.to_exr(), Err(PictureError::Empty(_))));
    let vast = Layout::Image { width: usize::MAX, height: 2 };
    assert!(matches!(Picture { layout: vast, ..none }.to_exr(), Err(PictureError::Empty(_))));
}

#[test]
fn damaged_missing_and_foreign_files_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let store = Store::open(dir.path()).unwrap();
    let hash = store.write_picture(&picture(LAYOUTS[0])).unwrap();
    let path = store.image_path(&hash);
    let bytes = fs::read(&path).unwrap();

    let is = |error: StoreError, part: &str| {
        let text = error.to_string();
        assert!(text.contains(hash.as_str()) && text.contains(part), "{text}");
    };
    is(store.read_reference(&hash).unwrap_err(), "channel `mean.R` is missing; found `B`, `G`, `R`, `valid`");
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    is(store.read_picture(&hash).unwrap_err(), "damaged");
    fs::remove_file(&path).unwrap();
    assert!(!store.has_image(&hash));
    is(store.read_picture(&hash).unwrap_err(), "No such file");

    // Every truncation and a text file end in an error, not a panic.
    for cut in (0..bytes.len()).step_by(7) {
        assert!(Picture::from_exr(&bytes[..cut], Path::new("cut.exr")).is_err(), "cut at {cut}");
    }
    let error = Picture::from_exr(b"not an image", Path::new("note.txt")).unwrap_err();
    assert!(error.to_string().starts_with("note.txt: not a readable EXR"), "{error}");
}
