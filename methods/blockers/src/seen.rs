//! Spheres as 16 receivers see them: [`halflight_proxies::seen`] in lanes.

use glam::Vec3;
use halflight_proxies::SelfShadow;
use halflight_scenes::{Receivers, Sphere};
use halflight_sh::{Block, LANES, Lanes, MAX_ORDER, Task};

use crate::Gather;

/// Spheres looked at before their circles are accumulated: few, so that the circles stay in the nearest cache.
pub(crate) const SPHERES: usize = 32;

/// Circles of directions that some spheres block at 16 receivers: an entry for each sphere, a lane for each receiver.
#[derive(Clone, Copy, Debug, Default)]
pub struct Circles<'a> {
    /// Unit directions of the circles' centres; anything finite where there is no circle.
    pub axes: &'a [[Block<f32>; 3]],
    /// Sines of the angular radii, in `(0, 1]`; 0 where there is no circle.
    pub sines: &'a [Block<f32>],
    /// The place of each circle's sphere among all blockers, ascending.
    pub places: &'a [u32],
    /// Factors for the bands of the circles' log visibilities, the same in all lanes, as many a circle as there are bands; none if
    /// nothing is scaled, which is so unless a method declares [`crate::params::CUT`].
    pub ratios: &'a [f32],
}

/// Room for the circles of some spheres.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    axes: [[Block<f32>; 3]; SPHERES],
    sines: [Block<f32>; SPHERES],
    places: [u32; SPHERES],
    ratios: [f32; SPHERES * MAX_ORDER],
    kept: usize,
    /// Circles seen lane by lane; `f32` counts exactly up to far more spheres than one receiver sees.
    pub(crate) accumulated: Block<f32>,
    /// Those below the smallest angle.
    pub(crate) too_small: Block<f32>,
}

impl Found {
    pub(crate) fn new() -> Self {
        Found {
            axes: [[Block::ZERO; 3]; SPHERES],
            sines: [Block::ZERO; SPHERES],
            places: [0; SPHERES],
            ratios: [0.0; SPHERES * MAX_ORDER],
            kept: 0,
            accumulated: Block::ZERO,
            too_small: Block::ZERO,
        }
    }

    /// The circles found last, with the ratios of their spheres, `bands` each.
    pub(crate) fn circles(&mut self, ratios: &[f32], bands: usize) -> Circles<'_> {
        let Found { axes, sines, places, ratios: scaled, kept, .. } = self;
        let (places, scaled) = (&places[..*kept], &mut scaled[..*kept * bands]);
        if bands > 0 {
            for (scaled, &place) in scaled.chunks_exact_mut(bands).zip(places) {
                scaled.copy_from_slice(&ratios[place as usize * bands..][..bands]);
            }
        }
        Circles { axes: &axes[..*kept], sines: &sines[..*kept], places, ratios: scaled }
    }
}

/// 16 receivers.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    position: [Block<f32>; 3],
    normal: [Block<f32>; 3],
}

impl Group {
    /// The receivers of the numbers given, 1 to 16; the last one fills the lanes that are left.
    pub(crate) fn new(receivers: &Receivers, numbers: &[usize]) -> Self {
        Group { position: lanes(numbers, &receivers.position), normal: lanes(numbers, &receivers.geometric_normal) }
    }
}

/// The vectors of 1 to 16 receivers, a lane each; the last one fills the lanes that are left.
pub(crate) fn lanes(numbers: &[usize], vectors: &[Vec3]) -> [Block<f32>; 3] {
    let mut blocks = [Block::ZERO; 3];
    for lane in 0..LANES {
        let Vec3 { x, y, z } = vectors[numbers[lane.min(numbers.len() - 1)]];
        (blocks[0].0[lane], blocks[1].0[lane], blocks[2].0[lane]) = (x, y, z);
    }
    blocks
}

/// Finds the circles of spheres, at most [`SPHERES`], that some lane sees.
pub(crate) struct Seen<'a> {
    pub(crate) gather: Gather,
    pub(crate) group: &'a Group,
    pub(crate) spheres: &'a [Sphere],
    /// Place of the first of them among all.
    pub(crate) first: u32,
    pub(crate) found: &'a mut Found,
}

impl Task<f32> for Seen<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let Found { axes, sines, places, kept: found, accumulated, too_small, .. } = self.found;
        let (zero, one) = (V::constant(0.0), V::constant(1.0));
        let least = V::splat(self.gather.min_sin_angle);
        let (mut kept, mut counted_lanes, mut dropped_lanes) = (0, Block::ZERO, Block::ZERO);
        for (number, sphere) in self.spheres.iter().enumerate() {
            let mut seen = false;
            for part in 0..LANES / V::WIDTH {
                let circle = View::<V>::new(self.group, sphere, part).circle(self.gather.self_shadow);
                let counted = circle.sine.where_less(least, zero, circle.sine);
                let exists = zero.where_less(counted, one, zero);
                let dropped = zero.where_less(circle.sine, one.sub(exists), zero);
                add(exists, &mut counted_lanes, part);
                add(dropped, &mut dropped_lanes, part);
                for (value, axis) in circle.axis.into_iter().zip(&mut axes[kept]) {
                    value.store(&mut axis.0, part);
                }
                counted.store(&mut sines[kept].0, part);
                seen |= zero.any_less(counted);
            }
            if seen {
                places[kept] = self.first + number as u32;
                kept += 1;
            }
        }
        *found = kept;
        for part in 0..LANES / V::WIDTH {
            add(V::load(&counted_lanes.0, part), accumulated, part);
            add(V::load(&dropped_lanes.0, part), too_small, part);
        }
    }
}

