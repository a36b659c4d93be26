//! Batches on every instruction set against the plain loop in double precision, and against the scalar twin.

use crate::common::{convert, distance, dot, norm};
use halflight_sh::{Batch, Block, LANES, Real, Simd, blocks_for, coefficients, gamma, pack, unpack};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Products of vectors without pattern err by at most this many units in the last place of `‖a‖‖b‖`, 2e-7 in single precision,
/// and by half as much again at order 8. Lobes, the worst, are judged in `halflight-sh-accuracy`.
const ERROR_ULPS: f64 = 1.68;

/// Results of two instruction sets differ by at most this many units in the last place of `‖a‖‖b‖`.
const TWIN_ULPS: f64 = 8.0;

pub(crate) fn instruction_sets(order: usize) -> Vec<Batch> {
    Simd::ALL.into_iter().filter_map(|simd| Batch::with_simd(order, simd)).collect()
}

pub(crate) fn packed<T: Real>(order: usize, vectors: &[Vec<f64>]) -> Vec<Block<T>> {
    let mut blocks = vec![Block::ZERO; blocks_for(order, vectors.len())];
    pack(order, &convert::<T>(&vectors.concat()), &mut blocks);
    blocks
}

pub(crate) fn unpacked<T: Real>(order: usize, blocks: &[Block<T>], count: usize) -> Vec<Vec<f64>> {
    let mut vectors = vec![T::ZERO; count * coefficients(order)];
    unpack(order, blocks, &mut vectors);
    vectors.chunks_exact(coefficients(order)).map(|v| v.iter().map(|x| x.to_f64()).collect()).collect()
}

/// An order and two lists of as many vectors, with lengths from 1e-3 to 1e3.
fn pairs() -> impl Strategy<Value = (usize, Vec<Vec<f64>>, Vec<Vec<f64>>)> {
    (1usize..=8, 1usize..40).prop_flat_map(|(order, count)| {
        let vector = (proptest::collection::vec(-1.0f64..1.0, coefficients(order)), -3.0f64..3.0)
            .prop_map(|(v, e)| v.iter().map(|x| x * 10f64.powf(e)).collect::<Vec<_>>());
        let list = proptest::collection::vec(vector, count);
        (Just(order), list.clone(), list)
    })
}

fn within<T: Real>(what: &str, got: &[T], want: &[f64], bound: f64, batch: &Batch) -> Result<(), TestCaseError> {
    let error = distance(got, want);
    prop_assert!(
        error <= bound,
        "{} at order {}, {:?}: {:e} over {:e}",
        what,
        batch.order(),
        batch.simd(),
        error,
        bound
    );
    Ok(())
}

