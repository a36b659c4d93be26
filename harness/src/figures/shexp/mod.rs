//! Ren et al. 2006: its figures and its table, and figures that its claims ask for. Fig. 2 is a drawing of the notation.

mod fig1;
mod fig10;
mod fig3;
mod fig4;
mod fig5;
mod fig6;
mod fig7;
mod fig8;
mod fig9;
mod gamma;
mod rim;
mod seams;
mod sequences;

use super::Figure;

/// In the paper's order, then those that are ours.
pub(super) const FIGURES: &[Figure] = &[
    fig1::FIGURE,
    gamma::FIGURE,
    fig3::FIGURE,
    fig4::FIGURE,
    fig5::FIGURE,
    fig6::FIGURE,
    fig7::FIGURE,
    fig8::FIGURE,
    fig9::FIGURE,
    fig10::FIGURE,
    rim::FIGURE,
    seams::FIGURE,
    sequences::FIGURE,
];
