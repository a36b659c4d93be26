//! Products, squares, product matrices and triple products.

use halflight_sh::{Block, LANES, Real, coefficients, gamma};

use crate::batches::{batches, packed, unpacked};
use crate::inputs::{Class, vectors};
use crate::operation::{MATRIX, PRODUCT, SPARSE, SQUARE, TRIPLE};
use crate::oracle::Oracle;
use crate::tally::Tally;
use crate::vector::{convert, distance, norm};

/// An operation on one set of vectors.
type One<'a, T> = dyn Fn(&[Vec<T>; 3], &mut [T]) + 'a;

/// Errors of vectors relative to scales.
fn errors<T: Real>(got: &[Vec<T>], want: &[Vec<f64>], scales: &[f64]) -> Vec<f64> {
    got.iter().zip(want).zip(scales).map(|((got, want), scale)| distance(got, want) / scale).collect()
}

pub(crate) fn measure<T: Real>(oracle: &Oracle, tally: &mut Tally) {
    let order = tally.order;
    let tensor = gamma(order);
    for class in Class::ALL {
        let sets = vectors::<T, 3>(order, class);
        let products: Vec<_> = sets.iter().map(|[a, b, _]| oracle.product(a, b)).collect();
        let squares: Vec<_> = sets.iter().map(|[a, ..]| oracle.product(a, a)).collect();
        let integrals: Vec<_> = sets.iter().map(|[a, b, c]| oracle.triple_product(a, b, c)).collect();
        let scales: Vec<f64> = sets.iter().map(|[a, b, _]| norm(a) * norm(b)).collect();
        let own: Vec<f64> = sets.iter().map(|[a, ..]| norm(a).powi(2)).collect();
        let lengths: Vec<f64> = sets.iter().zip(&scales).map(|([.., c], s)| order as f64 * s * norm(c)).collect();
        let triple_errors = |got: Vec<f64>| -> Vec<f64> {
            got.iter().zip(&integrals).zip(&lengths).map(|((x, want), scale)| (x - want).abs() / scale).collect()
        };
        let singly = |f: &One<'_, T>| -> Vec<Vec<T>> {
            let one = |set: &[Vec<f64>; 3]| {
                let mut out = vec![T::ZERO; coefficients(order)];
                f(&set.each_ref().map(|v| convert(v)), &mut out);
                out
            };
            sets.iter().map(one).collect()
        };

        let looped = singly(&|[a, b, _], out| tensor.product(a, b, out));
        tally.add::<T>(&SPARSE, "one", class, &errors(&looped, &products, &scales));
        let mut matrix = vec![T::ZERO; coefficients(order).pow(2)];
        for (name, batch) in batches(order) {
            let single = name.replace("batch", "one");
            let got = singly(&|[a, b, _], out| batch.single_product(a, b, out));
            tally.add::<T>(&PRODUCT, &single, class, &errors(&got, &products, &scales));
            let got = singly(&|[a, ..], out| batch.single_square(a, out));
            tally.add::<T>(&SQUARE, &single, class, &errors(&got, &squares, &own));
            let one = |[a, b, c]: &[Vec<f64>; 3]| {
                batch.single_triple_product::<T>(&convert(a), &convert(b), &convert(c)).to_f64()
            };
            tally.add::<T>(&TRIPLE, &single, class, &triple_errors(sets.iter().map(one).collect()));

            let [a, b, c] = [0, 1, 2].map(|n| packed::<T>(order, sets.iter().map(|set| &set[n])));
            let mut out = a.clone();
            batch.product(&a, &b, &mut out);
            tally.add::<T>(&PRODUCT, &name, class, &errors(&unpacked(order, &out), &products, &scales));
            batch.square(&a, &mut out);
            tally.add::<T>(&SQUARE, &name, class, &errors(&unpacked(order, &out), &squares, &own));
            let mut sums = vec![Block::<T>::ZERO; sets.len() / LANES];
            batch.triple_product(&a, &b, &c, &mut sums);
            let sums = sums.iter().flat_map(|block| block.0.map(|x| x.to_f64())).collect();
            tally.add::<T>(&TRIPLE, &name, class, &triple_errors(sums));
            let by_matrix: Vec<Vec<f64>> = sets
                .iter()
                .enumerate()
                .map(|(i, [a, ..])| {
                    tensor.product_matrix(&convert::<T>(a), &mut matrix);
                    let group = i / LANES * coefficients(order)..(i / LANES + 1) * coefficients(order);
                    batch.matrix_product(&matrix, &b[group.clone()], &mut out[group.clone()]);
                    unpacked(order, &out[group])[i % LANES].clone()
                })
                .collect();
            tally.add::<T>(&MATRIX, &name, class, &errors(&by_matrix, &products, &scales));
        }
        let [a, b] = [0, 1].map(|n| convert::<T>(&sets.iter().flat_map(|set| set[n].clone()).collect::<Vec<_>>()));
        let mut out = a.clone();
        for (name, batch) in batches(order) {
            batch.product_vectors(&a, &b, &mut out);
            let got: Vec<Vec<T>> = out.chunks_exact(coefficients(order)).map(<[T]>::to_vec).collect();
            tally.add::<T>(&PRODUCT, &name.replace("batch", "vectors"), class, &errors(&got, &products, &scales));
        }
    }
}
