//! Fig. 4: the level offset.

use super::cone::{OFFSETS, shadows};
use crate::figures::Figure;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/fig4",
    place: "Snyder and Nowrouzezahrai 2008, Fig. 4",
    shows: "the shadow of a cone by level offsets o of 0 to 4 octaves, k = 4, a swath of 20°",
    look: "The finer the levels that distances are looked up in, the sharper the shadow's tip and edges.",
    make: |bench, sheet| shadows(bench, sheet, OFFSETS),
};
