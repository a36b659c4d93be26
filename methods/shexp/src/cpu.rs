//! Sums of log visibilities on the CPU, and the exponentials that end them.

use halflight_blockers::{Accumulator, Circle, Work, blocker_params, params};
use halflight_contract::{Kind, ParamSpec, Params, Phase};
use halflight_sh::{CircleTable, ExpWorkspace, SquaringRule, coefficients, rotate_zonal};

/// Degree of the product series.
const DEGREE: ParamSpec = ParamSpec {
    name: "p",
    kind: Kind::Int { min: 1, max: 20, default: 2 },
    phase: Phase::Evaluate,
    help: "degree p of the product series in PS*-p",
};

/// Offset of the squaring count.
const SQUARING: ParamSpec = ParamSpec {
    name: "squaring",
    kind: Kind::Float { min: -4.0, max: 8.0, default: 3.0 },
    phase: Phase::Evaluate,
    help: "offset c of the squaring count max(0, ⌊log2‖f̂‖ + c⌋); the paper prints 3",
};

/// An exponential of SHEXP with its setting.
pub(crate) trait Exponential: Send + Sync {
    /// All parameters of the variant.
    const PARAMS: &'static [ParamSpec];
    /// Setting from parameters.
    fn new(params: &Params) -> Self;
    /// Writes the exponential of `log` and tells the operations it took.
    fn exp(&self, workspace: &mut ExpWorkspace<f32>, log: &[f32], out: &mut [f32]) -> halflight_sh::Work;
}

/// PS*-p.
pub(crate) struct SeriesExp {
    degree: usize,
    rule: SquaringRule,
}

impl Exponential for SeriesExp {
    const PARAMS: &'static [ParamSpec] = blocker_params!(DEGREE, SQUARING);

    fn new(params: &Params) -> Self {
        SeriesExp { degree: params.int(DEGREE.name), rule: squaring(params) }
    }

    fn exp(&self, workspace: &mut ExpWorkspace<f32>, log: &[f32], out: &mut [f32]) -> halflight_sh::Work {
        workspace.scaled_series(self.degree, self.rule, log, out)
    }
}

/// HYB.
pub(crate) struct HybridExp {
    rule: SquaringRule,
}

impl Exponential for HybridExp {
    const PARAMS: &'static [ParamSpec] = blocker_params!(SQUARING);

    fn new(params: &Params) -> Self {
        HybridExp { rule: squaring(params) }
    }

    fn exp(&self, workspace: &mut ExpWorkspace<f32>, log: &[f32], out: &mut [f32]) -> halflight_sh::Work {
        workspace.hybrid(self.rule, log, out)
    }
}

/// The eigen-exponential.
pub(crate) struct EigenExp;

impl Exponential for EigenExp {
    const PARAMS: &'static [ParamSpec] = blocker_params!();

    fn new(_: &Params) -> Self {
        EigenExp
    }

    fn exp(&self, workspace: &mut ExpWorkspace<f32>, log: &[f32], out: &mut [f32]) -> halflight_sh::Work {
        workspace.eigen(log, out)
    }
}

fn squaring(params: &Params) -> SquaringRule {
    SquaringRule { offset: params.float(SQUARING.name) }
}

/// The sum of tabulated circle logs (Ren 2006, eqs. 8 and 34), ended by an exponential.
pub(crate) struct LogSum<E> {
    order: usize,
    exponential: E,
}

/// The sum so far and scratch.
pub(crate) struct State {
    log: Vec<f32>,
    circle: Vec<f32>,
    zonal: Vec<f32>,
    workspace: ExpWorkspace<f32>,
    blockers: u64,
}

impl<E: Exponential> Accumulator for LogSum<E> {
    type State = State;
    const PARAMS: &'static [ParamSpec] = E::PARAMS;

    fn new(params: &Params) -> Self {
        LogSum { order: params.int(params::ORDER.name), exponential: E::new(params) }
    }

    fn state(&self) -> State {
        let [log, circle] = [0; 2].map(|_| vec![0.0; coefficients(self.order)]);
        let workspace = ExpWorkspace::new(self.order);
        State { log, circle, zonal: vec![0.0; self.order], workspace, blockers: 0 }
    }

    fn begin(&self, state: &mut State) {
        state.log.fill(0.0);
        state.blockers = 0;
    }

    fn block(&self, state: &mut State, circle: &Circle) {
        CircleTable::log(self.order).lookup(circle.sin_angle, &mut state.zonal);
        rotate_zonal(self.order, &state.zonal, circle.axis.to_array(), &mut state.circle);
        state.log.iter_mut().zip(&state.circle).for_each(|(sum, log)| *sum += log);
        state.blockers += 1;
    }

    fn finish(&self, state: &mut State, visibility: &mut [f32], work: &mut Work) {
        if state.blockers == 0 {
            visibility.fill(0.0);
            visibility[0] = (4.0 * std::f32::consts::PI).sqrt();
            return;
        }
        let spent = self.exponential.exp(&mut state.workspace, &state.log, visibility);
        work.additions += state.blockers;
        work.products += u64::from(spent.products);
        work.squares += u64::from(spent.squares);
    }
}
