//! SHEXP: soft shadows by summing the logs of blocker visibilities (Ren et al. 2006).
//!
//! `g = exp(f[1] + f[2] + … + f[m])` (eq. 8): `n²` additions a blocker instead of an SH product, and one SH exponential a
//! receiver. The variants differ in the exponential alone; all sum the same tabulated logs (eqs. 30–32), which invert the
//! *truncated* exponential.
//!
//! | variant | exponential |
//! |---|---|
//! | `shexp/ps-star` | DC isolation, scaling and squaring, factored product series of degree p (eqs. 20–22) |
//! | `shexp/hyb` | optimal linear `a·1 + b·f̂` with scaling and squaring (eqs. 21, 23–24) |
//! | `shexp/eigen` | eigenanalysis of the product matrix, no truncated series (eq. 28): the oracle of the family |
//!
//! **Domain.** A circle of more than about 49° (order 4) has a clipped log, and reproducing it errs by up to 5% of its norm.
//! Exponentials of heavily overlapping blockers grow where the truncated sum is positive; the overlap guard bounds the result
//! and the count of guarded receivers is in the results.

mod cpu;

use halflight_blockers::{Accumulator, DirectLight, params, supports};
use halflight_contract::{Backend, Coupling, Info, Job, Meter, Method, Params, Prepared, Request, Result, Support};
use halflight_scenes::SceneFacts;

use cpu::{EigenExp, HybridExp, LogSum, SeriesExp};

/// Declares a variant: its public type, its name plate, its exponential, what it approximates.
macro_rules! variant {
    ($(#[$doc:meta])* $name:ident, $exponential:ty, $id:literal, $about:literal, $paper:literal, $approximates:literal) => {
        $(#[$doc])*
        pub struct $name;

        impl Method for $name {
            fn info(&self) -> &'static Info {
                static INFO: Info = Info {
                    id: $id,
                    about: $about,
                    paper: $paper,
                    backends: &[Backend::Cpu],
                    params: LogSum::<$exponential>::PARAMS,
                    coupling: Coupling::Independent,
                };
                &INFO
            }

            fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
                supports(facts, request)
            }

            fn coupling(&self, params: &Params) -> Coupling {
                params::coupling(params)
            }

            fn approximates(&self) -> Option<&'static str> {
                Some($approximates)
            }

            fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
                Ok(Box::new(DirectLight::<LogSum<$exponential>>::prepare(job, meter)?))
            }
        }
    };
}

variant!(
    /// PS*-p.
    PsStar,
    SeriesExp,
    "shexp/ps-star",
    "sum of log visibilities, exponential by the factored product series",
    "Ren et al. 2006, eqs. 8, 20-22",
    "shexp/eigen"
);
variant!(
    /// HYB.
    Hyb,
    HybridExp,
    "shexp/hyb",
    "sum of log visibilities, exponential by the optimal linear fit and squaring",
    "Ren et al. 2006, eqs. 8, 21, 23-24",
    "shexp/eigen"
);
variant!(
    /// Eigen-exponential.
    Eigen,
    EigenExp,
    "shexp/eigen",
    "sum of log visibilities, exponential by eigenanalysis: the family's oracle",
    "Ren et al. 2006, eqs. 8, 28",
    "sh-product/ordered"
);
