//! Writes obvhs's binary tree down as nodes of eight.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};

use super::collapse::{Part, Plan};
use super::kernel::Level;
use super::{Child, Hierarchy, Id, LANES, Node, Packet};

pub(super) fn build<P: Packet>(items: &[(P::Primitive, Id)], level: Level) -> Hierarchy<P> {
    let boxes: Vec<Bounds> = items.iter().map(|(primitive, _)| Bounds::of::<P>(primitive)).collect();
    if boxes.is_empty() {
        let (nodes, packets, ids) = (Vec::new(), Vec::new(), Vec::new());
        return Hierarchy { nodes, packets, ids, bounds: [Vec3::ZERO; 2], waiting: 0, level, visits: 0.0 };
    }
    let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
    let bvh = build_bvh2(&boxes, params, &mut Duration::default());
    let Aabb { min, max } = *bvh.nodes[0].aabb();
    let plan = Plan::new(&bvh, P::CAPACITY);
    let mut writer = Writer { items, bvh: &bvh, plan: &plan, nodes: Vec::new(), packets: Vec::new(), ids: Vec::new() };
    let depth = writer.write();
    let Writer { nodes, packets, ids, .. } = writer;
    // Each node on a path leaves all but one of its children waiting; pushing writes `LANES` entries at once.
    let waiting = (depth + 1) * LANES;
    let tree = Hierarchy { nodes, packets, ids, bounds: [min.into(), max.into()], waiting, level, visits: 0.0 };
    Hierarchy { visits: tree.expected_visits(), ..tree }
}

struct Writer<'a, P: Packet> {
    items: &'a [(P::Primitive, Id)],
    bvh: &'a Bvh2,
    plan: &'a Plan<'a>,
    nodes: Vec<Node>,
    packets: Vec<P>,
    ids: Vec<Id>,
}

impl<P: Packet> Writer<'_, P> {
    /// Returns the levels of nodes. A list of its own, since a chain of coincident primitives could exhaust the call
    /// stack.
    fn write(&mut self) -> usize {
        self.nodes.push(Node::EMPTY);
        let root = self.plan.root();
        let mut open = Vec::new();
        let mut depth = 1;
        match root {
            Part::Node(index) => open.push((0, index, 1)),
            Part::Leaf(_) => self.fill(0, vec![root], 1, &mut open),
        }
        while let Some((at, below, level)) = open.pop() {
            depth = depth.max(level);
            self.fill(at, self.plan.children(below), level, &mut open);
        }
        depth
    }

    /// Smallest first, since a stack hands out the last, and the largest is the likeliest to block.
    fn fill(&mut self, at: usize, mut children: Vec<Part>, level: usize, open: &mut Vec<(usize, u32, usize)>) {
        let bvh = self.bvh;
        let aabb = |part: &Part| match part {
            Part::Leaf(index) | Part::Node(index) => *bvh.nodes[*index as usize].aabb(),
        };
        children.sort_by(|a, b| aabb(a).half_area().total_cmp(&aabb(b).half_area()));
        for (lane, part) in children.iter().enumerate() {
            let aabb = aabb(part);
            let child = match *part {
                Part::Leaf(index) => self.leaf(index),
                Part::Node(index) => {
                    self.nodes.push(Node::EMPTY);
                    open.push((self.nodes.len() - 1, index, level + 1));
                    Child::node(self.nodes.len() - 1)
                }
            };
            self.nodes[at].set(lane, &aabb, child);
        }
    }

    fn leaf(&mut self, index: u32) -> Child {
        let items = self.plan.primitives(index).into_iter().map(|i| self.items[i as usize].clone());
        let (primitives, mut ids): (Vec<_>, Vec<_>) = items.unzip();
        let child = Child::packet(self.packets.len(), primitives.len());
        self.packets.push(P::pack(&primitives));
        ids.resize(LANES, ids[0]);
        self.ids.extend(ids);
        child
    }
}

impl Node {
    const EMPTY: Node = Node { planes: [[[0.0; LANES]; 2]; 3], children: [Child(0); LANES], occupied: 0 };

    fn set(&mut self, lane: usize, aabb: &Aabb, child: Child) {
        self.set_box(lane, aabb.min.to_array(), aabb.max.to_array());
        self.children[lane] = child;
        self.occupied |= 1 << lane;
    }

    pub(super) fn set_box(&mut self, lane: usize, low: [f32; 3], high: [f32; 3]) {
        for axis in 0..3 {
            self.planes[axis][0][lane] = low[axis];
            self.planes[axis][1][lane] = high[axis];
        }
    }

    /// The children lie in the first lanes.
    pub(super) fn count(&self) -> usize {
        self.occupied.count_ones() as usize
    }

    /// Lowest and highest corners of the children.
    pub(super) fn boxes(&self) -> impl Iterator<Item = [Vec3; 2]> {
        let corner = |side: usize, lane: usize| Vec3::from(self.planes.each_ref().map(|axis| axis[side][lane]));
        (0..self.count()).map(move |lane| [corner(0, lane), corner(1, lane)])
    }
}

struct Bounds(Aabb);

impl Bounds {
    fn of<P: Packet>(primitive: &P::Primitive) -> Self {
        let [low, high] = P::bounds(primitive);
        Bounds(Aabb::new(Vec3A::from(low), Vec3A::from(high)))
    }
}

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}
