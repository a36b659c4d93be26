//! An 8-wide bounding volume hierarchy over one kind of primitive: built by obvhs, collapsed and traversed here.

mod build;
mod collapse;
mod kernel;
#[cfg(test)]
mod tests;
mod traverse;

use glam::Vec3;

use crate::traced_ray::TracedRay;
pub(crate) use kernel::Kernel;
use kernel::Level;

/// Children of a node and primitives of a packet.
pub(crate) const LANES: usize = 8;

/// The mask in which every lane counts.
pub(crate) const ALL_LANES: u32 = (1 << LANES) - 1;

/// A leaf: up to [`LANES`] primitives, laid out for their test.
pub(crate) trait Packet {
    type Primitive: Copy;

    /// Lowest and highest corner, finite.
    fn bounds(primitive: &Self::Primitive) -> [Vec3; 2];

    /// At least one and at most [`LANES`] primitives, in this order; lanes that are left over repeat the first.
    fn pack(primitives: &[Self::Primitive]) -> Self;

    /// A mask of lanes, among them all that the ray hits.
    fn candidates<K: Kernel>(&self, kernel: K, ray: &TracedRay) -> u32;

    /// The nearest hit of one lane with `t_min < t < t_max`.
    fn hit(&self, lane: usize, ray: &TracedRay, t_max: f32) -> Option<Found>;
}

/// A hit of one primitive.
#[derive(Clone, Copy)]
pub(crate) struct Found {
    pub(crate) t: f32,
    pub(crate) barycentrics: [f32; 2],
}

/// Which primitive of which geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Id {
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

/// Boxes by corner, axis and lane, and what lies in them. Four cache lines.
#[repr(C, align(64))]
#[derive(Clone)]
pub(crate) struct Node {
    corners: [[[f32; LANES]; 3]; 2],
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
}

/// Children that a traversal has yet to visit, and where the ray enters them; kept between rays to spare allocations.
#[derive(Default)]
pub(crate) struct Stack {
    children: Vec<Child>,
    nears: Vec<f32>,
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
    /// Every primitive must have finite bounds.
    pub(crate) fn build(items: &[(P::Primitive, Id)]) -> Self {
        build::build(items, Level::of_this_machine())
    }

    /// Whether anything lies on the segment: stops at the first thing found.
    pub(crate) fn any(&self, ray: &TracedRay, t_max: f32, stack: &mut Stack) -> bool {
        !self.nodes.is_empty() && self.level.any(self, ray, t_max, stack)
    }

    /// The nearest thing on the segment; of those at the same distance, the first in the tree.
    pub(crate) fn closest(&self, ray: &TracedRay, t_max: f32, stack: &mut Stack) -> Option<(Found, Id)> {
        if self.nodes.is_empty() { None } else { self.level.closest(self, ray, t_max, stack) }
    }
}
