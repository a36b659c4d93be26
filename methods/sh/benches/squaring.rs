//! What each more squaring buys HYB, and what it costs: `cargo bench -p halflight-sh --bench squaring`.
//!
//! For sums of the logs of 1 to 16 circles of 3° to 40° on a hemisphere: root mean squares, relative to the open sky, of HYB's
//! distance to the whole product series (what squarings can mend) and to the projection of the true visibility (what they
//! cannot), the mean count of squarings, and nanoseconds a vector of a batch. Ren et al. 2006 print the offset 3 and "at
//! most 3" squarings.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

use halflight_sh::{
    Batch, BatchExp, Block, ExpWorkspace, Quadrature, SquaringRule, Work, blocks_for, circle_log, coefficients, pack,
    project, rotate_zonal,
};

const VECTORS: usize = 480;
const SKY: f64 = 3.544_907_701_811_032;
/// Ends of the bins of ‖f̂‖.
const BINS: [f64; 6] = [0.5, 1.0, 2.0, 4.0, 8.0, f64::INFINITY];

/// SplitMix64.
struct Numbers(u64);

impl Numbers {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

type Circle = ([f64; 3], f64);

fn circles(numbers: &mut Numbers) -> Vec<Circle> {
    let count = 2f64.powf(numbers.between(0.0, 4.0)) as usize;
    let one = |numbers: &mut Numbers| {
        let (z, phi) = (numbers.between(0.0, 1.0), numbers.between(0.0, TAU));
        let radius = (1.0 - z * z).sqrt();
        ([radius * phi.cos(), radius * phi.sin(), z], numbers.between(3.0, 40.0) * PI / 180.0)
    };
    (0..count).map(|_| one(numbers)).collect()
}

fn log(order: usize, circles: &[Circle]) -> Vec<f64> {
    let (mut zonal, mut lobe) = (vec![0.0; order], vec![0.0; coefficients(order)]);
    let mut total = lobe.clone();
    for (axis, angle) in circles {
        circle_log(order, angle.cos(), &mut zonal);
        rotate_zonal(order, &zonal, *axis, &mut lobe);
        total.iter_mut().zip(&lobe).for_each(|(sum, x)| *sum += x);
    }
    total
}

fn visibility(order: usize, rule: &Quadrature, circles: &[Circle]) -> Vec<f64> {
    let outside = |s: [f64; 3]| {
        let clear = |(axis, angle): &Circle| (0..3).map(|k| axis[k] * s[k]).sum::<f64>() < angle.cos();
        f64::from(u8::from(circles.iter().all(clear)))
    };
    project(order, rule, outside)
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt() / SKY
}

#[derive(Clone, Copy, Default)]
struct Mean {
    series: f64,
    truth: f64,
    squares: f64,
    count: f64,
}

fn main() {
    let rule = Quadrature::exact(191);
    let mut numbers = Numbers(5);
    let sets: Vec<Vec<Circle>> = (0..VECTORS).map(|_| circles(&mut numbers)).collect();
    for order in 2..=8 {
        let logs: Vec<Vec<f64>> = sets.iter().map(|set| log(order, set)).collect();
        let truths: Vec<Vec<f64>> = sets.iter().map(|set| visibility(order, &rule, set)).collect();
        let mut exp = ExpWorkspace::<f64>::new(order);
        let mut out = vec![0.0; coefficients(order)];
        let series: Vec<Vec<f64>> = logs
            .iter()
            .map(|f| {
                exp.eigen(f, &mut out);
                out.clone()
            })
            .collect();
        let floor =
            (series.iter().zip(&truths).map(|(s, t)| distance(s, t).powi(2)).sum::<f64>() / VECTORS as f64).sqrt();
        println!("order {order}: the whole series is {floor:.4} from the truth");
        println!(
            "  offset   to series   to truth  squarings   ns     to series / to truth for ‖f̂‖ below 0.5, 1, 2, 4, 8, above"
        );
        let flat: Vec<f32> = logs.iter().flatten().map(|&x| x as f32).collect();
        let mut blocks = vec![Block::ZERO; blocks_for(order, VECTORS)];
        pack(order, &flat, &mut blocks);
        let (mut result, mut work) = (blocks.clone(), vec![Work::default(); VECTORS]);
        let mut batch = BatchExp::new(Batch::new(order));
        for offset in -2..=6 {
            let rule = SquaringRule { offset: f64::from(offset) };
            let mut bins = [Mean::default(); BINS.len()];
            for ((f, series), truth) in logs.iter().zip(&series).zip(&truths) {
                let spent = exp.hybrid(rule, f, &mut out);
                let length = f[1..].iter().map(|x| x * x).sum::<f64>().sqrt();
                let bin = &mut bins[BINS.iter().position(|&end| length < end).unwrap_or(0)];
                bin.series += distance(&out, series).powi(2);
                bin.truth += distance(&out, truth).powi(2);
                bin.squares += f64::from(spent.squares);
                bin.count += 1.0;
            }
            let best = (0..40)
                .map(|_| {
                    let start = Instant::now();
                    batch.hybrid(rule, black_box(&blocks), &mut result, &mut work);
                    start.elapsed().as_secs_f64() * 1e9 / VECTORS as f64
                })
                .fold(f64::MAX, f64::min);
            let sum = |part: fn(&Mean) -> f64| bins.iter().map(part).sum::<f64>() / VECTORS as f64;
            let each: Vec<String> = bins
                .iter()
                .filter(|bin| bin.count > 0.0)
                .map(|bin| format!("{:.4}/{:.4}", (bin.series / bin.count).sqrt(), (bin.truth / bin.count).sqrt()))
                .collect();
            println!(
                "  {offset:6} {:11.5} {:10.5} {:10.2} {best:6.1}     {}",
                sum(|b| b.series).sqrt(),
                sum(|b| b.truth).sqrt(),
                sum(|b| b.squares),
                each.join("  ")
            );
        }
    }
}
