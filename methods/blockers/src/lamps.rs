//! Local lights: spheres that emit, seen from each receiver as circles of light (Ren 2006, §7, "Analytic Lights").
//!
//! The paper tabulates `H(N) * L` over the light's angular radius and its angle to the normal, and fits a lobe that is cheap to rotate.
//! Here `H(N) * g` is at hand in lanes for all lights together, so that a lamp costs its zonal coefficients, a rotation and a dot product,
//! and nothing is fitted.

use halflight_scenes::{Frame, Rgb, Scene, Shape, Sphere};
use halflight_sh::{Batch, Block, LANES, coefficients};

/// A sphere that emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lamp {
    pub(crate) sphere: Sphere,
    pub(crate) radiance: Rgb,
}

/// Whether an object is made of lamps.
pub(crate) fn is_lamp(scene: &Scene, object: usize) -> bool {
    let object = &scene.objects[object];
    object.emits() && matches!(*object.shape, Shape::Spheres(_))
}

/// The lamps of a frame.
pub(crate) fn lamps(scene: &Scene, frame: &Frame) -> Vec<Lamp> {
    let mut lamps = Vec::new();
    for posed in frame.objects.iter().filter(|posed| is_lamp(scene, posed.object)) {
        if let Shape::Spheres(spheres) = &*posed.in_place() {
            let radiance = |i| scene.objects[posed.object].emission.of(i);
            lamps.extend(spheres.iter().enumerate().map(|(i, sphere)| Lamp { sphere: *sphere, radiance: radiance(i) }));
        }
    }
    lamps
}

/// One task's scratch.
pub(crate) struct Glow {
    batch: Batch,
    zonal: Vec<Block<f32>>,
    light: Vec<Block<f32>>,
}

impl Glow {
    pub(crate) fn new(batch: Batch) -> Self {
        let blocks = |count| vec![Block::ZERO; count];
        Glow { batch, zonal: blocks(batch.order()), light: blocks(coefficients(batch.order())) }
    }

    /// Adds what lamps bring to receivers at `position` with `transfer`, `H(N) * g`. Receivers inside a lamp see none of its light: it
    /// leaves its front. `window` holds a factor a band.
    pub(crate) fn add(
        &mut self,
        lamps: &[Lamp],
        position: &[Block<f32>; 3],
        transfer: &[Block<f32>],
        window: &[f32],
        irradiance: &mut [Block<f32>; 3],
    ) {
        for lamp in lamps {
            let (direction, sine) = seen(lamp.sphere, position);
            self.batch.circle_lights(&[sine], &mut self.zonal);
            self.batch.scale(window, &mut self.zonal);
            self.batch.rotate_zonal(&self.zonal, &[direction], &mut self.light);
            let share = self.batch.dot_each(&self.light, transfer);
            for (sum, radiance) in irradiance.iter_mut().zip(lamp.radiance.to_array()) {
                sum.0.iter_mut().zip(share.0).for_each(|(sum, share)| *sum += radiance * share);
            }
        }
    }
}

/// Unit directions and sines of the angular radii; 0 inside the sphere.
fn seen(sphere: Sphere, position: &[Block<f32>; 3]) -> ([Block<f32>; 3], Block<f32>) {
    let center = sphere.center.to_array();
    let mut to: [Block<f32>; 3] =
        std::array::from_fn(|axis| Block(position[axis].0.map(|position| center[axis] - position)));
    let mut sine = Block::ZERO;
    for lane in 0..LANES {
        let [x, y, z] = [0, 1, 2].map(|axis| to[axis].0[lane]);
        let distance = (x * x + y * y + z * z).sqrt();
        let outside = distance > sphere.radius;
        sine.0[lane] = if outside { sphere.radius / distance } else { 0.0 };
        let nearness = if outside { 1.0 / distance } else { 0.0 };
        to.iter_mut().for_each(|axis| axis.0[lane] *= nearness);
    }
    (to, sine)
}
