//! Distant lights.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{Quat, Vec3};

use crate::content::Collector;
use crate::{Content, Rgb};

/// A latitude–longitude radiance map, piecewise constant over its texels. Row 0 touches +z; column 0 begins at
/// azimuth 0 (+x), azimuth grows towards +y. Both are before [`Environment::rotation`]. Picture files run the other way
/// round, so that a photograph seen from inside is not mirrored: loading turns them.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Texels a row.
    pub width: usize,
    /// Rows from +z to −z.
    pub height: usize,
    /// Radiance, row major, finite and non-negative, scale applied.
    pub texels: Arc<Vec<Rgb>>,
    /// Rotation of the map about +z in radians (adds to the azimuth of every texel).
    pub rotation: f32,
}

impl Environment {
    /// Index of the texel that a unit direction falls into.
    pub fn texel(&self, direction: Vec3) -> usize {
        // atan2 keeps its precision at the poles, where acos(z) loses half the digits.
        let polar = direction.truncate().length().atan2(direction.z);
        let azimuth = (direction.y.atan2(direction.x) - self.rotation).rem_euclid(TAU);
        let row = (polar / PI * self.height as f32) as usize;
        let column = (azimuth / TAU * self.width as f32) as usize;
        row.min(self.height - 1) * self.width + column.min(self.width - 1)
    }
}

/// An analytic sky, a function of elevation alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sky {
    /// The same radiance from every direction of the sphere.
    Uniform(Rgb),
    /// CIE overcast sky `L(θ) = zenith·(1 + 2 sin(elevation))/3` above the horizon, 0 below.
    Overcast(Rgb),
}

impl Sky {
    fn radiance(&self, direction: Vec3) -> Rgb {
        match *self {
            Sky::Uniform(radiance) => radiance,
            Sky::Overcast(zenith) if direction.z >= 0.0 => zenith * ((1.0 + 2.0 * direction.z) / 3.0),
            Sky::Overcast(_) => Rgb::ZERO,
        }
    }
}

/// A distant circular light of constant radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyLight {
    /// Unit direction towards its centre.
    pub direction: Vec3,
    /// Angular radius in radians, in `(0, π/2]`.
    pub angular_radius: f32,
    /// Radiance within the circle.
    pub radiance: Rgb,
}

impl KeyLight {
    /// Whether a unit direction points into the circle. The chord decides, since for a narrow light the cosine of
    /// the angle has no digits left.
    pub fn contains(&self, direction: Vec3) -> bool {
        direction.distance(self.direction) <= 2.0 * (0.5 * self.angular_radius).sin()
    }
}

/// One light of a scene.
#[derive(Clone, Debug)]
pub enum Light {
    /// An image of the surroundings.
    Environment(Environment),
    /// An analytic sky.
    Sky(Sky),
    /// A circular light.
    Key(KeyLight),
}

impl Light {
    /// Radiance arriving from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        match self {
            Light::Environment(environment) => environment.texels[environment.texel(direction)],
            Light::Sky(sky) => sky.radiance(direction),
            Light::Key(key) if key.contains(direction) => key.radiance,
            Light::Key(_) => Rgb::ZERO,
        }
    }

    /// Hash of all that the light emits.
    pub fn content(&self) -> Content {
        let content = match self {
            Light::Environment(environment) => Collector::new("environment")
                .word(environment.width)
                .word(environment.height)
                .float(environment.rotation)
                .list(&environment.texels, |all, texel| all.vec3(*texel)),
            Light::Sky(Sky::Uniform(radiance)) => Collector::new("uniform").vec3(*radiance),
            Light::Sky(Sky::Overcast(zenith)) => Collector::new("overcast").vec3(*zenith),
            Light::Key(key) => Collector::new("key").vec3(key.direction).float(key.angular_radius).vec3(key.radiance),
        };
        content.finish()
    }
}

/// A steady turn about an axis through the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Unit axis, right-handed.
    pub axis: Vec3,
    /// Radians a second.
    pub speed: f32,
}

impl Turn {
    /// Radians at a time in seconds, whole turns left out.
    fn angle(&self, time: f32) -> f32 {
        // In f64: after many turns f32 has few digits left.
        (f64::from(self.speed) * f64::from(time)).rem_euclid(std::f64::consts::TAU) as f32
    }

    /// The rotation at a time in seconds.
    pub fn at(&self, time: f32) -> Quat {
        Quat::from_axis_angle(self.axis, self.angle(time))
    }
}

/// A light of a scene: as it is at second 0, and how it turns from then on.
#[derive(Clone, Debug)]
pub struct DistantLight {
    /// At second 0.
    pub rest: Light,
    /// None where it rests. That of an environment has a vertical axis; skies do not turn.
    pub turn: Option<Turn>,
}

impl DistantLight {
    /// The light at a time in seconds.
    pub fn at(&self, time: f32) -> Light {
        match (&self.rest, self.turn) {
            (Light::Environment(map), Some(turn)) => {
                let rotation = map.rotation + turn.axis.z * turn.angle(time);
                Light::Environment(Environment { rotation, ..map.clone() })
            }
            (Light::Key(key), Some(turn)) => {
                Light::Key(KeyLight { direction: (turn.at(time) * key.direction).normalize(), ..*key })
            }
            (rest, _) => rest.clone(),
        }
    }

    /// Hash of all that it emits at all times.
    pub fn content(&self) -> Content {
        match self.turn {
            None => self.rest.content(),
            Some(turn) => {
                let turning = Collector::new("turning").content(self.rest.content());
                turning.vec3(turn.axis).float(turn.speed).finish()
            }
        }
    }
}

