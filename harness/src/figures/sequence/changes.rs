//! How errors and pictures change from frame to frame.

use crate::budget::Seen;
use glam::Vec3;
use halflight_metrics::median;

/// A pop bends a picture so many times as much as the frames around it are bent in the median, and more than the truth.
pub(in crate::figures) const FACTOR: f64 = 3.0;
/// Frames on either side that a bend is held against.
pub(in crate::figures) const WINDOW: usize = 6;

/// From one frame to the next, over all receivers and channels; radiance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::figures) struct Change {
    /// Root mean square change of the error, without the truth's noise.
    pub(in crate::figures) error: f64,
    /// Root mean square change of the truth, without its noise.
    pub(in crate::figures) truth: f64,
    /// Largest change of one receiver's error, the mean of its channels, noise included.
    pub(in crate::figures) worst: f64,
    /// Largest change of one receiver's truth, noise included.
    pub(in crate::figures) worst_truth: f64,
}

/// The changes between frames, entry `t` from frame `t` to `t + 1`. Frames have the same receivers, and independent noise.
pub(in crate::figures) fn changes(run: &[Seen], truth: &[Seen]) -> Vec<Change> {
    run.windows(2)
        .zip(truth.windows(2))
        .map(|(run, truth)| change([&run[0], &run[1]], [&truth[0], &truth[1]]))
        .collect()
}

fn change(run: [&Seen; 2], truth: [&Seen; 2]) -> Change {
    let (mut square, mut own, mut noise) = (0.0, 0.0, 0.0);
    let mut found = Change::default();
    let receivers = truth[0].variance.len();
    for i in 0..receivers {
        let [moved, truly] = [run, truth].map(|pair| pair[1].picture.radiance[i] - pair[0].picture.radiance[i]);
        let change = moved - truly;
        square += mean(change * change);
        own += mean(truly * truly);
        noise += mean(truth[0].variance[i] + truth[1].variance[i]);
        found.worst = found.worst.max(mean(change).abs());
        found.worst_truth = found.worst_truth.max(mean(truly).abs());
    }
    let root = |square: f64| ((square - noise) / receivers.max(1) as f64).max(0.0).sqrt();
    Change { error: root(square), truth: root(own), ..found }
}

/// How far a picture lies from the middle of its neighbours. Smooth motion bends little, a pop as far as it jumps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::figures) struct Bend {
    /// Root mean square over receivers and channels, without noise; radiance.
    pub(in crate::figures) size: f64,
    /// What it is below by two standard errors of the noise.
    pub(in crate::figures) most: f64,
}

/// The bends from the second frame to the last but one.
pub(in crate::figures) fn bends(run: &[Seen]) -> Vec<Bend> {
    run.windows(3).map(|frames| bend([&frames[0], &frames[1], &frames[2]])).collect()
}

fn bend([before, this, after]: [&Seen; 3]) -> Bend {
    let (mut square, mut doubt) = (0.0, 0.0);
    for i in 0..this.variance.len() {
        let off = this.picture.radiance[i] - 0.5 * (before.picture.radiance[i] + after.picture.radiance[i]);
        let variance = this.variance[i] + 0.25 * (before.variance[i] + after.variance[i]);
        square += mean(off * off - variance);
        // The variance of d² for a normal d of mean δ is 4δ²σ² + 2σ⁴, and the mean of d² is δ² + σ²; channels err alike.
        doubt += mean(4.0 * off * off * variance - 2.0 * variance * variance);
    }
    let count = this.variance.len().max(1) as f64;
    let (square, doubt) = (square / count, doubt.max(0.0).sqrt() / count);
    Bend { size: square.max(0.0).sqrt(), most: (square + 2.0 * doubt).max(0.0).sqrt() }
}

/// Frames whose bend stands out of those around, and is surely more than the truth's own there.
pub(in crate::figures) fn pops(bends: &[Bend], truth: &[Bend]) -> Vec<usize> {
    let stands_out = |t: &usize| {
        let around = t.saturating_sub(WINDOW)..(t + WINDOW + 1).min(bends.len());
        let others: Vec<f64> = around.filter(|other| other != t).map(|other| bends[other].size).collect();
        let usual = median(&others).unwrap_or(f64::INFINITY);
        bends[*t].size > FACTOR * usual && bends[*t].size > truth[*t].most
    };
    (0..bends.len()).filter(stands_out).map(|t| t + 1).collect()
}

fn mean(v: Vec3) -> f64 {
    f64::from(v.element_sum()) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::{Layout, Picture};

    /// Frames of 300 receivers, a value each, all of one variance.
    fn frames(count: usize, variance: f32, value: impl Fn(usize, usize) -> f32) -> Vec<Seen> {
        let frame = |t| {
            let radiance = (0..300).map(|i| Vec3::splat(value(t, i))).collect();
            let picture = Picture { layout: Layout::List(300), radiance, valid: vec![true; 300] };
            Seen { picture, variance: vec![Vec3::splat(variance); 300] }
        };
        (0..count).map(frame).collect()
    }

    /// Independent of frame and receiver, of mean 0 and variance 1.
    fn noise(t: usize, i: usize) -> f32 {
        let mixed = ((t * 300 + i) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 40;
        ((mixed as f32 / (1 << 24) as f32) - 0.5) * 12f32.sqrt()
    }

    #[test]
    fn noise_of_the_truth_is_no_change_of_the_error() {
        let truth = frames(20, 1e-4, |t, i| 0.01 * t as f32 + 0.01 * noise(t, i));
        let run = frames(20, 0.0, |t, _| 0.012 * t as f32);
        // Four standard errors of a mean square of so many independent values of variance σ².
        let slack = |variance: f64| 4.0 * variance * (2.0 / 300f64).sqrt();
        for change in changes(&run, &truth) {
            // The error grows by 0.002 a frame, under noise of 0.014.
            assert!((change.error.powi(2) - 0.002f64.powi(2)).abs() < slack(2e-4), "{change:?}");
            // The truth by 0.01, which stands out of the noise less: 4δ²σ² + 2σ⁴ for 2σ⁴.
            assert!((change.truth.powi(2) - 1e-4).abs() < 2f64.sqrt() * slack(2e-4), "{change:?}");
        }
        assert!(bends(&truth).iter().all(|bend| bend.size.powi(2) < slack(1.5e-4)), "{:?}", bends(&truth));
    }

    #[test]
    fn a_jump_bends_two_frames_and_a_single_frame_three() {
        // A swing whose bends change by half along the way.
        let swing = |t: usize| 0.1 * (0.2 * t as f32 + 0.5).sin();
        let with = |pop: &dyn Fn(usize) -> f32| bends(&frames(20, 0.0, |t, _| swing(t) + pop(t)));
        let (smooth, single) = (with(&|_| 0.0), with(&|t| if t == 9 { 0.04 } else { 0.0 }));
        assert_eq!(pops(&smooth, &smooth), [0usize; 0]);
        assert_eq!(pops(&with(&|t| if t > 9 { 0.04 } else { 0.0 }), &smooth), [9, 10]);
        assert_eq!(pops(&single, &smooth), [8, 9, 10]);
        assert_eq!(pops(&single, &single), [0usize; 0], "what the truth does is no pop");
    }
}
