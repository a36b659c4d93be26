//! Self-shadow rules: which circle of directions a sphere blocks at a receiver (Ren 2006, §6.2).
//!
//! Bounding spheres enclose the surface that they stand for, so a receiver on it must not be shadowed by its own
//! neighbourhood. With `c` the height of the sphere's centre above the receiver's tangent plane, `r` its radius:
//!
//! The rules hold for exact spheres too: a receiver inside one whose centre lies behind the tangent plane sees it not at all.
//!
//! | receiver | sphere | rule |
//! |---|---|---|
//! | anywhere | `c ≤ −r`, behind the plane | nothing |
//! | inside | `c ≤ 0` | nothing |
//! | inside | `c > 0` | shrunk until tangent to the plane |
//! | outside | `−r < c < r`, straddling | replaced by S′, tangent, faded in with the distance from the rim by α |
//! | outside | `c ≥ r`, in front | as it is |

use glam::Vec3;
use halflight_scenes::Sphere;

/// How spheres near the receiver's tangent plane are replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SelfShadow {
    /// As printed: S′ keeps its centre and its radius grows with α. A centre at height `c > 0` jumps by `(c/r)³` of a
    /// uniform sky's irradiance where the receiver crosses the sphere's rim.
    Paper,
    /// Centre and radius go from `(P, max(c, 0))` at the rim to S′ by α: no jump.
    #[default]
    Continuous,
    /// Spheres are taken as they are; one that holds the receiver blocks the half space towards its centre
    /// (at its very centre, which has no such direction, nothing).
    Off,
}

impl SelfShadow {
    /// All rules by name, the default first.
    pub const NAMES: &'static [&'static str] = &["continuous", "paper", "off"];

    /// The rule of that name.
    pub fn named(name: &str) -> Option<Self> {
        [SelfShadow::Continuous, SelfShadow::Paper, SelfShadow::Off].into_iter().find(|rule| rule.name() == name)
    }

    /// The rule's name, one of [`SelfShadow::NAMES`].
    pub fn name(self) -> &'static str {
        match self {
            SelfShadow::Continuous => "continuous",
            SelfShadow::Paper => "paper",
            SelfShadow::Off => "off",
        }
    }
}

/// A circle of blocked directions, at most a half space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Unit direction of its centre.
    pub axis: Vec3,
    /// Sine of its angular radius, in `(0, 1]`.
    pub sin_angle: f32,
}

impl Circle {
    /// Cosine of its angular radius, in `[0, 1)`.
    pub fn cos_angle(&self) -> f32 {
        ((1.0 - self.sin_angle) * (1.0 + self.sin_angle)).sqrt()
    }
}

/// The circle that a sphere blocks at a receiver with unit geometric normal, or `None` if it blocks nothing.
pub fn seen(rule: SelfShadow, position: Vec3, normal: Vec3, sphere: &Sphere) -> Option<Circle> {
    let to = sphere.center - position;
    let (height, radius) = (to.dot(normal), sphere.radius);
    if rule == SelfShadow::Off {
        return circle(to, radius);
    }
    if height <= -radius {
        return None;
    }
    let inside = to.length_squared() < radius * radius;
    match (inside, height >= radius) {
        (true, _) => circle(to, height),
        (false, true) => circle(to, radius),
        (false, false) => straddling(rule, to, normal, height, radius),
    }
}

fn circle(to: Vec3, radius: f32) -> Option<Circle> {
    let nearness = to.length().recip();
    (radius > 0.0 && nearness.is_finite())
        .then(|| Circle { axis: to * nearness, sin_angle: (radius * nearness).min(1.0) })
        .filter(|circle| circle.sin_angle > 0.0)
}

