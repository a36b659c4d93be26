//! One vertex at a time in plain scalar code, as the paper's CPU implementation has it: products of visibilities, or sums of
//! their logs ended by an exponential. The denominator of speed-ups.

use super::ground::Ground;
use halflight_proxies::Circle;
use halflight_sh::{CircleTable, coefficients, rotate_zonal};
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
        let mut vertex = Vertex::new(order);
        for (i, out) in out.iter_mut().enumerate() {
            vertex.see(ground, chunk * CHUNK + i, how);
            *out = vertex.visibility.iter().zip(transfer).map(|(g, t)| g * t).sum();
        }
    });
    out
}

/// A vertex at work.
struct Vertex {
    order: usize,
    zonal: Vec<f32>,
    circle: Vec<f32>,
    visibility: Vec<f32>,
    term: Vec<f32>,
    scratch: Vec<f32>,
}

impl Vertex {
    fn new(order: usize) -> Vertex {
        let vector = || vec![0.0; coefficients(order)];
        let (zonal, circle) = (vec![0.0; order], vector());
        Vertex { order, zonal, circle, visibility: vector(), term: vector(), scratch: vector() }
    }

    fn see(&mut self, ground: &Ground, receiver: usize, how: How) {
        let logs = !matches!(how, How::Product);
        let table = if logs { CircleTable::log(self.order) } else { CircleTable::visibility(self.order) };
        self.visibility.fill(0.0);
        if !logs {
            self.visibility[0] = (4.0 * PI).sqrt();
        }
        for Circle { axis, sin_angle, .. } in ground.circles(receiver) {
            table.lookup(sin_angle, &mut self.zonal);
            rotate_zonal(self.order, &self.zonal, axis.to_array(), &mut self.circle);
            match how {
                How::Circles => self.visibility[0] += self.circle[self.circle.len() - 1],
                How::Product => {
                    product(self.order, &self.visibility, &self.circle, &mut self.scratch);
                    std::mem::swap(&mut self.visibility, &mut self.scratch);
                }
                _ => self.visibility.iter_mut().zip(&self.circle).for_each(|(sum, value)| *sum += value),
            }
        }
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
        let Vertex { order, circle, visibility, term, scratch, .. } = self;
        circle.copy_from_slice(visibility);
        term.copy_from_slice(circle);
        visibility[0] += (4.0 * PI).sqrt();
        for power in 2..=degree {
            product(*order, circle, term, scratch);
            term.iter_mut().zip(&*scratch).for_each(|(term, value)| *term = value / power as f32);
            visibility.iter_mut().zip(&*term).for_each(|(sum, term)| *sum += term);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::{Bench, Terms};
    use super::*;
    use halflight_sh::{ExpWorkspace, SquaringRule, project_binary_bound};

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

    #[test]
    fn plain_products_stay_visibilities() {
        let dir = tempfile::tempdir().unwrap();
        let terms = Terms { cache: dir.path().into(), quality: Default::default(), rounds: 1 };
        let bench = Bench::new(&terms);
        let ground = Ground::new(&bench, "sphere-plane", 4.0, 6, 64).unwrap();
        let mut vertex = Vertex::new(4);
        for receiver in 0..36 {
            vertex.see(&ground, receiver, How::Product);
            let mut bound = vertex.visibility.clone();
            assert!(!project_binary_bound(4, &mut bound), "one circle is within the bound of visibilities");
        }
    }
}
