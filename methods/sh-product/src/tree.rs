//! The product by pairs, 16 receivers side by side.

use halflight_blockers::{Accumulator, Circles, Work, blocker_params, fill_open, params};
use halflight_contract::{ParamSpec, Params};
use halflight_sh::{Batch, Block, LANES, coefficients};

/// Product of circle visibilities over a binary tree: neighbours among the blockers are multiplied, then pairs of them, and so on. The
/// tree is that of all blockers, whichever a receiver sees: those that it does not see are open sky, which changes no product, so that a
/// receiver's result does not depend on its company.
pub(crate) struct TreeProduct {
    batch: Batch,
}

/// The product below a node.
struct Node {
    /// Leaves below have a place of `[place, place + 1)·2^level` among all blockers.
    level: u32,
    place: u32,
    product: Vec<Block<f32>>,
    /// 1 in lanes that see some leaf below, 0 in others, whose product means nothing.
    seen: Block<f32>,
}

/// The nodes that wait for their neighbours, places ascending and levels descending, and scratch.
pub(crate) struct State {
    waiting: Vec<Node>,
    free: Vec<Vec<Block<f32>>>,
    zonal: Vec<Block<f32>>,
}

impl TreeProduct {
    /// The product of two neighbours, in each lane of what it sees.
    fn joined(&self, left: Node, right: Node, free: &mut Vec<Vec<Block<f32>>>) -> Node {
        let mut product = free.pop().unwrap_or_else(|| vec![Block::ZERO; coefficients(self.batch.order())]);
        self.batch.product(&left.product, &right.product, &mut product);
        let lone = |this: &Block<f32>, other: &Block<f32>| {
            Block(std::array::from_fn(|lane| this.0[lane] * (1.0 - other.0[lane])))
        };
        for (this, other) in [(&left, &right), (&right, &left)] {
            self.batch.replace_above(0.0, &lone(&this.seen, &other.seen), &this.product, &mut product);
        }
        let seen = Block(std::array::from_fn(|lane| left.seen.0[lane].max(right.seen.0[lane])));
        free.extend([left.product, right.product]);
        Node { level: left.level, place: left.place, product, seen }
    }

    /// Joins waiting nodes until the last one is a left child, or has no neighbour, or a leaf at `next` may still come below its parent.
    fn climb(&self, state: &mut State, next: Option<u32>) {
        while let Some(mut last) = state.waiting.pop() {
            let parent = (last.level + 1, last.place >> 1);
            if next.is_some_and(|next| next >> parent.0 == parent.1) || (next.is_none() && state.waiting.is_empty()) {
                state.waiting.push(last);
                return;
            }
            // All leaves below the parent are known: it takes the place of its one or two children.
            if state.waiting.last().is_some_and(|left| (left.level, left.place >> 1) == (last.level, parent.1)) {
                let left = state.waiting.pop().expect("there is one");
                last = self.joined(left, last, &mut state.free);
            }
            (last.level, last.place) = parent;
            state.waiting.push(last);
        }
    }
}

impl Accumulator for TreeProduct {
    type State = State;
    const PARAMS: &'static [ParamSpec] = blocker_params!();

    fn new(params: &Params) -> Self {
        TreeProduct { batch: Batch::new(params::accumulated_order(params)) }
    }

    fn state(&self) -> State {
        State { waiting: Vec::new(), free: Vec::new(), zonal: vec![Block::ZERO; self.batch.order()] }
    }

    fn begin(&self, state: &mut State) {
        state.free.extend(state.waiting.drain(..).map(|node| node.product));
    }

    fn block(&self, state: &mut State, Circles { axes, sines, places, .. }: &Circles<'_>) {
        for ((axis, sine), place) in axes.iter().zip(*sines).zip(*places) {
            self.climb(state, Some(*place));
            let mut product = state.free.pop().unwrap_or_else(|| vec![Block::ZERO; coefficients(self.batch.order())]);
            self.batch.circle_visibilities(std::slice::from_ref(sine), &mut state.zonal);
            self.batch.rotate_zonal(&state.zonal, std::slice::from_ref(axis), &mut product);
            let seen = Block(sine.0.map(|sine| if sine > 0.0 { 1.0 } else { 0.0 }));
            state.waiting.push(Node { level: 0, place: *place, product, seen });
        }
    }

    fn finish(&self, state: &mut State, blockers: &[u32], visibility: &mut [Block<f32>], work: &mut Work) {
        self.climb(state, None);
        (0..LANES).for_each(|lane| fill_open(visibility, lane));
        if let Some(root) = state.waiting.last() {
            self.batch.replace_above(0.0, &root.seen, &root.product, visibility);
        }
        work.products += blockers.iter().map(|&count| u64::from(count.saturating_sub(1))).sum::<u64>();
    }
}

#[cfg(test)]
mod tests {
    use halflight_sh::{CircleTable, gamma, rotate_zonal};

    use super::*;

    /// Circles of their own.
    #[derive(Default)]
    struct List {
        axes: Vec<[Block<f32>; 3]>,
        sines: Vec<Block<f32>>,
        places: Vec<u32>,
    }

