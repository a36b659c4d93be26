//! `idiff` agrees with our error measures.
//!
//! Its mean error is the mean of absolute differences over all channels, its RMS error the root of the mean of their
//! squares, its maximum that of any channel.

use glam::Vec3;
use halflight_metrics::{Picture as Measured, compare};
use halflight_results::{Layout, Picture};

use crate::tools::{copies, run};

fn noise(seed: u64, spread: f32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 40) as f32 / (1 << 24) as f32 - 0.5) * spread
    }
}

fn figure(report: &str, name: &str) -> f64 {
    let line = report.lines().find(|line| line.trim_start().starts_with(name)).expect(name);
    let value = line.split_once('=').unwrap().1.split_whitespace().next().unwrap();
    value.parse().unwrap_or_else(|_| panic!("{line}"))
}

fn measured(picture: &Picture) -> Measured<'_> {
    let (width, height) = picture.layout.size();
    let layout = halflight_metrics::Layout::Image { width, height };
    Measured { radiance: &picture.radiance, valid: &picture.valid, layout }
}

#[test]
fn idiff_agrees() {
    let (width, height) = (61, 37);
    let folder = tempfile::tempdir().unwrap();
    for (spread, offset) in [(1e-3, 0.0), (200.0, -3.0)] {
        let (mut value, mut error) = (noise(1, 2.0), noise(2, spread));
        let picture = |of: &mut dyn FnMut() -> f32| {
            let radiance = (0..width * height).map(|_| Vec3::from_array(std::array::from_fn(|_| of()))).collect();
            Picture { layout: Layout::Image { width, height }, radiance, valid: vec![true; width * height] }
        };
        let reference = picture(&mut || value() + 1.5);
        let mut at = reference.radiance.iter().flat_map(|v| v.to_array());
        let x = picture(&mut || at.next().unwrap() + offset + error());
        let mut names = Vec::new();
        for (name, picture) in [("x", &x), ("reference", &reference)] {
            let path = folder.path().join(format!("{name}.exr"));
            std::fs::write(&path, picture.to_exr().unwrap()).unwrap();
            // The mask counts as a channel otherwise.
            let Some(colours) = copies(&path, &[(vec!["--ch", "R,G,B"], &format!("{name}-rgb.exr"))]) else { return };
            names.push(colours[0].to_str().unwrap().to_owned());
        }
        let output = run("idiff", &["-v", &names[0], &names[1]]).expect("as oiiotool");
        let report = String::from_utf8_lossy(&output.stdout).into_owned();
        let scores = compare(&measured(&x), &measured(&reference), &vec![Vec3::ZERO; width * height]).unwrap();
        for (name, ours) in [("Mean error", scores.mae), ("RMS error", scores.rmse), ("Max error", scores.max)] {
            let theirs = figure(&report, name);
            assert!((theirs - ours).abs() <= 1e-5 * ours, "{name}: {theirs}, ours {ours}\n{report}");
        }
    }
}
