//! Rotations: zonal, general and about z, and the irradiance weights that rest on them.

use crate::common::{constant, convert, distance, dot, norm, unit_vector, vectors};
use halflight_sh::{
    Quadrature, Real, Rotation, apply_bands, circle_visibility, evaluate, irradiance_weights, project, rotate_z,
    rotate_zonal, window,
};
use proptest::prelude::*;

pub(crate) type Matrix = [[f64; 3]; 3];

/// Rotation about a unit axis (Rodrigues).
pub(crate) fn rotation_about([x, y, z]: [f64; 3], angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let d = 1.0 - c;
    [
        [c + d * x * x, d * x * y - s * z, d * x * z + s * y],
        [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
        [d * x * z - s * y, d * y * z + s * x, c + d * z * z],
    ]
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn turn(m: &Matrix, s: [f64; 3]) -> [f64; 3] {
    m.map(|row| dot(&row, &s))
}

fn turn_back(m: &Matrix, s: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|j| (0..3).map(|i| m[i][j] * s[i]).sum())
}

fn apply<T: Real>(order: usize, matrix: Matrix, v: &[f64]) -> Vec<T> {
    let mut out = vec![T::from_f64(f64::NAN); v.len()];
    Rotation::new(order, matrix).apply::<T>(&convert(v), &mut out);
    out
}

fn value(order: usize, v: &[f64], s: [f64; 3]) -> f64 {
    let mut basis = constant(order, 0.0);
    evaluate(order, s, &mut basis);
    dot(&basis, v)
}

/// Angles of every size, tiny ones as likely as large ones.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![-4.0f64..4.0, (-12.0f64..0.0).prop_map(|e| 10f64.powf(e)), Just(0.0), Just(std::f64::consts::PI)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn rotation_evaluates_at_rotated_directions(
        (order, v) in vectors(1), axis in unit_vector(), angle in angle(), s in unit_vector(),
    ) {
        let matrix = rotation_about(axis, angle);
        let want = value(order, &v[0], turn_back(&matrix, s));
        let rotated = apply::<f64>(order, matrix, &v[0]);
        prop_assert!((value(order, &rotated, s) - want).abs() < 1e-12);
        prop_assert!((norm(&rotated) - norm(&v[0])).abs() < 1e-12);
        prop_assert!(distance(&apply::<f32>(order, matrix, &v[0]), &rotated) < 5e-6);
    }

    #[test]
    fn rotations_compose(
        (order, v) in vectors(1), axes in [unit_vector(), unit_vector()], angles in [angle(), angle()],
    ) {
        let [first, second] = [0, 1].map(|k| rotation_about(axes[k], angles[k]));
        let twice = apply::<f64>(order, second, &apply::<f64>(order, first, &v[0]));
        prop_assert!(distance(&twice, &apply::<f64>(order, times(&second, &first), &v[0])) < 1e-12);
    }

    /// The change is first-order in the angle: none is lost to rounding, none is added.
    #[test]
    fn near_identity_moves_in_proportion((order, v) in vectors(1), axis in unit_vector(), e in -10.0f64..-3.0) {
        let angle = 10f64.powf(e);
        let moved = distance(&apply::<f64>(order, rotation_about(axis, angle), &v[0]), &v[0]);
        prop_assert!(moved <= order as f64 * angle * norm(&v[0]) + 1e-13);
        let still = apply::<f32>(order, rotation_about(axis, angle * 1e-3), &v[0]);
        prop_assert!(distance(&still, &v[0]) < 1e-6 * order as f64 * norm(&v[0]).max(1.0));
    }

    #[test]
    fn rotation_about_z_is_the_general_one((order, v) in vectors(1), angle in angle()) {
        let want = apply::<f64>(order, rotation_about([0.0, 0.0, 1.0], angle), &v[0]);
        let mut out = vec![f64::NAN; v[0].len()];
        rotate_z(order, angle, &v[0], &mut out);
        prop_assert!(distance(&out, &want) < 1e-12);
        let mut single = vec![f32::NAN; v[0].len()];
        rotate_z(order, angle as f32, &convert(&v[0]), &mut single);
        prop_assert!(distance(&single, &want) < 2e-5);
    }

    #[test]
    fn zonal_rotation_is_the_projection_of_the_rotated_function(
        order in 1usize..=8, zonal in proptest::collection::vec(-1.0f64..1.0, 8), axis in unit_vector(),
    ) {
        let zonal = &zonal[..order];
        let mut at_pole = constant(order, 0.0);
        rotate_zonal(order, zonal, [0.0, 0.0, 1.0], &mut at_pole);
        for (l, z) in zonal.iter().enumerate() {
            prop_assert!((at_pole[l * l + l] - z).abs() < 1e-14);
        }
        // the function of s is the one about z at an angle with the same cosine
        let f = |s: [f64; 3]| {
            let z = dot(&s, &axis).clamp(-1.0, 1.0);
            value(order, &at_pole, [(1.0 - z * z).sqrt(), 0.0, z])
        };
        let want = project(order, &Quadrature::exact(2 * (order - 1)), f);
        let mut out = vec![f64::NAN; want.len()];
        rotate_zonal(order, zonal, axis, &mut out);
        prop_assert!(distance(&out, &want) < 1e-12);
        let mut single = vec![f32::NAN; want.len()];
        rotate_zonal(order, &convert::<f32>(zonal), axis.map(|x| x as f32), &mut single);
        prop_assert!(distance(&single, &want) < 1e-5);
    }

    /// A sky of 1 gives 1 on every unoccluded receiver, at every order and with every window.
    #[test]
    fn furnace(order in 1usize..=8, normal in unit_vector(), h in 0.5f64..40.0) {
        let mut weights = constant(order, 0.0);
        irradiance_weights(order, normal, &mut weights);
        let mut sky = constant(order, 1.0);
        apply_bands(&window(order, h), &mut sky);
        prop_assert!((dot(&weights, &sky) - 1.0).abs() < 1e-14);
        let mut single = constant::<f32>(order, 0.0);
        irradiance_weights(order, normal.map(|x| x as f32), &mut single);
        prop_assert!((f64::from(single[0]) * crate::common::SQRT_4_PI - 1.0).abs() < 1e-6);
    }

    /// A zonal vector turned to an axis is the general rotation of it.
    #[test]
    fn zonal_and_general_rotation_agree(order in 1usize..=8, degrees in 0.0f64..180.0, axis in unit_vector(), a in angle()) {
        let mut zonal = vec![0.0; order];
        circle_visibility(order, degrees.to_radians().cos(), &mut zonal);
        let (mut pole, mut turned) = (constant(order, 0.0), constant(order, 0.0));
        rotate_zonal(order, &zonal, [0.0, 0.0, 1.0], &mut pole);
        let matrix = rotation_about(axis, a);
        rotate_zonal(order, &zonal, turn(&matrix, [0.0, 0.0, 1.0]), &mut turned);
        prop_assert!(distance(&apply::<f64>(order, matrix, &pole), &turned) < 1e-12);
    }
}

#[test]
fn bands_are_scaled_one_by_one() {
    let mut v = vec![1.0f32; 9];
    apply_bands(&[2.0, 3.0, 5.0], &mut v);
    assert_eq!(v, [2.0, 3.0, 3.0, 3.0, 5.0, 5.0, 5.0, 5.0, 5.0]);
}

#[test]
fn a_rotation_about_z_turns_counter_clockwise() {
    // y_11 is x, y_1-1 is y: a quarter turn takes x to y
    let mut out = [0.0; 4];
    rotate_z(2, std::f64::consts::FRAC_PI_2, &[0.0, 0.0, 0.0, 1.0], &mut out);
    assert!(distance(&out, &[0.0, 1.0, 0.0, 0.0]) < 1e-15);
}
