//! Parameters that all sphere-blocker methods share.

use halflight_contract::{Coupling, Kind, ParamSpec, Params, Phase};
use halflight_proxies::{DEFAULT_COUNT, MAX_COUNT, SelfShadow};

use crate::Gather;
use crate::cut::Rule;

/// Several times what another grouping changed a receiver by, with θmax = 30° under unit light: 0.012, on a scene made to tell.
const COMPANY: f32 = 0.05;

/// SH order of light, visibility and shading.
pub const ORDER: ParamSpec = ParamSpec {
    name: "order",
    kind: Kind::Int { min: 1, max: halflight_sh::MAX_ORDER as i64, default: 4 },
    phase: Phase::Prepare,
    help: "SH order n of light and visibility: bands 0..n−1, n² coefficients",
};

/// Bands beyond the order.
pub const EXTRA_BANDS: ParamSpec = ParamSpec {
    name: "extra-bands",
    kind: Kind::Int { min: 0, max: 4, default: 0 },
    phase: Phase::Evaluate,
    help: "bands beyond the order in which blockers are accumulated, dropped before shading",
};

/// Spheres an object.
pub const SPHERES: ParamSpec = ParamSpec {
    name: "spheres",
    kind: Kind::Int { min: 1, max: MAX_COUNT as i64, default: DEFAULT_COUNT as i64 },
    phase: Phase::Prepare,
    help: "bounding spheres for each mesh that casts shadows (exact spheres stay as they are)",
};

/// Self-shadow rule.
pub const SELF_SHADOW: ParamSpec = ParamSpec {
    name: "self-shadow",
    kind: Kind::Choice(SelfShadow::NAMES),
    phase: Phase::Evaluate,
    help: "how spheres near the receiver's tangent plane are replaced",
};

/// Smallest blocker.
pub const MIN_ANGLE: ParamSpec = ParamSpec {
    name: "min-angle",
    kind: Kind::Float { min: 0.0, max: 45.0, default: 0.0 },
    phase: Phase::Evaluate,
    help: "blockers of a smaller angular radius (degrees) are skipped",
};

/// Largest angle of a bounding sphere in a cut. Methods that sum logs declare it, and [`RATIO`] and [`CLUSTER`] with it.
pub const CUT: ParamSpec = ParamSpec {
    name: "cut",
    kind: Kind::Float { min: 0.0, max: 60.0, default: 0.0 },
    phase: Phase::Prepare,
    help: "bounding spheres below this angular radius (degrees) stand for groups of blockers, cluster by cluster; 0: none do",
};

/// Ratio vectors.
pub const RATIO: ParamSpec = ParamSpec {
    name: "ratio",
    kind: Kind::Flag { default: true },
    phase: Phase::Evaluate,
    help: "scale the bands of bounding spheres' logs to match, at the middle of a cluster, what they bound",
};

/// Receivers a cluster.
pub const CLUSTER: ParamSpec = ParamSpec {
    name: "cluster",
    kind: Kind::Int { min: 16, max: 65536, default: 256 },
    phase: Phase::Update,
    help: "most receivers that share a cut",
};

/// Static blockers baked in. Methods whose [`crate::Accumulator::kept`] tells what to keep declare it.
pub const BAKE: ParamSpec = ParamSpec {
    name: "bake",
    kind: Kind::Flag { default: false },
    phase: Phase::Prepare,
    help: "accumulate blockers that never move first, and keep that for receivers that stay where they are; cuts leave them whole",
};

/// Overlap guard.
pub const GUARD: ParamSpec = ParamSpec {
    name: "guard",
    kind: Kind::Flag { default: true },
    phase: Phase::Evaluate,
    help: "bring visibility back to 0 ≤ g0 ≤ √4π and ‖g‖² ≤ √4π·g0 where heavy overlap makes it diverge (counted); where that is in deep shadow, it may open the sky",
};

/// Windowing of the light.
pub const WINDOW_LIGHT: ParamSpec = ParamSpec {
    name: "window-light",
    kind: Kind::Flag { default: false },
    phase: Phase::Prepare,
    help: "attenuate the light's bands by cos(π/2·l/2n) against ringing",
};

/// Windowing of the visibility.
pub const WINDOW_VISIBILITY: ParamSpec = ParamSpec {
    name: "window-visibility",
    kind: Kind::Flag { default: false },
    phase: Phase::Evaluate,
    help: "attenuate the visibility's bands by cos(π/2·l/2n) against ringing",
};

/// Local lights.
pub const LOCAL_LIGHTS: ParamSpec = ParamSpec {
    name: "local-lights",
    kind: Kind::Flag { default: true },
    phase: Phase::Prepare,
    help: "spheres that emit give light and block none; blockers beyond such a lamp shade it too",
};

/// How lamps light.
pub const LAMPS: ParamSpec = ParamSpec {
    name: "lamps",
    kind: Kind::Choice(&["share", "lobe"]),
    phase: Phase::Prepare,
    help: "a lamp gives its exact irradiance times the visible share of its circle, or what a lobe fitted to H(N)*L gives, as in the paper",
};

/// The SH order in which blockers are accumulated.
pub fn accumulated_order(params: &Params) -> usize {
    params.int(ORDER.name) + params.int(EXTRA_BANDS.name)
}

/// The gathering rules that a method's parameters ask for.
pub fn gather(params: &Params) -> Gather {
    let self_shadow = SelfShadow::named(params.choice(SELF_SHADOW.name)).expect("declared by the rules' names");
    Gather { self_shadow, min_sin_angle: params.float(MIN_ANGLE.name).to_radians().sin() as f32 }
}

/// How receivers couple: by clusters if they share cuts. The bound was measured with ratio vectors up to 30°; beyond, all light may
/// come and go.
pub fn coupling(params: &Params) -> Coupling {
    match params.float(CUT.name) {
        0.0 => Coupling::Independent,
        angle if angle <= 30.0 && params.flag(RATIO.name) => Coupling::Clustered(COMPANY),
        _ => Coupling::Clustered(1.0),
    }
}

/// How cuts are made, if there are to be any.
pub(crate) fn cut(params: &Params, specs: &[ParamSpec]) -> Option<Rule> {
    let declared = specs.iter().any(|spec| spec.name == CUT.name);
    let angle = if declared { params.float(CUT.name) } else { 0.0 };
    let max_sin_angle = angle.to_radians().sin() as f32;
    (angle > 0.0).then(|| Rule { max_sin_angle, ratios: params.flag(RATIO.name) })
}

/// Whether blockers that never move are baked.
pub(crate) fn bakes(params: &Params, specs: &[ParamSpec]) -> bool {
    specs.iter().any(|spec| spec.name == BAKE.name) && params.flag(BAKE.name)
}

/// The parameters of a sphere-blocker method: the order, its own, then all others that such methods share.
#[macro_export]
macro_rules! blocker_params {
    ($($own:expr),*) => {
        &[
            $crate::params::ORDER,
            $crate::params::EXTRA_BANDS,
            $($own,)*
            $crate::params::SPHERES,
            $crate::params::SELF_SHADOW,
            $crate::params::MIN_ANGLE,
            $crate::params::GUARD,
            $crate::params::WINDOW_LIGHT,
            $crate::params::WINDOW_VISIBILITY,
            $crate::params::LOCAL_LIGHTS,
            $crate::params::LAMPS,
        ]
    };
}
