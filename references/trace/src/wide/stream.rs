//! The walk of many rays at once: each node and leaf is fetched once for all rays that reach it, and their tests do not wait for
//! each other (Barringer and Akenine-Möller 2014, "Dynamic ray stream traversal").

use super::kernel::{BoxRay, Kernel};
use super::traverse::{ones, walk};
use super::{BUNDLE, Child, Hierarchy, LANES, Opened, Packet, Stack};
use crate::traced_ray::TracedRay;

/// So few rays walk alone: sharing out their children costs more than it saves.
const FEW: u32 = 2;

/// Of the rays in `open`, those that hit anything before their ends.
#[inline(always)]
pub(super) fn any_of<P: Packet, K: Kernel>(
    kernel: K,
    tree: &Hierarchy<P>,
    rays: &[TracedRay],
    ends: &[f32],
    open: u64,
    stack: &mut Stack<P::Scratch>,
) -> u64 {
    stack.children.resize(tree.waiting, Child::default());
    stack.groups.resize(tree.waiting, Group::default());
    stack.boxes.clear();
    stack.boxes.extend(rays.iter().map(|ray| BoxRay::new(ray, &tree.bounds)));
    let Stack { children, groups, boxes, scratch, .. } = stack;
    let boxes = &boxes[..];
    let mut entered = [0; BUNDLE];
    let mut blocked = 0;
    let (mut top, mut group) = (0, Group { child: Child::node(0), rays: open });
    loop {
        group.rays &= !blocked;
        if group.rays.count_ones() <= FEW {
            for i in bits(group.rays) {
                let hit = walk(kernel, tree, &rays[i], &boxes[i], ends[i], group.child, children, scratch);
                blocked |= u64::from(hit) << i;
            }
        } else {
            match group.child.open() {
                Opened::Node(index) => {
                    let node = &tree.nodes[index];
                    for i in bits(group.rays) {
                        entered[i] = (kernel.enter(node, &boxes[i], ends[i]).0 & node.occupied) as u8;
                    }
                    let of_child = kernel.transpose(&entered);
                    let room: &mut [Group; LANES] = groups[top..].first_chunk_mut().expect("room by the tree's depth");
                    let mut count = 0;
                    for lane in 0..LANES {
                        let rays = of_child[lane] & group.rays;
                        room[count & (LANES - 1)] = Group { child: node.children[lane], rays };
                        count += usize::from(rays != 0);
                    }
                    top += count;
                }
                Opened::Packet { index, lanes } => {
                    let packet = &tree.packets[index];
                    for i in bits(group.rays) {
                        let candidates = packet.candidates(kernel, &rays[i]) & lanes;
                        let hit = ones(candidates).any(|lane| packet.blocks(lane, &rays[i], ends[i], scratch));
                        blocked |= u64::from(hit) << i;
                    }
                }
            }
        }
        if top == 0 {
            return blocked;
        }
        top -= 1;
        group = groups[top];
    }
}

/// What some rays have yet to visit.
#[derive(Clone, Copy, Default)]
pub(super) struct Group {
    child: Child,
    rays: u64,
}

/// The positions of a mask, ascending.
#[inline(always)]
fn bits(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros();
        (mask != 0).then(|| {
            mask &= mask - 1;
            bit as usize % BUNDLE
        })
    })
}
