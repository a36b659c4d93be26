//! The integral over directions at one receiver, and its randomised quasi-Monte Carlo estimate.

use glam::{DVec3, Vec3};
use halflight_scenes::Rgb;

use crate::emission::Emission;
use crate::receiver::Receiver;
use crate::sampling::{CosineLobe, Sobol, mix};
use crate::unoccluded::Unoccluded;
use crate::visibility::{View, Visibility};

/// How many samples to take: `batches` independent replicates of `per_batch` (a power of two) each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Plan {
    pub(crate) batches: u32,
    pub(crate) per_batch: u32,
}

impl Plan {
    pub(crate) fn samples(self) -> u32 {
        self.batches * self.per_batch
    }
}

/// What an estimate found at one receiver, for albedo 1.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moments {
    pub(crate) mean: DVec3,
    /// Of the mean.
    pub(crate) variance: DVec3,
    /// Rays traced, or directions held against circles.
    pub(crate) rays: u64,
}

/// `1/π · L(ω) V(ω) max(0, n·ω)` over all directions.
pub(crate) struct Integrand {
    pub(crate) emission: Emission,
    pub(crate) visibility: Visibility,
    /// The integral with `V = 1`.
    pub(crate) unoccluded: Unoccluded,
}

/// Rays that are asked for at once.
const BUNDLE: usize = 1024;

/// Memory that is used again from receiver to receiver.
#[derive(Default)]
pub(crate) struct Scratch {
    directions: Vec<Vec3>,
    /// What each direction adds to its batch if it is not blocked.
    contributions: Vec<(u32, Rgb)>,
    blocked: Vec<bool>,
    batches: Vec<Batch>,
    rays: u64,
    /// Sum of squared contributions, blocked or not.
    squares: DVec3,
    /// The last normal and what it reflects with nothing in the way: neighbours on a plane share both.
    unoccluded: Option<(Vec3, DVec3)>,
}

/// What one batch finds.
#[derive(Clone, Copy, Default)]
struct Batch {
    /// Of the integral.
    visible: DVec3,
    /// Of the integral with `V = 1`.
    open: DVec3,
}

/// A control variate: the integral with `V = 1` is known, and what a batch finds for it tells much of that batch's error.
/// Times the share of the light that is visible this is subtracted, so that in the open and in the dark no error remains.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control {
    /// Any share leaves the estimate without bias that was not chosen by the same samples.
    pub(crate) share: f64,
    pub(crate) known: DVec3,
}

impl Integrand {
    /// Samples one receiver into `scratch`; the same for the same seed.
    pub(crate) fn sample(&self, receiver: &Receiver, plan: Plan, seed: u64, scratch: &mut Scratch) {
        let view = self.visibility.from(receiver);
        scratch.start(plan.batches);
        for batch in 0..plan.batches {
            self.draw(receiver, batch, plan.per_batch, mix(seed, u64::from(batch)), scratch);
            if scratch.directions.len() >= BUNDLE {
                scratch.trace(&view);
            }
        }
        scratch.trace(&view);
    }

    /// The integral with `V = 1`.
    pub(crate) fn unoccluded(&self, normal: Vec3, scratch: &mut Scratch) -> DVec3 {
        match scratch.unoccluded {
            Some((last, known)) if last == normal => known,
            _ => scratch.unoccluded.insert((normal, self.unoccluded.at(normal.as_dvec3()))).1,
        }
    }

    /// Adds one batch's directions that may bring light: several strategies by the balance heuristic.
    fn draw(&self, receiver: &Receiver, batch: u32, count: u32, seed: u64, scratch: &mut Scratch) {
        let lobe = CosineLobe::new(receiver.normal);
        let [cosine, lights] = self.emission.strategies();
        let share = if cosine && lights { (count / 2).max(1) } else { count };
        let (of_lobe, of_lights) = (if cosine { share } else { 0 }, if lights { share } else { 0 });
        let mut add = |direction: Vec3| {
            let cos = receiver.normal.dot(direction);
            if cos <= 0.0 {
                return;
            }
            let (radiance, light_density) = self.emission.look(direction);
            let density = CosineLobe::density(cos);
            let value = radiance * density / (of_lobe as f32 * density + of_lights as f32 * light_density);
            if value != Rgb::ZERO && value.is_finite() {
                scratch.directions.push(direction);
                scratch.contributions.push((batch, value));
            }
        };
        let sobol = Sobol::new(mix(seed, 0));
        (0..of_lobe).for_each(|i| add(lobe.direction(sobol.point(i))));
        let sobol = Sobol::new(mix(seed, 1));
        (0..of_lights).for_each(|i| add(self.emission.direction(sobol.point(i))));
    }
}

