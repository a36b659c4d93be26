//! An 8-wide bounding volume hierarchy over one kind of primitive: built by obvhs, collapsed and traversed here.

mod build;
mod collapse;
mod kernel;
mod refit;
mod stream;
#[cfg(test)]
mod tests;
mod traverse;

use glam::Vec3;

use crate::traced_ray::TracedRay;
pub(crate) use kernel::Kernel;
use kernel::Level;
use traverse::ones;

/// Children of a node and primitives of a packet.
pub(crate) const LANES: usize = 8;

/// Farthest coordinate of what can be built: areas of boxes stay finite.
const FARTHEST: f32 = 1e18;

/// Whether a box lies within [`FARTHEST`]; never for what is not a number.
pub(crate) fn is_within_reach(corners: [Vec3; 2]) -> bool {
    corners.iter().all(|corner| corner.abs().cmple(Vec3::splat(FARTHEST)).all())
}

/// Rays that are traced together.
pub(crate) const BUNDLE: usize = 64;

/// The mask in which every lane counts.
pub(crate) const ALL_LANES: u32 = (1 << LANES) - 1;

/// A leaf: up to [`LANES`] primitives, laid out for their test.
pub(crate) trait Packet {
    type Primitive: Clone;
    /// What is known of a hit besides its distance.
    type Detail: Copy;
    /// What testing a primitive needs for its own, kept between rays.
    type Scratch: Default;

    /// The most primitives of a leaf, at most [`LANES`].
    const CAPACITY: usize = LANES;

    /// Lowest and highest corner.
    fn bounds(primitive: &Self::Primitive) -> [Vec3; 2];

    /// At least one and at most `CAPACITY` primitives, in this order; lanes that are left over are never asked for.
    fn pack(primitives: &[Self::Primitive]) -> Self;

    /// A mask of lanes, among them all that the ray hits.
    fn candidates<K: Kernel>(&self, kernel: K, ray: &TracedRay) -> u32;

    /// The nearest hit of one lane with `t_min < t < t_max`.
    fn hit(&self, lane: usize, ray: &TracedRay, t_max: f32, scratch: &mut Self::Scratch)
    -> Option<Found<Self::Detail>>;

    /// Of the open rays, those that hit any of the lanes.
    #[inline(always)]
    fn blocks_of<K: Kernel>(&self, kernel: K, lanes: u32, bundle: Bundle<'_>, scratch: &mut Self::Scratch) -> u64 {
        let mut blocked = 0;
        for i in bundle.open() {
            let (ray, end) = (&bundle.rays[i], bundle.ends[i]);
            let hit = ones(self.candidates(kernel, ray) & lanes).any(|lane| self.blocks(lane, ray, end, scratch));
            blocked |= u64::from(hit) << i;
        }
        blocked
    }

    /// Whether there is such a hit.
    #[inline(always)]
    fn blocks(&self, lane: usize, ray: &TracedRay, t_max: f32, scratch: &mut Self::Scratch) -> bool {
        self.hit(lane, ray, t_max, scratch).is_some()
    }
}

/// Up to [`BUNDLE`] rays that are traced together, with the ends of their segments.
#[derive(Clone, Copy)]
pub(crate) struct Bundle<'a> {
    pub(crate) rays: &'a [TracedRay; BUNDLE],
    pub(crate) ends: &'a [f32; BUNDLE],
    /// A mask of those that count.
    pub(crate) open: u64,
}

/// A hit of one primitive.
#[derive(Clone, Copy)]
pub(crate) struct Found<D> {
    pub(crate) t: f32,
    pub(crate) detail: D,
}

/// Which primitive of which geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Id {
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

/// Boxes by axis, side (low, high) and lane, and what lies in them. Four cache lines.
#[repr(C, align(64))]
#[derive(Clone)]
pub(crate) struct Node {
    planes: [[[f32; LANES]; 2]; 3],
    children: [Child; LANES],
    /// Mask of the lanes that hold a child.
    occupied: u32,
}

