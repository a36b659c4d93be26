//! Batched evaluation, rotations, circles and exponentials against the functions for one vector.

use crate::batches::{instruction_sets, packed, unpacked};
use crate::common::{blockers, convert, distance, norm, scaled, sum, unit_vector, vectors};
use halflight_sh::{
    Batch, BatchExp, Block, ExpWorkspace, LANES, Real, Rotation, SquaringRule, Work, circle_log, circle_visibility,
    coefficients, evaluate, rotate_z, rotate_zonal,
};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

/// Blocks of x, of y and of z.
fn direction_blocks<T: Real>(directions: &[[f64; 3]]) -> Vec<[Block<T>; 3]> {
    let group = |group: &[[f64; 3]]| {
        std::array::from_fn(|axis| {
            Block(std::array::from_fn(|lane| T::from_f64(group.get(lane).map_or(0.0, |direction| direction[axis]))))
        })
    };
    directions.chunks(LANES).map(group).collect()
}

/// Whether both are the same up to `ulps` units in the last place of `scale`.
fn close<T: Real>(got: &[f64], want: &[T], scale: f64, ulps: f64) -> Result<(), TestCaseError> {
    let error = distance(got, want);
    prop_assert!(error <= ulps * T::EPSILON.to_f64() * scale, "{error:e} at scale {scale:e}");
    Ok(())
}

fn check_basis<T: Real>(order: usize, directions: &[[f64; 3]], zonal: &[Vec<f64>]) -> Result<(), TestCaseError> {
    let blocks = direction_blocks::<T>(directions);
    let mut zonal_blocks = vec![Block::<T>::ZERO; order * blocks.len()];
    for (i, v) in zonal.iter().enumerate() {
        v.iter().enumerate().for_each(|(l, x)| zonal_blocks[i / LANES * order + l].0[i % LANES] = T::from_f64(*x));
    }
    for batch in instruction_sets(order) {
        let mut out = vec![Block::splat(T::from_f64(f64::NAN)); coefficients(order) * blocks.len()];
        batch.evaluate(&blocks, &mut out);
        let basis = unpacked(order, &out, directions.len());
        batch.rotate_zonal(&zonal_blocks, &blocks, &mut out);
        let lobes = unpacked(order, &out, directions.len());
        let lobe = &mut out[..coefficients(order)];
        batch.sum_zonal(&zonal_blocks, &blocks, lobe);
        let sums = unpacked(order, lobe, LANES.min(directions.len()));
        let mut totals: Vec<Vec<f64>> = lobes[..sums.len()].to_vec(); // what `lobe` held before
        for (i, (direction, zonal)) in directions.iter().zip(zonal).enumerate() {
            let (direction, zonal) = (direction.map(|x| T::from_f64(x).to_f64()), convert::<T>(zonal));
            let zonal: Vec<f64> = zonal.iter().map(|x| x.to_f64()).collect();
            let mut want = vec![0.0; coefficients(order)];
            evaluate(order, direction, &mut want);
            close(&basis[i], &convert::<T>(&want), order as f64, 4.0)?;
            rotate_zonal(order, &zonal, direction, &mut want);
            close(&lobes[i], &convert::<T>(&want), order as f64 * norm(&zonal), 4.0)?;
            totals[i % LANES].iter_mut().zip(&want).for_each(|(total, value)| *total += value);
        }
        let longest = zonal.iter().fold(0.0f64, |longest, zonal| longest.max(norm(zonal)));
        for (sum, total) in sums.iter().zip(&totals) {
            close(sum, &convert::<T>(total), order as f64 * longest, 16.0)?;
        }
    }
    Ok(())
}

