//! What the passes did, counted from what the shaders wrote.

use halflight_contract::Meter;

use super::{Counted, Occlusion, Receiver};

/// Operations on a node that is looked at: a vector to it and its square.
pub(super) const LOOK: u64 = 8;
/// On a node that is summed: two dot products and a factor.
pub(super) const SUM: u64 = 11;
/// On one that faces the point: two roots, two quotients, three sums, six products.
pub(super) const FACE: u64 = 13;
/// On a group: two areas added, a quotient, a difference, two vectors weighted and added.
const MEAN: u64 = 12;

impl Occlusion {
    pub(super) fn tell_elements(&self, counted: Counted, meter: &mut dyn Meter) {
        let (nodes, elements) = (self.stage.forest.nodes() as u64, self.stage.forest.elements() as u64);
        let groups = nodes - elements;
        meter.work("elements", self.walked(elements, counted), walk_bytes(nodes) + 20 * elements);
        // A group reads its number and its neighbours', two nodes, and writes one.
        meter.work("groups", MEAN * groups, (8 + 48) * groups);
    }

    pub(super) fn tell_receivers(&self, counted: Counted, meter: &mut dyn Meter) {
        let (receivers, light) = (self.valid.len() as u64, self.stage.lit.rgb[0].len() as u64);
        // A factor and three products summed a coefficient, albedo and accessibility.
        let shading = (1 + 6) * light + 6;
        let bytes = walk_bytes(self.stage.forest.nodes() as u64) + (size_of::<Receiver>() as u64 + 12) * receivers;
        meter.work("receivers", self.walked(receivers, counted) + shading * receivers, bytes + 12 * light);
    }

    /// Operations of walks from so many points. A walk that sums `s` nodes of `t` trees opened `s − t` groups on its way.
    fn walked(&self, points: u64, [summed, facing, _]: Counted) -> u64 {
        let trees = self.stage.trees().filter(|tree| !tree.is_empty()).count() as u64;
        let looked_at = 2 * summed - points * trees;
        LOOK * looked_at + SUM * summed + FACE * facing
    }
}

/// Bytes of the nodes that walks read: places, casters, the next ones.
fn walk_bytes(nodes: u64) -> u64 {
    (16 + 16 + 4) * nodes
}
