//! All basis functions at a direction as polynomials of x, y and z, and zonal vectors turned to that direction.
//!
//! `y_lm = q_lm(z)·(c_m or s_m)` with `c_m + i s_m = (x + iy)^m`; `q_lm` has even or odd powers of z alone: up to degree 4 it
//! is summed in z² (Horner), beyond by the three-term recurrence, which rounds less there.

use std::f64::consts::PI;

use halflight_sh::{evaluate, index};

use crate::program::{Factor, Id, Op, Program};

/// The highest degree that is summed in powers of z².
const MAX_HORNER: usize = 4;

/// What a program writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// `y_lm`. Input: the direction.
    Basis,
    /// `√(4π/(2l+1))·zonal_l·y_lm`. Inputs: the direction, the zonal vector.
    Lobe,
}

/// The program of an order.
pub fn build(order: usize, output: Output) -> Program {
    let mut program = Program::default();
    let p = &mut program;
    let [x, y, z] = [0, 1, 2].map(|i| p.input(0, i));
    let mut power = None; // (x + iy)^m, none for m = 0
    for m in 0..order {
        if m > 0 {
            power = Some(power.map_or((x, y), |(cos, sin)| next_power(p, (x, y), (cos, sin))));
        }
        let mut column = Column { m, z, known: Vec::new() };
        for l in m..order {
            let scale = if output == Output::Basis { 1.0 } else { (4.0 * PI / (2 * l + 1) as f64).sqrt() };
            let zonal = (output != Output::Basis).then(|| p.input(1, l));
            let latitude = column.value(p, l, scale, zonal);
            for (sine, i) in [(true, index(l, -(m as isize))), (false, index(l, m as isize))] {
                let azimuth = power.map(|(c, s)| if sine { s } else { c });
                if sine && m == 0 {
                    continue;
                }
                let value = match (latitude, azimuth) {
                    (Latitude::Constant(k), None) => p.push(Op::Constant(k)),
                    (Latitude::Constant(k), Some(a)) => p.push(Op::Scale(Factor::Literal(k), a)),
                    (Latitude::Value(v), None) => v,
                    (Latitude::Value(v), Some(a)) => p.push(Op::Mul(v, a)),
                };
                p.output(i, value);
            }
        }
    }
    program
}

pub(crate) fn next_power(p: &mut Program, (x, y): (Id, Id), (cos, sin): (Id, Id)) -> (Id, Id) {
    let (xc, xs) = (p.push(Op::Mul(x, cos)), p.push(Op::Mul(x, sin)));
    (p.push(Op::NegMulAdd(y, sin, xc)), p.push(Op::MulAdd(y, cos, xs)))
}

/// `q_lm(z)`, perhaps times a lane's own factor.
#[derive(Clone, Copy)]
enum Latitude {
    Constant(f64),
    Value(Id),
}

/// The functions of one m.
struct Column {
    m: usize,
    z: Id,
    /// `q_lm` from l = m on, without scale.
    known: Vec<Latitude>,
}

impl Column {
    /// `scale·zonal·q_lm`; bands are asked for in turn.
    fn value(&mut self, p: &mut Program, l: usize, scale: f64, zonal: Option<Id>) -> Latitude {
        let degree = l - self.m;
        let value = if degree > MAX_HORNER { self.recur(p, l) } else { self.horner(p, l, 1.0) };
        self.known.push(value);
        match zonal {
            None => value,
            // the scale goes into the polynomial's constants where it can
            Some(zonal) => {
                let scaled = if degree > MAX_HORNER { times(p, scale, value) } else { self.horner(p, l, scale) };
                Latitude::Value(match scaled {
                    Latitude::Constant(k) => p.push(Op::Scale(Factor::Literal(k), zonal)),
                    Latitude::Value(v) => p.push(Op::Mul(v, zonal)),
                })
            }
        }
    }

    /// By powers of z².
    fn horner(&self, p: &mut Program, l: usize, scale: f64) -> Latitude {
        let powers: Vec<f64> = polynomial(l, self.m).into_iter().rev().step_by(2).map(|k| scale * k).collect();
        let odd = (l - self.m) % 2 == 1;
        let mut value = Latitude::Constant(powers[0]);
        for &next in &powers[1..] {
            let square = p.push(Op::Mul(self.z, self.z));
            value = Latitude::Value(match value {
                Latitude::Constant(k) => p.push(Op::Affine(k, square, next)),
                Latitude::Value(v) => p.push(Op::MulOffset(v, square, next)),
            });
        }
        match (odd, value) {
            (false, value) => value,
            (true, Latitude::Constant(k)) => Latitude::Value(p.push(Op::Scale(Factor::Literal(k), self.z))),
            (true, Latitude::Value(v)) => Latitude::Value(p.push(Op::Mul(v, self.z))),
        }
    }

    /// `q_l = rise·z·q_(l-1) - fall·q_(l-2)`.
    fn recur(&self, p: &mut Program, l: usize) -> Latitude {
        let [l2, m2, below2] = [l * l, self.m * self.m, (l - 1) * (l - 1)].map(|v| v as f64);
        let rise = ((4.0 * l2 - 1.0) / (l2 - m2)).sqrt();
        let fall = rise * ((below2 - m2) / (4.0 * below2 - 1.0)).sqrt();
        let [Latitude::Value(below), Latitude::Value(last)] = self.known[self.known.len() - 2..] else {
            unreachable!("degrees from 3 on are no constants")
        };
        let risen = p.push(Op::Scale(Factor::Literal(rise), self.z));
        let fallen = p.push(Op::Scale(Factor::Literal(-fall), below));
        Latitude::Value(p.push(Op::MulAdd(risen, last, fallen)))
    }
}

fn times(p: &mut Program, scale: f64, value: Latitude) -> Latitude {
    match value {
        Latitude::Constant(k) => Latitude::Constant(scale * k),
        Latitude::Value(v) => Latitude::Value(p.push(Op::Scale(Factor::Literal(scale), v))),
    }
}

/// The coefficients of `q_lm` by ascending powers of z, from values at as many points.
pub(crate) fn polynomial(l: usize, m: usize) -> Vec<f64> {
    let degree = l - m;
    let q = |z: f64| {
        let r = (1.0 - z * z).sqrt();
        let mut basis = vec![0.0; (l + 1) * (l + 1)];
        evaluate(l + 1, [r, 0.0, z], &mut basis);
        basis[index(l, m as isize)] / r.powi(m as i32)
    };
    // Newton's divided differences at points within (-1, 1), then expanded.
    let points: Vec<f64> = (0..=degree).map(|k| (k as f64 + 0.5) / (degree + 1) as f64 * 1.6 - 0.8).collect();
    let mut differences: Vec<f64> = points.iter().map(|&z| q(z)).collect();
    for k in 1..=degree {
        for i in (k..=degree).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (points[i] - points[i - k]);
        }
    }
    let mut coefficients = vec![0.0; degree + 1];
    for k in (0..=degree).rev() {
        for i in (0..=degree).rev() {
            let below = if i > 0 { coefficients[i - 1] } else { 0.0 };
            coefficients[i] = below - points[k] * coefficients[i];
        }
        coefficients[0] += differences[k];
    }
    coefficients
}
