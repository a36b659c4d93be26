//! Basis functions and zonal rotation.

use halflight_sh::{Block, Real, coefficients, evaluate, rotate_zonal};

use crate::batches::{batches, lanes, unpacked};
use crate::inputs::{COUNT, Class, Numbers, directions};
use crate::operation::{EVALUATE, ZONAL};
use crate::oracle::{Oracle, basis};
use crate::tally::Tally;
use crate::vector::{convert, distance, norm};

/// Zonal vectors: random ones, and for structured input every band alone.
fn zonals<T: Real>(order: usize, class: Class) -> Vec<Vec<f64>> {
    let mut numbers = Numbers::new(81);
    let mut one = |k: usize| -> Vec<f64> {
        let length = if class == Class::Adversarial { 10f64.powf(numbers.between(-12.0, 12.0)) } else { 1.0 };
        let value = |l: usize, x: f64| if class == Class::Structured && l != k % order { 0.0 } else { length * x };
        (0..order).map(|l| T::from_f64(value(l, numbers.between(-1.0, 1.0))).to_f64()).collect()
    };
    (0..COUNT).map(&mut one).collect()
}

pub(crate) fn measure<T: Real>(oracle: &Oracle, tally: &mut Tally) {
    let order = tally.order;
    let mut out = vec![T::ZERO; coefficients(order)];
    for class in Class::ALL {
        let (axes, zonals) = (directions::<T>(class), zonals::<T>(order, class));
        // Rounded directions are not quite unit vectors: the polynomials are judged there, as they are computed.
        let values: Vec<Vec<f64>> = axes
            .iter()
            .map(|&s| {
                let mut y = vec![0.0; coefficients(order)];
                basis(order, s, &mut y);
                y
            })
            .collect();
        let n = order as f64;
        let at = |i: usize| axes[i].map(|x| T::from_f64(x));
        let error = |got: &[T], want: &[f64], scale: f64| distance(got, want) / scale;
        let one = |i: usize, out: &mut [T]| {
            evaluate(order, at(i), out);
            error(out, &values[i], n)
        };
        let singly: Vec<f64> = (0..COUNT).map(|i| one(i, &mut out)).collect();
        tally.add::<T>(&EVALUATE, "one", class, &singly);

        let lobes: Vec<Vec<f64>> = zonals.iter().zip(&axes).map(|(zonal, &s)| oracle.lobe(zonal, unit(s))).collect();
        // what the rounding of the direction adds is not the operation's
        let scales: Vec<f64> = zonals.iter().map(|zonal| n * norm(zonal)).collect();
        let one = |i: usize, out: &mut [T]| {
            rotate_zonal(order, &convert::<T>(&zonals[i]), at(i), out);
            error(out, &lobes[i], scales[i])
        };
        let singly: Vec<f64> = (0..COUNT).map(|i| one(i, &mut out)).collect();
        tally.add::<T>(&ZONAL, "one", class, &singly);

        let blocks = lanes::<T, 3>(&axes);
        let mut zonal_blocks = vec![Block::<T>::ZERO; order * blocks.len()];
        for (i, zonal) in zonals.iter().enumerate() {
            zonal.iter().enumerate().for_each(|(l, x)| zonal_blocks[i / 16 * order + l].0[i % 16] = T::from_f64(*x));
        }
        let mut out = vec![Block::<T>::ZERO; coefficients(order) * blocks.len()];
        for (name, batch) in batches(order) {
            batch.evaluate(&blocks, &mut out);
            let got = unpacked(order, &out);
            let errors: Vec<f64> = got.iter().zip(&values).map(|(got, want)| distance(got, want) / n).collect();
            tally.add::<T>(&EVALUATE, &name, class, &errors);
            batch.rotate_zonal(&zonal_blocks, &blocks, &mut out);
            let got = unpacked(order, &out);
            let errors: Vec<f64> = (0..COUNT).map(|i| distance(&got[i], &lobes[i]) / scales[i]).collect();
            tally.add::<T>(&ZONAL, &name, class, &errors);
        }
    }
}

fn unit(s: [f64; 3]) -> [f64; 3] {
    let length = norm(&s);
    s.map(|x| x / length)
}
