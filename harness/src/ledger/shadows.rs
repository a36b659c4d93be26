//! Shadows apart from what is around them.

use super::{Bench, direct};
use crate::Error;
use crate::budget::{Asked, Seen};
use glam::Vec3;
use halflight_scenes::Scene;

/// Part of its light that a receiver in shadow lacks at least.
pub(crate) const SHADOW: f32 = 0.1;

/// Mean signed change of the receivers in shadow, or of those outside, with its standard error (channels taken to err alike).
pub(crate) fn mean_change(this: &Seen, before: &Seen, shadow: &[bool], dark: bool) -> (f64, f64) {
    let mean = |v: Vec3| f64::from(v.element_sum()) / 3.0;
    let chosen = (0..shadow.len()).filter(|&i| shadow[i] == dark && this.picture.valid[i]);
    let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
    for i in chosen {
        sum += mean(this.picture.radiance[i] - before.picture.radiance[i]);
        variance += mean(this.variance[i] + before.variance[i]);
        count += 1.0;
    }
    (sum / f64::max(count, 1.0), variance.sqrt() / f64::max(count, 1.0))
}

/// Which receivers lie in the traced shadow, all under light of order 4.
pub(crate) fn in_shadow(bench: &Bench, scene: &Scene, asked: &Asked<'_>) -> Result<Vec<bool>, Error> {
    let mut open = scene.clone();
    open.objects.iter_mut().for_each(|object| object.casts = false);
    let open = open.as_changed();
    let question = direct(&open, 0);
    let (lit, open) = (asked.traced("sh-light:4")?.picture, bench.ask(&question)?.traced("sh-light:4")?.picture);
    let lacks = |(lit, open): (&Vec3, &Vec3)| lit.element_sum() < (1.0 - SHADOW) * open.element_sum();
    Ok(lit.radiance.iter().zip(&open.radiance).map(lacks).collect())
}