impl From<Light> for DistantLight {
    fn from(rest: Light) -> Self {
        DistantLight { rest, turn: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quarter_a_second(axis: Vec3) -> Option<Turn> {
        Some(Turn { axis, speed: PI / 2.0 })
    }

    #[test]
    fn lights_turn_about_their_axis() {
        let texels: Arc<Vec<Rgb>> = Arc::new((0..8).map(|i| Rgb::splat(i as f32)).collect());
        let map = Environment { width: 4, height: 2, texels, rotation: 0.3 };
        let key = KeyLight { direction: Vec3::X, angular_radius: 0.2, radiance: Rgb::ONE };
        for (axis, light) in [
            (Vec3::Z, Light::Environment(map.clone())),
            (-Vec3::Z, Light::Environment(map)),
            (Vec3::Z, Light::Key(key)),
            (Vec3::new(1.0, 2.0, 3.0).normalize(), Light::Key(key)),
        ] {
            let turning = DistantLight { rest: light.clone(), turn: quarter_a_second(axis) };
            for time in [0.0, 0.5, 1.0, 3.2, 401.0] {
                let turned = Quat::from_axis_angle(axis, PI / 2.0 * (time % 4.0));
                for i in 0..200 {
                    let wave = |phase: f32| (2.4 * i as f32 + phase).sin();
                    let direction = Vec3::new(wave(0.0), wave(1.0), wave(2.0)).normalize();
                    let (got, want) = (turning.at(time).radiance(turned * direction), light.radiance(direction));
                    assert_eq!(got, want, "{axis} {time} {direction}");
                }
            }
            assert_ne!(turning.content(), DistantLight::from(light.clone()).content());
            assert_eq!(light.content(), DistantLight::from(light).content());
        }
    }

    #[test]
    fn environment_texels_lie_where_the_convention_says() {
        let texels = Arc::new((0..8).map(|i| Rgb::splat(i as f32)).collect());
        let mut map = Environment { width: 4, height: 2, texels, rotation: 0.0 };
        let at = |map: &Environment, x: f32, y: f32, z: f32| map.texel(Vec3::new(x, y, z).normalize());
        // Row 0 above the horizon; columns by quadrant from +x through +y.
        assert_eq!([at(&map, 1.0, 1.0, 1.0), at(&map, -1.0, 1.0, 1.0)], [0, 1]);
        assert_eq!([at(&map, -1.0, -1.0, 1.0), at(&map, 1.0, -1.0, 1.0)], [2, 3]);
        assert_eq!([at(&map, 1.0, 1.0, -1.0), at(&map, 1.0, -1.0, -1.0)], [4, 7]);
        assert_eq!([at(&map, 0.0, 0.0, 1.0) / 4, at(&map, 0.0, 0.0, -1.0) / 4], [0, 1]);
        // A quarter turn carries column 0 to where column 1 was.
        map.rotation = PI / 2.0;
        assert_eq!(at(&map, -1.0, 1.0, 1.0), 0);
        map.rotation = -PI / 2.0;
        assert_eq!(at(&map, 1.0, -1.0, 1.0), 0);
    }

    #[test]
    fn every_direction_has_a_texel() {
        let map = Environment { width: 4, height: 2, texels: Arc::new(vec![Rgb::ONE; 8]), rotation: 1e-7 };
        for direction in [Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::X, Vec3::new(1.0, -1e-20, 0.0), Vec3::new(-1.0, -0.0, 0.0)]
        {
            assert!(map.texel(direction) < 8, "{direction}");
        }
    }

    #[test]
    fn overcast_sky_gives_the_irradiance_of_the_standard() {
        // CIE S 011: E = 7π/9 · zenith radiance on the horizontal.
        let sky = Light::Sky(Sky::Overcast(Rgb::ONE));
        let steps = 4000;
        let irradiance: f64 = (0..steps)
            .map(|i| {
                let z = (i as f64 + 0.5) / steps as f64;
                let x = (1.0 - z * z).sqrt();
                f64::from(sky.radiance(Vec3::new(x as f32, 0.0, z as f32)).x) * z * std::f64::consts::TAU / steps as f64
            })
            .sum();
        assert!((irradiance - 7.0 / 9.0 * std::f64::consts::PI).abs() < 1e-6, "{irradiance}");
        assert_eq!(sky.radiance(-Vec3::Z), Rgb::ZERO);
    }

    #[test]
    fn key_light_is_a_circle_of_its_angular_radius() {
        for degrees in [0.01f32, 0.25, 30.0, 90.0] {
            let radius = degrees.to_radians();
            let key = Light::Key(KeyLight { direction: Vec3::Z, angular_radius: radius, radiance: Rgb::ONE });
            let at = |angle: f32| key.radiance(Vec3::new(0.0, angle.sin(), angle.cos())).x;
            assert_eq!([at(0.0), at(0.999 * radius), at(1.001 * radius), at(3.0)], [1.0, 1.0, 0.0, 0.0]);
        }
    }

    #[test]
    fn content_follows_what_is_emitted() {
        let key = |r| Light::Key(KeyLight { direction: Vec3::Z, angular_radius: r, radiance: Rgb::ONE });
        assert_eq!(key(0.1).content(), key(0.1).content());
        assert_ne!(key(0.1).content(), key(0.2).content());
        assert_ne!(Light::Sky(Sky::Uniform(Rgb::ONE)).content(), Light::Sky(Sky::Overcast(Rgb::ONE)).content());
    }
}
