//! Fig. 3: pyramid levels an octave.

use super::cone::{LEVELS, shadows};
use crate::figures::Figure;

pub(super) const FIGURE: Figure = Figure {
    id: "hw/fig3",
    place: "Snyder and Nowrouzezahrai 2008, Fig. 3",
    shows: "the shadow of a cone by pyramids of 1 to 4 levels an octave k, a swath of 20°",
    look: "At k = 1 the shadow is banded along its length, from level to level; more levels an octave take the bands away.",
    make: |bench, sheet| shadows(bench, sheet, LEVELS),
};
