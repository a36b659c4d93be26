//! The exponentials against the whole product series, which they truncate.

use halflight_sh::{BatchExp, Block, ExpWorkspace, Real, SquaringRule, Work};

use crate::batches::{batches, packed, unpacked};
use crate::inputs::{Class, logs};
use crate::operation::{EIGEN, HYBRID, LINEAR, Operation, PS_8, PS_21, SCALED_2, SCALED_5};
use crate::oracle::Oracle;
use crate::tally::Tally;
use crate::vector::{convert, distance, norm};

/// A variant for one vector.
pub(crate) type Single<T> = fn(&mut ExpWorkspace<T>, &[T], &mut [T]) -> Work;
type Batched<T> = fn(&mut BatchExp<T>, &[Block<T>], &mut [Block<T>], &mut [Work]);

/// A variant, for one vector and for batches.
type Variant<T> = (&'static Operation, Single<T>, Batched<T>);

/// Every variant.
pub(crate) fn variants<T: Real>() -> [Variant<T>; 7] {
    const RULE: fn() -> SquaringRule = SquaringRule::default;
    [
        (&PS_8, |e, f, out| e.product_series(8, f, out), |e, f, out, work| e.product_series(8, f, out, work)),
        (&PS_21, |e, f, out| e.product_series(21, f, out), |e, f, out, work| e.product_series(21, f, out, work)),
        (
            &SCALED_2,
            |e, f, out| e.scaled_series(2, RULE(), f, out),
            |e, f, out, work| e.scaled_series(2, RULE(), f, out, work),
        ),
        (
            &SCALED_5,
            |e, f, out| e.scaled_series(5, RULE(), f, out),
            |e, f, out, work| e.scaled_series(5, RULE(), f, out, work),
        ),
        (&LINEAR, ExpWorkspace::optimal_linear, BatchExp::optimal_linear),
        (&HYBRID, |e, f, out| e.hybrid(RULE(), f, out), |e, f, out, work| e.hybrid(RULE(), f, out, work)),
        (&EIGEN, ExpWorkspace::eigen, BatchExp::eigen),
    ]
}

pub(crate) fn measure<T: Real>(oracle: &Oracle, tally: &mut Tally) {
    let order = tally.order;
    let mut one = ExpWorkspace::<T>::new(order);
    for class in Class::ALL {
        let inputs = logs::<T>(order, class);
        let series: Vec<Vec<f64>> = inputs.iter().map(|f| oracle.exp(f)).collect();
        let blocks = packed::<T>(order, &inputs);
        for (operation, single, batched) in variants::<T>() {
            let mut error = |(f, want): (&Vec<f64>, &Vec<f64>)| {
                let mut out = vec![T::ZERO; f.len()];
                single(&mut one, &convert(f), &mut out);
                distance(&out, want) / norm(want)
            };
            let errors: Vec<f64> = inputs.iter().zip(&series).map(&mut error).collect();
            tally.add::<T>(operation, "one", class, &errors);
            let mut out = blocks.clone();
            for (name, batch) in batches(order) {
                batched(&mut BatchExp::new(batch), &blocks, &mut out, &mut vec![Work::default(); inputs.len()]);
                let got = unpacked(order, &out);
                let errors: Vec<f64> = got.iter().zip(&series).map(|(g, w)| distance(g, w) / norm(w)).collect();
                tally.add::<T>(operation, &name, class, &errors);
            }
        }
    }
}
