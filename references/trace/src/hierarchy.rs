//! A bounding volume hierarchy over one kind of primitive: built by obvhs, traversed here.

use std::ops::ControlFlow;
use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};

use crate::traced_ray::TracedRay;

/// What a hierarchy is built over.
pub(crate) trait Primitive: Copy {
    /// Lowest and highest corner, finite.
    fn bounds(&self) -> (Vec3, Vec3);

    /// The nearest hit with `t_min < t < t_max`.
    fn hit(&self, ray: &TracedRay, t_max: f32) -> Option<Found>;
}

/// A hit of one primitive.
#[derive(Clone, Copy)]
pub(crate) struct Found {
    pub(crate) t: f32,
    pub(crate) barycentrics: [f32; 2],
}

/// Which primitive of which geometry.
#[derive(Clone, Copy)]
pub(crate) struct Id {
    pub(crate) geometry: u32,
    pub(crate) primitive: u32,
}

/// Two to a cache line; siblings are neighbours.
#[repr(C, align(32))]
struct Node {
    corners: [[f32; 3]; 2],
    /// First child, or first primitive of a leaf.
    first: u32,
    /// Primitives of a leaf, 0 for an inner node.
    count: u32,
}

/// Primitives in the order of their leaves, and the tree above them.
pub(crate) struct Hierarchy<P> {
    nodes: Vec<Node>,
    primitives: Vec<P>,
    ids: Vec<Id>,
    /// Entries that the traversal's stack may need.
    depth: usize,
}

impl<P: Primitive> Hierarchy<P> {
    /// Every primitive must have finite bounds.
    pub(crate) fn build(items: &[(P, Id)]) -> Self {
        let boxes: Vec<Bounds> = items.iter().map(|(primitive, _)| Bounds::of(primitive)).collect();
        let bvh = match boxes.len() {
            0 => obvhs::bvh2::Bvh2::default(),
            _ => build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default()),
        };
        let nodes: Vec<Node> = bvh.nodes.iter().map(Node::from).collect();
        let ordered = || bvh.primitive_indices.iter().map(|&i| items[i as usize]);
        Hierarchy {
            depth: depth(&nodes),
            primitives: ordered().map(|(primitive, _)| primitive).collect(),
            ids: ordered().map(|(_, id)| id).collect(),
            nodes,
        }
    }

    /// Whether anything lies on the segment: stops at the first thing found.
    pub(crate) fn any(&self, ray: &TracedRay, t_max: f32, stack: &mut Vec<u32>) -> bool {
        let found = self.traverse(ray, t_max, stack, |primitive, _, limit| match primitive.hit(ray, *limit) {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        });
        found.is_break()
    }

    /// The nearest thing on the segment.
    pub(crate) fn closest(&self, ray: &TracedRay, t_max: f32, stack: &mut Vec<u32>) -> Option<(Found, Id)> {
        let mut nearest = None;
        let _ = self.traverse(ray, t_max, stack, |primitive, index, limit| {
            if let Some(found) = primitive.hit(ray, *limit) {
                *limit = found.t;
                nearest = Some((found, self.ids[index]));
            }
            ControlFlow::<()>::Continue(())
        });
        nearest
    }

    /// Hands every primitive whose leaf the segment enters to `visit`, nearer children first, until it breaks.
    /// `visit` may shorten the segment.
    fn traverse<B>(
        &self,
        ray: &TracedRay,
        mut t_max: f32,
        stack: &mut Vec<u32>,
        mut visit: impl FnMut(&P, usize, &mut f32) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        stack.clear();
        stack.reserve(self.depth);
        if self.nodes.first().is_some_and(|root| ray.enter(&root.corners, t_max).is_some()) {
            stack.push(0);
        }
        while let Some(top) = stack.pop() {
            let mut node = &self.nodes[top as usize];
            while node.count == 0 {
                let first = node.first as usize;
                let [left, right] = [&self.nodes[first], &self.nodes[first + 1]];
                node = match (ray.enter(&left.corners, t_max), ray.enter(&right.corners, t_max)) {
                    (Some(l), Some(r)) => {
                        let (near, far) = if l <= r { (left, first + 1) } else { (right, first) };
                        stack.push(far as u32);
                        near
                    }
                    (Some(_), None) => left,
                    (None, Some(_)) => right,
                    (None, None) => break,
                };
            }
            // An inner node whose children were both missed has no primitives.
            let leaf = node.first as usize..(node.first + node.count) as usize;
            for index in leaf {
                visit(&self.primitives[index], index, &mut t_max)?;
            }
        }
        ControlFlow::Continue(())
    }
}

impl From<&obvhs::bvh2::node::Bvh2Node> for Node {
    fn from(node: &obvhs::bvh2::node::Bvh2Node) -> Self {
        let Aabb { min, max } = *node.aabb();
        Node { corners: [min.to_array(), max.to_array()], first: node.first_index, count: node.prim_count }
    }
}

/// Edges on the longest path from the root: the most entries that wait on the stack.
fn depth(nodes: &[Node]) -> usize {
    let mut deepest = 0;
    let mut waiting = vec![(0, 0)];
    while let Some((index, level)) = waiting.pop() {
        deepest = deepest.max(level);
        if let Some(node) = nodes.get(index as usize).filter(|node| node.count == 0) {
            waiting.extend([(node.first, level + 1), (node.first + 1, level + 1)]);
        }
    }
    deepest
}

struct Bounds(Aabb);

impl Bounds {
    fn of(primitive: &impl Primitive) -> Self {
        let (low, high) = primitive.bounds();
        Bounds(Aabb::new(Vec3A::from(low), Vec3A::from(high)))
    }
}

impl Boundable for Bounds {
    fn aabb(&self) -> Aabb {
        self.0
    }
}