#[inline(always)]
fn add<V: Lanes<Scalar = f32>>(value: V, sum: &mut Block<f32>, part: usize) {
    value.add(V::load(&sum.0, part)).store(&mut sum.0, part);
}

struct LaneCircle<V> {
    axis: [V; 3],
    sine: V,
}

/// One sphere before the receivers of a register. Sums are rounded as in [`halflight_proxies::seen`], so that both find the same
/// sines and remove the same spheres. No closures: those that are not inlined lack the instruction set.
struct View<V> {
    to: [V; 3],
    normal: [V; 3],
    height: V,
    radius: V,
}

impl<V: Lanes<Scalar = f32>> View<V> {
    #[inline(always)]
    fn new(group: &Group, sphere: &Sphere, part: usize) -> Self {
        let [position, normal] = [load(&group.position, part), load(&group.normal, part)];
        let Vec3 { x, y, z } = sphere.center;
        let mut to = [V::splat(x), V::splat(y), V::splat(z)];
        for axis in 0..3 {
            to[axis] = to[axis].sub(position[axis]);
        }
        View { to, normal, height: dot(to, normal), radius: V::splat(sphere.radius) }
    }

    #[inline(always)]
    fn circle(&self, rule: SelfShadow) -> LaneCircle<V> {
        let View { to, height, radius, .. } = *self;
        if rule == SelfShadow::Off {
            return circle(to, radius);
        }
        let zero = V::constant(0.0);
        let behind = zero.sub(radius);
        if !behind.any_less(height) {
            return LaneCircle { axis: [zero; 3], sine: zero };
        }
        let straddles = behind.where_less(height, height, radius).any_less(radius);
        if !straddles {
            return circle(to, behind.where_less(height, radius, zero));
        }
        let (distance, limit) = (dot(to, to), radius.mul(radius));
        let (mut seen_to, straddling_radius) = self.straddling(rule);
        for axis in 0..3 {
            let outside = height.where_less(radius, seen_to[axis], to[axis]);
            seen_to[axis] = distance.where_less(limit, to[axis], outside);
        }
        let outside = height.where_less(radius, straddling_radius, radius);
        let seen_radius = distance.where_less(limit, height, outside);
        circle(seen_to, behind.where_less(height, seen_radius, zero))
    }

    /// Direction and radius of the sphere that replaces one that pokes through the receiver's tangent plane.
    #[inline(always)]
    fn straddling(&self, rule: SelfShadow) -> ([V; 3], V) {
        let View { to, normal, height, radius } = *self;
        let (zero, one) = (V::constant(0.0), V::constant(1.0));
        let tangent_radius = V::constant(0.5).mul(height.add(radius));
        let foot = raised(to, zero.sub(height), normal);
        let rim = radius.sub(height).mul(radius.add(height)).max(zero).sqrt();
        let past_rim = dot(foot, foot).sqrt().sub(rim).div(rim);
        let alpha = zero.where_less(rim, past_rim.max(zero).min(one), one);
        if rule == SelfShadow::Paper {
            return (raised(foot, tangent_radius, normal), alpha.mul(tangent_radius));
        }
        let from_radius = height.max(zero);
        let blended_height = height.add(alpha.mul(tangent_radius.sub(height)));
        (raised(foot, blended_height, normal), from_radius.add(alpha.mul(tangent_radius.sub(from_radius))))
    }
}

#[inline(always)]
fn load<V: Lanes>(blocks: &[Block<V::Scalar>; 3], part: usize) -> [V; 3] {
    [V::load(&blocks[0].0, part), V::load(&blocks[1].0, part), V::load(&blocks[2].0, part)]
}

/// `point + height·normal`.
#[inline(always)]
fn raised<V: Lanes>(mut point: [V; 3], height: V, normal: [V; 3]) -> [V; 3] {
    for axis in 0..3 {
        point[axis] = point[axis].add(height.mul(normal[axis]));
    }
    point
}

#[inline(always)]
fn dot<V: Lanes>(a: [V; 3], b: [V; 3]) -> V {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

#[inline(always)]
fn circle<V: Lanes<Scalar = f32>>(to: [V; 3], radius: V) -> LaneCircle<V> {
    let (zero, one) = (V::constant(0.0), V::constant(1.0));
    let distance = dot(to, to).sqrt();
    let nearness = zero.where_less(distance, one.div(distance), zero);
    let sine = radius.max(zero).mul(nearness).min(one);
    LaneCircle { axis: [to[0].mul(nearness), to[1].mul(nearness), to[2].mul(nearness)], sine }
}
