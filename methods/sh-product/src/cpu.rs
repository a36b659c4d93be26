//! The product on the CPU.

use halflight_blockers::{Accumulator, Circle, Work, blocker_params, params};
use halflight_contract::{ParamSpec, Params};
use halflight_sh::{CircleTable, coefficients, gamma, rotate_zonal};

/// Left-to-right product of circle visibilities.
pub(crate) struct OrderedProduct {
    order: usize,
}

/// The product so far and scratch.
pub(crate) struct State {
    product: Vec<f32>,
    next: Vec<f32>,
    circle: Vec<f32>,
    zonal: Vec<f32>,
    blockers: u64,
}

impl Accumulator for OrderedProduct {
    type State = State;
    const PARAMS: &'static [ParamSpec] = blocker_params!();

    fn new(params: &Params) -> Self {
        OrderedProduct { order: params.int(params::ORDER.name) }
    }

    fn state(&self) -> State {
        let [product, next, circle] = [0; 3].map(|_| vec![0.0; coefficients(self.order)]);
        State { product, next, circle, zonal: vec![0.0; self.order], blockers: 0 }
    }

    fn begin(&self, state: &mut State) {
        state.product.fill(0.0);
        state.product[0] = (4.0 * std::f32::consts::PI).sqrt();
        state.blockers = 0;
    }

    fn block(&self, state: &mut State, circle: &Circle) {
        CircleTable::visibility(self.order).lookup(circle.sin_angle, &mut state.zonal);
        rotate_zonal(self.order, &state.zonal, circle.axis.to_array(), &mut state.circle);
        if state.blockers == 0 {
            std::mem::swap(&mut state.product, &mut state.circle);
        } else {
            gamma(self.order).product(&state.product, &state.circle, &mut state.next);
            std::mem::swap(&mut state.product, &mut state.next);
        }
        state.blockers += 1;
    }

    fn finish(&self, state: &mut State, visibility: &mut [f32], work: &mut Work) {
        visibility.copy_from_slice(&state.product);
        work.products += state.blockers.saturating_sub(1);
    }
}
