//! SHEXP: soft shadows by summing the logs of blocker visibilities (Ren et al. 2006).
//!
//! `g = exp(f[1] + f[2] + … + f[m])` (eq. 8): `n²` additions a blocker instead of an SH product, and one SH exponential a
//! receiver. The variants differ in the exponential alone; all sum the same tabulated logs (eqs. 30–32), which invert the
//! *truncated* exponential.
//!
//! | variant | exponential |
//! |---|---|
//! | `shexp/ps` | plain product series of degree p (eqs. 15–17), for comparison |
//! | `shexp/ps-star` | DC isolation, scaling and squaring, factored product series of degree p (eqs. 20–22) |
//! | `shexp/ol` | optimal linear `a·1 + b·f̂` (eqs. 23–24) without scaling |
//! | `shexp/hyb` | optimal linear `a·1 + b·f̂` with scaling and squaring (eqs. 21, 23–24) |
//! | `shexp/eigen` | eigenanalysis of the product matrix, no truncated series (eq. 28): the oracle of the family |
//! | `shexp/quadrature` | `exp` direction by direction, then projected (eq. 10): exact, and worse for it, since the logs invert the truncated one |
//!
//! **Domain.** A circle of more than about 49° (order 4) has a clipped log, and reproducing it errs by up to 5% of its norm.
//! Exponentials of heavily overlapping blockers grow where the truncated sum is positive; the overlap guard bounds the result
//! and the count of guarded receivers is in the results. Beyond that:
//!
//! - `ps` at degree p needs eigenvalues well below p in magnitude, hence p > 30 in a deep umbra: a little less alternates between
//!   bright and dark, much less is off by orders of magnitude and left to the guard.
//! - `ol` is fitted to circles, by the norm of the log without its mean: up to order 4, `‖f̂‖ < 4.8`, about 50° of radius. At other
//!   orders several circles share a norm, and the first is taken.
//! - `ps-star`, `hyb` and `eigen` hold at every order and length.

mod cpu;
mod exponentials;
#[cfg(all(test, feature = "gpu"))]
mod planted;
mod quadrature;

use halflight_blockers::{Accumulator, backends, params, prepare, supports};
use halflight_contract::{Coupling, Info, Job, Meter, Method, Params, Prepared, Request, Result, Support};
use halflight_scenes::SceneFacts;

use cpu::LogSum;
use exponentials::{EigenExp, HybridExp, LinearExp, PlainSeries, QuadratureExp, SeriesExp};

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
                    backends: backends(LogSum::<$exponential>::SHADER),
                    params: LogSum::<$exponential>::PARAMS,
                    coupling: Coupling::Independent,
                };
                &INFO
            }

            fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
                supports::<LogSum<$exponential>>(facts, request)
            }

            fn coupling(&self, params: &Params) -> Coupling {
                params::coupling(params)
            }

            fn approximates(&self) -> Option<&'static str> {
                Some($approximates)
            }

            fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
                prepare::<LogSum<$exponential>>(job, meter)
            }
        }
    };
}

variant!(
    /// PS-p.
    Ps,
    PlainSeries,
    "shexp/ps",
    "sum of log visibilities, exponential by the plain product series",
    "Ren et al. 2006, eqs. 8, 15-17",
    "shexp/eigen"
);
variant!(
    /// OL.
    Ol,
    LinearExp,
    "shexp/ol",
    "sum of log visibilities, exponential by the optimal linear fit alone",
    "Ren et al. 2006, eqs. 8, 23-24",
    "shexp/eigen"
);
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
variant!(
    /// Exponential by quadrature.
    Quadrature,
    QuadratureExp,
    "shexp/quadrature",
    "sum of log visibilities, exponential direction by direction",
    "Ren et al. 2006, eqs. 8, 10",
    "shexp/eigen"
);