fn check<T: Real>(order: usize, a: &[Vec<f64>], b: &[Vec<f64>]) -> Result<(), TestCaseError> {
    let (left, right) = (packed::<T>(order, a), packed::<T>(order, b));
    let wide = |v: &Vec<f64>| convert::<T>(v).iter().map(|x| x.to_f64()).collect::<Vec<_>>();
    // In double precision the plain loop, whose table errs by 1e-15, errs more than what it judges.
    let ulps = if T::EPSILON.to_f64() > 1e-10 { ERROR_ULPS } else { 16.0 };
    let error = ulps * T::EPSILON.to_f64() * if order == 8 { 1.5 } else { 1.0 };
    let mut twin: Option<[Vec<Vec<f64>>; 2]> = None;
    for batch in instruction_sets(order) {
        let mut out = vec![Block::splat(T::from_f64(f64::NAN)); left.len()];
        batch.product(&left, &right, &mut out);
        let products = unpacked(order, &out, a.len());
        batch.square(&left, &mut out);
        let squares = unpacked(order, &out, a.len());
        let mut triples = vec![Block::ZERO; left.len() / coefficients(order)];
        batch.triple_product(&left, &right, &left, &mut triples);
        let mut matrix = vec![T::ZERO; coefficients(order).pow(2)];
        gamma(order).product_matrix(&convert::<T>(&a[0]), &mut matrix);
        batch.matrix_product(&matrix, &right, &mut out);
        let by_matrix = unpacked(order, &out, b.len());
        let first = convert::<T>(&a[0]);
        let dots: Vec<Block<T>> = right.chunks_exact(first.len()).map(|b| batch.dot(&first, b)).collect();
        let mut vectors = convert::<T>(&a.concat());
        batch.product_vectors(&convert::<T>(&a.concat()), &convert(&b.concat()), &mut vectors);
        for (i, (x, y)) in a.iter().zip(b).enumerate() {
            let (mut product, mut square) = (x.clone(), x.clone());
            gamma(order).product(&wide(x), &wide(y), &mut product);
            gamma(order).square(&wide(x), &mut square);
            let (scale, own) = (norm(x) * norm(y), norm(x) * norm(x));
            within("product", &products[i], &product, error * scale, &batch)?;
            within("square", &squares[i], &square, error * own, &batch)?;
            let size = x.len();
            let (integral, length) = (dot(&product, &wide(x)), own * norm(y) * order as f64);
            let triple = triples[i / LANES].0[i % LANES].to_f64();
            prop_assert!((triple - integral).abs() <= 4.0 * T::EPSILON.to_f64() * length, "{triple} for {integral}");
            let (got, want) = (dots[i / LANES].0[i % LANES].to_f64(), dot(&wide(&a[0]), &wide(y)));
            prop_assert!((got - want).abs() <= 4.0 * T::EPSILON.to_f64() * norm(&a[0]) * norm(y), "{got} for {want}");
            let single = batch.single_triple_product(&convert::<T>(x), &convert(y), &convert(x)).to_f64();
            prop_assert!((single - integral).abs() <= 4.0 * T::EPSILON.to_f64() * length, "{single} for {integral}");
            let mut first = x.clone();
            gamma(order).product(&wide(&a[0]), &wide(y), &mut first);
            within("matrix product", &by_matrix[i], &first, 4.0 * error * norm(&a[0]) * norm(y), &batch)?;
            prop_assert!(vectors[i * size..(i + 1) * size] == convert::<T>(&products[i]));
            let mut single = convert::<T>(x);
            batch.single_product(&convert::<T>(x), &convert(y), &mut single);
            within("single product", &single, &product, error * scale, &batch)?;
            batch.single_square(&convert::<T>(x), &mut single);
            within("single square", &single, &square, error * own, &batch)?;
            if let Some([twin_products, twin_squares]) = &twin {
                let ulps = TWIN_ULPS * T::EPSILON.to_f64();
                prop_assert!(distance(&products[i], &twin_products[i]) <= ulps * scale);
                prop_assert!(distance(&squares[i], &twin_squares[i]) <= ulps * own);
            }
        }
        twin.get_or_insert([products, squares]);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn batches_are_the_plain_products((order, a, b) in pairs()) {
        check::<f32>(order, &a, &b)?;
        check::<f64>(order, &a, &b)?;
    }

    #[test]
    fn packing_is_undone_by_unpacking((order, a, _) in pairs()) {
        prop_assert_eq!(&unpacked(order, &packed::<f64>(order, &a), a.len()), &a);
        let blocks = packed::<f64>(order, &a);
        for (i, v) in a.iter().enumerate() {
            for (k, x) in v.iter().enumerate() {
                prop_assert_eq!(blocks[i / LANES * v.len() + k].0[i % LANES], *x);
            }
        }
    }
}

#[test]
fn a_lane_does_not_depend_on_its_neighbours() {
    for order in 1..=8 {
        for batch in instruction_sets(order) {
            let v: Vec<f64> = (0..order * order).map(|i| (i as f64).cos()).collect();
            let alone = packed::<f32>(order, std::slice::from_ref(&v));
            let crowd: Vec<Block<f32>> = alone
                .iter()
                .map(|b| Block([[b.0[0]; 1].repeat(15), vec![1e20]].concat().try_into().expect("16")))
                .collect();
            let (mut a, mut b) = (alone.clone(), alone.clone());
            batch.product(&alone, &alone, &mut a);
            batch.product(&crowd, &crowd, &mut b);
            assert!(a.iter().zip(&b).all(|(a, b)| a.0[0] == b.0[0] && b.0[..15].iter().all(|x| *x == b.0[0])));
        }
    }
}

#[test]
fn lanes_above_a_bound_are_replaced() {
    for batch in instruction_sets(2) {
        let values = Block(std::array::from_fn(|lane| [1.0f32, 2.0, f32::NAN, 3.0][lane % 4]));
        let mut out = [Block::splat(7.0); 4];
        batch.replace_above(1.0, &values, &[Block::splat(8.0); 4], &mut out);
        let want = Block(std::array::from_fn(|lane| if lane % 2 == 1 { 8.0 } else { 7.0 }));
        assert!(out.iter().all(|block| *block == want), "{:?}", batch.simd());
    }
}

#[test]
#[should_panic(expected = "batches of [9, 18] and 9 blocks")]
fn batches_of_different_size_are_refused() {
    let blocks = [Block::<f32>::ZERO; 18];
    Batch::new(3).product(&blocks[..9], &blocks, &mut [Block::ZERO; 9]);
}
