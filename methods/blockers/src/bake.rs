//! What blockers that never move leave, kept for receivers that stay where they are (Ren 2006, §7: static blockers are "baked in").

use glam::Vec3;
use halflight_scenes::{Receivers, Sphere};

/// Sums, or whatever a method accumulates, of still blockers at each receiver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bake {
    /// The blockers that never move.
    pub(crate) spheres: Vec<Sphere>,
    /// Coefficients a receiver.
    size: usize,
    /// Position and normal for which each receiver is baked; none if it is not.
    known: Vec<Option<[Vec3; 2]>>,
    /// Circles a receiver.
    counts: Vec<u32>,
    /// `size` coefficients a receiver.
    sums: Vec<f32>,
}

impl Bake {
    pub(crate) fn new(spheres: Vec<Sphere>) -> Self {
        Bake { spheres, ..Bake::default() }
    }

    /// Forgets everything but the blockers.
    pub(crate) fn clear(&mut self) {
        self.known.clear();
    }

    /// Makes room for `size` coefficients a receiver and tells which receivers are not baked where they are now.
    pub(crate) fn missing(&mut self, receivers: &Receivers, size: usize) -> Vec<usize> {
        let count = receivers.len();
        if self.known.len() != count || self.size != size {
            (self.size, self.known) = (size, vec![None; count]);
            self.counts = vec![0; count];
            self.sums = vec![0.0; count * size];
        }
        let valid = (0..count).filter(|&receiver| receivers.valid[receiver]);
        valid.filter(|&receiver| self.known[receiver] != Some(place(receivers, receiver))).collect()
    }

    /// Keeps what was accumulated of so many circles at a receiver.
    pub(crate) fn store(&mut self, receivers: &Receivers, receiver: usize, count: u32, sums: &[f32]) {
        self.known[receiver] = Some(place(receivers, receiver));
        self.counts[receiver] = count;
        self.sums[receiver * self.size..][..self.size].copy_from_slice(sums);
    }

    /// Circles baked at a receiver, and what was accumulated of them.
    pub(crate) fn at(&self, receiver: usize) -> (u32, &[f32]) {
        (self.counts[receiver], &self.sums[receiver * self.size..][..self.size])
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let receivers = size_of_val(self.known.as_slice()) + size_of_val(self.counts.as_slice());
        receivers + size_of_val(self.sums.as_slice()) + size_of_val(self.spheres.as_slice())
    }
}

fn place(receivers: &Receivers, receiver: usize) -> [Vec3; 2] {
    [receivers.position[receiver], receivers.geometric_normal[receiver]]
}
