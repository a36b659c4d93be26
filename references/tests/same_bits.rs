//! The same seed gives the same bits, whatever the threads; other seeds and references give independent errors.

mod support;

use glam::Vec3;
use halflight_contract::{Cache, Error as ContractError, Flow, Meter, Quantity};
use halflight_references::{Error, Estimate, Quality, Reference, Request, estimate};
use halflight_scenes::{Rgb, Scene};
use support::*;

fn busy() -> Scene {
    let points: Vec<_> = (0..1500).map(|i| (Vec3::new(i as f32 * 0.002 - 1.5, 0.4, 0.0), Vec3::Z)).collect();
    let lights =
        vec![sky(0.2), map(8, 4, |x, y| Rgb::new(x as f32, y as f32, 1.0)), key(Vec3::new(1.0, 0.0, 1.0), 0.1, 20.0)];
    scene(vec![spheres(&[(Vec3::new(0.0, 0.0, 0.7), 0.5)]), ball(Vec3::new(0.9, 0.5, 0.6), 0.4, 12)], lights, &points)
}

fn with_threads(threads: usize, reference: &str, quantity: Quantity, seed: u64) -> Estimate {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    let quality = Quality { max_samples: 256, ..Quality::default() };
    pool.install(|| run_of(quantity, reference, &busy(), &quality, seed).expect("an estimate"))
}

#[test]
fn one_and_two_threads_agree_and_seeds_do_not() {
    for (reference, quantity) in [
        ("truth", Quantity::Direct),
        ("truth", Quantity::Total),
        ("sh-light:3", Quantity::Direct),
        ("sphere-proxies:8", Quantity::Direct),
        ("sh-visibility:3", Quantity::Direct),
        ("unoccluded-indirect", Quantity::Indirect { bounces: 2 }),
    ] {
        let one = with_threads(1, reference, quantity, 7);
        assert_eq!(one, with_threads(2, reference, quantity, 7), "{reference}");
        assert_ne!(one, with_threads(2, reference, quantity, 8), "{reference}");
        assert!(one.mean.iter().chain(&one.variance).all(|v| v.is_finite()));
    }
}

#[test]
fn receivers_at_one_place_have_errors_of_their_own() {
    let Scene { objects, lights, .. } = busy();
    let scene = scene(
        objects,
        lights.into_iter().map(|light| light.rest).collect(),
        &[(Vec3::new(-0.5, 0.4, 0.0), Vec3::Z); 100],
    );
    let estimate = run("truth", &scene, &Quality::fixed(64), 1);
    let mut means: Vec<u32> = estimate.mean.iter().map(|mean| mean.x.to_bits()).collect();
    means.sort_unstable();
    means.dedup();
    assert!(means.len() > 95, "{} of 100 differ", means.len());
}

#[test]
fn sh_light_of_a_uniform_sky_is_truth() {
    let scene = Scene { lights: vec![sky(1.0).into()], ..busy() };
    let (truth, sh) =
        (run("truth", &scene, &Quality::fixed(1024), 1), run("sh-light:4", &scene, &Quality::fixed(1024), 1));
    let mut sum = 0.0;
    for i in 0..truth.mean.len() {
        let error = (truth.variance[i].x + sh.variance[i].x).sqrt();
        let z = (truth.mean[i].x - sh.mean[i].x) / error;
        assert!(z.abs() < 5.5, "receiver {i}: {z}");
        sum += z;
    }
    assert!(sum.abs() <= 3.0 * (truth.mean.len() as f32).sqrt(), "mean z {}", sum / truth.mean.len() as f32);
    assert_ne!(truth.mean, sh.mean, "references of one seed have errors of their own");
}

/// Cancels at the second report.
struct Impatient(u32);

impl Meter for Impatient {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, what: &'static str, done: u64, total: u64) -> Flow {
        assert_eq!((what, total), ("reference", 1500));
        self.0 += 1;
        assert!(done < total && self.0 <= 2, "went on after the cancellation");
        if self.0 == 2 { Flow::Cancel } else { Flow::Continue }
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

#[test]
fn cancelling_stops() {
    let scene = busy();
    let quality = Quality::default();
    let (reference, frame) = (&Reference::TRUTH, &scene.frame(0));
    let request = Request { reference, quantity: Quantity::Direct, scene: &scene, frame, quality: &quality, seed: 1 };
    let result = estimate(&request, &Cache::in_memory(), &mut Impatient(0));
    assert!(matches!(result, Err(Error::Contract(ContractError::Cancelled))), "{result:?}");
}
