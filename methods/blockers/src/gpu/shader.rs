//! The text of a shader, put together of what a scene and its parameters need.

use std::fmt::Write;

use halflight_gpu::Access;
use halflight_sh::wgsl;

use crate::Accumulator;
use crate::lamps::{ANGLES, TILTS};

/// What not every scene needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Receivers look at cuts, not at all spheres.
    pub cuts: bool,
    /// Blockers that never move are known before.
    pub baked: bool,
    /// How lamps light, if there are any.
    pub lamps: Option<Lamplight>,
}

/// How lamps light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lamplight {
    /// By the visible share of their circle.
    Share,
    /// By the paper's lobes.
    Lobe,
}

/// A shader's text by the order of accumulation and what is needed.
pub type Text = Box<dyn Fn(usize, Needs) -> String + Send>;

/// The buffers of every shader, in the order of their bindings: settings, receivers, spheres, tables, results, counters.
const BUFFERS: [Access; 6] = [Access::Read, Access::Read, Access::Read, Access::Read, Access::Write, Access::Write];

impl Needs {
    /// The buffers that are bound behind those of every shader, by the names of their bindings.
    fn more(self) -> Vec<&'static str> {
        let cuts: &[_] = if self.cuts { &["LISTS", "RATIOS"] } else { &[] };
        let baked: &[_] = if self.baked { &["BAKED"] } else { &[] };
        let lamps: &[_] = match self.lamps {
            None => &[],
            Some(Lamplight::Share) => &["LAMPS"],
            Some(Lamplight::Lobe) => &["LAMPS", "LOBES"],
        };
        [cuts, baked, lamps].concat()
    }

    pub(super) fn buffers(self) -> Vec<Access> {
        BUFFERS.into_iter().chain(self.more().iter().map(|_| Access::Read)).collect()
    }

    fn parts(self) -> Vec<&'static str> {
        let list = if self.cuts { include_str!("../wgsl/cuts.wgsl") } else { include_str!("../wgsl/all_spheres.wgsl") };
        let baked =
            if self.baked { include_str!("../wgsl/baked.wgsl") } else { include_str!("../wgsl/not_baked.wgsl") };
        let lamps: &[_] = match self.lamps {
            None => &[include_str!("../wgsl/no_lamps.wgsl")],
            Some(Lamplight::Share) => &[include_str!("../wgsl/lamps.wgsl"), include_str!("../wgsl/shares.wgsl")],
            Some(Lamplight::Lobe) => &[include_str!("../wgsl/lamps.wgsl"), include_str!("../wgsl/lobes.wgsl")],
        };
        [&[include_str!("../wgsl/direct.wgsl"), include_str!("../wgsl/seen.wgsl"), list, baked], lamps].concat()
    }
}

/// The whole shader of a method at an order of accumulation.
///
/// # Panics
/// If the method has none.
pub fn source<A: Accumulator>(order: usize, needs: Needs) -> String {
    let own = A::SHADER.expect("only methods with a shader are supported");
    let mut text = wgsl::algebra(order);
    let bindings = needs.more().into_iter().zip(BUFFERS.len()..);
    for (name, value) in bindings.chain([("LOBE_ANGLES", ANGLES), ("LOBE_TILTS", TILTS)]) {
        writeln!(text, "const {name}: u32 = {value}u;").expect("a string");
    }
    [&[text.as_str()], needs.parts().as_slice(), &[own]].concat().join("\n")
}
