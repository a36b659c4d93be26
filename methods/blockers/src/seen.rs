//! Spheres as 16 receivers see them: [`halflight_proxies::seen`] in lanes.

use glam::Vec3;
use halflight_proxies::SelfShadow;
use halflight_scenes::{Receivers, Sphere};
use halflight_sh::{Block, LANES, Lanes, Task};

use crate::Gather;

/// Circles of directions that some spheres block at 16 receivers: an entry for each sphere, a lane for each receiver.
#[derive(Clone, Debug, Default)]
pub struct Circles {
    /// Unit directions of the circles' centres; anything finite where there is no circle.
    pub axes: Vec<[Block<f32>; 3]>,
    /// Sines of the angular radii, in `(0, 1]`; 0 where there is no circle.
    pub sines: Vec<Block<f32>>,
    /// Factors for the bands of the circles' log visibilities, the same in all lanes, as many a circle as there are bands; none if
    /// nothing is scaled, which is so unless a method declares [`crate::params::CUT`].
    pub ratios: Vec<f32>,
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
        let block = |value: &dyn Fn(usize) -> f32| {
            Block(std::array::from_fn(|lane| value(numbers[lane.min(numbers.len() - 1)])))
        };
        Group {
            position: std::array::from_fn(|axis| block(&|receiver| receivers.position[receiver][axis])),
            normal: std::array::from_fn(|axis| block(&|receiver| receivers.geometric_normal[receiver][axis])),
        }
    }
}

/// Circles seen lane by lane; `f32` counts exactly up to far more spheres than one call sees.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counts {
    pub(crate) accumulated: Block<f32>,
    pub(crate) too_small: Block<f32>,
}

/// Finds the circles of spheres that some lane sees.
pub(crate) struct Seen<'a> {
    pub(crate) gather: Gather,
    pub(crate) group: &'a Group,
    pub(crate) spheres: &'a [Sphere],
    /// As many factors a sphere as there are bands, or none.
    pub(crate) ratios: &'a [f32],
    pub(crate) circles: &'a mut Circles,
    pub(crate) counts: &'a mut Counts,
}

impl Task<f32> for Seen<'_> {
    #[inline(always)]
    fn run<V: Lanes<Scalar = f32>>(self) {
        let Circles { axes, sines, ratios } = self.circles;
        axes.resize(self.spheres.len(), [Block::ZERO; 3]);
        sines.resize(self.spheres.len(), Block::ZERO);
        let bands = self.ratios.len() / self.spheres.len().max(1);
        ratios.resize(self.ratios.len(), 0.0);
        let (zero, one) = (V::constant(0.0), V::constant(1.0));
        let least = V::splat(self.gather.min_sin_angle);
        let mut kept = 0;
        for (number, sphere) in self.spheres.iter().enumerate() {
            let mut seen = false;
            for part in 0..LANES / V::WIDTH {
                let circle = View::<V>::new(self.group, sphere, part).circle(self.gather.self_shadow);
                let counted = circle.sine.where_less(least, zero, circle.sine);
                let exists = zero.where_less(counted, one, zero);
                let dropped = zero.where_less(circle.sine, one.sub(exists), zero);
                add(exists, &mut self.counts.accumulated, part);
                add(dropped, &mut self.counts.too_small, part);
                for (value, axis) in circle.axis.into_iter().zip(&mut axes[kept]) {
                    value.store(&mut axis.0, part);
                }
                counted.store(&mut sines[kept].0, part);
                seen |= zero.any_less(counted);
            }
            ratios[kept * bands..][..bands].copy_from_slice(&self.ratios[number * bands..][..bands]);
            kept += usize::from(seen);
        }
        axes.truncate(kept);
        sines.truncate(kept);
        ratios.truncate(kept * bands);
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
    let sine = radius.div(distance).min(one);
    let sine = zero.where_less(radius, zero.where_less(distance, sine, zero), zero);
    let nearness = zero.where_less(sine, one.div(distance), zero);
    LaneCircle { axis: [to[0].mul(nearness), to[1].mul(nearness), to[2].mul(nearness)], sine }
}
