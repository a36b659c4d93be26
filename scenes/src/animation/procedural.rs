//! Deformations by formula. Each is periodic, starts at rest, and is written about the origin of its own space with +z up.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

/// A deformation by formula; lengths in the object's own units before `scale`, angles in radians, time in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Procedural {
    /// What it does.
    pub form: Form,
    /// Seconds.
    pub period: f64,
}

/// How points move; `s = sin(2π · time / period)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// About z by `s · angle · z / height`.
    Twist {
        /// At z = `height`.
        angle: f64,
        /// Metres.
        height: f64,
    },
    /// The x axis is rolled up, its length kept, so that it has turned by `s · angle` at x = `length`.
    Bend {
        /// At x = `length`.
        angle: f64,
        /// Metres.
        length: f64,
    },
    /// What lies beyond `hinge` on either side of x = 0 turns up by `s · angle` about the y axis there, smoothly within the
    /// hinge's width.
    Flap {
        /// Of the tips.
        angle: f64,
        /// Distance of the hinges from x = 0.
        hinge: f64,
    },
    /// Stretched along z by `1 + s · stretch`, the volume kept, and tapered: what is above gets narrower.
    Egg {
        /// Below 1.
        stretch: f64,
        /// Share by which it narrows at z = 1; below 1 for shapes within −1 ≤ z ≤ 1.
        taper: f64,
    },
}

impl Procedural {
    /// How the surroundings of a point are stretched and turned at a time: the derivative of [`Procedural::point`].
    pub fn derivative(&self, p: DVec3, time: f64) -> DMat3 {
        let step = 1e-5 * (1.0 + p.length());
        let along =
            |axis: DVec3| (self.point(p + axis * step, time) - self.point(p - axis * step, time)) / (2.0 * step);
        DMat3::from_cols(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }

    /// Where a point is at a time.
    pub fn point(&self, p: DVec3, time: f64) -> DVec3 {
        let s = (TAU * time / self.period).sin();
        match self.form {
            Form::Twist { angle, height } => DQuat::from_rotation_z(s * angle * p.z / height) * p,
            Form::Bend { angle, length } => bent(p, s * angle / length),
            Form::Flap { angle, hinge } => flapped(p, s * angle, hinge),
            Form::Egg { stretch, taper } => {
                let tall = 1.0 + s * stretch;
                let wide = tall.sqrt().recip() * (1.0 - s * taper * p.z.clamp(-1.0, 1.0));
                DVec3::new(p.x * wide, p.y * wide, p.z * tall)
            }
        }
    }
}

/// The x axis as an arc of a circle in the xz plane, of a curvature.
fn bent(p: DVec3, curvature: f64) -> DVec3 {
    let angle = curvature * p.x;
    // sin(kx)/k and (1 − cos(kx))/k, well behaved as k goes to 0.
    let sinc = |x: f64| if x.abs() < 1e-8 { 1.0 } else { x.sin() / x };
    let along = p.x * sinc(angle);
    let up = 0.5 * p.x * angle * sinc(0.5 * angle).powi(2);
    DVec3::new(along - p.z * angle.sin(), p.y, up + p.z * angle.cos())
}

fn flapped(p: DVec3, angle: f64, hinge: f64) -> DVec3 {
    let beyond = ((p.x.abs() - hinge) / hinge).clamp(0.0, 1.0);
    let smooth = beyond * beyond * (3.0 - 2.0 * beyond);
    let (side, out) = (p.x.signum(), p.x.abs() - hinge);
    if out <= 0.0 {
        return p;
    }
    let (sine, cosine) = (angle * smooth).sin_cos();
    DVec3::new(side * (hinge + out * cosine - p.z * sine), p.y, out * sine + p.z * cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMS: [Form; 4] = [
        Form::Twist { angle: 2.0, height: 1.5 },
        Form::Bend { angle: 2.5, length: 2.0 },
        Form::Flap { angle: 0.9, hinge: 0.2 },
        Form::Egg { stretch: 0.4, taper: 0.3 },
    ];

    #[test]
    fn all_start_at_rest_and_come_back() {
        for form in FORMS {
            let deformation = Procedural { form, period: 2.0 };
            for p in [DVec3::new(0.3, -0.2, 0.9), DVec3::new(-1.7, 0.4, -0.6), DVec3::ZERO] {
                assert_eq!(deformation.point(p, 0.0), p, "{form:?}");
                assert!(deformation.point(p, 2.0).distance(p) < 1e-12, "{form:?}");
            }
            let moved = DVec3::new(-1.7, 0.4, -0.6);
            assert!(deformation.point(moved, 0.5).distance(moved) > 0.1, "{form:?} moves");
        }
    }

    #[test]
    fn nothing_turns_inside_out_and_a_twist_keeps_volume() {
        for form in FORMS {
            let deformation = Procedural { form, period: 2.0 };
            for i in 0..200 {
                let unit = |k: f64| (f64::from(i) * k).fract() - 0.5;
                let p = DVec3::new(4.0 * unit(0.618), unit(0.414), 0.1 * unit(0.732));
                let volume = deformation.derivative(p, 0.37).determinant();
                assert!(volume > 0.05, "{form:?} at {p}: {volume}");
                if let Form::Twist { .. } = form {
                    assert!((volume - 1.0).abs() < 1e-8, "{volume}");
                }
            }
        }
    }

    #[test]
    fn a_bent_axis_keeps_its_length_and_turns_as_told() {
        let deformation = Procedural { form: Form::Bend { angle: 1.0, length: 2.0 }, period: 4.0 };
        let points: Vec<DVec3> =
            (0..=1000).map(|i| deformation.point(DVec3::X * 2.0 * f64::from(i) / 1000.0, 1.0)).collect();
        let length: f64 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let end = points[1000] - points[999];
        assert!((length - 2.0).abs() < 1e-6 && (end.z.atan2(end.x) - 1.0).abs() < 1e-3, "{length} {end}");
    }
}
