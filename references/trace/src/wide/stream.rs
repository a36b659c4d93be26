//! The walk of many rays at once: each node and leaf is fetched once for all rays that reach it, and their tests do not
//! wait for each other (Barringer and Akenine-Möller 2014, "Dynamic ray stream traversal").

use super::kernel::{BoxRay, Kernel};
use super::traverse::{Alone, walk};
use super::{BUNDLE, Bundle, Child, Hierarchy, LANES, Opened, Packet, Stack};

/// So few rays walk alone: sharing out their children costs more than it saves.
const FEW: u32 = 2;

/// Of the open rays, those that hit anything before their ends.
#[inline(always)]
pub(super) fn any_of<P: Packet, K: Kernel>(
    kernel: K,
    tree: &Hierarchy<P>,
    bundle: Bundle<'_>,
    stack: &mut Stack<P::Scratch>,
) -> u64 {
    let Stack { children, groups, boxes, scratch, .. } = stack;
    children.resize(tree.waiting, Child::default());
    groups.resize(tree.waiting, Group::default());
    boxes.resize(BUNDLE, BoxRay::default());
    for i in bundle.open() {
        boxes[i] = BoxRay::new(&bundle.rays[i], &tree.bounds);
    }
    let mut entered = [0; BUNDLE];
    let mut blocked = 0;
    let (mut top, mut group) = (0, Group { child: Child::node(0), rays: bundle.open });
    loop {
        group.rays &= !blocked;
        let reached = Bundle { open: group.rays, ..bundle };
        if group.rays.count_ones() <= FEW {
            for i in reached.open() {
                let alone = Alone { ray: &bundle.rays[i], boxes: &boxes[i], t_max: bundle.ends[i] };
                blocked |= u64::from(walk(kernel, tree, alone, group.child, children, scratch)) << i;
            }
        } else {
            match group.child.open() {
                Opened::Node(index) => {
                    let node = &tree.nodes[index];
                    for i in reached.open() {
                        entered[i] = (kernel.enter(node, &boxes[i], bundle.ends[i]).0 & node.occupied) as u8;
                    }
                    let room: &mut [Group; LANES] = groups[top..].first_chunk_mut().expect("room by the tree's depth");
                    let mut count = 0;
                    for (child, rays) in node.children.into_iter().zip(kernel.transpose(&entered)) {
                        let rays = rays & group.rays;
                        room[count % LANES] = Group { child, rays };
                        count += usize::from(rays != 0);
                    }
                    top += count;
                    // The last is taken at once.
                    room[..count.saturating_sub(1)].iter().for_each(|group| tree.fetch(kernel, group.child));
                }
                Opened::Packet { index, lanes } => {
                    blocked |= tree.packets[index].blocks_of(kernel, lanes, reached, scratch);
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

impl Bundle<'_> {
    /// The indices of the open rays, ascending.
    #[inline(always)]
    pub(crate) fn open(self) -> impl Iterator<Item = usize> {
        let mut open = self.open;
        std::iter::from_fn(move || {
            let index = open.trailing_zeros() as usize;
            (open != 0).then(|| {
                open &= open - 1;
                index % BUNDLE
            })
        })
    }
}
