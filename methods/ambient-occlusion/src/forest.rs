//! Elements in a hierarchy: every object a binary tree, its leaves elements, an inner node standing for all below it.

use std::f32::consts::FRAC_1_PI;
use std::ops::Range;

use glam::Vec3;
use halflight_sh::LANES;
use rayon::prelude::*;

use crate::lanes::{Directions, Lanes, Points};
use crate::sites::Site;

/// Weight of normals against positions (over the object's size) where a node is halved: groups are to be flat as well as small.
const NORMAL_WEIGHT: f32 = 0.5;

/// The trees of all objects one after the other, the nodes of each depth first: parents before children, first child next to its parent.
#[derive(Debug, Default)]
pub(crate) struct Forest {
    /// First node after all that lie below: the next one for a leaf.
    skip: Vec<u32>,
    /// What lies below, as a range of `order`.
    below: Vec<Range<u32>>,
    /// Sites of each object, leaf by leaf.
    order: Vec<u32>,
    /// Area over π.
    area: Vec<f32>,
    /// Mean by area.
    position: Vec<Vec3>,
    /// Mean by area: shorter than 1 where normals differ, as the projection of a curved surface is smaller than its area.
    normal: Vec<Vec3>,
    /// Radius about `position` of a ball around all discs below.
    extent: Vec<f32>,
    /// Normals that cast: mean by area of normals times what remains of each element's shadow.
    casting: Vec<Vec3>,
}

/// The nodes of one object.
pub(crate) type Tree = Range<usize>;

impl Forest {
    /// Adds an object: a tree over its sites with at most so many leaves.
    pub(crate) fn plant(&mut self, sites: &[Site], most: usize) -> Tree {
        let (root, first) = (self.skip.len(), self.order.len());
        self.order.extend(0..sites.len() as u32);
        if !sites.is_empty() {
            let size = spread(sites.iter().map(|site| site.position.to_array())).into_iter().fold(0.0, f32::max);
            let scale = if size > 0.0 { 1.0 / size } else { 0.0 };
            let keys: Vec<[f32; 6]> = sites.iter().map(|site| key(site, scale)).collect();
            self.grow(&keys, first..self.order.len(), most);
        }
        let nodes = self.skip.len();
        self.area.resize(nodes, 0.0);
        self.extent.resize(nodes, 0.0);
        self.position.resize(nodes, Vec3::ZERO);
        self.normal.resize(nodes, Vec3::ZERO);
        self.casting.resize(nodes, Vec3::ZERO);
        root..nodes
    }

    fn grow(&mut self, keys: &[[f32; 6]], below: Range<usize>, most: usize) {
        let node = self.skip.len();
        self.skip.push(0);
        self.below.push(below.start as u32..below.end as u32);
        let most = most.min(below.len());
        if most > 1 {
            let group = &mut self.order[below.clone()];
            let spread = spread(group.iter().map(|&site| keys[site as usize]));
            let axis = (0..6).max_by(|&a, &b| spread[a].total_cmp(&spread[b])).expect("six axes");
            let along = |site: &u32| keys[*site as usize][axis];
            let half = group.len() / 2;
            group.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
            self.grow(keys, below.start..below.start + half, most / 2);
            self.grow(keys, below.start + half..below.end, most - most / 2);
        }
        self.skip[node] = self.skip.len() as u32;
    }

    /// Takes an object's sites as they are now; its elements cast in full.
    pub(crate) fn fit(&mut self, tree: Tree, sites: &[Site]) {
        for node in tree.rev() {
            if self.is_leaf(node) {
                self.fit_leaf(node, sites);
            } else {
                self.fit_parent(node);
            }
        }
    }

    fn fit_leaf(&mut self, node: usize, sites: &[Site]) {
        let Range { start, end } = self.below[node];
        let group = || self.order[start as usize..end as usize].iter().map(|site| sites[*site as usize]);
        let area: f32 = group().map(|site| site.area).sum();
        // Sites without area, of vertices without triangles, cast nothing wherever they are.
        let share = |site: Site| if area > 0.0 { site.area / area } else { 1.0 / (end - start) as f32 };
        self.area[node] = FRAC_1_PI * area;
        self.extent[node] = self.area[node].sqrt();
        self.position[node] = group().map(|site| share(site) * site.position).sum();
        self.normal[node] = group().map(|site| share(site) * site.normal).sum();
    }

    fn fit_parent(&mut self, node: usize) {
        let [a, b] = self.children(node);
        let [share_a, share_b] = self.shares(node);
        let position = share_a * self.position[a] + share_b * self.position[b];
        let reach = |child: usize| self.position[child].distance(position) + self.extent[child];
        self.extent[node] = reach(a).max(reach(b));
        self.area[node] = self.area[a] + self.area[b];
        self.normal[node] = share_a * self.normal[a] + share_b * self.normal[b];
        self.position[node] = position;
    }

    fn is_leaf(&self, node: usize) -> bool {
        self.skip[node] as usize == node + 1
    }

    fn children(&self, node: usize) -> [usize; 2] {
        [node + 1, self.skip[node + 1] as usize]
    }

    /// The shares of a parent's area that its children have.
    fn shares(&self, node: usize) -> [f32; 2] {
        let [a, b] = self.children(node).map(|child| self.area[child]);
        let first = if a + b > 0.0 { a / (a + b) } else { 0.5 };
        [first, 1.0 - first]
    }

