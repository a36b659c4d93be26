//! Sums of log visibilities on the CPU, 16 receivers side by side, ended by an exponential.

use halflight_blockers::{Accumulator, Circles, Counts, Work, fill_open, params};
use halflight_contract::{ParamSpec, Params};
use halflight_sh::{self as sh, Batch, BatchExp, Block, LANES, coefficients};

use crate::exponentials::Exponential;

/// The sum of circle logs (Ren 2006, eqs. 8 and 34), ended by an exponential.
pub(crate) struct LogSum<E> {
    order: usize,
    exponential: E,
}

/// The sums so far and scratch.
pub(crate) struct State {
    log: Vec<Block<f32>>,
    zonal: Vec<Block<f32>>,
    exp: BatchExp<f32>,
}

impl<E: Exponential> Accumulator for LogSum<E> {
    type State = State;
    const PARAMS: &'static [ParamSpec] = E::PARAMS;
    const SHADER: Option<&'static str> = E::SHADER;

    fn new(params: &Params) -> Self {
        LogSum { order: params::accumulated_order(params), exponential: E::new(params) }
    }

    fn shader_settings(params: &Params) -> [f32; 4] {
        E::shader_settings(params)
    }

    fn state(&self) -> State {
        let log = vec![Block::ZERO; coefficients(self.order)];
        State { log, zonal: Vec::new(), exp: BatchExp::new(Batch::new(self.order)) }
    }

    fn begin(&self, state: &mut State) {
        state.log.fill(Block::ZERO);
    }

    fn block(&self, State { log, zonal, exp }: &mut State, Circles { axes, sines, ratios, .. }: &Circles<'_>) {
        let size = self.order * sines.len();
        zonal.resize(zonal.len().max(size), Block::ZERO);
        let zonal = &mut zonal[..size];
        exp.batch().circle_logs(sines, zonal);
        if !ratios.is_empty() {
            exp.batch().scale(ratios, zonal);
        }
        exp.batch().sum_zonal(zonal, axes, log);
    }

    fn finish(&self, state: &mut State, counts: &Counts<'_>, visibility: &mut [Block<f32>], work: &mut Work) {
        let blockers = counts.all;
        if blockers.iter().all(|&count| count == 0) {
            (0..LANES).for_each(|lane| fill_open(visibility, lane));
            return;
        }
        let mut spent = [sh::Work::default(); LANES];
        self.exponential.exp(&mut state.exp, &state.log, visibility, &mut spent[..blockers.len()]);
        for (lane, (&count, spent)) in blockers.iter().zip(spent).enumerate() {
            if count == 0 {
                fill_open(visibility, lane);
                continue;
            }
            work.additions += u64::from(count - counts.kept[lane]);
            work.products += u64::from(spent.products);
            work.squares += u64::from(spent.squares);
        }
    }

    fn kept<'s>(&self, state: &'s mut State) -> Option<&'s mut [Block<f32>]> {
        Some(&mut state.log)
    }
}

#[cfg(test)]
mod tests {
    use halflight_sh::{CircleTable, ExpWorkspace, SquaringRule, rotate_zonal};

    use super::*;
    use crate::exponentials::{EigenExp, HybridExp, LinearExp, PlainSeries, SeriesExp};

    /// Circles of their own.
    #[derive(Default)]
    struct List {
        axes: Vec<[Block<f32>; 3]>,
        sines: Vec<Block<f32>>,
        ratios: Vec<f32>,
    }

    /// Receivers with from 0 to 20 circles, those of up to 55° among them, scaled band by band.
    fn circles(order: usize) -> (List, [u32; LANES]) {
        let (mut circles, mut blockers) = (List::default(), [0; LANES]);
        for k in 0..25usize {
            let wave = |lane: usize, phase: f32| ((31 * k + 7 * lane) as f32 + phase).sin();
            let axis = |lane| glam::Vec3::new(wave(lane, 0.0), wave(lane, 2.0), wave(3 * lane, 4.0)).normalize();
            circles.axes.push(std::array::from_fn(|i| Block(std::array::from_fn(|lane| axis(lane)[i]))));
            let seen = |lane: usize| (k + 3 * lane) % 20 < lane;
            let sine = |lane| if seen(lane) { 0.05 + 0.77 * wave(lane, 5.0).abs().powi(3) } else { 0.0 };
            circles.sines.push(Block(std::array::from_fn(sine)));
            circles.ratios.extend((0..order).map(|l| 1.0 + 0.5 * wave(l, 6.0)));
            blockers.iter_mut().enumerate().for_each(|(lane, count)| *count += u32::from(seen(lane)));
        }
        (circles, blockers)
    }

