//! What a pass did at least, from what it counted: for `Meter::work`.

use halflight_sh::{coefficients, wgsl};

use crate::{Tally, Work};

/// Operations on a sphere that is looked at: the vector to it and its height.
const LOOK: u64 = 8;
/// On one that becomes a circle: its squared distance, a root, four products.
const SEE: u64 = 10;
/// On a circle's zonal coefficient.
const PROFILE: u64 = 6;

/// Arithmetic of receivers at an order of accumulation, shaded or not.
pub(super) fn operations(order: usize, receivers: u64, shaded: bool, tally: &Tally, work: &Work) -> u64 {
    let (each, size) = (wgsl::operations(order), coefficients(order) as u64);
    let looked_at = tally.accumulated + tally.removed + tally.too_small;
    let circle = SEE + PROFILE * order as u64 + each.rotate_zonal;
    let accumulation = work.additions * size + work.products * each.product + work.squares * each.square;
    // Transfer, three dot products, albedo.
    let shading = if shaded { receivers * (each.rotate_zonal + each.product + 6 * size + 3) } else { 0 };
    LOOK * looked_at + tally.accumulated.saturating_sub(work.kept) * circle + accumulation + shading
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two spheres before each of three receivers at order 2, one of them removed, by products.
    #[test]
    fn it_is_as_counted_by_hand() {
        let tally = Tally { accumulated: 3, removed: 3, too_small: 0 };
        let work = Work { products: 3, ..Work::default() };
        let circles = 6 * 8 + 3 * (10 + 12 + 3);
        assert_eq!(operations(2, 3, false, &tally, &work), circles + 3 * 19);
        assert_eq!(operations(2, 3, true, &tally, &work), circles + 3 * 19 + 3 * (3 + 19 + 24 + 3));
    }
}
