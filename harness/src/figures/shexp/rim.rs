//! The rim sweep: a receiver that crosses the rim of a straddling sphere (§6.2).

use crate::Error;
use crate::figures::Figure;
use crate::figures::seeing::direct;
use crate::ledger::{Bench, number};
use glam::Vec3;
use halflight_proxies::{SelfShadow, seen};
use halflight_reports::{Axis, Mark, Plot, Series, Sheet};
use halflight_scenes::{Scene, Shape, Sphere};
use std::sync::Arc;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/rim",
    place: "Ren et al. 2006, §6.2 and Fig. 5",
    shows: "blocked light along a line over the rim of a straddling sphere, both self-shadow rules",
    look: "At the rim (distance 1) the printed rule drops by (c/r)³ of a uniform sky's irradiance where the centre lies above the receiver's \
           plane (c > 0), which a moving receiver shows as a jump; the continuous rule passes through.",
    make,
};

/// Heights of the centre over the plane, in radii.
const HEIGHTS: [f32; 4] = [-0.5, 0.0, 0.5, 0.9];
const RULES: [SelfShadow; 2] = [SelfShadow::Paper, SelfShadow::Continuous];
/// On either side of the rim, in radii of its circle.
const BESIDE: f32 = 1e-5;
/// Distances that are plotted, in radii of the rim.
const FAR: f32 = 2.5;
const STEPS: usize = 400;

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let mut rows = Vec::new();
    for c in HEIGHTS {
        let cube = f64::from(c.max(0.0).powi(3));
        let exact = RULES.map(|rule| jump(|d| Ok(blocked(rule, c, d))));
        let order = |rule: SelfShadow| jump_of_method(bench, rule, c);
        let [paper, continuous] = exact;
        let numbers = [cube, paper?, continuous?, order(RULES[0])?, order(RULES[1])?];
        rows.push([vec![format!("{c}")], numbers.map(number).to_vec()].concat());
        sheet.plot(&sweep(c))?;
    }
    sheet.note(
        "Jump: what is blocked just inside the rim less just outside, of a uniform sky's irradiance. In closed form: sin²θ cos γ of the \
         circle that the rule leaves. By the method: shexp/eigen at order 4 on a scene of that sphere, receivers on both sides.",
    );
    let columns =
        ["c/r", "(c/r)³", "paper, closed form", "continuous, closed form", "paper, method", "continuous, method"];
    sheet.table(&columns, &rows);
    Ok(())
}

/// Share of a uniform sky's irradiance that a unit sphere with its centre at height `c` takes from a receiver at a distance from
/// the rim's middle, in radii of the rim.
fn blocked(rule: SelfShadow, c: f32, distance: f32) -> f64 {
    let rim = (1.0 - c * c).sqrt();
    let sphere = Sphere { center: Vec3::Z * c, radius: 1.0 };
    let circle = seen(rule, Vec3::X * (distance * rim), Vec3::Z, &sphere);
    circle.map_or(0.0, |circle| f64::from(circle.sin_angle * circle.sin_angle * circle.axis.z))
}

/// By how much something falls from just inside the rim to just outside.
fn jump(of: impl Fn(f32) -> Result<f64, Error>) -> Result<f64, Error> {
    Ok(of(1.0 - BESIDE)? - of(1.0 + BESIDE)?)
}

fn sweep(c: f32) -> Plot {
    let distances = (0..=STEPS).map(|i| FAR * i as f32 / STEPS as f32);
    let points = |rule| distances.clone().map(move |d| (f64::from(d), blocked(rule, c, d)));
    let series = RULES.map(|rule| {
        let mark = if rule == SelfShadow::Paper { Mark::Line } else { Mark::Dashed };
        Series::new(rule.name(), mark, points(rule))
    });
    Plot {
        title: format!("c/r = {c}"),
        across: Axis::linear("distance from the foot of the centre, radii of the rim"),
        upwards: Axis::linear("blocked, of a uniform sky"),
        series: series.to_vec(),
    }
}

/// The jump of a method's radiance, as a share of the open sky's.
fn jump_of_method(bench: &Bench, rule: SelfShadow, c: f32) -> Result<f64, Error> {
    let mut scene: Scene = halflight_scenes::find("sphere-plane")?;
    let shape = Shape::Spheres(vec![Sphere { center: Vec3::Z * c, radius: 1.0 }]);
    scene.objects[0].content = shape.content();
    scene.objects[0].shape = Arc::new(shape);
    let rim = (1.0 - c * c).sqrt();
    let far = 1e4;
    let at = |distance: f32| (Vec3::X * (distance * rim), Vec3::Z);
    let scene = scene.with_receivers(&[at(1.0 - BESIDE), at(1.0 + BESIDE), at(far)]);
    let question = direct(&scene, 0);
    let settings = [("self-shadow", rule.name())];
    let radiance = bench.ask(&question)?.shaded("shexp/eigen", &settings)?.picture.radiance;
    let [inside, outside, open] = [0, 1, 2].map(|i: usize| f64::from(radiance[i].x));
    Ok((outside - inside) / open)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::Terms;
    use halflight_references::Quality;

    #[test]
    fn the_printed_rule_jumps_by_the_cube_and_the_continuous_one_does_not() {
        let cache = tempfile::tempdir().unwrap();
        let terms = Terms { cache: cache.path().into(), quality: Quality::default(), rounds: 1 };
        let bench = Bench::new(&terms);
        for c in HEIGHTS {
            let cube = f64::from(c.max(0.0).powi(3));
            let [paper, continuous] = RULES.map(|rule| jump(|d| Ok(blocked(rule, c, d))).unwrap());
            assert!((paper - cube).abs() < 2e-3 && continuous.abs() < 2e-3, "c = {c}: {paper}, {continuous}");
            // The log's clip at order 4 lets a few hundredths of a wide circle through.
            let [paper, continuous] = RULES.map(|rule| jump_of_method(&bench, rule, c).unwrap());
            assert!(
                (paper - cube).abs() < 0.1 * cube + 1e-3 && continuous.abs() < 1e-3,
                "c = {c}: {paper}, {continuous}"
            );
        }
    }
}