    fn visibilities<E: Exponential>(params: &Params, circles: &List, blockers: &[u32]) -> (Vec<Block<f32>>, Work) {
        let (method, mut work) = (LogSum::<E>::new(params), Work::default());
        let mut state = method.state();
        let mut visibility = vec![Block::splat(f32::NAN); coefficients(method.order)];
        method.begin(&mut state);
        let List { axes, sines, ratios } = circles;
        for (part, (axes, sines)) in axes.chunks(16).zip(sines.chunks(16)).enumerate() {
            let ratios = ratios.chunks(16 * method.order).nth(part).unwrap_or_default();
            method.block(&mut state, &Circles { axes, sines, ratios, places: &[] });
        }
        let counts = Counts { all: blockers, kept: &[0; LANES][..blockers.len()] };
        method.finish(&mut state, &counts, &mut visibility, &mut work);
        (visibility, work)
    }

    /// The log of the circles in a lane, one after the other from the table.
    fn log(order: usize, List { axes, sines, ratios }: &List, lane: usize) -> Vec<f32> {
        let mut sum = vec![0.0; coefficients(order)];
        let (mut zonal, mut circle) = (vec![0.0; order], sum.clone());
        let all = axes.iter().zip(sines).zip(ratios.chunks_exact(order));
        for ((axis, sine), ratios) in all.filter(|((_, sine), _)| sine.0[lane] > 0.0) {
            CircleTable::log(order).lookup(sine.0[lane], &mut zonal);
            zonal.iter_mut().zip(ratios).for_each(|(value, ratio)| *value *= ratio);
            rotate_zonal(order, &zonal, axis.map(|component| component.0[lane]), &mut circle);
            sum.iter_mut().zip(&circle).for_each(|(sum, log)| *sum += log);
        }
        sum
    }

    fn norm(vector: impl Iterator<Item = f32>) -> f32 {
        vector.map(|value| value * value).sum::<f32>().sqrt()
    }

    /// Each lane is what one vector at a time gives to 1e-3, squarings are as many, and lanes may be reordered.
    fn check<E: Exponential>(single: fn(&mut ExpWorkspace<f32>, &[f32], &mut [f32]) -> sh::Work) {
        for order in 1..=sh::MAX_ORDER {
            let (circles, blockers) = circles(order);
            let params = Params::resolve(E::PARAMS, [("order", order.to_string().as_str())]).expect("in range");
            let (visibility, work) = visibilities::<E>(&params, &circles, &blockers);
            let mut expected = Work { additions: blockers.iter().map(|&n| u64::from(n)).sum(), ..Work::default() };
            for (lane, &count) in blockers.iter().enumerate() {
                let mut want = vec![0.0; coefficients(order)];
                let spent = single(&mut ExpWorkspace::new(order), &log(order, &circles, lane), &mut want);
                if count > 0 {
                    expected.products += u64::from(spent.products);
                    expected.squares += u64::from(spent.squares);
                }
                let error = norm(visibility.iter().zip(&want).map(|(got, want)| got.0[lane] - want));
                assert!(error <= 1e-3 * norm(want.iter().copied()), "order {order}, lane {lane}: {error}");
            }
            assert_eq!(work, expected, "order {order}");

            let turn = |block: &Block<f32>| Block(std::array::from_fn(|lane| block.0[(lane + 5) % LANES]));
            let turned = List {
                axes: circles.axes.iter().map(|axis| axis.each_ref().map(turn)).collect(),
                sines: circles.sines.iter().map(turn).collect(),
                ratios: circles.ratios.clone(),
            };
            let turned_blockers: Vec<u32> = (0..LANES).map(|lane| blockers[(lane + 5) % LANES]).collect();
            let (again, _) = visibilities::<E>(&params, &turned, &turned_blockers);
            assert_eq!(again, visibility.iter().map(turn).collect::<Vec<_>>(), "order {order}");
        }
    }

    #[test]
    fn lanes_are_what_single_receivers_were() {
        check::<PlainSeries>(|exp, log, out| exp.product_series(21, log, out));
        check::<LinearExp>(ExpWorkspace::optimal_linear);
        check::<SeriesExp>(|exp, log, out| exp.scaled_series(2, SquaringRule::default(), log, out));
        check::<HybridExp>(|exp, log, out| exp.hybrid(SquaringRule::default(), log, out));
        check::<EigenExp>(ExpWorkspace::eigen);
    }

    #[test]
    fn receivers_without_circles_see_an_open_sky() {
        let none = List { axes: vec![Default::default()], sines: vec![Block::ZERO], ratios: Vec::new() };
        let params = Params::defaults(HybridExp::PARAMS);
        let (visibility, work) = visibilities::<HybridExp>(&params, &none, &[0; 3]);
        assert_eq!(work, Work::default());
        let (circles, mut blockers) = circles(4);
        blockers[3] = 0;
        let (beside, _) = visibilities::<HybridExp>(&params, &circles, &blockers);
        let sky = (4.0 * std::f32::consts::PI).sqrt();
        for (i, (alone, beside)) in visibility.iter().zip(&beside).enumerate() {
            let want = if i == 0 { sky } else { 0.0 };
            assert_eq!((alone.0[0], beside.0[3]), (want, want));
        }
    }
}
