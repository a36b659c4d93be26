//! Height fields that change with time: waves that run, ground that grows.

use glam::{DVec2, DVec3};

use crate::HeightField;

/// A sine that runs over the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wave {
    /// Metres.
    pub(crate) amplitude: f64,
    /// Radians a metre along x and y.
    pub(crate) frequency: DVec2,
    /// Radians at the origin at second 0.
    pub(crate) phase: f64,
    /// Radians a second by which the phase falls: positive, and the wave runs along its frequency.
    pub(crate) pace: f64,
}

impl Wave {
    /// Height in metres at a place and a time in seconds.
    pub(crate) fn height(&self, at: DVec2, time: f64) -> f64 {
        self.amplitude * (self.frequency.dot(at) + self.phase - self.pace * time).sin()
    }
}

/// Steady growth of all heights above a field's own zero, from second 0 on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Growth {
    /// Share of its height that it has at second 0.
    pub(crate) from: f64,
    /// When it is as high as at rest, from when on it stays so.
    pub(crate) seconds: f64,
}

impl Growth {
    fn share(&self, time: f64) -> f64 {
        self.from + (1.0 - self.from) * (time / self.seconds).clamp(0.0, 1.0)
    }
}

/// What a field does over time. At second 0, fully grown, it is as at rest.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Swell {
    /// Those that run.
    pub(crate) waves: Vec<Wave>,
    pub(crate) growth: Option<Growth>,
    /// Scale and place of the field's own space.
    pub(crate) scale: f64,
    pub(crate) place: DVec3,
}

impl Swell {
    /// The field at a time in seconds.
    pub(crate) fn at(&self, rest: &HeightField, time: f64) -> HeightField {
        let (columns, zero) = (rest.columns(), self.place.z);
        let share = self.growth.map_or(1.0, |growth| growth.share(time));
        let height = |(index, height): (usize, &f32)| {
            let at = rest.position(index % columns, index / columns).as_dvec3().truncate();
            let own = (at - self.place.truncate()) / self.scale;
            let risen: f64 = self.waves.iter().map(|wave| wave.height(own, time) - wave.height(own, 0.0)).sum();
            (zero + share * (f64::from(*height) - zero + self.scale * risen)) as f32
        };
        let heights = rest.heights().iter().enumerate().map(height).collect();
        HeightField::new([columns, rest.rows()], rest.origin(), rest.cell(), heights)
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    fn rest(swell: &Swell) -> HeightField {
        let origin = Vec2::new(-3.0, 4.0);
        let height = |index: usize| {
            let at = (origin + Vec2::new((index % 9) as f32, (index / 9) as f32)).as_dvec2();
            let own = (at - swell.place.truncate()) / swell.scale;
            let waves: f64 = swell.waves.iter().map(|wave| wave.height(own, 0.0)).sum();
            (swell.place.z + swell.scale * waves) as f32
        };
        HeightField::new([9, 7], origin, Vec2::ONE, (0..63).map(height).collect())
    }

    fn swell() -> Swell {
        let frequency = DVec2::new(0.7, 0.4);
        let wave = Wave { amplitude: 0.5, frequency, phase: 0.3, pace: 2.0 };
        Swell { waves: vec![wave], growth: None, scale: 2.0, place: DVec3::new(1.0, 5.0, 10.0) }
    }

    #[test]
    fn waves_run_along_their_direction_at_their_speed() {
        let swell = swell();
        let field = rest(&swell);
        assert_eq!(swell.at(&field, 0.0).heights(), field.heights());
        // In its own space the crest goes pace/|frequency| a second; a whole period later all is as before.
        let period = std::f64::consts::TAU / 2.0;
        for (now, later) in field.heights().iter().zip(swell.at(&field, period).heights()) {
            assert!((now - later).abs() < 1e-5);
        }
        let velocity = 2.0 * swell.waves[0].frequency / swell.waves[0].frequency.length_squared();
        for time in [0.1, 0.37] {
            let later = swell.at(&field, time);
            for (index, height) in later.heights().iter().enumerate() {
                let at = later.position(index % 9, index / 9).as_dvec3().truncate();
                let own = (at - swell.place.truncate()) / swell.scale - velocity * time;
                let expected = 10.0 + 2.0 * swell.waves[0].height(own, 0.0);
                assert!((f64::from(*height) - expected).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn ground_grows_from_its_zero_and_stops() {
        let swell = Swell { waves: Vec::new(), growth: Some(Growth { from: 0.25, seconds: 2.0 }), ..swell() };
        let field = HeightField::new([2, 2], Vec2::ZERO, Vec2::ONE, vec![10.0, 14.0, 6.0, 11.0]);
        assert_eq!(swell.at(&field, 0.0).heights(), [10.0, 11.0, 9.0, 10.25]);
        assert_eq!(swell.at(&field, 1.0).heights(), [10.0, 12.5, 7.5, 10.625]);
        assert_eq!(swell.at(&field, 2.0).heights(), field.heights());
        assert_eq!(swell.at(&field, 9.0).heights(), field.heights());
    }
}
