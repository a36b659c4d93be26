//! Truth and methods at the same points of ground and skin, frame by frame.

use crate::Error;
use crate::budget::chain::What;
use crate::budget::{Asked, Seen};
use crate::execute::Runner;
use crate::figures::seeing::direct;
use crate::ledger::{Bench, Setting, silent};
use crate::probe::Question;
use glam::Vec3;
use halflight_references::{Quality, Reference};
use halflight_results::{Layout, Picture};
use halflight_scenes::{Frame, Rgb, Scene, Shape};
use std::ops::Range;

/// A sequence with receivers that stay where they are on the ground and on the skin.
pub(super) struct Track {
    scene: Scene,
    /// For every frame the scene with its receivers there; posed alike.
    placed: Vec<Scene>,
    /// The first frame's number in the scene.
    first: usize,
    /// How many receivers lie on the ground; they come first.
    ground: usize,
}

impl Track {
    /// Frames of a shipped scene at so many a second; `ground²` receivers about the origin and `skin` on each
    /// object that deforms.
    pub(super) fn new(name: &str, rate: f32, frames: Range<usize>, ground: usize, skin: usize) -> Result<Track, Error> {
        let scene = Scene { frame_count: frames.end, fps: rate, ..halflight_scenes::find(name)? }.as_changed();
        let placed =
            frames.clone().map(|index| scene.with_receivers(&points(&scene, &scene.frame(index), ground, skin)));
        Ok(Track { placed: placed.collect(), scene, first: frames.start, ground: ground * ground })
    }

    /// A reference at every so many frames, the noise of each independent of the others'. Half the error that is asked for, since
    /// frames differ by little.
    pub(super) fn traced(&self, bench: &Bench, reference: &str, every: usize) -> Result<Vec<Seen>, Error> {
        let reference = Reference::parse(reference).map_err(|error| Error::Other(error.to_string()))?;
        let quality = &bench.terms.quality;
        let quality = Quality { standard_error: quality.standard_error / 2.0, ..*quality };
        let traced = |(index, scene): (usize, &Scene)| {
            let question = Question { seed: 1 + index as u64, ..direct(scene, self.first + index) };
            let asked = Asked::new(&question, &quality, &bench.terms.cache)?;
            asked.see(&What::Reference(reference.clone()), &mut silent)
        };
        self.placed.iter().enumerate().step_by(every).map(traced).collect()
    }

    /// The ground's receivers alone, or the skin's.
    pub(super) fn part(&self, frames: &[Seen], ground: bool) -> Vec<Seen> {
        let of = |seen: &Seen| {
            let range = if ground { 0..self.ground } else { self.ground..seen.variance.len() };
            let Picture { radiance, valid, .. } = &seen.picture;
            let (layout, radiance) = (Layout::List(range.len()), radiance[range.clone()].to_vec());
            let valid = valid[range.clone()].to_vec();
            Seen { picture: Picture { layout, radiance, valid }, variance: seen.variance[range].to_vec() }
        };
        frames.iter().map(of).collect()
    }

    /// A method's radiance, prepared once.
    pub(super) fn shaded(&self, bench: &Bench, setting: &Setting) -> Result<Vec<Seen>, Error> {
        let mut runner = Runner::new(bench.task(&self.scene, setting.method, &setting.params));
        let shade = |(index, scene): (usize, &Scene)| {
            let frame = scene.frame(self.first + index);
            let shaded = runner.picture(&frame, &mut silent);
            let radiance = shaded.map_err(|error| setting.failed(&self.scene, &error))?.radiance;
            let (variance, valid) = (vec![Rgb::ZERO; radiance.len()], frame.receivers.valid.clone());
            Ok(Seen { picture: Picture { layout: Layout::List(radiance.len()), radiance, valid }, variance })
        };
        self.placed.iter().enumerate().map(shade).collect()
    }

    /// Spheres accumulated a receiver in the first frame.
    pub(super) fn accumulated(&self, bench: &Bench, setting: &Setting) -> Result<f64, Error> {
        let scene = &self.placed[0];
        let counters = bench.shaded(scene, &scene.frame(self.first), setting)?.recorded.counters;
        let count = |name: &str| counters.get(name).copied().unwrap_or(0) as f64;
        Ok(count("blockers accumulated") / count("receivers"))
    }
}

/// Metres of ground on either side of the origin.
const REACH: f32 = 1.6;

fn points(scene: &Scene, frame: &Frame, ground: usize, skin: usize) -> Vec<(Vec3, Vec3)> {
    let at = |i: usize| ((i as f32 + 0.5) / ground as f32 * 2.0 - 1.0) * REACH;
    let mut points: Vec<_> =
        (0..ground * ground).map(|i| (Vec3::new(at(i % ground), at(i / ground), 0.0), Vec3::Z)).collect();
    for posed in frame.objects.iter().filter(|posed| scene.objects[posed.object].deformation.is_some()) {
        let Shape::Mesh(mesh) = &*posed.in_place() else { continue };
        let every = mesh.positions.len().div_ceil(skin).max(1);
        let vertices = mesh.positions.iter().copied().zip(mesh.normals.iter().copied());
        points.extend(vertices.step_by(every).filter(|(_, normal)| normal.is_normalized()));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::sequence::changes::{bends, pops};
    use crate::ledger::Terms;

    /// A sphere set of another size in a single frame is a pop; the walk by itself has none.
    #[test]
    fn a_planted_pop_is_found_and_a_walk_has_none() {
        let cache = tempfile::tempdir().unwrap();
        let bench = Bench::new(&Terms { cache: cache.path().into(), quality: Quality::default(), rounds: 1 });
        let track = Track::new("walker", 120.0, 0..14, 10, 100).unwrap();
        let shaded =
            |spheres| track.shaded(&bench, &Setting::new("shexp/hyb", &[("spheres", spheres)]).unwrap()).unwrap();
        let (mut run, truth) = (shaded("20"), bends(&track.traced(&bench, "truth", 1).unwrap()));
        assert_eq!(pops(&bends(&run), &truth), [0usize; 0], "{:?}", bends(&run));
        run[7] = shaded("19").swap_remove(7);
        assert_eq!(pops(&bends(&run), &truth), [6, 7, 8], "{:?}", bends(&run));
    }
}
