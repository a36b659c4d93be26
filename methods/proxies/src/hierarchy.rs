//! A hierarchy of bounding spheres over the spheres of objects (Ren 2006, §6.3).
//!
//! Which spheres belong together is decided once, at rest; where spheres move, [`Hierarchy::bounds`] fits the bounding spheres
//! again from the leaves up. Objects move against one another, so that each has a tree of its own, and a scene is a forest.

use std::ops::Range;

use glam::Vec3;
use halflight_scenes::Sphere;

use crate::levels::{Tree, tree};

/// A forest over spheres; its nodes lie in preorder, so that a node's leaves and a node's subtree are ranges.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hierarchy {
    nodes: Vec<Node>,
    leaves: Vec<u32>,
}

/// A node: a leaf stands for one sphere.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Node {
    /// The first node that is not below this one.
    next: u32,
    /// Its spheres, as places in [`Hierarchy::leaves`].
    leaves: Range<u32>,
}

impl Hierarchy {
    /// One tree over the spheres of an object, at least two children a parent, four on average; nothing over none.
    pub fn new(spheres: &[Sphere]) -> Self {
        let mut hierarchy = Hierarchy::default();
        tree(spheres).iter().for_each(|root| hierarchy.push(root));
        hierarchy
    }

    fn push(&mut self, tree: &Tree) {
        let (node, first) = (self.nodes.len(), self.leaves.len() as u32);
        self.nodes.push(Node { next: 0, leaves: first..first });
        match tree {
            Tree::Leaf(sphere) => self.leaves.push(*sphere),
            Tree::Parent(children) => children.iter().for_each(|child| self.push(child)),
        }
        self.nodes[node] = Node { next: self.nodes.len() as u32, leaves: first..self.leaves.len() as u32 };
    }

    /// Adds the trees of another hierarchy, whose spheres follow those of this one.
    pub fn append(&mut self, other: &Hierarchy) {
        let (nodes, leaves) = (self.nodes.len() as u32, self.leaves.len() as u32);
        self.nodes.extend(other.nodes.iter().map(|node| Node {
            next: node.next + nodes,
            leaves: node.leaves.start + leaves..node.leaves.end + leaves,
        }));
        self.leaves.extend(other.leaves.iter().map(|sphere| sphere + leaves));
    }

    /// Number of nodes, leaves included. Node 0 is the first root; roots follow one another by [`Hierarchy::next`].
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The first node that is not below this one; for a leaf, which has nothing below it, the one after it. The node after a parent is its first
    /// child.
    pub fn next(&self, node: usize) -> usize {
        self.nodes[node].next as usize
    }

    /// Whether a node stands for one sphere.
    pub fn is_leaf(&self, node: usize) -> bool {
        self.next(node) == node + 1
    }

    /// The children of a node.
    pub fn children(&self, node: usize) -> impl Iterator<Item = usize> {
        let below = move |child: &usize| *child < self.next(node);
        std::iter::successors(Some(node + 1).filter(below), move |child| Some(self.next(*child)).filter(below))
    }

    /// Numbers of the spheres at and below a node.
    pub fn spheres(&self, node: usize) -> &[u32] {
        let Range { start, end } = self.nodes[node].leaves;
        &self.leaves[start as usize..end as usize]
    }

    /// Bounding spheres of all nodes, from the leaves up by pairs (Ren 2006, §6.3): a leaf's is its sphere, a parent's holds those of
    /// its children.
    ///
    /// # Panics
    /// If there are fewer spheres than the hierarchy was made for.
    pub fn bounds(&self, spheres: &[Sphere], bounds: &mut Vec<Sphere>) {
        bounds.clear();
        bounds.resize(self.nodes.len(), Sphere { center: Vec3::ZERO, radius: 0.0 });
        for node in (0..self.nodes.len()).rev() {
            bounds[node] = match self.is_leaf(node) {
                true => spheres[self.spheres(node)[0] as usize],
                false => self.children(node).map(|child| bounds[child]).reduce(around).expect("a parent has children"),
            };
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.leaves.as_slice())
    }
}

/// The smallest sphere that holds two, enlarged by what rounding may cut off.
fn around(a: Sphere, b: Sphere) -> Sphere {
    let (between, distance) = (b.center - a.center, a.center.distance(b.center));
    if distance + b.radius <= a.radius {
        return a;
    }
    if distance + a.radius <= b.radius {
        return b;
    }
    let radius = 0.5 * (distance + a.radius + b.radius);
    let center = a.center + between * ((radius - a.radius) / distance);
    let magnitude = radius + center.abs().max_element();
    Sphere { center, radius: radius + 4.0 * f32::EPSILON * magnitude }
}