impl Scratch {
    fn start(&mut self, batches: u32) {
        self.directions.clear();
        self.contributions.clear();
        self.batches.clear();
        self.batches.resize(batches as usize, Batch::default());
        self.rays = 0;
        self.squares = DVec3::ZERO;
    }

    /// Adds to each batch what is not blocked, and what would be with nothing in the way.
    fn trace(&mut self, view: &View<'_>) {
        self.blocked.clear();
        self.blocked.resize(self.directions.len(), false);
        view.blocked(&self.directions, &mut self.blocked);
        for ((batch, value), blocked) in self.contributions.iter().zip(&self.blocked) {
            let value = value.as_dvec3();
            self.squares += value * value;
            let batch = &mut self.batches[*batch as usize];
            batch.open += value;
            if !blocked {
                batch.visible += value;
            }
        }
        self.rays += self.directions.len() as u64;
        self.directions.clear();
        self.contributions.clear();
    }

    /// The share of the light that is visible, in `[0, 1]`.
    pub(crate) fn share(&self) -> f64 {
        let sum = |part: fn(&Batch) -> DVec3| self.batches.iter().map(|batch| part(batch).element_sum()).sum::<f64>();
        let (visible, open) = (sum(|batch| batch.visible), sum(|batch| batch.open));
        if open > 0.0 { (visible / open).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Mean of the batches' estimates, and the variance that their spread gives it.
    pub(crate) fn moments(&self, control: Control) -> Moments {
        let estimates = || self.batches.iter().map(|b| b.visible - control.share * b.open);
        let batches = self.batches.len() as f64;
        let mean = estimates().sum::<DVec3>() / batches;
        let spread: DVec3 = estimates().map(|estimate| (estimate - mean) * (estimate - mean)).sum();
        let mean = mean + control.share * control.known;
        let variance = spread / (batches * (batches - 1.0)) + self.grain();
        Moments { mean, variance, rays: self.rays }
    }

    /// The variance that half a ray more or less brings. Visibility comes in whole rays and stratified batches often agree
    /// on their number, above all where it is none or all of them; that does not make it certain. By Jeffreys' prior, of `N`
    /// rays that agree about `1/2N` still go the other way. Elsewhere this is far below the batches' spread.
    fn grain(&self) -> DVec3 {
        let batches = self.batches.len() as f64;
        self.squares / (batches * batches) * (0.5 / self.rays.max(1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use halflight_scenes::{Environment, KeyLight, Light, Sky, Sphere};

    use super::*;
    use crate::emission::Lights;
    use crate::statistics::equivalent_z;

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
            let integrand = Integrand {
                emission: Emission::Lights(Lights::new(&lights)),
                visibility: Visibility::Spheres {
                    spheres: Vec::<Sphere>::new(),
                    rule: halflight_proxies::SelfShadow::Off,
                },
                unoccluded: Unoccluded::of(&lights),
            };
            let (mut scratch, mut sum, mut count) = (Scratch::default(), 0.0, 0);
            for i in 0..200u64 {
                let turn = i as f32;
                let normal = Vec3::new(turn.sin(), (1.3 * turn).cos(), (0.7 * turn).sin() + 0.5).normalize();
                let receiver = Receiver { position: Vec3::ZERO, geometric_normal: normal, normal, object: None };
                integrand.sample(&receiver, Plan { batches: 32, per_batch: 128 }, mix(5, i), &mut scratch);
                let moments = scratch.moments(Control { share: 0.0, known: DVec3::ZERO });
                let known = integrand.unoccluded.at(normal.as_dvec3());
                // Only a little of the light near the horizon: few samples carry it, and errors are far from normal.
                if known.y > 0.05 * integrand.unoccluded.at(direction.as_dvec3()).y {
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
