//! Exact visibility in spherical harmonics: projected by sampling, and the light that its truncation lets through.

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DVec3, Vec3};
use halflight_sh::coefficients;

use super::Scratch;
use super::distant::draw;
use super::moments::{Moments, Plan, spread};
use crate::emission::Emission;
use crate::receiver::Receiver;
use crate::sampling::{Sobol, mix};
use crate::unoccluded::Unoccluded;
use crate::visibility::{View, Visibility};

/// `1/π ∫ L(ω) Vₙ(ω) max(0, n·ω) dω` with `Vₙ` the projection of order `n` of the visibility.
///
/// With `B = 1 − V`, of which `1` is its own projection, that is the unoccluded light less `Σ bᵢ tᵢ`, where `bᵢ = ∫ B yᵢ` and
/// `tᵢ = 1/π ∫ L yᵢ max(0, n·ω)` are estimated by samples independent of each other, hence their product without bias.
pub(crate) struct ShVisibility {
    pub(crate) order: usize,
    pub(crate) emission: Arc<Emission>,
    pub(crate) visibility: Visibility,
    pub(crate) unoccluded: Unoccluded,
}

/// Estimates of `b` and `t`, a row of coefficients a batch.
#[derive(Default)]
pub(crate) struct Visibilities {
    directions: Vec<Vec3>,
    blocked: Vec<bool>,
    blocking: Vec<f64>,
    transfer: Vec<DVec3>,
    basis: Vec<f32>,
}

impl ShVisibility {
    pub(crate) fn estimate(&self, receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch) -> Moments {
        let memory = &mut scratch.visibilities;
        let count = coefficients(self.order);
        let view = self.visibility.from(receiver);
        memory.project(&view, self.order, plan, mix(seed, 0));
        memory.transfer.clear();
        memory.transfer.resize(count * plan.batches as usize, DVec3::ZERO);
        memory.basis.resize(count, 0.0);
        for (batch, transfer) in (0..).zip(memory.transfer.chunks_exact_mut(count)) {
            draw(&self.emission, receiver.normal, plan.per_batch, mix(mix(seed, 1), batch), |direction, value| {
                halflight_sh::evaluate(self.order, direction.to_array(), &mut memory.basis);
                let value = value.as_dvec3();
                transfer.iter_mut().zip(&memory.basis).for_each(|(t, y)| *t += value * f64::from(*y));
            });
        }
        self.combine(receiver, plan, memory)
    }

    fn combine(&self, receiver: &Receiver, plan: Plan, memory: &Visibilities) -> Moments {
        let count = coefficients(self.order);
        let batches = f64::from(plan.batches);
        let column = |i: usize| (0..plan.batches as usize).map(move |batch| batch * count + i);
        let blocking: Vec<f64> =
            (0..count).map(|i| column(i).map(|at| memory.blocking[at]).sum::<f64>() / batches).collect();
        let transfer: Vec<DVec3> =
            (0..count).map(|i| column(i).map(|at| memory.transfer[at]).sum::<DVec3>() / batches).collect();
        let dot = |b: &[f64], t: &[DVec3]| b.iter().zip(t).map(|(b, t)| *b * *t).sum::<DVec3>();
        let mean = dot(&blocking, &transfer);
        // The product's first-order change with each batch.
        let rows = memory.blocking.chunks_exact(count).zip(memory.transfer.chunks_exact(count));
        let (_, variance) = spread(rows.map(|(b, t)| dot(b, &transfer) + dot(&blocking, t) - mean));
        let squares: DVec3 = transfer.iter().map(|t| *t * *t).sum();
        Moments {
            mean: self.unoccluded.at(receiver.normal.as_dvec3()) - mean,
            variance: variance + grain(plan) * squares,
            rays: u64::from(plan.samples()),
        }
    }
}

impl Visibilities {
    /// `bᵢ = ∫ B yᵢ dω` by directions uniform over the sphere.
    fn project(&mut self, view: &View<'_>, order: usize, plan: Plan, seed: u64) {
        let count = coefficients(order);
        self.blocking.clear();
        self.blocking.resize(count * plan.batches as usize, 0.0);
        self.basis.resize(count, 0.0);
        let weight = f64::from(4.0 * PI) / f64::from(plan.per_batch);
        for (batch, blocking) in (0..).zip(self.blocking.chunks_exact_mut(count)) {
            let sobol = Sobol::new(mix(seed, batch));
            self.directions.clear();
            self.directions.extend((0..plan.per_batch).map(|i| on_sphere(sobol.point(i))));
            self.blocked.clear();
            self.blocked.resize(self.directions.len(), false);
            view.blocked(&self.directions, &mut self.blocked);
            for (direction, _) in self.directions.iter().zip(&self.blocked).filter(|(_, blocked)| **blocked) {
                halflight_sh::evaluate(order, direction.to_array(), &mut self.basis);
                blocking.iter_mut().zip(&self.basis).for_each(|(b, y)| *b += weight * f64::from(*y));
            }
        }
    }

    /// Mean and variance of the coefficients of the visibility at a receiver.
    pub(crate) fn visibility(
        &mut self,
        visibility: &Visibility,
        receiver: &Receiver,
        order: usize,
        plan: Plan,
        seed: u64,
        mut write: impl FnMut(usize, f64, f64),
    ) {
        self.project(&visibility.from(receiver), order, plan, seed);
        let count = coefficients(order);
        for i in 0..count {
            let all = (0..plan.batches as usize).map(|batch| DVec3::splat(self.blocking[batch * count + i]));
            let (blocked, variance) = spread(all);
            let open = if i == 0 { f64::from(2.0 * PI.sqrt()) } else { 0.0 };
            write(i, open - blocked.x, variance.x + grain(plan));
        }
    }
}

/// The variance of any `bᵢ` that half a ray more or less brings: `(4π)² · mean(yᵢ²) · (1/2N)/N`.
fn grain(plan: Plan) -> f64 {
    f64::from(TAU) / f64::from(plan.samples()).powi(2)
}

/// Uniform over the sphere.
fn on_sphere([u, v]: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * u;
    let rim = (4.0 * u * (1.0 - u)).sqrt();
    let (sin, cos) = (TAU * v).sin_cos();
    Vec3::new(rim * cos, rim * sin, z)
}
