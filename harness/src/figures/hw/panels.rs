//! A shipped suite as pictures: what its cells make of a scene, beside the truth.

use crate::Error;
use crate::budget::chain::What;
use crate::budget::{Seen, apart};
use crate::figures::seeing::{alone, beside, direct};
use crate::ledger::{Bench, number, silent};
use crate::plan::{Group, Plan, Terms};
use crate::suite::Suite;
use glam::Vec3;
use halflight_reports::{Sheet, plus_minus};
use halflight_scenes::{Camera, Placement, Scene};

/// All cells of a shipped suite, scene by scene.
pub(super) fn planned(suite: &str) -> Result<Plan, Error> {
    Plan::new(&Suite::find(suite)?.entries, &Terms { seed: 1, timed_on: String::new() })
}

/// A terrain seen through a camera, in place of its vertices.
pub(super) fn from(eye: Vec3, target: Vec3, [width, height]: [usize; 2], scene: &Scene) -> Scene {
    let camera = Camera { eye, target, up: Vec3::Z, vertical_fov: 31f32.to_radians(), width, height };
    Scene { placement: Placement::Camera, camera: Some(camera), ..scene.clone() }.as_changed()
}

/// The fractal terrains, a kilometre wide, from the south and above: the key light comes from the right.
pub(super) fn from_south(size: [usize; 2], scene: &Scene) -> Scene {
    from(Vec3::new(-60.0, -1330.0, 740.0), Vec3::new(0.0, -70.0, -60.0), size, scene)
}

/// Pictures of a scene.
pub(super) struct Panels {
    pub(super) truth: Seen,
    /// Name and picture of every cell.
    pub(super) cells: Vec<(String, Seen)>,
}

impl Panels {
    /// The cells of a plan on its scene of this number, at the receivers of `scene`, which may be others than the suite's.
    pub(super) fn new(
        bench: &Bench,
        plan: &Plan,
        number: usize,
        scene: &Scene,
        name: impl Fn(&Group) -> String,
    ) -> Result<Panels, Error> {
        let question = direct(scene, 0);
        let asked = bench.ask(&question)?;
        let see = |group: &Group| {
            let what = What::Method(group.method, group.params.clone());
            Ok::<_, Error>((name(group), asked.see(&what, &mut silent)?))
        };
        let cells = plan.groups.iter().filter(|group| group.scene == number).map(see).collect::<Result<_, _>>()?;
        Ok(Panels { truth: asked.traced("truth")?, cells })
    }

    /// The truth, then every cell with its error.
    pub(super) fn show(&self, sheet: &mut Sheet) -> Result<(), Error> {
        let mut shown = vec![alone("ray traced", &self.truth)];
        for (name, seen) in &self.cells {
            shown.push(beside(name.clone(), seen, &self.truth)?);
        }
        Ok(sheet.pictures(&shown)?)
    }

    /// Name, RMSE and bias of every cell against a picture, each over the truth's mean level; nothing of a picture against itself.
    pub(super) fn errors(&self, against: &Seen) -> Result<Vec<[String; 3]>, Error> {
        let level = level(&self.truth);
        let share = |value: f64, error: f64| plus_minus(value / level, error / level);
        let row = |(name, seen): &(String, Seen)| {
            if std::ptr::eq(seen, against) {
                return Ok([name.clone(), "–".into(), "–".into()]);
            }
            let found = apart(seen, against)?;
            Ok([name.clone(), share(found.rmse, found.rmse_error), share(found.bias, found.bias_error)])
        };
        self.cells.iter().map(row).collect()
    }

    /// Roughness of every cell's picture over the truth's mean level.
    pub(super) fn roughness(&self) -> Vec<String> {
        self.cells.iter().map(|(_, seen)| number(roughness(seen) / level(&self.truth))).collect()
    }
}

/// Mean radiance over valid receivers and channels.
pub(super) fn level(seen: &Seen) -> f64 {
    let picture = &seen.picture;
    let valid = picture.radiance.iter().zip(&picture.valid).filter(|(_, valid)| **valid);
    let (sum, count) = valid.fold((0.0, 0usize), |(sum, count), (v, _)| (sum + f64::from(v.element_sum()), count + 1));
    sum / (3 * count.max(1)) as f64
}

/// Root mean square second difference along the rows of a picture, noise taken out; radiance.
pub(super) fn roughness(seen: &Seen) -> f64 {
    let (width, _) = seen.picture.layout.size();
    let (mut square, mut count) = (0.0, 0usize);
    let (radiance, valid) = (&seen.picture.radiance, &seen.picture.valid);
    for i in (1..radiance.len().saturating_sub(1)).filter(|i| !matches!(i % width, 0) && i % width != width - 1) {
        if valid[i - 1] && valid[i] && valid[i + 1] {
            let bend = radiance[i - 1] - 2.0 * radiance[i] + radiance[i + 1];
            let noise = seen.variance[i - 1] + 4.0 * seen.variance[i] + seen.variance[i + 1];
            square += f64::from((bend * bend - noise).element_sum()) / 3.0;
            count += 1;
        }
    }
    (square / count.max(1) as f64).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::{Layout, Picture};
    use std::collections::HashSet;

    /// Each cell of a suite that is shown has a name of its own; a setting that a suite gains must be in its name.
    #[test]
    fn panels_differ_in_their_names() {
        for (suite, name) in super::super::cone::NAMES {
            let plan = planned(suite).unwrap();
            let names: HashSet<String> = plan.groups.iter().map(name).collect();
            assert_eq!(names.len(), plan.groups.len(), "{suite}: {names:?}");
        }
    }

    #[test]
    fn the_swaths_are_normalised_as_the_caption_of_their_figure_has_it() {
        let plan = planned("paper/hw-fig6").unwrap();
        assert_eq!(plan.groups.len(), 4);
        assert!(plan.groups.iter().all(|group| group.params.choice("key-level") == "facing"));
    }

    #[test]
    fn roughness_is_of_second_differences_within_rows() {
        let of = |value: fn(usize) -> f32, variance: f32| {
            let radiance = (0..12).map(|i| Vec3::splat(value(i))).collect();
            let picture = Picture { layout: Layout::Image { width: 4, height: 3 }, radiance, valid: vec![true; 12] };
            Seen { picture, variance: vec![Vec3::splat(variance); 12] }
        };
        assert_eq!(roughness(&of(|i| (3 * (i % 4) + 100 * (i / 4)) as f32, 0.0)), 0.0);
        let squares = |i: usize| ((i % 4) * (i % 4)) as f32;
        assert_eq!(roughness(&of(squares, 0.0)), 2.0);
        assert!((roughness(&of(squares, 0.5)) - 1.0).abs() < 1e-9);
        assert_eq!(level(&of(|_| 0.5, 0.0)), 0.5);
    }
}
