//! A scene seen from a square grid of receivers on its ground, with what plain code needs of it.

use super::bench::{Bench, silent};
use crate::Error;
use crate::recorder::Recorder;
use glam::Vec3;
use halflight_contract::{Backend, Job, Params};
use halflight_light::LightOf;
use halflight_proxies::{Circle, SelfShadow, blockers, proxies, seen};
use halflight_scenes::{Frame, Scene, Sphere};
use halflight_sh::{CircleTable, coefficients, gamma, irradiance_weights, rotate_zonal};
use rayon::prelude::*;

/// The scene, its frame and the spheres that block.
pub(crate) struct Ground {
    pub(crate) scene: Scene,
    pub(crate) frame: Frame,
    pub(crate) spheres: Vec<Sphere>,
}

impl Ground {
    /// `side²` receivers on the plane z = 0, `size` metres wide about the origin, before sets of so many spheres an object.
    pub(crate) fn new(bench: &Bench, name: &str, size: f32, side: usize, spheres: usize) -> Result<Ground, Error> {
        let at = |i: usize| (i as f32 / (side - 1) as f32 - 0.5) * size;
        let point = |i| (Vec3::new(at(i % side), at(i / side), 0.0), Vec3::Z);
        let points: Vec<(Vec3, Vec3)> = (0..side * side).map(point).collect();
        let scene = halflight_scenes::find(name)?.with_receivers(&points);
        let frame = scene.frame(0);
        let params = Params::default();
        let job = Job::new(&scene, &params, 1, Backend::Cpu, &bench.cache);
        let sets = proxies(&job, spheres, &mut Recorder::new(&mut silent)).map_err(|e| Error::Other(e.to_string()))?;
        let spheres = blockers(&scene, &frame, &sets).spheres;
        drop(job);
        Ok(Ground { scene, frame, spheres })
    }

    /// The circles that a receiver sees.
    pub(crate) fn circles(&self, receiver: usize) -> impl Iterator<Item = Circle> {
        let receivers = &self.frame.receivers;
        let (position, normal) = (receivers.position[receiver], receivers.geometric_normal[receiver]);
        self.spheres.iter().filter_map(move |sphere| seen(SelfShadow::Paper, position, normal, sphere))
    }

    /// The sums of log visibilities at receivers that see any blocker, `order²` each.
    pub(crate) fn logs(&self, order: usize) -> Vec<Vec<f32>> {
        let log = |receiver| {
            let (mut zonal, mut circle) = (vec![0.0; order], vec![0.0; coefficients(order)]);
            let mut sum = vec![0.0f32; coefficients(order)];
            for Circle { axis, sin_angle, .. } in self.circles(receiver) {
                CircleTable::log(order).lookup(sin_angle, &mut zonal);
                rotate_zonal(order, &zonal, axis.to_array(), &mut circle);
                sum.iter_mut().zip(&circle).for_each(|(sum, value)| *sum += value);
            }
            sum
        };
        let all = (0..self.frame.receivers.len()).into_par_iter().map(log);
        all.filter(|log| log.iter().any(|value| *value != 0.0)).collect()
    }

    /// `H(z) * L` for each colour: what a receiver's visibility is dotted with.
    pub(crate) fn transfer(&self, bench: &Bench, order: usize) -> Result<[Vec<f32>; 3], Error> {
        let light = light(bench, &self.scene, order)?;
        let mut weights = vec![0.0; coefficients(order)];
        irradiance_weights(order, [0.0, 0.0, 1.0], &mut weights);
        Ok(light.map(|channel| {
            let mut product = vec![0.0; coefficients(order)];
            gamma(order).product(&weights, &channel, &mut product);
            product
        }))
    }
}

/// The distant light of a scene in SH at second 0.
pub(crate) fn light(bench: &Bench, scene: &Scene, order: usize) -> Result<[Vec<f32>; 3], Error> {
    let params = Params::default();
    let job = Job::new(scene, &params, 1, Backend::Cpu, &bench.cache);
    let light = job.derive(&LightOf { order }, &mut Recorder::new(&mut silent));
    Ok(light.map_err(|error| Error::Other(error.to_string()))?.at(0.0).rgb.clone())
}
