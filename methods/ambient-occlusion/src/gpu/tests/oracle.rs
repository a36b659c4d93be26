//! Walks over the forest in f64, and how far those of the shaders may be from them.

use glam::{DVec3, Vec3};

use crate::stage::Stage;

/// A rounding of `f32`.
pub(super) const ROUNDING: f64 = f32::EPSILON as f64 / 2.0;

/// Roundings of a term that is not small: a vector and its square 5; a root, 2 of a reciprocal root and 2.5 units of a quotient, 9 (WGSL,
/// "accuracy of expressions"); quotients 5. That is 19 for each cosine but for cancellation, 40 for the cover, 3 to multiply.
const TERM: f64 = 19.0 + 19.0 + 40.0 + 3.0;
/// Of a dot product, of the vectors' lengths.
const DOT: f64 = 3.0;
/// Of a direction, and of a mean from elements up to the root, of its length.
const MEAN: f64 = 12.0 + 3.0 * 16.0;
/// Two of them decide alike where a square is further from the bound that it is held against.
const TIE: f64 = 8.0 * ROUNDING;

/// The forest as it is uploaded.
pub(super) struct Walk {
    next: Vec<usize>,
    places: Vec<(DVec3, f64)>,
    casters: Vec<(DVec3, f64)>,
    /// How far the casters on the device may be from these.
    off: f64,
}

/// What is left of the hemisphere at a point, and how far from it a shader may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Left {
    pub(super) value: f64,
    pub(super) bound: f64,
}

impl Walk {
    /// Of elements that cast as they do after their own passes.
    pub(super) fn new(stage: &Stage) -> Self {
        let (forest, whole) = (&stage.forest, 0..stage.forest.nodes());
        let split = |[x, y, z, w]: [f32; 4]| (Vec3::new(x, y, z).as_dvec3(), f64::from(w));
        let mut walk = Walk {
            next: forest.topology()[1..].iter().map(|next| *next as usize).collect(),
            places: forest.places(whole.clone(), stage.opening()).into_iter().map(split).collect(),
            casters: forest.normals(whole).into_iter().map(split).collect(),
            off: 0.0,
        };
        for _ in 0..stage.own_passes() {
            walk.cast();
        }
        walk
    }

    fn cast(&mut self) {
        let nodes = self.next.len();
        let left: Vec<Option<Left>> = (0..nodes).map(|node| self.of_element(node)).collect();
        for node in (0..nodes).rev() {
            let (normal, area) = self.casters[node];
            let vector = match left[node] {
                Some(left) => left.value * normal,
                None => {
                    let [(a, area_a), (b, area_b)] = [node + 1, self.next[node + 1]].map(|child| self.casters[child]);
                    let share = if area_a + area_b > 0.0 { area_a / (area_a + area_b) } else { 0.5 };
                    share * a + (1.0 - share) * b
                }
            };
            self.casters[node] = (vector, area);
        }
        let worst = left.iter().flatten().map(|left| left.bound).fold(0.0, f64::max);
        self.off = worst + MEAN * ROUNDING;
    }

    /// What an element itself is left, if the node is one.
    fn of_element(&self, node: usize) -> Option<Left> {
        let (normal, _) = self.casters[node];
        (self.next[node] == node + 1).then(|| self.at(self.places[node].0, normal.normalize_or_zero()))
    }

    pub(super) fn accessibility(&self, position: Vec3, normal: Vec3) -> Left {
        self.at(position.as_dvec3(), normal.as_dvec3())
    }

    /// The sum of shadows and of the bounds of their errors; roundings of the sum itself are taken as independent.
    fn at(&self, position: DVec3, normal: DVec3) -> Left {
        let (mut sum, mut bound, mut terms, mut node) = (0.0, 0.0, 0.0f64, 0);
        while node < self.next.len() {
            let (place, opened_within) = self.places[node];
            let to = place - position;
            let square = to.length_squared();
            let tied = (square - opened_within).abs() <= TIE * square && square > 0.0;
            assert!(!tied, "node {node} from {position} is opened or not by a rounding: choose another receiver");
            if square <= opened_within {
                node += 1;
                continue;
            }
            let (shadow, error) = self.term(node, to, normal);
            (sum, bound, terms) = (sum + shadow, bound + error, terms + 1.0);
            node = self.next[node];
        }
        let value = (1.0 - sum).max(0.0);
        Left { value, bound: bound + (4.0 * terms.sqrt() * sum + 1.0) * ROUNDING }
    }

    fn term(&self, node: usize, to: DVec3, normal: DVec3) -> (f64, f64) {
        let ((caster, area), square) = (self.casters[node], to.length_squared());
        if square < area.max(f64::from(f32::MIN_POSITIVE)) {
            return (0.0, 0.0);
        }
        let direction = to / square.sqrt();
        let cover = 1.0 - 1.0 / (area / square + 1.0).sqrt();
        let [back, front] = [caster.dot(direction), 4.0 * normal.dot(direction)].map(|cosine| cosine.clamp(0.0, 1.0));
        let off = DOT * ROUNDING * caster.length() + self.off;
        let cancelled = off * front + 4.0 * (DOT + MEAN) * ROUNDING * back;
        (cover * back * front, cover * (TERM * ROUNDING * back * front + cancelled))
    }
}
