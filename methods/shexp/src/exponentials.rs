//! The exponentials that end sums of logs, 16 vectors side by side, with their parameters.

use halflight_blockers::{blocker_params, params};
use halflight_contract::{Kind, ParamSpec, Params, Phase};
use halflight_sh::{self as sh, BatchExp, Block, SquaringRule};

use crate::quadrature::Directions;

/// Degree of the product series.
const DEGREE: ParamSpec = ParamSpec {
    name: "p",
    kind: Kind::Int { min: 1, max: 20, default: 2 },
    phase: Phase::Evaluate,
    help: "degree p of the product series in PS*-p",
};

/// Degree of the plain series.
const TERMS: ParamSpec = ParamSpec {
    name: "p",
    kind: Kind::Int { min: 1, max: 60, default: 21 },
    phase: Phase::Evaluate,
    help: "degree p of the product series in PS-p; deep umbras need more than 30",
};

/// Rings of directions.
const RINGS: ParamSpec = ParamSpec {
    name: "rings",
    kind: Kind::Int { min: 4, max: 128, default: 32 },
    phase: Phase::Evaluate,
    help: "rings of directions at which the exponential is taken, twice as many on each",
};

/// Offset of the squaring count.
const SQUARING: ParamSpec = ParamSpec {
    name: "squaring",
    kind: Kind::Float { min: -4.0, max: 8.0, default: 3.0 },
    phase: Phase::Evaluate,
    help: "offset c of the squaring count max(0, ⌊log2‖f̂‖ + c⌋); the paper prints 3",
};

/// The shader that ends with this file.
macro_rules! shader {
    ($file:literal) => {
        Some(concat!(include_str!("wgsl/log_sum.wgsl"), include_str!($file)))
    };
}

/// An exponential of SHEXP with its setting.
pub(crate) trait Exponential: Send + Sync + 'static {
    /// All parameters of the variant.
    const PARAMS: &'static [ParamSpec];
    /// What ends sums of logs on the GPU, with those before it; none if it does not run there.
    const SHADER: Option<&'static str> = None;
    /// Setting from parameters.
    fn new(params: &Params) -> Self;
    /// The same for the shader.
    fn shader_settings(_: &Params) -> [f32; 4] {
        [0.0; 4]
    }
    /// Writes the exponentials of `log`, and the operations that each took to `spent`.
    fn exp(&self, exp: &mut BatchExp<f32>, log: &[Block<f32>], out: &mut [Block<f32>], spent: &mut [sh::Work]);
}

/// PS-p.
pub(crate) struct PlainSeries {
    degree: usize,
}

impl Exponential for PlainSeries {
    const PARAMS: &'static [ParamSpec] =
        blocker_params!(TERMS, params::CUT, params::RATIO, params::CLUSTER, params::BAKE);
    const SHADER: Option<&'static str> = shader!("wgsl/ps.wgsl");

    fn new(params: &Params) -> Self {
        PlainSeries { degree: params.int(TERMS.name) }
    }

    fn shader_settings(params: &Params) -> [f32; 4] {
        [params.int(TERMS.name) as f32, 0.0, 0.0, 0.0]
    }

    fn exp(&self, exp: &mut BatchExp<f32>, log: &[Block<f32>], out: &mut [Block<f32>], spent: &mut [sh::Work]) {
        exp.product_series(self.degree, log, out, spent);
    }
}

/// OL.
pub(crate) struct LinearExp;

impl Exponential for LinearExp {
    const PARAMS: &'static [ParamSpec] = blocker_params!(params::CUT, params::RATIO, params::CLUSTER, params::BAKE);
    const SHADER: Option<&'static str> = shader!("wgsl/ol.wgsl");

    fn new(_: &Params) -> Self {
        LinearExp
    }

    fn exp(&self, exp: &mut BatchExp<f32>, log: &[Block<f32>], out: &mut [Block<f32>], spent: &mut [sh::Work]) {
        exp.optimal_linear(log, out, spent);
    }
}

/// The exponential direction by direction.
pub(crate) struct QuadratureExp {
    directions: Directions,
}

impl Exponential for QuadratureExp {
    const PARAMS: &'static [ParamSpec] =
        blocker_params!(RINGS, params::CUT, params::RATIO, params::CLUSTER, params::BAKE);

    fn new(params: &Params) -> Self {
        QuadratureExp { directions: Directions::new(params::accumulated_order(params), params.int(RINGS.name)) }
    }

    fn exp(&self, _: &mut BatchExp<f32>, log: &[Block<f32>], out: &mut [Block<f32>], _: &mut [sh::Work]) {
        self.directions.exp(log, out);
    }
}

/// PS*-p.
pub(crate) struct SeriesExp {
    degree: usize,
    rule: SquaringRule,
}

impl Exponential for SeriesExp {
    const PARAMS: &'static [ParamSpec] =
        blocker_params!(DEGREE, SQUARING, params::CUT, params::RATIO, params::CLUSTER, params::BAKE);
    const SHADER: Option<&'static str> = shader!("wgsl/ps_star.wgsl");

    fn new(params: &Params) -> Self {
        SeriesExp { degree: params.int(DEGREE.name), rule: squaring(params) }
    }

    fn shader_settings(params: &Params) -> [f32; 4] {
        let degree = params.int(DEGREE.name) as f64;
        [factor(params), (80.0 / degree).exp2() as f32, degree as f32, 0.0]
    }

    fn exp(&self, exp: &mut BatchExp<f32>, log: &[Block<f32>], out: &mut [Block<f32>], spent: &mut [sh::Work]) {
        exp.scaled_series(self.degree, self.rule, log, out, spent);
    }
}

/// HYB.
pub(crate) struct HybridExp {
    rule: SquaringRule,
}

impl Exponential for HybridExp {
    const PARAMS: &'static [ParamSpec] =
        blocker_params!(SQUARING, params::CUT, params::RATIO, params::CLUSTER, params::BAKE);
    const SHADER: Option<&'static str> = shader!("wgsl/hyb.wgsl");

    fn new(params: &Params) -> Self {
        HybridExp { rule: squaring(params) }
    }

    fn shader_settings(params: &Params) -> [f32; 4] {
        [factor(params), 0.0, 0.0, 0.0]
    }

    fn exp(&self, exp: &mut BatchExp<f32>, log: &[Block<f32>], out: &mut [Block<f32>], spent: &mut [sh::Work]) {
        exp.hybrid(self.rule, log, out, spent);
    }
}

/// The eigen-exponential.
pub(crate) struct EigenExp;

impl Exponential for EigenExp {
    const PARAMS: &'static [ParamSpec] = blocker_params!(params::CUT, params::RATIO, params::CLUSTER, params::BAKE);

    fn new(_: &Params) -> Self {
        EigenExp
    }

    fn exp(&self, exp: &mut BatchExp<f32>, log: &[Block<f32>], out: &mut [Block<f32>], spent: &mut [sh::Work]) {
        exp.eigen(log, out, spent);
    }
}

/// 2 to the offset of the squaring rule.
fn factor(params: &Params) -> f32 {
    params.float(SQUARING.name).exp2() as f32
}

fn squaring(params: &Params) -> SquaringRule {
    SquaringRule { offset: params.float(SQUARING.name) }
}