    /// Makes every element cast as far as it is accessible after that many passes among the elements themselves.
    pub(crate) fn cast(&mut self, passes: usize, opening: f32) {
        self.casting.clone_from(&self.normal);
        let leaves: Vec<usize> = (0..self.skip.len()).filter(|node| self.is_leaf(*node)).collect();
        for _ in 0..passes {
            let group = |group: &[usize]| {
                let points = group.iter().map(|&leaf| (self.position[leaf], self.normal[leaf].normalize_or_zero()));
                self.shadow(&Points::new(points), opening).0.map(accessibility)
            };
            let accessible: Vec<Lanes> = leaves.par_chunks(LANES).map(group).collect();
            for (&leaf, accessible) in leaves.iter().zip(accessible.as_flattened()) {
                self.casting[leaf] = accessible * self.normal[leaf];
            }
            for node in (0..self.skip.len()).rev().filter(|node| !self.is_leaf(*node)).collect::<Vec<_>>() {
                let [a, b] = self.children(node);
                let [share_a, share_b] = self.shares(node);
                self.casting[node] = share_a * self.casting[a] + share_b * self.casting[b];
            }
        }
    }

    /// The sum of shadows at each of 16 points, and of how many nodes. A point in one lane gets the same whatever is in the others.
    pub(crate) fn shadow(&self, points: &Points, opening: f32) -> (Lanes, [u32; LANES]) {
        let (mut sum, mut terms, mut resume) = ([0.0; LANES], [0; LANES], [0; LANES]);
        let mut node = 0;
        while node < self.skip.len() {
            let next = self.skip[node];
            let nearest = self.opened_within(node, opening);
            let to = points.to(self.position[node]);
            let (mut open, mut any, mut counts) = (0, 0, [0; LANES]);
            for lane in 0..LANES {
                let here = mask(resume[lane] <= node as u32);
                let near = mask(to.square[lane] <= nearest);
                counts[lane] = here & !near;
                open |= here & near;
                any |= counts[lane];
            }
            if any != 0 {
                self.add(node, points, &to, &counts, &mut sum);
                for lane in 0..LANES {
                    terms[lane] += counts[lane] & 1;
                    resume[lane] = (next & counts[lane]) | (resume[lane] & !counts[lane]);
                }
            }
            node = if open != 0 { node + 1 } else { next as usize };
        }
        (sum, terms)
    }

    /// The squared distance up to which a group is opened; below 0 for an element, which never is.
    fn opened_within(&self, node: usize, opening: f32) -> f32 {
        if self.is_leaf(node) { -1.0 } else { (self.extent[node] / opening).powi(2).min(f32::MAX) }
    }

    /// Adds a node's shadow where it counts.
    fn add(&self, node: usize, points: &Points, to: &Directions, counts: &[u32; LANES], sum: &mut Lanes) {
        let (area, casting, [x, y, z]) = (self.area[node], self.casting[node], &to.vector);
        let (mut back, mut front) = ([0.0; LANES], [0.0; LANES]);
        let mut any = 0;
        for lane in 0..LANES {
            let [nx, ny, nz] = points.normal.map(|axis| axis[lane]);
            back[lane] = casting.x * x[lane] + casting.y * y[lane] + casting.z * z[lane];
            front[lane] = 4.0 * (nx * x[lane] + ny * y[lane] + nz * z[lane]);
            any |= counts[lane] & mask(back[lane] > 0.0) & mask(front[lane] > 0.0);
        }
        if any == 0 {
            return;
        }
        // Within its own radius an element shadows nothing: such a point lies on it.
        let radius = area.max(f32::MIN_POSITIVE);
        for lane in 0..LANES {
            let square = to.square[lane];
            let distance = square.sqrt();
            // 1 − 1/√(A/πr² + 1) without cancellation.
            let rim = (square + area).sqrt();
            let cover = area / (rim * (rim + distance));
            let near = 1.0 / distance;
            let shadow = cover * (near * back[lane]).clamp(0.0, 1.0) * (near * front[lane]).clamp(0.0, 1.0);
            sum[lane] += f32::from_bits(shadow.to_bits() & counts[lane] & mask(square >= radius));
        }
    }

    /// Nodes that are elements.
    pub(crate) fn elements(&self) -> usize {
        (0..self.skip.len()).filter(|node| self.is_leaf(*node)).count()
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let Forest { skip, below, order, area, position, normal, extent, casting } = self;
        size_of_val(&skip[..])
            + size_of_val(&below[..])
            + size_of_val(&order[..])
            + [area, extent].map(|numbers| size_of_val(&numbers[..])).iter().sum::<usize>()
            + [position, normal, casting].map(|vectors| size_of_val(&vectors[..])).iter().sum::<usize>()
    }
}

/// All bits or none: lanes take part by masks, which compilers turn into vector code.
fn mask(holds: bool) -> u32 {
    if holds { u32::MAX } else { 0 }
}

/// What remains of the hemisphere under a sum of shadows, 0 to 1.
pub(crate) fn accessibility(shadow: f32) -> f32 {
    (1.0 - shadow).max(0.0)
}

/// Position, relative to the object's size, and normal.
fn key(site: &Site, scale: f32) -> [f32; 6] {
    let [x, y, z] = (scale * site.position).to_array();
    let [u, v, w] = (NORMAL_WEIGHT * site.normal).to_array();
    [x, y, z, u, v, w]
}

/// Greatest less least, axis by axis.
fn spread<const N: usize>(points: impl Iterator<Item = [f32; N]>) -> [f32; N] {
    let (mut least, mut greatest) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
    for point in points {
        for axis in 0..N {
            least[axis] = least[axis].min(point[axis]);
            greatest[axis] = greatest[axis].max(point[axis]);
        }
    }
    std::array::from_fn(|axis| greatest[axis] - least[axis])
}

#[cfg(feature = "gpu")]
mod layout;
#[cfg(test)]
mod tests;
