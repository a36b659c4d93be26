//! Grids of samples over a field.

/// Where a grid's samples lie along x and y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    /// Samples in the length of one of the field's, at most 1.
    pub(crate) scale: [f64; 2],
    /// By how many samples it begins before the field, where it does not fit.
    pub(crate) shift: [f64; 2],
    /// The field's last vertex, in its grid coordinates.
    pub(crate) last: [f64; 2],
}

/// Centres of rectangles, a whole number of which covers the field: its own are rectangles about its vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    pub(crate) size: [usize; 2],
    pub(crate) lattice: Lattice,
}

impl Grid {
    /// Of `size`, as wide as a field of `full` vertices.
    pub(crate) fn new(size: [usize; 2], full: [usize; 2]) -> Self {
        Self::scaled(size, full, [0, 1].map(|axis| size[axis] as f64 / full[axis] as f64))
    }

    fn scaled(size: [usize; 2], full: [usize; 2], scale: [f64; 2]) -> Self {
        let shift = [0, 1].map(|axis| 0.5 * (size[axis] as f64 - full[axis] as f64 * scale[axis]));
        let last = full.map(|count| (count - 1) as f64);
        Grid { size, lattice: Lattice { scale, shift, last } }
    }

    /// For bringing one back to at least twice its own resolution: by a power of two of the field's, at least an eighth, so that registers
    /// of receivers lie alike among samples.
    pub(crate) fn octave(of: &Grid, full: [usize; 2]) -> Self {
        let halvings = [0, 1].map(|axis| halvings(of.lattice.scale[axis] * 2.0));
        let size = [0, 1].map(|axis| full[axis].div_ceil(1 << halvings[axis]));
        Self::scaled(size, full, halvings.map(|halvings| 1.0 / f64::from(1 << halvings)))
    }
}

/// How often 1 can be halved, at most thrice, and be no less than `scale`.
fn halvings(scale: f64) -> usize {
    (0..3).take_while(|halvings| scale * f64::from(2 << halvings) <= 1.0).count()
}