fn check_rotation<T: Real>(order: usize, v: &[f64], angles: &[f64]) -> Result<(), TestCaseError> {
    let blocks: Vec<[Block<T>; 2]> = angles
        .chunks(LANES)
        .map(|group| {
            let of = |f: fn(f64) -> f64| {
                Block(std::array::from_fn(|lane| T::from_f64(f(group.get(lane).copied().unwrap_or(0.0)))))
            };
            [of(f64::cos), of(f64::sin)]
        })
        .collect();
    let input = packed::<T>(order, &vec![v.to_vec(); angles.len()]);
    for batch in instruction_sets(order) {
        let mut out = input.clone();
        batch.rotate_z(&blocks, &input, &mut out);
        for (got, &angle) in unpacked(order, &out, angles.len()).iter().zip(angles) {
            let mut want = v.to_vec();
            rotate_z(order, angle, v, &mut want);
            close(got, &convert::<T>(&want), norm(v), 8.0)?;
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn basis_and_lobes(order in 1usize..=8, directions in proptest::collection::vec(unit_vector(), 1..36), e in -2.0f64..2.0) {
        let zonal: Vec<Vec<f64>> = (0..directions.len())
            .map(|i| (0..order).map(|l| 10f64.powf(e) * (i as f64 + 1.7 * l as f64).sin()).collect())
            .collect();
        check_basis::<f32>(order, &directions, &zonal)?;
        check_basis::<f64>(order, &directions, &zonal)?;
    }

    #[test]
    fn rotations_about_z((order, v) in vectors(1), angles in proptest::collection::vec(-7.0f64..7.0, 1..36)) {
        check_rotation::<f32>(order, &v[0], &angles)?;
        check_rotation::<f64>(order, &v[0], &angles)?;
    }

    #[test]
    fn general_rotations((order, v) in vectors(18), axis in unit_vector(), e in -9.0f64..0.6) {
        let rotation = Rotation::new(order, crate::rotations::rotation_about(axis, 10f64.powf(e)));
        let input = packed::<f32>(order, &v);
        for batch in instruction_sets(order) {
            let mut out = input.clone();
            batch.rotate(&rotation, &input, &mut out);
            for (got, v) in unpacked(order, &out, v.len()).iter().zip(&v) {
                let mut want = v.clone();
                rotation.apply(v, &mut want);
                prop_assert!(distance(got, &want) <= 1e-6 * norm(v), "{:?}, order {order}", batch.simd());
            }
        }
    }

    #[test]
    fn rotations_of_their_own(
        (order, v) in vectors(18), axes in proptest::collection::vec(unit_vector(), 18), e in -9.0f64..0.6,
    ) {
        // angles of every size, and the half turns about all axes, whose α and γ are badly determined as well
        let angle = |i: usize| if i % 6 == 5 { std::f64::consts::PI - 10f64.powf(e - 3.0) } else { 10f64.powf(e - i as f64 / 3.0) };
        let axis = |i: usize| if i % 7 == 6 { [0.0, 0.0, 1.0] } else { axes[i] };
        let matrices: Vec<_> = (0..v.len()).map(|i| crate::rotations::rotation_about(axis(i), angle(i))).collect();
        check_rotate_each::<f32>(order, &v, &matrices, 1e-6)?;
        check_rotate_each::<f64>(order, &v, &matrices, 1e-14)?;
    }

    #[test]
    fn exponentials_are_those_of_single_vectors(sets in proptest::collection::vec(blockers(), 20), factor in -0.2f64..3.0) {
        let order = sets[0].0;
        let logs: Vec<Vec<f64>> = sets
            .iter()
            .filter(|set| set.0 == order)
            .map(|set| scaled(&sum(order, set.1.iter().map(|blocker| &blocker.1)), factor))
            .collect();
        check_exponentials::<f32>(order, &logs, 3e-4)?;
        check_exponentials::<f64>(order, &logs, 3e-4)?;
    }
}

fn check_rotate_each<T: Real>(
    order: usize,
    v: &[Vec<f64>],
    matrices: &[[[f64; 3]; 3]],
    bound: f64,
) -> Result<(), TestCaseError> {
    let entry = |i: usize, row: usize, column: usize| matrices.get(i).map_or(0.0, |matrix| matrix[row][column]);
    let block = |group: usize, row, column| {
        Block(std::array::from_fn(|lane| T::from_f64(entry(group * LANES + lane, row, column))))
    };
    let blocks: Vec<[[Block<T>; 3]; 3]> = (0..v.len().div_ceil(LANES))
        .map(|group| std::array::from_fn(|row| std::array::from_fn(|column| block(group, row, column))))
        .collect();
    let input = packed::<T>(order, v);
    for batch in instruction_sets(order) {
        let mut out = input.clone();
        batch.rotate_each(&blocks, &input, &mut out);
        for ((got, v), matrix) in unpacked(order, &out, v.len()).iter().zip(v).zip(matrices) {
            let mut want = v.clone();
            Rotation::new(order, *matrix).apply(v, &mut want);
            let error = distance(got, &want) / norm(v);
            prop_assert!(error <= bound, "{:?}, order {order}: {error:e}", batch.simd());
        }
    }
    Ok(())
}

type Variant<T> = fn(&mut BatchExp<T>, &[Block<T>], &mut [Block<T>], &mut [Work]);
type Single<T> = fn(&mut ExpWorkspace<T>, &[T], &mut [T]) -> Work;

fn check_exponentials<T: Real>(order: usize, logs: &[Vec<f64>], tolerance: f64) -> Result<(), TestCaseError> {
    let variants: [(&str, Variant<T>, Single<T>); 7] = [
        (
            "hyb",
            |b, f, o, w| b.hybrid(SquaringRule::default(), f, o, w),
            |e, f, o| e.hybrid(SquaringRule::default(), f, o),
        ),
        ("ol", BatchExp::optimal_linear, ExpWorkspace::optimal_linear),
        (
            "ps*-2",
            |b, f, o, w| b.scaled_series(2, SquaringRule::default(), f, o, w),
            |e, f, o| e.scaled_series(2, SquaringRule::default(), f, o),
        ),
        (
            "ps*-5",
            |b, f, o, w| b.scaled_series(5, SquaringRule::default(), f, o, w),
            |e, f, o| e.scaled_series(5, SquaringRule::default(), f, o),
        ),
        ("ps-1", |b, f, o, w| b.product_series(1, f, o, w), |e, f, o| e.product_series(1, f, o)),
        ("ps-6", |b, f, o, w| b.product_series(6, f, o, w), |e, f, o| e.product_series(6, f, o)),
        ("eigen", BatchExp::eigen, ExpWorkspace::eigen),
    ];
    let input = packed::<T>(order, logs);
    for batch in instruction_sets(order) {
        for (name, variant, single) in variants {
            let mut exp = BatchExp::<T>::new(batch);
            let mut out = input.clone();
            let mut work = vec![Work::default(); logs.len()];
            variant(&mut exp, &input, &mut out, &mut work);
            let got = unpacked(order, &out, logs.len());
            for (i, log) in logs.iter().enumerate() {
                let f = convert::<T>(log);
                let mut want = f.clone();
                let spent = single(&mut ExpWorkspace::new(order), &f, &mut want);
                prop_assert!(got[i].iter().all(|x| x.is_finite()));
                // A norm that rounds to the other side of a power of two is squared once more or less.
                if work[i] == spent {
                    let (error, scale) = (distance(&got[i], &want), norm(&want).max(1e-30));
                    prop_assert!(
                        error <= tolerance * scale,
                        "{name}, order {order}, {:?}: {:e}",
                        batch.simd(),
                        error / scale
                    );
                }
            }
        }
    }
    Ok(())
}

/// Without eigenvectors it is the same sum: vectors of every length, those that are left to eigenvectors among them.
#[test]
fn eigen_in_lanes_is_eigen_of_single_vectors() {
    for order in 1..=8 {
        let vectors: Vec<Vec<f64>> = (0..40)
            .map(|k| {
                let v: Vec<f64> = (0..order * order).map(|i| (f64::from(i as u32 * 7 + k) + 0.5).sin()).collect();
                let v = scaled(&v, 10f64.powf(f64::from(k) / 10.0 - 2.5) / norm(&v));
                convert::<f32>(&v).into_iter().map(f64::from).collect()
            })
            .collect();
        let input = packed::<f32>(order, &vectors);
        for batch in instruction_sets(order) {
            let mut out = vec![Block::splat(f32::NAN); input.len()];
            BatchExp::new(batch).eigen(&input, &mut out, &mut [Work::default(); 40]);
            for (got, v) in unpacked(order, &out, vectors.len()).iter().zip(&vectors) {
                let mut want = v.clone();
                ExpWorkspace::new(order).eigen(v, &mut want);
                let error = distance(got, &want) / norm(&want);
                assert!(error < 2e-7, "order {order}, length {}, {:?}: {error:e}", norm(v), batch.simd());
            }
        }
    }
}

/// The stated errors of circle lookups, and their ends.
#[test]
fn circles_keep_their_stated_errors() {
    for order in 1..=8 {
        let sines: Vec<f64> =
            (0..1536).map(|k| f64::from((f64::from(k) / 1535.0 * std::f64::consts::FRAC_PI_2).sin() as f32)).collect();
        let mut none = vec![Block::splat(f32::NAN); order];
        Batch::new(order)
            .circle_logs(&[Block([0.0, -1.0, f32::NAN, -0.0].repeat(4).try_into().expect("16"))], &mut none);
        assert!(none.iter().all(|block| *block == Block::ZERO));
        let mut worst = [0.0f64; 2];
        let batch = Batch::new(order);
        for sines in sines.chunks_exact(LANES) {
            let block = Block::<f32>(std::array::from_fn(|lane| sines[lane] as f32));
            let [mut logs, mut visibilities] = [0; 2].map(|_| vec![Block::ZERO; order]);
            batch.circle_logs(&[block], &mut logs);
            batch.circle_visibilities(&[block], &mut visibilities);
            for (lane, sine) in sines.iter().enumerate() {
                let mut want = vec![0.0; order];
                let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
                circle_log(order, cosine, &mut want);
                let scale = want.iter().fold(1.0f64, |m, v| m.max(v.abs()));
                let error = |got: &[Block<f32>], want: &[f64]| {
                    got.iter().zip(want).fold(0.0f64, |m, (g, w)| m.max((f64::from(g.0[lane]) - w).abs()))
                };
                worst[0] = worst[0].max(error(&logs, &want) / scale);
                circle_visibility(order, cosine, &mut want);
                worst[1] = worst[1].max(error(&visibilities, &want));
            }
        }
        let stated = [[2e-6, 5e-6, 1e-4][order.max(6) - 6], 1e-6];
        assert!(worst.iter().zip(stated).all(|(w, s)| *w < s), "order {order}: {worst:?} over {stated:?}");
    }
}

/// Against what the same circle leaves of the sphere and, for circles too small for that difference, against their solid angle.
#[test]
fn circles_of_light_are_what_circles_block() {
    for order in 1..=8 {
        for batch in instruction_sets(order) {
            for exponent in 0..60 {
                let sine = f64::from(2f32.powf(-0.5 * exponent as f32));
                let mut light = vec![Block::<f32>::ZERO; order];
                batch.circle_lights(&[Block::splat(sine as f32)], &mut light);
                let cosine = ((1.0 - sine) * (1.0 + sine)).sqrt();
                let height = sine * sine / (1.0 + cosine);
                let mut visible = vec![0.0; order];
                circle_visibility(order, cosine, &mut visible);
                for (l, light) in light.iter().enumerate() {
                    let bound = (std::f64::consts::PI * (2 * l + 1) as f64).sqrt() * height;
                    let want = match (l, sine > 3e-5) {
                        (0, true) => 2.0 * std::f64::consts::PI.sqrt() - visible[0],
                        (_, true) => -visible[l],
                        (_, false) => bound,
                    };
                    assert!(
                        light.0.iter().all(|value| (f64::from(*value) - want).abs() < 4e-6 * bound),
                        "{order} {l} {sine}"
                    );
                }
            }
        }
    }
}

#[test]
fn extreme_vectors_stay_finite_in_lanes() {
    for order in 1..=8 {
        for batch in instruction_sets(order) {
            for length in [0.0, 1e-30, 1e-3, 30.0, 1e4, 1e20] {
                let vectors: Vec<Vec<f64>> = (0..20)
                    .map(|k| {
                        let v: Vec<f64> =
                            (0..order * order).map(|i| (f64::from(i as u32 * 7 + k) + 0.5).sin()).collect();
                        scaled(&v, length / norm(&v))
                    })
                    .collect();
                let input = packed::<f32>(order, &vectors);
                let mut out = input.clone();
                let mut work = vec![Work::default(); 20];
                let mut exp = BatchExp::new(batch);
                exp.hybrid(SquaringRule::default(), &input, &mut out, &mut work);
                assert!(out.iter().all(|block| block.0.iter().all(|x| x.is_finite())));
                exp.scaled_series(3, SquaringRule::default(), &input, &mut out, &mut work);
                assert!(out.iter().all(|block| block.0.iter().all(|x| x.is_finite())));
                exp.product_series(9, &input, &mut out, &mut work);
                assert!(out.iter().all(|block| block.0.iter().all(|x| x.is_finite())));
                exp.optimal_linear(&input, &mut out, &mut work);
                assert!(out.iter().all(|block| block.0.iter().all(|x| x.is_finite())));
            }
        }
    }
}
