//! What a method declares about itself, and how it answers a request.

use std::fmt;

use crate::{ParamSpec, Params};

/// Where a method runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// This machine's cores.
    Cpu,
    /// A graphics processor, by its number among the machine's adapters.
    Gpu(u8),
}

impl Backend {
    /// The first graphics processor. In [`Info::backends`] it stands for any.
    pub const GPU: Backend = Backend::Gpu(0);
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Backend::Cpu => f.write_str("cpu"),
            Backend::Gpu(_) => f.write_str("gpu"),
        }
    }
}

/// How the answer at one receiver depends on the other receivers of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coupling {
    /// Not at all: permuting receivers permutes the answers, bit for bit.
    Independent,
    /// Receivers share work in clusters; another grouping changes an answer by at most this much radiance
    /// (for unit environment and albedo).
    Clustered(f32),
    /// Receivers are cells of one grid whose order is part of the input.
    Grid,
}

/// What is asked at the receivers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Outgoing radiance by light that arrives straight from the lights.
    Direct,
    /// Outgoing radiance by light that was reflected 1 to `bounces` times before.
    Indirect {
        /// Number of bounces counted.
        bounces: u8,
    },
    /// Direct and all indirect light.
    Total,
    /// Visibility of the distance in spherical harmonics: `order²` coefficients a receiver.
    Visibility {
        /// SH order.
        order: u8,
    },
}

impl Quantity {
    /// Floats that [`crate::Output`] holds for each receiver.
    pub fn channels(&self) -> usize {
        match self {
            Quantity::Visibility { order } => *order as usize * *order as usize,
            _ => 3,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Quantity::Direct => f.write_str("direct"),
            Quantity::Indirect { bounces } => write!(f, "indirect-{bounces}"),
            Quantity::Total => f.write_str("total"),
            Quantity::Visibility { order } => write!(f, "visibility-{order}"),
        }
    }
}

/// A method's name plate: constant, known before any work.
#[derive(Debug)]
pub struct Info {
    /// `family/variant`, lower case.
    pub id: &'static str,
    /// One line: what it does.
    pub about: &'static str,
    /// Where it comes from, with the equations that decide it.
    pub paper: &'static str,
    /// Backends it has.
    pub backends: &'static [Backend],
    /// Parameters, declared once.
    pub params: &'static [ParamSpec],
    /// How receivers couple at the default parameters.
    pub coupling: Coupling,
}

impl Info {
    /// The part of the id before the slash: the crate's folder.
    pub fn family(&self) -> &'static str {
        self.id.split('/').next().unwrap_or(self.id)
    }

    /// Whether it has a backend of that kind.
    pub fn runs_on(&self, backend: Backend) -> bool {
        self.backends.iter().any(|own| std::mem::discriminant(own) == std::mem::discriminant(&backend))
    }
}

/// What is asked of a method on a scene.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Quantity wanted at the receivers.
    pub quantity: Quantity,
    /// Backend to run on.
    pub backend: Backend,
    /// Parameters, complete and in range.
    pub params: &'a Params,
}

/// A method's answer to a [`Request`], decided without work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Support {
    /// Nothing but the method's own approximations.
    Exact,
    /// Runs, but leaves out or replaces part of the scene.
    Approximate(String),
    /// Does not run, and why.
    Skip(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_and_names_of_quantities() {
        let quantities = [
            (Quantity::Direct, 3, "direct"),
            (Quantity::Indirect { bounces: 2 }, 3, "indirect-2"),
            (Quantity::Total, 3, "total"),
            (Quantity::Visibility { order: 8 }, 64, "visibility-8"),
        ];
        for (quantity, channels, name) in quantities {
            assert_eq!((quantity.channels(), quantity.to_string().as_str()), (channels, name));
        }
    }
}
