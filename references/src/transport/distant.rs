//! Distant light.

use glam::{DVec3, Vec3};
use halflight_scenes::Rgb;

use super::{Plan, Scratch, Term};
use crate::emission::Emission;
use crate::receiver::Receiver;
use crate::sampling::{CosineLobe, Sobol, mix};
use crate::unoccluded::Unoccluded;
use crate::visibility::{View, Visibility};

/// Light that comes straight from the distance.
pub(crate) struct Distant {
    pub(crate) emission: std::sync::Arc<Emission>,
    pub(crate) visibility: Visibility,
    /// The integral with `V = 1`.
    pub(crate) unoccluded: Unoccluded,
}

impl Term for Distant {
    fn sample(&self, receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch) {
        let view = self.visibility.from(receiver);
        for batch in 0..plan.batches {
            let bundle = &mut scratch.bundle;
            draw(&self.emission, receiver.normal, plan.per_batch, mix(seed, u64::from(batch)), |direction, value| {
                bundle.directions.push(direction);
                bundle.contributions.push((batch, value));
            });
            if scratch.bundle.directions.len() >= super::Bundle::FULL {
                trace(&view, scratch);
            }
        }
        trace(&view, scratch);
    }

    fn known(&self, receiver: &Receiver, scratch: &mut Scratch) -> DVec3 {
        match scratch.open {
            Some((last, known)) if last == receiver.normal => known,
            _ => scratch.open.insert((receiver.normal, self.unoccluded.at(receiver.normal.as_dvec3()))).1,
        }
    }
}

/// Draws one batch's directions that may bring light, several strategies by the balance heuristic, and what each brings of the
/// reflected radiance if nothing is in its way.
pub(super) fn draw(emission: &Emission, normal: Vec3, count: u32, seed: u64, mut add: impl FnMut(Vec3, Rgb)) {
    let lobe = CosineLobe::new(normal);
    let [cosine, lights] = emission.strategies();
    let share = if cosine && lights { (count / 2).max(1) } else { count };
    let (of_lobe, of_lights) = (if cosine { share } else { 0 }, if lights { share } else { 0 });
    let mut weigh = |direction: Vec3| {
        let cos = normal.dot(direction);
        if cos <= 0.0 {
            return;
        }
        let (radiance, light_density) = emission.look(direction);
        let density = CosineLobe::density(cos);
        let value = radiance * density / (of_lobe as f32 * density + of_lights as f32 * light_density);
        if value != Rgb::ZERO && value.is_finite() {
            add(direction, value);
        }
    };
    let sobol = Sobol::new(mix(seed, 0));
    (0..of_lobe).for_each(|i| weigh(lobe.direction(sobol.point(i))));
    let sobol = Sobol::new(mix(seed, 1));
    (0..of_lights).for_each(|i| weigh(emission.direction(sobol.point(i))));
}

/// Adds to each batch what is not blocked, and what would be with nothing in the way.
fn trace(view: &View<'_>, scratch: &mut Scratch) {
    let bundle = &mut scratch.bundle;
    bundle.blocked.clear();
    bundle.blocked.resize(bundle.directions.len(), false);
    view.blocked(&bundle.directions, &mut bundle.blocked);
    for ((batch, value), blocked) in bundle.contributions.iter().zip(&bundle.blocked) {
        scratch.batches.shadow_ray(*batch, *value, *blocked);
    }
    bundle.directions.clear();
    bundle.contributions.clear();
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use halflight_scenes::{Environment, KeyLight, Light, Sky};

    use super::*;
    use crate::emission::Lights;
    use crate::statistics::equivalent_z;
    use crate::transport::Control;
    use crate::visibility::Blockers;

    /// Two ways to the same integral that share nothing but the lights: sampling in `f32`, and closed forms and quadrature.
    #[test]
    fn samples_without_control_agree_with_the_unoccluded_integral() {
        let rough = |i: usize| Rgb::new((i * 7 % 11) as f32, 1.0, if i == 57 { 300.0 } else { (i % 3) as f32 });
        let texels = Arc::new((0..24 * 12).map(rough).collect());
        let map = Light::Environment(Environment { width: 24, height: 12, texels, rotation: 0.7 });
        let direction = Vec3::new(0.5, 0.1, 0.6).normalize();
        let key =
            |angular_radius| Light::Key(KeyLight { direction, angular_radius, radiance: Rgb::new(9.0, 6.0, 3.0) });
        let overcast = Light::Sky(Sky::Overcast(Rgb::new(1.0, 2.0, 3.0)));
        let cases = [
            vec![map.clone()],
            vec![overcast.clone()],
            vec![key(0.4)],
            vec![key(0.005), key(1.5)],
            vec![key(0.3), key(0.31), map.clone(), map.clone()],
            vec![map, overcast, key(0.1), Light::Sky(Sky::Uniform(Rgb::ONE))],
        ];
        for (case, lights) in cases.into_iter().enumerate() {
            let blockers = Blockers::Spheres { spheres: Arc::default(), rule: halflight_proxies::SelfShadow::Off };
            let distant = Distant {
                emission: Arc::new(Emission::Lights(Lights::new(&lights))),
                visibility: Visibility { blockers, upper_sky: false },
                unoccluded: Unoccluded::of(&lights),
            };
            let (mut scratch, mut sum, mut count) = (Scratch::default(), 0.0, 0);
            for i in 0..200u64 {
                let turn = i as f32;
                let normal = Vec3::new(turn.sin(), (1.3 * turn).cos(), (0.7 * turn).sin() + 0.5).normalize();
                let receiver = Receiver { position: Vec3::ZERO, geometric_normal: normal, normal, object: None };
                let plan = Plan { batches: 32, per_batch: 128 };
                scratch.batches.start(plan.batches);
                distant.sample(&receiver, plan, mix(5, i), &mut scratch);
                let moments = scratch.batches.moments(Control { share: 0.0, known: DVec3::ZERO });
                let known = distant.known(&receiver, &mut scratch);
                // Only a little of the light near the horizon: few samples carry it, and errors are far from normal.
                if known.y > 0.05 * distant.unoccluded.at(direction.as_dvec3()).y {
                    let z = equivalent_z(moments.mean.y - known.y, moments.variance.y.sqrt(), 31.0);
                    assert!(z.abs() < 5.0, "case {case}, receiver {i}: z = {z}");
                    sum += z;
                    count += 1;
                }
            }
            assert!(count > 60 && sum.abs() < 3.0 * f64::from(count).sqrt(), "case {case}: {sum} over {count}");
        }
    }
}
