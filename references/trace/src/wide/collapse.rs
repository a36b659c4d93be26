//! Which descendants of a binary node become the children of a wide one: the choice of least expected cost
//! (Ylitie, Karras and Laine 2017, "Efficient incoherent ray traversal on GPUs through compressed wide BVHs", section 4).

use obvhs::bvh2::Bvh2;

use super::LANES;

/// Cost of testing a leaf against that of testing the boxes of a node, both with all lanes at once.
const LEAF_COST: f32 = 1.0;

/// A wide child, as an index into the binary nodes.
pub(super) enum Part {
    Leaf(u32),
    Node(u32),
}

/// The cheapest forests for every binary node.
pub(super) struct Plan<'a> {
    bvh: &'a Bvh2,
    best: Vec<Forests>,
    /// The most primitives of a leaf.
    capacity: usize,
}

/// A binary node's subtree as at most 1, 2, … trees.
#[derive(Clone, Copy, Default)]
struct Forests {
    primitives: u32,
    /// By number of trees less one.
    costs: [f32; LANES],
    /// Trees that go to the first child, 0 for one tree fewer.
    splits: [u8; LANES],
    /// Whether a single tree is best as a leaf.
    leaf: bool,
    /// Trees that go to the first child when the node itself becomes a wide node.
    split: u8,
}

impl<'a> Plan<'a> {
    /// Over a tree with one primitive a leaf.
    pub(super) fn new(bvh: &'a Bvh2, capacity: usize) -> Self {
        let mut plan = Plan { bvh, best: vec![Forests::default(); bvh.nodes.len()], capacity };
        let mut order = vec![0];
        let mut next = 0;
        while let Some(&index) = order.get(next) {
            let node = &bvh.nodes[index as usize];
            if !node.is_leaf() {
                order.extend([node.first_index, node.first_index + 1]);
            }
            next += 1;
        }
        for &index in order.iter().rev() {
            plan.best[index as usize] = plan.forests(index as usize);
        }
        plan
    }

    fn forests(&self, index: usize) -> Forests {
        let node = &self.bvh.nodes[index];
        let area = node.aabb().half_area();
        if node.is_leaf() {
            let costs = [area * LEAF_COST; LANES];
            return Forests { primitives: node.prim_count, costs, leaf: true, ..Forests::default() };
        }
        let [left, right] = [0, 1].map(|side| &self.best[node.first_index as usize + side]);
        let cheapest = |trees: usize| {
            let cost = |first: usize| left.costs[first - 1] + right.costs[trees - first - 1];
            let first = (1..trees).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).expect("two trees or more");
            (cost(first), first as u8)
        };
        let mut forests = Forests { primitives: left.primitives + right.primitives, ..Forests::default() };
        let (below, split) = cheapest(LANES);
        let as_leaf = if forests.primitives as usize <= self.capacity { area * LEAF_COST } else { f32::INFINITY };
        forests.split = split;
        forests.leaf = as_leaf <= area + below;
        forests.costs[0] = as_leaf.min(area + below);
        for trees in 2..=LANES {
            let (cost, first) = cheapest(trees);
            let fewer = forests.costs[trees - 2];
            (forests.costs[trees - 1], forests.splits[trees - 1]) =
                if cost < fewer { (cost, first) } else { (fewer, 0) };
        }
        forests
    }

    /// The whole tree.
    pub(super) fn root(&self) -> Part {
        self.part(0)
    }

    fn part(&self, index: u32) -> Part {
        if self.best[index as usize].leaf { Part::Leaf(index) } else { Part::Node(index) }
    }

    /// The children of a wide node, as indices of binary nodes.
    pub(super) fn children(&self, index: u32) -> Vec<Part> {
        let first = self.bvh.nodes[index as usize].first_index;
        let split = usize::from(self.best[index as usize].split);
        let mut children = Vec::new();
        let mut open = vec![(first, split), (first + 1, LANES - split)];
        while let Some((index, trees)) = open.pop() {
            let forests = &self.best[index as usize];
            let first = self.bvh.nodes[index as usize].first_index;
            let trees = (2..=trees).rev().find(|&t| forests.splits[t - 1] > 0);
            match trees {
                None => children.push(self.part(index)),
                Some(trees) => {
                    let split = usize::from(forests.splits[trees - 1]);
                    open.extend([(first, split), (first + 1, trees - split)]);
                }
            }
        }
        children
    }

    /// The primitives below a binary node.
    pub(super) fn primitives(&self, index: u32) -> Vec<u32> {
        let mut primitives = Vec::new();
        let mut open = vec![index];
        while let Some(index) = open.pop() {
            let node = &self.bvh.nodes[index as usize];
            if node.is_leaf() {
                let first = node.first_index as usize;
                primitives.extend(&self.bvh.primitive_indices[first..first + node.prim_count as usize]);
            } else {
                open.extend([node.first_index, node.first_index + 1]);
            }
        }
        primitives
    }
}
