//! General rotations and those about z.

use halflight_sh::{Real, Rotation, coefficients, rotate_z};

use crate::batches::{batches, lanes, packed, unpacked};
use crate::inputs::{Class, rotations, vectors};
use crate::operation::{ROTATION, ROTATION_Z};
use crate::oracle::Oracle;
use crate::tally::Tally;
use crate::vector::{convert, distance, norm};

/// The rotation about an axis, counter-clockwise seen from its tip; exact near the identity too.
fn matrix([x, y, z]: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let (s, c) = angle.sin_cos();
    let d = 2.0 * (0.5 * angle).sin().powi(2);
    [
        [c + d * x * x, d * x * y - s * z, d * x * z + s * y],
        [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
        [d * x * z - s * y, d * y * z + s * x, c + d * z * z],
    ]
}

/// The rotation of a case applied to a vector.
type One<'a, T> = dyn Fn(usize, &[T], &mut [T]) + 'a;

pub(crate) fn measure<T: Real>(oracle: &Oracle, tally: &mut Tally) {
    let order = tally.order;
    for class in Class::ALL {
        let inputs: Vec<Vec<f64>> = vectors::<T, 1>(order, class).into_iter().map(|[v]| v).collect();
        let turns = rotations(class);
        let want = |(f, &(axis, angle)): (&Vec<f64>, &([f64; 3], f64))| oracle.rotated(&matrix(axis, angle), f);
        let general: Vec<_> = inputs.iter().zip(&turns).map(want).collect();
        let about_z: Vec<_> = inputs.iter().zip(&turns).map(|(f, t)| want((f, &([0.0, 0.0, 1.0], t.1)))).collect();
        let errors = |got: &[Vec<f64>], want: &[Vec<f64>]| -> Vec<f64> {
            got.iter().zip(want).zip(&inputs).map(|((got, want), f)| distance(got, want) / norm(f)).collect()
        };
        let mut out = vec![T::ZERO; coefficients(order)];
        let mut singly = |f: &One<'_, T>| -> Vec<Vec<f64>> {
            let mut one = |(i, v): (usize, &Vec<f64>)| {
                f(i, &convert(v), &mut out);
                crate::vector::widen(&out)
            };
            inputs.iter().enumerate().map(&mut one).collect()
        };
        let turned = |i: usize| Rotation::new(order, matrix(turns[i].0, turns[i].1));
        let got = singly(&|i, v, out| turned(i).apply(v, out));
        tally.add::<T>(&ROTATION, "one", class, &errors(&got, &general));
        let got = singly(&|i, v, out| rotate_z(order, T::from_f64(turns[i].1), v, out));
        tally.add::<T>(&ROTATION_Z, "one", class, &errors(&got, &about_z));

        let blocks = packed::<T>(order, &inputs);
        let angles: Vec<[f64; 2]> = turns.iter().map(|t| [t.1.cos(), t.1.sin()]).collect();
        let mut out = blocks.clone();
        for (name, batch) in batches(order) {
            let one = |i: usize| {
                let input = packed::<T>(order, [&inputs[i]]);
                let mut out = input.clone();
                batch.rotate(&turned(i), &input, &mut out);
                unpacked(order, &out)[0].clone()
            };
            let got: Vec<Vec<f64>> = (0..inputs.len()).map(one).collect();
            tally.add::<T>(&ROTATION, &name, class, &errors(&got, &general));
            batch.rotate_z(&lanes::<T, 2>(&angles), &blocks, &mut out);
            tally.add::<T>(&ROTATION_Z, &name, class, &errors(&unpacked(order, &out), &about_z));
        }
    }
}
