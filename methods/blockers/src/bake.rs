//! What blockers that never move leave, kept for receivers that stay where they are (Ren 2006, §7: static blockers are "baked in").

use glam::Vec3;
use halflight_scenes::{Receivers, Sphere};

/// Sums, or whatever a method accumulates, of still blockers at each receiver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bake {
    /// The blockers that never move.
    pub(crate) spheres: Vec<Sphere>,
    /// Position and normal of each receiver; none if it is not valid.
    places: Vec<Option<[Vec3; 2]>>,
    /// Receivers that are not baked where they are.
    missing: Vec<usize>,
    /// Circles a receiver.
    counts: Vec<u32>,
    /// As many coefficients a receiver.
    sums: Vec<f32>,
}

impl Bake {
    pub(crate) fn new(spheres: Vec<Sphere>) -> Self {
        Bake { spheres, ..Bake::default() }
    }

    /// Forgets what was accumulated.
    pub(crate) fn clear(&mut self) {
        self.missing = (0..self.places.len()).filter(|&receiver| self.places[receiver].is_some()).collect();
        self.counts.clear();
        self.sums.clear();
    }

    /// Takes receivers where they are now: those that have moved lack their blockers.
    pub(crate) fn move_to(&mut self, receivers: &Receivers) {
        let place = |receiver: usize| [receivers.position[receiver], receivers.geometric_normal[receiver]];
        let places: Vec<_> = (0..receivers.len()).map(|i| receivers.valid[i].then(|| place(i))).collect();
        if places.len() != self.places.len() {
            self.places = places;
            self.clear();
            return;
        }
        let moved = |&receiver: &usize| places[receiver].is_some() && places[receiver] != self.places[receiver];
        self.missing.extend((0..places.len()).filter(moved));
        self.missing.sort_unstable();
        self.missing.dedup();
        self.places = places;
    }

    /// Receivers that are not baked where they are.
    pub(crate) fn missing(&self) -> &[usize] {
        &self.missing
    }

    /// Keeps `size` coefficients of so many circles for each receiver that lacked them.
    pub(crate) fn store(&mut self, size: usize, baked: &[(u32, Vec<f32>)]) {
        self.counts.resize(self.places.len(), 0);
        self.sums.resize(self.places.len() * size, 0.0);
        for (receiver, (count, sums)) in self.missing.drain(..).zip(baked) {
            self.counts[receiver] = *count;
            self.sums[receiver * size..][..size].copy_from_slice(sums);
        }
    }

    /// Circles baked at a receiver, and what was accumulated of them.
    pub(crate) fn at(&self, receiver: usize) -> (u32, &[f32]) {
        let size = self.sums.len() / self.counts.len();
        (self.counts[receiver], &self.sums[receiver * size..][..size])
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let receivers = size_of_val(self.places.as_slice()) + size_of_val(self.counts.as_slice());
        receivers + size_of_val(self.sums.as_slice()) + size_of_val(self.spheres.as_slice())
    }
}
