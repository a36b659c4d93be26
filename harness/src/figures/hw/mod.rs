//! Snyder and Nowrouzezahrai 2008: its figures of results and its table, and height fields in motion. Figs. 2, 5 and 7 are drawings of the
//! notation; Fig. 1 is a table of examples.

mod cone;
mod fig10;
mod fig11;
mod fig3;
mod fig4;
mod fig6;
mod fig8;
mod fig9;
mod moving;
mod panels;
mod table1;

use super::Figure;

/// In the paper's order, then those that are ours.
pub(super) const FIGURES: &[Figure] = &[
    fig3::FIGURE,
    fig4::FIGURE,
    fig6::FIGURE,
    fig8::FIGURE,
    fig9::FIGURE,
    fig10::FIGURE,
    fig11::FIGURE,
    table1::FIGURE,
    moving::FIGURE,
];
