//! The identities, each as a check of one case.

use std::f64::consts::PI;

use super::{Matrix, ShOps, Sphere};

/// The identities of one order.
pub(super) struct Laws<'a, O> {
    ops: &'a O,
    order: usize,
    /// The basis at points of a rule that is exact for products of three functions, with the weights.
    samples: Vec<(Vec<f64>, f64)>,
}

type Outcome = Result<(), String>;

impl<'a, O: ShOps> Laws<'a, O> {
    pub(super) fn new(ops: &'a O, order: usize) -> Self {
        let points = Sphere::exact(3 * (order - 1)).points;
        let samples = points.into_iter().map(|(s, weight)| (ops.evaluate(order, s), weight)).collect();
        Self { ops, order, samples }
    }

    /// Whether two vectors are the same at the scale of what they were made from.
    fn same(&self, got: &[f64], want: &[f64], scale: f64) -> Outcome {
        if got.len() != want.len() {
            return Err(format!("{} coefficients, expected {}", got.len(), want.len()));
        }
        let difference: Vec<f64> = got.iter().zip(want).map(|(x, y)| x - y).collect();
        let (error, bound) = (length(&difference), self.ops.tolerance() * self.order as f64 * scale);
        // also false for NaN
        if error <= bound { Ok(()) } else { Err(format!("off by {error:e}, at most {bound:e} expected")) }
    }

    /// The projection of a function of the basis values at a point.
    fn project(&self, f: impl Fn(&[f64]) -> f64) -> Vec<f64> {
        let mut out = vec![0.0; self.order * self.order];
        for (basis, weight) in &self.samples {
            let value = weight * f(basis);
            out.iter_mut().zip(basis).for_each(|(sum, y)| *sum += value * y);
        }
        out
    }

    fn one(&self) -> Vec<f64> {
        self.project(|_| 1.0)
    }

    pub(super) fn orthonormal(&self) -> Outcome {
        for i in 0..self.order * self.order {
            let mut unit = vec![0.0; self.order * self.order];
            unit[i] = 1.0;
            self.same(&self.project(|basis| basis[i]), &unit, 1.0).map_err(|error| format!("function {i}: {error}"))?;
        }
        Ok(())
    }

    pub(super) fn addition(&self, s: [f64; 3]) -> Outcome {
        let basis = self.ops.evaluate(self.order, s);
        for l in 0..self.order {
            let sum: f64 = basis[l * l..(l + 1) * (l + 1)].iter().map(|y| y * y).sum();
            let want = (2 * l + 1) as f64 / (4.0 * PI);
            self.same(&[sum], &[want], want).map_err(|error| format!("band {l} at {s:?}: {error}"))?;
        }
        Ok(())
    }

    pub(super) fn projection(&self, f: &[f64]) -> Outcome {
        self.same(&self.project(|basis| dot(basis, f)), f, length(f))
    }

    pub(super) fn product_is_projection(&self, a: &[f64], b: &[f64]) -> Outcome {
        let Some(product) = self.ops.product(self.order, a, b) else { return Ok(()) };
        self.same(&product, &self.project(|basis| dot(basis, a) * dot(basis, b)), length(a) * length(b))
    }

    pub(super) fn product_commutes(&self, a: &[f64], b: &[f64]) -> Outcome {
        let products = self.ops.product(self.order, a, b).zip(self.ops.product(self.order, b, a));
        let Some((ab, ba)) = products else { return Ok(()) };
        self.same(&ab, &ba, length(a) * length(b))
    }

    pub(super) fn product_has_unit(&self, f: &[f64]) -> Outcome {
        let one = self.one();
        let Some(product) = self.ops.product(self.order, &one, f) else { return Ok(()) };
        self.same(&product, f, length(&one) * length(f))
    }

    pub(super) fn product_is_linear(&self, a: &[f64], b: &[f64], c: &[f64]) -> Outcome {
        let mixed = combine(2.0, b, -0.5, c);
        let product = |x: &[f64]| self.ops.product(self.order, a, x);
        let (Some(ab), Some(ac), Some(got)) = (product(b), product(c), product(&mixed)) else { return Ok(()) };
        self.same(&got, &combine(2.0, &ab, -0.5, &ac), 3.0 * length(a) * (length(b) + length(c)))
    }

