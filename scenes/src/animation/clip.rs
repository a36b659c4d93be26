//! Keys of joints over time, and how a scene plays them.

use glam::{DQuat, DVec3};

use super::Transform;

/// What a scene's time means to a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Playback {
    /// Seconds of the clip at the scene's second 0.
    pub(crate) start: f64,
    /// Seconds of the clip a second of the scene.
    pub(crate) speed: f64,
    /// From the end back to the beginning; else the last key holds.
    pub(crate) repeat: bool,
}

impl Default for Playback {
    fn default() -> Self {
        Playback { start: 0.0, speed: 1.0, repeat: false }
    }
}

impl Playback {
    pub(crate) fn clip_time(&self, time: f64, duration: f64) -> f64 {
        let time = self.start + self.speed * time;
        if self.repeat && duration > 0.0 { time.rem_euclid(duration) } else { time }
    }
}

/// Tracks of joints; what has none keeps its rest transform.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clip {
    pub(crate) tracks: Vec<Track>,
    /// Seconds, up to the last key.
    pub(crate) duration: f64,
}

/// The keys of one part of a joint's transform.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    pub(crate) joint: usize,
    /// Ascending, at least one.
    pub(crate) times: Vec<f64>,
    pub(crate) keys: Keys,
    pub(crate) interpolation: Interpolation,
}

/// Values at the keys; with [`Interpolation::Cubic`] three a key: tangent in, value, tangent out.
#[derive(Clone, Debug)]
pub(crate) enum Keys {
    Translations(Vec<DVec3>),
    Rotations(Vec<DQuat>),
    Scales(Vec<DVec3>),
}

/// Between keys, as glTF 2.0, appendix C has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Interpolation {
    Step,
    /// Straight; rotations along the shorter arc.
    Linear,
    /// Hermite splines; rotations normalised after.
    Cubic,
}

/// Between which keys a time falls.
struct Between {
    from: usize,
    to: usize,
    /// Share of the way, and seconds between the keys.
    weight: f64,
    span: f64,
}

impl Clip {
    pub(crate) fn new(tracks: Vec<Track>) -> Self {
        let last = tracks.iter().filter_map(|track| track.times.last()).copied();
        Clip { duration: last.fold(0.0, f64::max), tracks }
    }

    pub(crate) fn apply(&self, time: f64, joints: &mut [Transform]) {
        for track in &self.tracks {
            let at = track.between(time);
            let joint = &mut joints[track.joint];
            match &track.keys {
                Keys::Translations(values) => joint.translation = track.vector(values, &at),
                Keys::Scales(values) => joint.scale = track.vector(values, &at),
                Keys::Rotations(values) => joint.rotation = track.rotation(values, &at),
            }
        }
    }
}

impl Track {
    fn between(&self, time: f64) -> Between {
        let next = self.times.partition_point(|key| *key <= time);
        match (next.checked_sub(1), self.times.get(next)) {
            (Some(from), Some(end)) => {
                let span = end - self.times[from];
                Between { from, to: next, weight: (time - self.times[from]) / span, span }
            }
            (from, _) => Between { from: from.unwrap_or(0), to: from.unwrap_or(0), weight: 0.0, span: 0.0 },
        }
    }

    fn vector(&self, values: &[DVec3], at: &Between) -> DVec3 {
        match self.interpolation {
            Interpolation::Step => values[at.from],
            Interpolation::Linear => values[at.from].lerp(values[at.to], at.weight),
            Interpolation::Cubic => {
                let [from, out, into, to] = hermite(at).map(|(index, _)| values[index]);
                let [a, b, c, d] = hermite(at).map(|(_, weight)| weight);
                from * a + out * b + into * c + to * d
            }
        }
    }

    fn rotation(&self, values: &[DQuat], at: &Between) -> DQuat {
        match self.interpolation {
            Interpolation::Step => values[at.from],
            Interpolation::Linear => values[at.from].slerp(values[at.to], at.weight),
            Interpolation::Cubic => {
                let sum = hermite(at)
                    .into_iter()
                    .fold(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), |sum, (index, weight)| sum + values[index] * weight);
                if sum.length_squared() > 0.0 { sum.normalize() } else { values[3 * at.from + 1] }
            }
        }
    }
}

/// Index into the values and weight of: the value before, its tangent out, the next one's tangent in, the next value.
fn hermite(at: &Between) -> [(usize, f64); 4] {
    let (t, span) = (at.weight, at.span);
    let (t2, t3) = (t * t, t * t * t);
    [
        (3 * at.from + 1, 2.0 * t3 - 3.0 * t2 + 1.0),
        (3 * at.from + 2, span * (t3 - 2.0 * t2 + t)),
        (3 * at.to, span * (t3 - t2)),
        (3 * at.to + 1, 3.0 * t2 - 2.0 * t3),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(keys: Keys, times: &[f64], interpolation: Interpolation) -> Clip {
        Clip::new(vec![Track { joint: 0, times: times.to_vec(), keys, interpolation }])
    }

    fn at(clip: &Clip, time: f64) -> Transform {
        let mut joints = [Transform::IDENTITY];
        clip.apply(time, &mut joints);
        joints[0]
    }

    #[test]
    fn first_and_last_key_hold() {
        let clip = track(Keys::Translations(vec![DVec3::X, DVec3::Y]), &[1.0, 2.0], Interpolation::Linear);
        assert_eq!((at(&clip, 0.0).translation, at(&clip, 5.0).translation), (DVec3::X, DVec3::Y));
        assert_eq!((at(&clip, 1.5).translation, clip.duration), (DVec3::new(0.5, 0.5, 0.0), 2.0));
        let steps =
            Clip { tracks: vec![Track { interpolation: Interpolation::Step, ..clip.tracks[0].clone() }], ..clip };
        assert_eq!(at(&steps, 1.999).translation, DVec3::X);
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let turn = |degrees: f64| DQuat::from_rotation_z(degrees.to_radians());
        let keys = Keys::Rotations(vec![turn(0.0), -turn(90.0)]);
        let halfway = at(&track(keys, &[0.0, 1.0], Interpolation::Linear), 0.5).rotation;
        assert!(halfway.angle_between(turn(45.0)) < 1e-7);
    }

    #[test]
    fn cubic_keys_reproduce_a_cubic() {
        // x(t) = t³ between t = 1 and 3, with its own derivatives as tangents.
        let key = |t: f64| [DVec3::X * 3.0 * t * t, DVec3::X * t * t * t, DVec3::X * 3.0 * t * t];
        let keys = Keys::Translations([key(1.0), key(3.0)].concat());
        let clip = track(keys, &[1.0, 3.0], Interpolation::Cubic);
        for time in [1.0, 1.3, 2.0, 2.9, 3.0, 4.0] {
            let expected = f64::min(time, 3.0).powi(3);
            assert!((at(&clip, time).translation.x - expected).abs() < 1e-12, "{time}");
        }
    }

    #[test]
    fn playback_repeats_and_shifts() {
        let playback = Playback { start: 1.0, speed: 2.0, repeat: true };
        assert_eq!(playback.clip_time(2.0, 3.0), 2.0);
        assert_eq!(Playback { repeat: false, ..playback }.clip_time(2.0, 3.0), 5.0);
        assert_eq!(playback.clip_time(-2.0, 3.0), 0.0);
    }
}
