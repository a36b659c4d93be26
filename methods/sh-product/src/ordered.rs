//! The product from left to right, 16 receivers side by side.

use halflight_blockers::{Accumulator, Circles, Counts, Work, blocker_params, fill_open, params};
use halflight_contract::{ParamSpec, Params};
use halflight_sh::{Batch, Block, LANES, coefficients};

/// Left-to-right product of circle visibilities.
pub(crate) struct OrderedProduct {
    batch: Batch,
}

/// The products so far and scratch.
pub(crate) struct State {
    product: Vec<Block<f32>>,
    next: Vec<Block<f32>>,
    circle: Vec<Block<f32>>,
    zonal: Vec<Block<f32>>,
    empty: bool,
}

impl Accumulator for OrderedProduct {
    type State = State;
    const PARAMS: &'static [ParamSpec] = blocker_params!(params::BAKE);
    const SHADER: Option<&'static str> = Some(include_str!("ordered.wgsl"));

    fn new(params: &Params) -> Self {
        OrderedProduct { batch: Batch::new(params::accumulated_order(params)) }
    }

    fn state(&self) -> State {
        let [product, next, circle] = [0; 3].map(|_| vec![Block::ZERO; coefficients(self.batch.order())]);
        State { product, next, circle, zonal: vec![Block::ZERO; self.batch.order()], empty: true }
    }

    fn begin(&self, state: &mut State) {
        (0..LANES).for_each(|lane| fill_open(&mut state.product, lane));
        state.empty = true;
    }

    fn block(&self, state: &mut State, Circles { axes, sines, .. }: &Circles<'_>) {
        let State { product, next, circle, zonal, empty } = state;
        for (axis, sine) in axes.iter().zip(*sines) {
            self.batch.circle_visibilities(std::slice::from_ref(sine), zonal);
            self.batch.rotate_zonal(zonal, std::slice::from_ref(axis), circle);
            if !*empty {
                self.batch.product(product, circle, next);
                std::mem::swap(circle, next);
            }
            if sine.0.iter().all(|&sine| sine > 0.0) {
                std::mem::swap(product, circle);
            } else {
                self.batch.replace_above(0.0, sine, circle, product);
            }
            *empty = false;
        }
    }

    fn finish(&self, state: &mut State, counts: &Counts<'_>, visibility: &mut [Block<f32>], work: &mut Work) {
        visibility.copy_from_slice(&state.product);
        let products = |counts: &[u32]| counts.iter().map(|&count| u64::from(count.saturating_sub(1))).sum::<u64>();
        work.products += products(counts.all) - products(counts.kept);
    }

    fn kept<'s>(&self, state: &'s mut State) -> Option<&'s mut [Block<f32>]> {
        state.empty = false;
        Some(&mut state.product)
    }
}

#[cfg(test)]
mod tests {
    use halflight_sh::{CircleTable, gamma, rotate_zonal};

    use super::*;

    /// The product of the circles in a lane by the plain loop, and the norm of the longest intermediate one.
    fn product(order: usize, axes: &[[Block<f32>; 3]], sines: &[Block<f32>], lane: usize) -> (Vec<f32>, f32) {
        let [mut product, mut circle, mut next] = [0; 3].map(|_| vec![0.0; coefficients(order)]);
        product[0] = (4.0 * std::f32::consts::PI).sqrt();
        let (mut zonal, mut longest) = (vec![0.0; order], norm(product.iter().copied()));
        for (axis, sine) in axes.iter().zip(sines).filter(|(_, sine)| sine.0[lane] > 0.0) {
            CircleTable::visibility(order).lookup(sine.0[lane], &mut zonal);
            rotate_zonal(order, &zonal, axis.map(|component| component.0[lane]), &mut circle);
            gamma(order).product(&product, &circle, &mut next);
            std::mem::swap(&mut product, &mut next);
            longest = longest.max(norm(product.iter().copied()));
        }
        (product, longest)
    }

    fn norm(vector: impl Iterator<Item = f32>) -> f32 {
        vector.map(|value| value * value).sum::<f32>().sqrt()
    }

    #[test]
    fn lanes_are_what_single_receivers_were() {
        let (mut axes, mut sines, mut blockers) = (Vec::new(), Vec::new(), [0; LANES]);
        for k in 0..25usize {
            let wave = |lane: usize, phase: f32| ((31 * k + 7 * lane) as f32 + phase).sin();
            let axis = |lane| glam::Vec3::new(wave(lane, 0.0), wave(lane, 2.0), wave(3 * lane, 4.0)).normalize();
            axes.push(std::array::from_fn(|i| Block(std::array::from_fn(|lane| axis(lane)[i]))));
            let seen = |lane: usize| (k + 3 * lane) % 20 < lane;
            let sine = |lane| if seen(lane) { 0.05 + 0.5 * wave(lane, 5.0).abs() } else { 0.0 };
            sines.push(Block(std::array::from_fn(sine)));
            blockers.iter_mut().enumerate().for_each(|(lane, count)| *count += u32::from(seen(lane)));
        }
        for order in 1..=halflight_sh::MAX_ORDER {
            let params = Params::resolve(OrderedProduct::PARAMS, [("order", order.to_string().as_str())]);
            let method = OrderedProduct::new(&params.expect("in range"));
            let (mut state, mut work) = (method.state(), Work::default());
            let mut visibility = vec![Block::splat(f32::NAN); coefficients(order)];
            for _ in 0..2 {
                method.begin(&mut state);
                method.block(&mut state, &Circles { axes: &axes, sines: &sines, ..Circles::default() });
                let counts = Counts { all: &blockers, kept: &[0; LANES] };
                method.finish(&mut state, &counts, &mut visibility, &mut work);
            }
            for lane in 0..LANES {
                let (want, longest) = product(order, &axes, &sines, lane);
                let error = norm(visibility.iter().zip(&want).map(|(got, want)| got.0[lane] - want));
                assert!(error <= 2e-5 * longest, "order {order}, lane {lane}: {error} of {longest}");
            }
            let products: u64 = blockers.iter().map(|&count| u64::from(count.saturating_sub(1))).sum();
            assert_eq!(work, Work { products: 2 * products, ..Work::default() });
        }
    }
}
