//! Collapses obvhs's binary tree into nodes of eight.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::{Boundable, BvhBuildParams};

use super::kernel::Level;
use super::{Child, Hierarchy, Id, LANES, Node, Packet};

pub(super) fn build<P: Packet>(items: &[(P::Primitive, Id)], level: Level) -> Hierarchy<P> {
    let boxes: Vec<Bounds> = items.iter().map(|(primitive, _)| Bounds::of::<P>(primitive)).collect();
    if boxes.is_empty() {
        let (nodes, packets, ids) = (Vec::new(), Vec::new(), Vec::new());
        return Hierarchy { nodes, packets, ids, bounds: [Vec3::ZERO; 2], waiting: 0, level };
    }
    let params = BvhBuildParams { max_prims_per_leaf: LANES as u32, ..BvhBuildParams::medium_build() };
    let bvh = build_bvh2(&boxes, params, &mut Duration::default());
    let Aabb { min, max } = *bvh.nodes[0].aabb();
    let mut collapse = Collapse { items, bvh: &bvh, nodes: Vec::new(), packets: Vec::new(), ids: Vec::new() };
    let depth = collapse.run();
    let Collapse { nodes, packets, ids, .. } = collapse;
    // Each node on a path leaves all but one of its children waiting; pushing writes `LANES` entries at once.
    let waiting = (depth + 1) * LANES;
    Hierarchy { nodes, packets, ids, bounds: [min.into(), max.into()], waiting, level }
}

struct Collapse<'a, P: Packet> {
    items: &'a [(P::Primitive, Id)],
    bvh: &'a Bvh2,
    nodes: Vec<Node>,
    packets: Vec<P>,
    ids: Vec<Id>,
}

impl<P: Packet> Collapse<'_, P> {
    /// Levels of nodes. With a list of its own: a chain of coincident primitives would exhaust the call stack.
    fn run(&mut self) -> usize {
        self.nodes.push(Node::EMPTY);
        let mut open = vec![(0, &self.bvh.nodes[0], 1)];
        let mut depth = 0;
        while let Some((at, below, level)) = open.pop() {
            depth = depth.max(level);
            for (lane, binary) in children(self.bvh, below).into_iter().enumerate() {
                let child = if binary.is_leaf() {
                    self.leaf(binary)
                } else {
                    self.nodes.push(Node::EMPTY);
                    open.push((self.nodes.len() - 1, binary, level + 1));
                    Child::node(self.nodes.len() - 1)
                };
                self.nodes[at].set(lane, binary.aabb(), child);
            }
        }
        depth
    }

    fn leaf(&mut self, leaf: &Bvh2Node) -> Child {
        let first = leaf.first_index as usize;
        let indices = &self.bvh.primitive_indices[first..first + leaf.prim_count as usize];
        let (primitives, mut ids): (Vec<_>, Vec<_>) = indices.iter().map(|&i| self.items[i as usize]).unzip();
        let child = Child::packet(self.packets.len(), primitives.len());
        self.packets.push(P::pack(&primitives));
        ids.resize(LANES, ids[0]);
        self.ids.extend(ids);
        child
    }
}

/// Up to [`LANES`] descendants that cover `node`: the largest is opened until none can be. Smallest first, since
/// a stack hands out the last, and the largest is the likeliest to block.
fn children<'a>(bvh: &'a Bvh2, node: &'a Bvh2Node) -> Vec<&'a Bvh2Node> {
    let area = |node: &&Bvh2Node| node.aabb().half_area();
    let mut children = vec![node];
    while children.len() < LANES {
        let inner = (0..children.len()).filter(|&i| !children[i].is_leaf());
        let Some(largest) = inner.max_by(|&a, &b| area(&children[a]).total_cmp(&area(&children[b]))) else { break };
        let first = children.swap_remove(largest).first_index as usize;
        children.extend(&bvh.nodes[first..first + 2]);
    }
    children.sort_by(|a, b| area(a).total_cmp(&area(b)));
    children
}

impl Node {
    const EMPTY: Node = Node { corners: [[[0.0; LANES]; 3]; 2], children: [Child(0); LANES], occupied: 0 };

    fn set(&mut self, lane: usize, aabb: &Aabb, child: Child) {
        for axis in 0..3 {
            self.corners[0][axis][lane] = aabb.min[axis];
            self.corners[1][axis][lane] = aabb.max[axis];
        }
        self.children[lane] = child;
        self.occupied |= 1 << lane;
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
