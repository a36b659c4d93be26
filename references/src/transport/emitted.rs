//! Light of objects that emit.

use std::sync::Arc;

use glam::DVec3;

use super::{Bundle, Plan, Scratch, Term};
use crate::emitters::{Emitters, Weights};
use crate::receiver::Receiver;
use crate::sampling::{Sobol, mix};
use crate::visibility::{View, Visibility};

/// Light that comes straight from objects that emit.
pub(crate) struct Emitted {
    pub(crate) emitters: Arc<Emitters>,
    pub(crate) visibility: Visibility,
}

impl Term for Emitted {
    fn sample(&self, receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch) {
        let (view, start) = (self.visibility.from(receiver), self.visibility.start(receiver));
        let mut weights = Weights::default();
        self.emitters.weigh(start, receiver.normal, &mut weights);
        for batch in 0..plan.batches {
            let sobol = Sobol::new(mix(seed, u64::from(batch)));
            for i in 0..plan.per_batch {
                let Some(towards) = self.emitters.sample(&weights, start, sobol.point(i)) else { continue };
                let cos = receiver.normal.dot(towards.direction);
                let reflected = cos * std::f32::consts::FRAC_1_PI / (towards.density * plan.per_batch as f32);
                if cos > 0.0 && reflected.is_finite() {
                    scratch.bundle.rays.push(view.ray(towards.direction, towards.distance));
                    scratch.bundle.contributions.push((batch, reflected * towards.radiance));
                }
            }
            if scratch.bundle.rays.len() >= Bundle::FULL {
                self.trace(&view, scratch);
            }
        }
        self.trace(&view, scratch);
    }

    fn known(&self, receiver: &Receiver, _: &mut Scratch) -> DVec3 {
        match self.emitters.are_few() {
            true => self.emitters.open(self.visibility.start(receiver), receiver.normal),
            false => DVec3::ZERO,
        }
    }
}

impl Emitted {
    fn trace(&self, view: &View<'_>, scratch: &mut Scratch) {
        let bundle = &mut scratch.bundle;
        bundle.blocked.clear();
        bundle.blocked.resize(bundle.rays.len(), false);
        view.occluded(&bundle.rays, &mut bundle.blocked);
        for ((batch, value), blocked) in bundle.contributions.iter().zip(&bundle.blocked) {
            if self.emitters.are_few() {
                scratch.batches.shadow_ray(*batch, *value, *blocked);
            } else if !blocked {
                scratch.batches.add(*batch, *value);
            }
        }
        if !self.emitters.are_few() {
            scratch.batches.count(bundle.rays.len());
        }
        bundle.rays.clear();
        bundle.contributions.clear();
    }
}
