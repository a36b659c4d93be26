//! Five small methods that keep the contract, each with a twin that breaks it in one line.
//!
//! All compute the same toy: the mean light of nine directions, less the share that each sphere covers alone. Between
//! them they have every trait of the real methods that the contract must bear: receivers in clusters, a grid updated in
//! part, buffers that stay where results were made, a solver that may be cancelled, and data shared between methods.
//!
//! [`Faulty`] breaks what the twins leave whole, so that every check has something that it must reject.

mod cancellable;
mod clustered;
mod derived;
mod faulty;
mod grid;
mod resident;
mod toy;

use halflight_contract::Method;

pub use cancellable::Cancellable;
pub use clustered::Clustered;
pub use derived::SharedDerived;
pub use faulty::{Fault, Faulty};
pub use grid::Grid;
pub use resident::Resident;

/// A mock, its broken twin, and the check that is meant to reject the twin.
pub struct Pair {
    /// Keeps the contract.
    pub honest: &'static dyn Method,
    /// The same code with one flaw.
    pub twin: &'static dyn Method,
    /// Name of the check that rejects the twin.
    pub caught_by: &'static str,
}

/// The five mocks with their twins.
pub static PAIRS: [Pair; 5] = [
    Pair { honest: &Clustered::HONEST, twin: &Clustered::TWIN, caught_by: "permuted_receivers" },
    Pair { honest: &Grid::HONEST, twin: &Grid::TWIN, caught_by: "fresh_equals_updated" },
    Pair { honest: &Resident::HONEST, twin: &Resident::TWIN, caught_by: "dirty_output" },
    Pair { honest: &Cancellable::HONEST, twin: &Cancellable::TWIN, caught_by: "cancellation" },
    Pair { honest: &SharedDerived::HONEST, twin: &SharedDerived::TWIN, caught_by: "shared_derived_data" },
];
