//! Calibration: fixed work whose time tells how fast the machine is at the moment, so that runs of different days, or beside
//! other work, can be told apart.

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::hint::black_box;
use std::time::Instant;

/// Multiplications and additions of one chain.
const STEPS: usize = 240_000;

/// Chains that run beside each other: enough to hide the latency of an addition.
const CHAINS: usize = 32;

/// Bytes that are read: more than a core's own caches hold.
const BYTES: usize = 16 << 20;

/// The fixed work, with the memory that it reads.
pub(crate) struct Calibrator(Vec<u64>);

impl Calibrator {
    pub(crate) fn new() -> Self {
        Self((0..(BYTES / 8) as u64).collect())
    }

    /// Nanoseconds of computing, by every thread at once, and of reading memory, by all together: about a millisecond each.
    pub(crate) fn sample(&self) -> [f64; 2] {
        let compute = timed(|| {
            rayon::broadcast(|_| black_box(compute(black_box(1.0))));
        });
        let share = self.0.len().div_ceil(rayon::current_num_threads());
        let memory = timed(|| {
            let parts: Vec<&[u64]> = self.0.chunks(share).collect();
            black_box(parts.par_iter().map(|part| sum(part)).reduce(|| 0, u64::wrapping_add));
        });
        [compute, memory]
    }
}

#[inline(never)]
fn compute(start: f32) -> f32 {
    let mut values = [start; CHAINS];
    for _ in 0..STEPS {
        // Tends to 2, so that nothing overflows or becomes denormal.
        values.iter_mut().for_each(|value| *value = *value * 0.75 + 0.5);
    }
    values.iter().sum()
}

#[inline(never)]
fn sum(values: &[u64]) -> u64 {
    values.iter().fold(0, |sum, value| sum.wrapping_add(*value))
}

fn timed(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_nanos() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_work_is_done_and_takes_about_a_millisecond() {
        assert!((compute(1.0) - CHAINS as f32 * 2.0).abs() < 1e-3, "the fixed point of x ← 0.75 x + 0.5");
        let calibrator = Calibrator::new();
        let n = calibrator.0.len() as u64;
        assert_eq!(sum(&calibrator.0), n * (n - 1) / 2);
        let fastest = (0..20).map(|_| calibrator.sample()).reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]).unwrap();
        assert!(fastest.iter().all(|time| (2e4..3e7).contains(time)), "{fastest:?}");
    }
}
