//! The two walks through the tree, written once for all kernels.

use super::kernel::{BoxRay, Kernel};
use super::{Child, Found, Hierarchy, Id, LANES, Opened, Packet, Stack};
use crate::traced_ray::TracedRay;

/// Whether anything is hit.
#[inline(always)]
pub(super) fn any<P: Packet, K: Kernel>(
    kernel: K,
    tree: &Hierarchy<P>,
    ray: &TracedRay,
    t_max: f32,
    stack: &mut Stack<P::Scratch>,
) -> bool {
    let alone = Alone { ray, boxes: &BoxRay::new(ray, &tree.bounds), t_max };
    stack.children.resize(tree.waiting, Child::default());
    walk(kernel, tree, alone, Child::node(0), &mut stack.children, &mut stack.scratch)
}

/// A ray on its own way, as primitives and as boxes see it.
pub(super) struct Alone<'a> {
    pub(super) ray: &'a TracedRay,
    pub(super) boxes: &'a BoxRay,
    pub(super) t_max: f32,
}

/// Whether anything is hit from a child on downward.
#[inline(always)]
pub(super) fn walk<P: Packet, K: Kernel>(
    kernel: K,
    tree: &Hierarchy<P>,
    Alone { ray, boxes, t_max }: Alone<'_>,
    mut child: Child,
    waiting: &mut [Child],
    scratch: &mut P::Scratch,
) -> bool {
    let mut top = 0;
    loop {
        match child.open() {
            Opened::Node(index) => {
                let node = &tree.nodes[index];
                let entered = kernel.enter(node, boxes, t_max).0 & node.occupied;
                if entered != 0 {
                    // The last one is taken at once, without the detour through memory.
                    let room: &mut [Child; LANES] =
                        waiting[top..].first_chunk_mut().expect("room for one more node, by the tree's depth");
                    kernel.push(&node.children, entered, room);
                    let others = entered.count_ones() as usize - 1;
                    room[..others].iter().for_each(|other| tree.fetch(kernel, *other));
                    top += others;
                    child = node.children[(entered.ilog2() as usize) % LANES];
                    continue;
                }
            }
            Opened::Packet { index, lanes } => {
                let packet = &tree.packets[index];
                let candidates = packet.candidates(kernel, ray) & lanes;
                if ones(candidates).any(|lane| packet.blocks(lane, ray, t_max, scratch)) {
                    return true;
                }
            }
        }
        if top == 0 {
            return false;
        }
        top -= 1;
        child = waiting[top];
    }
}

/// The nearest hit; children are visited in the order in which the ray enters them.
#[inline(always)]
pub(super) fn closest<P: Packet, K: Kernel>(
    kernel: K,
    tree: &Hierarchy<P>,
    ray: &TracedRay,
    mut t_max: f32,
    stack: &mut Stack<P::Scratch>,
) -> Option<(Found<P::Detail>, Id)> {
    let boxes = BoxRay::new(ray, &tree.bounds);
    stack.clear();
    stack.push(ray.t_min, Child::node(0));
    let mut nearest: Option<(Found<P::Detail>, usize)> = None;
    while let Some((near, child)) = stack.pop() {
        if near > t_max {
            continue;
        }
        match child.open() {
            Opened::Node(index) => {
                let node = &tree.nodes[index];
                let (entered, nears) = kernel.enter(node, &boxes, t_max);
                let first = stack.children.len();
                ones(entered & node.occupied).for_each(|lane| stack.insert(first, nears[lane], node.children[lane]));
            }
            Opened::Packet { index, lanes } => {
                let packet = &tree.packets[index];
                for lane in ones(packet.candidates(kernel, ray) & lanes) {
                    let slot = index * LANES + lane;
                    // Kernels round boxes apart and so meet leaves in another order: ties go to the first slot.
                    let limit = if nearest.is_some_and(|(_, other)| slot < other) { t_max.next_up() } else { t_max };
                    if let Some(found) = packet.hit(lane, ray, limit, &mut stack.scratch) {
                        t_max = found.t;
                        nearest = Some((found, slot));
                    }
                }
            }
        }
    }
    nearest.map(|(found, slot)| (found, tree.ids[slot]))
}

/// The lanes of a mask, ascending.
#[inline(always)]
pub(super) fn ones(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros();
        (mask != 0).then(|| {
            mask &= mask - 1;
            lane as usize
        })
    })
}

impl<S> Stack<S> {
    fn clear(&mut self) {
        self.children.clear();
        self.nears.clear();
    }

    fn push(&mut self, near: f32, child: Child) {
        self.nears.push(near);
        self.children.push(child);
    }

    fn pop(&mut self) -> Option<(f32, Child)> {
        Some((self.nears.pop()?, self.children.pop()?))
    }

    /// Keeps the entries from `first` on in the order of falling `near`.
    fn insert(&mut self, first: usize, near: f32, child: Child) {
        self.push(near, child);
        let mut at = self.nears.len() - 1;
        while at > first && self.nears[at - 1] < near {
            self.nears.swap(at - 1, at);
            self.children.swap(at - 1, at);
            at -= 1;
        }
    }
}
