//! Soft shadows by SH products of blocker visibilities: the baseline of Zhou et al. 2005 as told by Ren et al. 2006, §3.
//!
//! `g = g[1] * g[2] * … * g[m]` (eq. 6), each product truncated to the same order, so that the order of blockers matters.
//!
//! **Domain.** Products of heavily overlapping blockers diverge, since a truncated product matrix has eigenvalues above 1: at
//! order 4 the irradiance under N coincident circles of 15° overhead is 0.929, 0.703, 0.765, 1.42, 8.91 for N = 1, 10, 20, 60,
//! 200 (truth: 0.933; `docs/stress.md`). The mean over all directions exceeds 1, which no visibility does, from where coincident circles of 5° to
//! 15°, counted with their overlap, cover 2.9 to 3.6 steradians at order 4, 1.3 to 2.4 at order 6: a mesh's sphere set does that
//! at arm's length. The overlap guard bounds it (such receivers look evenly lit); the count of guarded receivers is in the
//! results.

mod ordered;
#[cfg(all(test, feature = "gpu"))]
mod planted;
mod tree;

use halflight_blockers::{Accumulator, backends, prepare, supports};
use halflight_contract::{Coupling, Info, Job, Meter, Method, Prepared, Request, Result, Support};
use halflight_scenes::SceneFacts;

use ordered::OrderedProduct;
use tree::TreeProduct;

/// Blockers multiplied one after the other, in the order of the sphere sets.
pub struct Ordered;

static ORDERED: Info = Info {
    id: "sh-product/ordered",
    about: "SH product of all sphere blockers, left to right",
    paper: "Zhou et al. 2005; Ren et al. 2006, eq. 6",
    backends: backends(OrderedProduct::SHADER),
    params: OrderedProduct::PARAMS,
    coupling: Coupling::Independent,
};

impl Method for Ordered {
    fn info(&self) -> &'static Info {
        &ORDERED
    }

    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        supports::<OrderedProduct>(facts, request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        prepare::<OrderedProduct>(job, meter)
    }
}

/// Blockers multiplied by pairs, pairs by pairs, over a binary tree.
pub struct Tree;

static TREE: Info = Info {
    id: "sh-product/tree",
    about: "SH product of all sphere blockers, over a binary tree",
    paper: "Ren et al. 2006, eq. 6, in another order",
    backends: backends(TreeProduct::SHADER),
    params: TreeProduct::PARAMS,
    ..ORDERED
};

impl Method for Tree {
    fn info(&self) -> &'static Info {
        &TREE
    }

    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        supports::<TreeProduct>(facts, request)
    }

    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        prepare::<TreeProduct>(job, meter)
    }
}
