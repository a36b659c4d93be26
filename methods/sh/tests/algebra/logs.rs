//! Batched logarithms against those of one vector.

use crate::batches::{instruction_sets, packed, unpacked};
use crate::common::{circle, constant, convert, distance, norm};
use halflight_sh::{BatchLog, LANES, Real, log_eigen, product};

/// Visibilities of one to three circles, from slits to half the sky, positive on the whole; more than one group of lanes.
fn visibilities(order: usize) -> Vec<Vec<f64>> {
    let one = |i: usize| {
        let mut g: Vec<f64> = constant(order, 1.0);
        for k in 0..i % 4 {
            let (degrees, turn) = ((i * 29 + k * 17) % 86, (i + 5 * k) as f64);
            let z = (0.7 * turn).sin();
            let flat = (1.0 - z * z).sqrt();
            let (blocker, open) =
                (circle(order, degrees as f64, [flat * turn.cos(), flat * turn.sin(), z]).0, g.clone());
            product(order, &open, &blocker, &mut g);
        }
        g
    };
    (0..2 * LANES).map(one).filter(|g| g[0] > 0.05).collect()
}

fn check<T: Real>(order: usize, bound: f64) {
    let vectors = visibilities(order);
    assert!(vectors.len() > LANES, "order {order}: {}", vectors.len());
    for batch in instruction_sets(order) {
        let g = packed::<T>(order, &vectors);
        let mut out = g.clone();
        BatchLog::new(batch).eigen(&g, &mut out);
        for (got, g) in unpacked(order, &out, vectors.len()).iter().zip(&vectors) {
            let g: Vec<f64> = convert::<T>(g).iter().map(|x| x.to_f64()).collect();
            let mut want = g.clone();
            log_eigen(order, &g, &mut want);
            let error = distance(got, &want) / norm(&want).max(1.0);
            assert!(error <= bound, "order {order}, {:?}: {error:e}", batch.simd());
        }
    }
}

#[test]
fn lanes_are_what_one_vector_gives() {
    for order in 1..=8 {
        check::<f64>(order, 1e-12);
        check::<f32>(order, 1e-7);
    }
}

#[test]
fn lanes_do_not_mix() {
    let order = 4;
    let mut vectors = visibilities(order);
    vectors.truncate(LANES);
    for batch in instruction_sets(order) {
        let mut logs = BatchLog::new(batch);
        let [straight, turned] = [false, true].map(|turn| {
            let mut vectors = vectors.clone();
            if turn {
                vectors.rotate_left(3);
                vectors[0] = vec![f64::NAN; 16];
            }
            let g = packed::<f64>(order, &vectors);
            let mut out = g.clone();
            logs.eigen(&g, &mut out);
            unpacked(order, &out, LANES)
        });
        for lane in 1..LANES - 3 {
            assert!(distance(&turned[lane], &straight[lane + 3]) < 1e-12, "{:?}, lane {lane}", batch.simd());
        }
        assert!(turned[0].iter().all(|x| x.is_nan()));
    }
}