/// The tangent replacement S′ of a sphere that pokes through the plane, faded in by the print's α with `min` for its `max`.
fn straddling(rule: SelfShadow, to: Vec3, normal: Vec3, height: f32, radius: f32) -> Option<Circle> {
    let tangent_radius = 0.5 * (height + radius);
    let foot = to - height * normal;
    let rim = ((radius - height) * (radius + height)).max(0.0).sqrt();
    let alpha = if rim > 0.0 { ((foot.length() - rim) / rim).clamp(0.0, 1.0) } else { 1.0 };
    match rule {
        SelfShadow::Continuous => {
            let from_radius = height.max(0.0);
            let blended_height = height + alpha * (tangent_radius - height);
            circle(foot + blended_height * normal, from_radius + alpha * (tangent_radius - from_radius))
        }
        _ => circle(foot + tangent_radius * normal, alpha * tangent_radius),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Share of a uniform sky's irradiance that a circle in front of the plane takes away.
    fn blocked(circle: Option<Circle>) -> f32 {
        circle.map_or(0.0, |c| c.sin_angle * c.sin_angle * c.axis.z)
    }

    /// The receiver at `distance` from the foot of a unit sphere's centre at height `c`.
    fn at(rule: SelfShadow, c: f32, distance: f32) -> Option<Circle> {
        let sphere = Sphere { center: Vec3::new(distance, 0.0, c), radius: 1.0 };
        seen(rule, Vec3::ZERO, Vec3::Z, &sphere)
    }

    #[test]
    fn the_printed_rule_jumps_by_the_cube_at_the_rim_and_the_continuous_one_does_not() {
        for c in [-0.5f32, 0.0, 0.5, 0.9] {
            let rim = (1.0 - c * c).sqrt();
            let jump = |rule| blocked(at(rule, c, rim * (1.0 - 1e-5))) - blocked(at(rule, c, rim * (1.0 + 1e-5)));
            let expected = if c > 0.0 { c.powi(3) } else { 0.0 };
            assert!((jump(SelfShadow::Paper) - expected).abs() < 2e-3, "c = {c}: {}", jump(SelfShadow::Paper));
            assert!(jump(SelfShadow::Continuous).abs() < 2e-3, "c = {c}: {}", jump(SelfShadow::Continuous));
        }
    }

    #[test]
    fn a_sphere_behind_the_plane_or_of_no_radius_blocks_nothing() {
        for rule in [SelfShadow::Paper, SelfShadow::Continuous] {
            assert_eq!(at(rule, -1.0, 3.0), None);
            assert_eq!(at(rule, -0.3, 0.1), None);
            let point = Sphere { center: Vec3::new(1.0, 0.0, 1.0), radius: 0.0 };
            assert_eq!(seen(rule, Vec3::ZERO, Vec3::Z, &point), None);
        }
    }

    #[test]
    fn a_receiver_inside_is_wholly_covered_only_when_the_centre_is_straight_above() {
        let covered = at(SelfShadow::Paper, 0.8, 0.0).expect("blocks");
        assert_eq!((covered.axis, covered.sin_angle), (Vec3::Z, 1.0));
        let tangent = at(SelfShadow::Paper, 0.8, 0.3).expect("blocks");
        assert!(tangent.sin_angle < 1.0 && (tangent.axis.z - tangent.sin_angle).abs() < 1e-6, "{tangent:?}");
    }

    #[test]
    fn without_rules_spheres_are_taken_as_they_are() {
        let circle = at(SelfShadow::Off, -0.5, 2.0).expect("blocks, behind the plane or not");
        assert!((circle.sin_angle - 1.0 / 4.25f32.sqrt()).abs() < 1e-6 && circle.axis.z < 0.0);
        assert_eq!(at(SelfShadow::Off, -0.5, 0.1).expect("holds the receiver").sin_angle, 1.0);
    }

    #[test]
    fn rules_are_found_by_their_names() {
        for name in SelfShadow::NAMES {
            assert_eq!(SelfShadow::named(name).map(SelfShadow::name), Some(*name));
        }
        assert_eq!(SelfShadow::NAMES[0], SelfShadow::default().name());
        assert_eq!(SelfShadow::named("Paper"), None);
    }

    proptest! {
        #[test]
        fn circles_are_proper_and_in_front(
            c in -2.0f32..2.0, distance in 0.0f32..5.0, radius in 0.01f32..2.0, paper in any::<bool>(),
        ) {
            let rule = if paper { SelfShadow::Paper } else { SelfShadow::Continuous };
            let sphere = Sphere { center: Vec3::new(0.0, distance, c), radius };
            if let Some(circle) = seen(rule, Vec3::ZERO, Vec3::Z, &sphere) {
                prop_assert!(circle.axis.is_normalized());
                prop_assert!(circle.sin_angle > 0.0 && circle.sin_angle <= 1.0);
                // Where the paper's S′ is used the circle never dips below the horizon.
                if rule == SelfShadow::Paper {
                    prop_assert!(circle.axis.z >= circle.sin_angle - 1e-4);
                }
            }
        }

        #[test]
        fn only_the_continuous_rule_never_jumps(c in -0.95f32..0.95, height_step in any::<bool>(), distance in 0.05f32..3.0) {
            let (step, rim) = (1e-4, (1.0 - c * c).sqrt());
            let jump = |rule, distance| {
                let (dc, dd) = if height_step { (step, 0.0) } else { (0.0, step) };
                (blocked(at(rule, c + dc, distance + dd)) - blocked(at(rule, c, distance))).abs()
            };
            // A small sphere may grow as fast as the step allows, so the bound is on the share of a jump.
            prop_assert!(jump(SelfShadow::Continuous, distance) < 0.02);
            prop_assert!(jump(SelfShadow::Continuous, rim - 0.5 * step) < 0.02);
            if c > 0.5 && !height_step {
                prop_assert!(jump(SelfShadow::Paper, rim - 0.5 * step) > 0.1);
            }
        }
    }
}
