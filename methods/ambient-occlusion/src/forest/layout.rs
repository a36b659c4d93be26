//! The forest as shaders read it.

use std::ops::Range;

use super::Forest;

impl Forest {
    /// Of each node the first after all that lie below, after the number of nodes.
    pub(crate) fn topology(&self) -> Vec<u32> {
        [&[self.nodes() as u32], self.skip.as_slice()].concat()
    }

    /// Positions, and the squared distances up to which groups are opened.
    pub(crate) fn places(&self, nodes: Range<usize>, opening: f32) -> Vec<[f32; 4]> {
        nodes.map(|node| self.position[node].extend(self.opened_within(node, opening)).to_array()).collect()
    }

    /// Normals, and areas over π.
    pub(crate) fn normals(&self, nodes: Range<usize>) -> Vec<[f32; 4]> {
        nodes.map(|node| self.normal[node].extend(self.area[node]).to_array()).collect()
    }

    /// Nodes by height: elements, then groups of elements, then groups of these.
    pub(crate) fn levels(&self) -> Vec<Vec<u32>> {
        let (mut heights, mut levels) = (vec![0; self.nodes()], Vec::new());
        for node in (0..self.nodes()).rev() {
            if !self.is_leaf(node) {
                heights[node] = 1 + self.children(node).map(|child| heights[child]).into_iter().fold(0, usize::max);
            }
            if levels.len() <= heights[node] {
                levels.resize(heights[node] + 1, Vec::new());
            }
            levels[heights[node]].push(node as u32);
        }
        levels
    }

    /// Elements and groups.
    pub(crate) fn nodes(&self) -> usize {
        self.skip.len()
    }
}