    pub(super) fn rotation_moves_values(&self, f: &[f64], rotation: &Matrix, s: [f64; 3]) -> Outcome {
        let Some(turned) = self.ops.rotate(self.order, rotation, f) else { return Ok(()) };
        let back = std::array::from_fn(|j| (0..3).map(|i| rotation[i][j] * s[i]).sum());
        let value = dot(&self.ops.evaluate(self.order, s), &turned);
        let want = dot(&self.ops.evaluate(self.order, back), f);
        self.same(&[value], &[want], self.order as f64 * length(f))
    }

    pub(super) fn rotations_compose(&self, f: &[f64], first: &Matrix, second: &Matrix) -> Outcome {
        let Some(once) = self.ops.rotate(self.order, first, f) else { return Ok(()) };
        let both = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| second[i][k] * first[k][j]).sum()));
        let results = self.ops.rotate(self.order, second, &once).zip(self.ops.rotate(self.order, &both, f));
        let Some((twice, at_once)) = results else { return Ok(()) };
        self.same(&twice, &at_once, length(f))
    }

    pub(super) fn rotation_keeps_length(&self, f: &[f64], rotation: &Matrix) -> Outcome {
        let Some(turned) = self.ops.rotate(self.order, rotation, f) else { return Ok(()) };
        self.same(&[length(&turned)], &[length(f)], length(f))
    }

    pub(super) fn rotation_and_product(&self, a: &[f64], b: &[f64], rotation: &Matrix) -> Outcome {
        let turn = |f: &[f64]| self.ops.rotate(self.order, rotation, f);
        let Some((ta, tb)) = turn(a).zip(turn(b)) else { return Ok(()) };
        let Some(turned) = self.ops.product(self.order, a, b).and_then(|product| turn(&product)) else {
            return Ok(());
        };
        let Some(product) = self.ops.product(self.order, &ta, &tb) else { return Ok(()) };
        self.same(&product, &turned, 2.0 * self.order as f64 * length(a) * length(b))
    }

    pub(super) fn exp_of_zero(&self) -> Outcome {
        let one = self.one();
        let Some(exp) = self.ops.exp(self.order, &vec![0.0; one.len()]) else { return Ok(()) };
        self.same(&exp, &one, length(&one))
    }

    pub(super) fn exp_isolates_mean(&self, f: &[f64], mean: f64) -> Outcome {
        if !self.ops.isolates_mean() {
            return Ok(());
        }
        let raised = combine(1.0, f, mean, &self.one());
        let results = self.ops.exp(self.order, f).zip(self.ops.exp(self.order, &raised));
        let Some((exp, got)) = results else { return Ok(()) };
        let want = combine(mean.exp(), &exp, 0.0, &exp);
        self.same(&got, &want, 16.0 * length(&want))
    }

    pub(super) fn rotation_and_exp(&self, f: &[f64], rotation: &Matrix) -> Outcome {
        let Some(turned) = self.ops.rotate(self.order, rotation, f) else { return Ok(()) };
        let results = self.ops.exp(self.order, &turned).zip(self.ops.exp(self.order, f));
        let Some((exp_of_turned, exp)) = results else { return Ok(()) };
        let Some(turned_exp) = self.ops.rotate(self.order, rotation, &exp) else { return Ok(()) };
        self.same(&exp_of_turned, &turned_exp, 64.0 * length(&exp))
    }

    pub(super) fn rotation_and_log(&self, f: &[f64], rotation: &Matrix) -> Outcome {
        // 1 plus what keeps it positive
        let positive = combine(1.0, &self.one(), 0.5 / (self.order as f64 * length(f)).max(1.0), f);
        let Some(turned) = self.ops.rotate(self.order, rotation, &positive) else { return Ok(()) };
        let results = self.ops.log(self.order, &turned).zip(self.ops.log(self.order, &positive));
        let Some((log_of_turned, log)) = results else { return Ok(()) };
        let Some(turned_log) = self.ops.rotate(self.order, rotation, &log) else { return Ok(()) };
        self.same(&log_of_turned, &turned_log, 16.0 * length(&positive))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn length(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

/// `p·a + q·b`.
fn combine(p: f64, a: &[f64], q: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(x, y)| p * x + q * y).collect()
}