/// The index of a node, or of a packet together with the count of its primitives.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Child(u32);

/// Packets in the order of the tree, and the tree above them.
pub(crate) struct Hierarchy<P> {
    nodes: Vec<Node>,
    packets: Vec<P>,
    /// [`LANES`] a packet.
    ids: Vec<Id>,
    /// Of everything.
    bounds: [Vec3; 2],
    /// Entries that a traversal's stack may need.
    waiting: usize,
    level: Level,
    /// Boxes that a random line was expected to enter when the tree was built.
    visits: f64,
}

/// Children that a traversal has yet to visit, and where the ray enters them; kept between rays to spare allocations.
#[derive(Default)]
pub(crate) struct Stack<S = ()> {
    children: Vec<Child>,
    nears: Vec<f32>,
    groups: Vec<stream::Group>,
    boxes: Vec<kernel::BoxRay>,
    /// What the primitives' tests need.
    pub(crate) scratch: S,
}

impl Child {
    const PACKET: u32 = 1 << 31;
    /// Bits for a packet's count less one.
    const COUNT_BITS: u32 = 3;

    fn node(index: usize) -> Self {
        assert!(index < Self::PACKET as usize, "more nodes than a child can name");
        Child(index as u32)
    }

    fn packet(index: usize, count: usize) -> Self {
        assert!((1..=LANES).contains(&count), "{count} primitives in a leaf");
        assert!(index < (Self::PACKET >> Self::COUNT_BITS) as usize, "more leaves than a child can name");
        Child(Self::PACKET | (index as u32) << Self::COUNT_BITS | (count as u32 - 1))
    }

    #[inline(always)]
    fn open(self) -> Opened {
        if self.0 & Self::PACKET == 0 {
            return Opened::Node(self.0 as usize);
        }
        let count = self.0 & (LANES as u32 - 1);
        Opened::Packet {
            index: ((self.0 & !Self::PACKET) >> Self::COUNT_BITS) as usize,
            lanes: ALL_LANES >> (7 - count),
        }
    }
}

/// What a [`Child`] names.
enum Opened {
    Node(usize),
    Packet { index: usize, lanes: u32 },
}

impl<P: Packet> Hierarchy<P> {
    /// Every primitive must be within reach.
    pub(crate) fn build(items: &[(P::Primitive, Id)]) -> Self {
        build::build(items, Level::of_this_machine())
    }

    /// Lowest and highest corner; nothing when empty.
    pub(crate) fn bounds(&self) -> Option<[Vec3; 2]> {
        (!self.nodes.is_empty()).then_some(self.bounds)
    }

    /// Whether anything lies on the segment: stops at the first thing found.
    pub(crate) fn any(&self, ray: &TracedRay, t_max: f32, stack: &mut Stack<P::Scratch>) -> bool {
        !self.nodes.is_empty() && self.level.any(self, ray, t_max, stack)
    }

    /// Of the open rays, those that anything lies on before their ends.
    pub(crate) fn any_of(&self, bundle: Bundle<'_>, stack: &mut Stack<P::Scratch>) -> u64 {
        if self.nodes.is_empty() || bundle.open == 0 { 0 } else { self.level.any_of(self, bundle, stack) }
    }

    /// Asks the memory for a child that is to be visited soon.
    #[inline(always)]
    fn fetch<K: Kernel>(&self, kernel: K, child: Child) {
        match child.open() {
            Opened::Node(index) => kernel.fetch(&self.nodes[index]),
            Opened::Packet { index, .. } => kernel.fetch(&self.packets[index]),
        }
    }

    /// The nearest thing on the segment; of those at the same distance, the first in the tree.
    pub(crate) fn closest(
        &self,
        ray: &TracedRay,
        t_max: f32,
        stack: &mut Stack<P::Scratch>,
    ) -> Option<(Found<P::Detail>, Id)> {
        if self.nodes.is_empty() { None } else { self.level.closest(self, ray, t_max, stack) }
    }
}
