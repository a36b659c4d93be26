//! The list of methods: one line each.

use halflight_contract::Method;

/// Every registered method.
pub fn methods() -> Vec<&'static dyn Method> {
    vec![
        &halflight_sh_product::Ordered,
        &halflight_sh_product::Tree,
        &halflight_shexp::Ps,
        &halflight_shexp::PsStar,
        &halflight_shexp::Ol,
        &halflight_shexp::Hyb,
        &halflight_shexp::Eigen,
        &halflight_shexp::Quadrature,
        &halflight_ambient_occlusion::Elements,
        &halflight_horizon_wedges::COMPLETE,
        &halflight_horizon_wedges::PARTIAL,
        &halflight_horizon_wedges::MARCH,
        &halflight_horizon_wedges::SWEEP,
        &halflight_horizon_wedges::HARD,
        &halflight_horizon_wedges::AMBIENT,
        &halflight_horizon_wedges::BLOCKERS,
    ]
}

/// The method of that id.
pub fn find(id: &str) -> Option<&'static dyn Method> {
    methods().into_iter().find(|method| method.info().id == id)
}

include!(concat!(env!("OUT_DIR"), "/revisions.rs"));

/// Hash of the sources that decide a family's results: those of its crate and of the workspace crates below it.
/// `None` for a family that is not registered.
pub fn revision(family: &str) -> Option<&'static str> {
    REVISIONS.iter().find(|(name, _)| *name == family).map(|(_, revision)| *revision)
}
