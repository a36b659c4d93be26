//! Accumulation and exponential one vertex at a time in plain scalar code, as the paper's CPU implementation has them: products of
//! visibilities, or sums of their logs ended by an exponential. The denominator of speed-ups.

use super::ground::Ground;
use halflight_blockers::{Blockers, Gather, SelfShadow, Tally};
use halflight_sh::{Batch, Block, LANES, coefficients, unpack};
use rayon::prelude::*;
use std::f32::consts::PI;

#[cfg(target_arch = "x86_64")]
#[path = "../../../methods/sh/benches/baseline/mod.rs"]
mod baseline;

/// Vertices that one task handles.
const CHUNK: usize = 256;

/// What is done with the circles at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum How {
    /// Found, looked up and rotated alone: what all have in common.
    Circles,
    /// Multiplied.
    Product,
    /// Summed as logs, without an end.
    Sum,
    /// Summed as logs, ended by PS*-2.
    PsStar2,
    /// Summed as logs, ended by PS-p.
    Series(usize),
}

/// The product by generated scalar code with nothing shared between pairs, where the processor has its instructions; or else by a
/// loop over the nonzero triples.
pub(crate) fn product(order: usize, a: &[f32], b: &[f32], out: &mut [f32]) {
    #[cfg(target_arch = "x86_64")]
    if (2..=6).contains(&order) && is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        return baseline::plain_product(order, a, b, out);
    }
    halflight_sh::gamma(order).product(a, b, out);
}

/// Red radiance at albedo 1 of all vertices; `transfer` is `H(N) * L`.
pub(crate) fn render(ground: &Ground, order: usize, transfer: &[f32], how: How) -> Vec<f32> {
    let mut out = vec![0.0; ground.frame.receivers.len()];
    out.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
        let mut seen = Seen::new(order);
        let mut vertices: [Vertex; LANES] = std::array::from_fn(|_| Vertex::new(order));
        for (out, first) in out.chunks_mut(LANES).zip((chunk * CHUNK..).step_by(LANES)) {
            let numbers: Vec<usize> = (first..first + out.len()).collect();
            seen.shade(ground, &numbers, how, &mut vertices);
            for (out, vertex) in out.iter_mut().zip(&vertices) {
                *out = vertex.visibility.iter().zip(transfer).map(|(g, t)| g * t).sum();
            }
        }
    });
    out
}

/// Circles found, looked up and rotated for 16 vertices at a time, since that is the same work for all.
struct Seen {
    batch: Batch,
    zonal: Vec<Block<f32>>,
    lobes: Vec<Block<f32>>,
    vectors: Vec<f32>,
}

impl Seen {
    fn new(order: usize) -> Seen {
        let vectors = vec![0.0; LANES * coefficients(order)];
        Seen { batch: Batch::new(order), zonal: Vec::new(), lobes: Vec::new(), vectors }
    }

    fn shade(&mut self, ground: &Ground, numbers: &[usize], how: How, vertices: &mut [Vertex; LANES]) {
        let Seen { batch, zonal, lobes, vectors } = self;
        let (order, size) = (batch.order(), coefficients(batch.order()));
        vertices.iter_mut().for_each(|vertex| vertex.begin(how));
        let gather = Gather { self_shadow: SelfShadow::Paper, min_sin_angle: 0.0 };
        let blockers = Blockers { spheres: &ground.spheres, ratios: &[] };
        gather.circles(&ground.frame.receivers, numbers, blockers, &mut Tally::default(), |circles| {
            zonal.resize(order * circles.sines.len(), Block::ZERO);
            lobes.resize(size * circles.sines.len(), Block::ZERO);
            match how {
                How::Product => batch.circle_visibilities(circles.sines, zonal),
                _ => batch.circle_logs(circles.sines, zonal),
            }
            batch.rotate_zonal(zonal, circles.axes, lobes);
            for (lobe, sines) in lobes.chunks_exact(size).zip(circles.sines) {
                unpack(order, lobe, vectors);
                let lanes = vertices.iter_mut().zip(vectors.chunks_exact(size)).zip(&sines.0).take(numbers.len());
                lanes.filter(|(_, sine)| **sine > 0.0).for_each(|((vertex, circle), _)| vertex.add(circle, how));
            }
        });
        vertices.iter_mut().take(numbers.len()).for_each(|vertex| vertex.end(how));
    }
}

/// A vertex at work.
struct Vertex {
    order: usize,
    visibility: Vec<f32>,
    term: Vec<f32>,
    scratch: Vec<f32>,
    log: Vec<f32>,
    /// Nothing has been added.
    open: bool,
}

impl Vertex {
    fn new(order: usize) -> Vertex {
        let vector = || vec![0.0; coefficients(order)];
        Vertex { order, visibility: vector(), term: vector(), scratch: vector(), log: vector(), open: true }
    }

    fn begin(&mut self, how: How) {
        self.open = true;
        self.visibility.fill(0.0);
        if how == How::Product {
            self.visibility[0] = (4.0 * PI).sqrt();
        }
    }

