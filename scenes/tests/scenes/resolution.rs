//! Scenes with more or fewer receivers.

use halflight_scenes::{Layout, find};

#[test]
fn cameras_and_grids_are_scaled_and_nothing_else() {
    for (name, size) in [("bunny-studio", [160, 120]), ("spheres-60", [96, 96])] {
        let whole = find(name).unwrap();
        for (factor, by) in [("0.5", 0.5), ("2", 2.0), ("0.001", 0.0), ("1", 1.0)] {
            let scaled = find(&format!("{name}@{factor}")).unwrap();
            let [width, height] = size.map(|side| ((f64::from(side) * by) as usize).max(1));
            let frame = scaled.frame(0);
            assert_eq!(frame.receivers.layout, Layout::Image { width, height });
            assert_eq!(scaled.name, format!("{name}@{factor}"));
            assert_eq!(scaled.content == whole.content, by == 1.0, "what decides the pictures");
            assert_eq!(scaled.facts().triangles, whole.facts().triangles);
        }
    }
    // The picture shows the same: the corner pixels' mean is the corner pixel of half the resolution.
    let [whole, half] = ["bunny-studio", "bunny-studio@0.5"].map(|name| find(name).unwrap().camera.unwrap());
    assert!(whole.direction(2.0, 2.0).distance(half.direction(1.0, 1.0)) < 1e-6);
}

#[test]
fn factors_that_make_no_sense_are_refused() {
    for (name, part) in [
        ("bunny-studio@0", "a factor above zero"),
        ("bunny-studio@-1", "a factor above zero"),
        ("bunny-studio@NaN", "a factor above zero"),
        ("bunny-studio@half", "a factor above zero"),
        ("bunny-studio@", "a factor above zero"),
        ("bunny-studio@1000", "at most 16384 a side"),
        ("bunny-studio@1e300", "at most 16384 a side"),
        ("trench@0.5", "receivers of a camera or a grid"),
        ("nowhere@0.5", "nowhere: expected the path of a scene file"),
    ] {
        let error = find(name).unwrap_err().to_string();
        assert!(error.contains(part), "{name}: {error}");
    }
}