    impl List {
        fn part(&self, part: std::ops::Range<usize>) -> Circles<'_> {
            let List { axes, sines, places } = self;
            Circles { axes: &axes[part.clone()], sines: &sines[part.clone()], places: &places[part], ratios: &[] }
        }
    }

    /// Receivers that see from none to all of 37 circles, and the places of these among 60.
    fn circles() -> (List, [u32; LANES]) {
        let (mut circles, mut blockers) = (List::default(), [0; LANES]);
        for k in 0..37usize {
            let wave = |lane: usize, phase: f32| ((31 * k + 7 * lane) as f32 + phase).sin();
            let axis = |lane| glam::Vec3::new(wave(lane, 0.0), wave(lane, 2.0), wave(3 * lane, 4.0)).normalize();
            circles.axes.push(std::array::from_fn(|i| Block(std::array::from_fn(|lane| axis(lane)[i]))));
            let seen = |lane: usize| (k + 3 * lane) % 15 < lane;
            let sine = |lane| if seen(lane) { 0.05 + 0.3 * wave(lane, 5.0).abs() } else { 0.0 };
            circles.sines.push(Block(std::array::from_fn(sine)));
            circles.places.push((k + k / 3 + 3 * (k / 11)) as u32);
            blockers.iter_mut().enumerate().for_each(|(lane, count)| *count += u32::from(seen(lane)));
        }
        (circles, blockers)
    }

    /// The product of a lane's circles with places in `[first, first + count)`, `count` a power of two, by recursion; and the norm of
    /// the longest vector on the way.
    fn product(order: usize, circles: &List, lane: usize, first: u32, count: u32) -> Option<(Vec<f32>, f32)> {
        if count == 1 {
            let index = circles.places.iter().position(|place| *place == first)?;
            let sine = circles.sines[index].0[lane];
            let (mut zonal, mut circle) = (vec![0.0; order], vec![0.0; coefficients(order)]);
            CircleTable::visibility(order).lookup(sine, &mut zonal);
            let axis = circles.axes[index].map(|component| component.0[lane]);
            rotate_zonal(order, &zonal, axis, &mut circle);
            let length = norm(circle.iter().copied());
            return (sine > 0.0).then_some((circle, length));
        }
        let half = count / 2;
        match [first, first + half].map(|first| product(order, circles, lane, first, half)) {
            [Some((left, a)), Some((right, b))] => {
                let mut both = vec![0.0; coefficients(order)];
                gamma(order).product(&left, &right, &mut both);
                let length = norm(both.iter().copied());
                Some((both, length.max(a).max(b)))
            }
            [left, right] => left.or(right),
        }
    }

    fn norm(vector: impl Iterator<Item = f32>) -> f32 {
        vector.map(|value| value * value).sum::<f32>().sqrt()
    }

    #[test]
    fn lanes_are_products_over_the_tree_of_all_blockers() {
        let (circles, blockers) = circles();
        for order in 1..=halflight_sh::MAX_ORDER {
            let params = Params::resolve(TreeProduct::PARAMS, [("order", order.to_string().as_str())]);
            let method = TreeProduct::new(&params.expect("in range"));
            let (mut state, mut work) = (method.state(), Work::default());
            let mut visibility = vec![Block::splat(f32::NAN); coefficients(order)];
            for _ in 0..2 {
                method.begin(&mut state);
                for start in (0..circles.sines.len()).step_by(16) {
                    let part = start..(start + 16).min(circles.sines.len());
                    method.block(&mut state, &circles.part(part));
                }
                method.finish(&mut state, &blockers, &mut visibility, &mut work);
            }
            for (lane, count) in blockers.iter().enumerate() {
                let mut open = vec![0.0; coefficients(order)];
                open[0] = (4.0 * std::f32::consts::PI).sqrt();
                let (want, longest) = product(order, &circles, lane, 0, 64).unwrap_or((open, 1.0));
                let error = norm(visibility.iter().zip(&want).map(|(got, want)| got.0[lane] - want));
                assert!(error <= 2e-5 * longest, "order {order}, lane {lane}, {count} circles: {error} of {longest}");
            }
            let products: u64 = blockers.iter().map(|&count| u64::from(count.saturating_sub(1))).sum();
            assert_eq!(work, Work { products: 2 * products, ..Work::default() });
            // No circle that another lane alone sees changes a lane's bits.
            let seen: Vec<usize> = (0..37).filter(|&k| circles.sines[k].0[9] > 0.0).collect();
            let few = List {
                axes: seen.iter().map(|k| circles.axes[*k].map(|axis| Block::splat(axis.0[9]))).collect(),
                sines: seen.iter().map(|k| Block::splat(circles.sines[*k].0[9])).collect(),
                places: seen.iter().map(|k| circles.places[*k]).collect(),
            };
            let mut again = vec![Block::ZERO; coefficients(order)];
            method.begin(&mut state);
            method.block(&mut state, &few.part(0..seen.len()));
            method.finish(&mut state, &[seen.len() as u32; 1], &mut again, &mut work);
            assert!(visibility.iter().zip(&again).all(|(a, b)| a.0[9] == b.0[0]), "order {order}");
        }
    }
}