    fn add(&mut self, circle: &[f32], how: How) {
        match how {
            How::Circles => self.visibility[0] += circle[0],
            How::Product if self.open => self.visibility.copy_from_slice(circle),
            How::Product => {
                product(self.order, &self.visibility, circle, &mut self.scratch);
                std::mem::swap(&mut self.visibility, &mut self.scratch);
            }
            _ => self.visibility.iter_mut().zip(circle).for_each(|(sum, value)| *sum += value),
        }
        self.open = false;
    }

    fn end(&mut self, how: How) {
        match how {
            How::PsStar2 => self.ps_star_2(),
            How::Series(degree) => self.series(degree),
            How::Circles | How::Product | How::Sum => {}
        }
    }

    /// The exponential of `visibility` by PS*-2 (Ren 2006, eqs. 20–22), scaled as the paper prints.
    fn ps_star_2(&mut self) {
        let Vertex { order, visibility, term, scratch, .. } = self;
        let mean = std::mem::take(&mut visibility[0]) / (4.0 * PI).sqrt();
        let norm = visibility.iter().map(|value| value * value).sum::<f32>().sqrt();
        let squarings = if norm > 0.0 { (norm.log2() + 3.0).floor().max(0.0) as i32 } else { 0 };
        visibility.iter_mut().for_each(|value| *value *= 0.5f32.powi(squarings));
        product(*order, visibility, visibility, term);
        visibility.iter_mut().zip(&*term).for_each(|(value, square)| *value += 0.5 * square);
        visibility[0] += (4.0 * PI).sqrt();
        for _ in 0..squarings {
            product(*order, visibility, visibility, scratch);
            std::mem::swap(visibility, scratch);
        }
        visibility.iter_mut().for_each(|value| *value *= mean.exp());
    }

    /// The exponential of `visibility` by PS-p (Ren 2006, eq. 17).
    fn series(&mut self, degree: usize) {
        let Vertex { order, log, visibility, term, scratch, .. } = self;
        log.copy_from_slice(visibility);
        term.copy_from_slice(log);
        visibility[0] += (4.0 * PI).sqrt();
        for power in 2..=degree {
            product(*order, log, term, scratch);
            term.iter_mut().zip(&*scratch).for_each(|(term, value)| *term = value / power as f32);
            visibility.iter_mut().zip(&*term).for_each(|(sum, term)| *sum += term);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, Setting, Terms};
    use super::*;
    use halflight_sh::{ExpWorkspace, SquaringRule};

    /// Plain exponentials are those of the algebra, and plain products those of the method.
    #[test]
    fn plain_code_computes_what_the_algebra_does() {
        let dir = tempfile::tempdir().unwrap();
        let terms = Terms { cache: dir.path().into(), quality: Default::default(), rounds: 1 };
        let ground = Ground::new(&Bench::new(&terms), "spheres-60", 6.4, 12, 64).unwrap();
        let receivers = ground.frame.receivers.len();
        for order in 3..=6 {
            let logs = ground.logs(order);
            assert_eq!(logs.len(), receivers, "every vertex sees a sphere");
            let mut transfer = vec![0.0; coefficients(order)];
            for check in [0, 2, coefficients(order) - 1] {
                transfer.fill(0.0);
                transfer[check] = 1.0;
                let plain = [How::PsStar2, How::Series(21)].map(|how| render(&ground, order, &transfer, how));
                for (i, log) in logs.iter().enumerate() {
                    let (mut out, mut exp) = (log.clone(), ExpWorkspace::new(order));
                    exp.scaled_series(2, SquaringRule::default(), log, &mut out);
                    assert!((plain[0][i] - out[check]).abs() < 1e-3, "{order} {i}: {} {}", plain[0][i], out[check]);
                    exp.product_series(21, log, &mut out);
                    let size = out.iter().fold(1.0f32, |largest, value| largest.max(value.abs()));
                    assert!((plain[1][i] - out[check]).abs() < 1e-2 * size, "{order} {i}: PS-21");
                }
            }
        }
    }

    /// Plain products of circles are what the method multiplies, away from its guard.
    #[test]
    fn plain_products_are_those_of_the_method() {
        let dir = tempfile::tempdir().unwrap();
        let terms = Terms { cache: dir.path().into(), quality: Default::default(), rounds: 1 };
        let bench = Bench::new(&terms);
        let ground = Ground::new(&bench, "spheres-60", 6.4, 12, 64).unwrap();
        let setting = Setting::new("sh-product/ordered", &[("guard", "false")]).unwrap();
        let shaded = bench.shaded(&ground.scene, &ground.frame, &setting).unwrap().radiance;
        let plain = render(&ground, 4, &ground.transfer(&bench, 4).unwrap()[0], How::Product);
        for (plain, shaded) in plain.iter().zip(&shaded) {
            assert!((plain - shaded.x).abs() < 1e-3 * shaded.x.abs().max(1.0), "{plain} {}", shaded.x);
        }
    }
}
