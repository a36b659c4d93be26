//! Local lights: spheres that emit, seen from each receiver as circles of light (Ren 2006, §7, "Analytic Lights").
//!
//! The paper tabulates `H(N) * L` over the light's angular radius and its angle to the normal, fits a lobe that is cheap to rotate, and
//! takes its dot product with the visibility ([`Lobes`]). By default a lamp's light with nothing in the way is known in closed form, and
//! spherical harmonics say only which share of the circle is visible, `(g, L)/(1, L)`: nothing is fitted, the clamped cosine is not
//! truncated, no light comes from below the horizon, and a lamp costs its zonal coefficients, a rotation and a dot product.
//! In the scene `lamp` both err alike (RMSE at orders 4 and 6: 0.0637 and 0.0474 by shares, 0.0626 and 0.0468 by lobes), but shares are
//! exact in the open, where one lobe of order 4 is up to 10% off.

mod lobes;

use std::f32::consts::PI;

use halflight_scenes::{Frame, Rgb, Scene, Shape, Sphere};
use halflight_sh::{Batch, Block, LANES, coefficients};

pub(crate) use lobes::Lobes;
#[cfg(feature = "gpu")]
pub(crate) use lobes::{ANGLES, TILTS};

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

/// 16 receivers with their visibilities.
pub(crate) struct Seers<'a> {
    pub(crate) position: [Block<f32>; 3],
    /// Shading normals.
    pub(crate) normal: [Block<f32>; 3],
    /// `order²` blocks.
    pub(crate) visibility: &'a [Block<f32>],
}

/// One task's scratch.
pub(crate) struct Glow {
    batch: Batch,
    zonal: Vec<Block<f32>>,
    light: Vec<Block<f32>>,
}

/// A lamp's circle as 16 receivers see it.
struct Circle {
    direction: [Block<f32>; 3],
    sine: Block<f32>,
    /// Of the angle between its middle and the normal.
    cosine: Block<f32>,
    /// `1/π ∫ max(0, n·ω) dω` over it.
    open: Block<f32>,
}

/// How lamps shine.
pub(crate) struct Shine<'a> {
    /// A factor for each band of light.
    pub(crate) window: &'a [f32],
    /// Keeps visible shares within [0, 1], which ringing leaves.
    pub(crate) guard: bool,
    /// The paper's way, if that is asked for; `window` is in it.
    pub(crate) lobes: Option<&'a Lobes>,
}

impl Glow {
    pub(crate) fn new(batch: Batch) -> Self {
        let blocks = |count| vec![Block::ZERO; count];
        Glow { batch, zonal: blocks(batch.order()), light: blocks(coefficients(batch.order())) }
    }

    /// Adds what lamps bring to surfaces of albedo 1.
    pub(crate) fn add(
        &mut self,
        lamps: &[Lamp],
        seers: &Seers<'_>,
        shine: &Shine<'_>,
        irradiance: &mut [Block<f32>; 3],
    ) {
        for lamp in lamps {
            let circle = Circle::new(lamp.sphere, seers);
            let seen = match shine.lobes {
                Some(lobes) => self.by_lobe(lobes, &circle, seers),
                None if circle.open.0.iter().all(|open| *open == 0.0) => continue,
                None => self.by_share(shine, &circle, seers),
            };
            for (sum, radiance) in irradiance.iter_mut().zip(lamp.radiance.to_array()) {
                sum.0.iter_mut().zip(seen.0).for_each(|(sum, seen)| *sum += radiance * seen);
            }
        }
    }

    /// What is visible of a lamp of radiance 1: its irradiance times the share of its circle that visibility leaves.
    fn by_share(&mut self, shine: &Shine<'_>, circle: &Circle, seers: &Seers<'_>) -> Block<f32> {
        self.batch.circle_lights(&[circle.sine], &mut self.zonal);
        let whole = self.zonal[0]; // times the open sky's first coefficient, which y₀₀ makes 1
        self.batch.scale(shine.window, &mut self.zonal);
        self.batch.rotate_zonal(&self.zonal, &[circle.direction], &mut self.light);
        let seen = self.batch.dot_each(&self.light, seers.visibility);
        Block(std::array::from_fn(|lane| {
            let open = circle.open.0[lane];
            let share = if open > 0.0 { seen.0[lane] / (whole.0[lane] * (4.0 * PI).sqrt()) } else { 0.0 };
            open * if shine.guard { share.clamp(0.0, 1.0) } else { share }
        }))
    }

    /// What is visible of a lamp of radiance 1 by the lobe of `H(N) * L`.
    fn by_lobe(&mut self, lobes: &Lobes, circle: &Circle, seers: &Seers<'_>) -> Block<f32> {
        let mut axis = [Block::ZERO; 3];
        let mut zonal = [0.0; halflight_sh::MAX_ORDER];
        let zonal = &mut zonal[..self.batch.order()];
        for lane in 0..LANES {
            let cosine = circle.cosine.0[lane];
            let (sin, cos) = lobes.lookup(circle.sine.0[lane], cosine, zonal).sin_cos();
            self.zonal.iter_mut().zip(&*zonal).for_each(|(block, value)| block.0[lane] = *value);
            let across = (1.0 - cosine * cosine).max(1e-12).sqrt();
            for (axis, (normal, direction)) in axis.iter_mut().zip(seers.normal.iter().zip(&circle.direction)) {
                let sideways = (direction.0[lane] - cosine * normal.0[lane]) / across;
                axis.0[lane] = cos * normal.0[lane] + sin * sideways;
            }
        }
        self.batch.rotate_zonal(&self.zonal, &[axis], &mut self.light);
        self.batch.dot_each(&self.light, seers.visibility)
    }
}

impl Circle {
    /// Receivers inside the sphere see none of its light: it leaves its front.
    fn new(sphere: Sphere, seers: &Seers<'_>) -> Self {
        let mut circle =
            Circle { direction: [Block::ZERO; 3], sine: Block::ZERO, cosine: Block::ZERO, open: Block::ZERO };
        let center = sphere.center.to_array();
        for lane in 0..LANES {
            let to = [0, 1, 2].map(|axis| center[axis] - seers.position[axis].0[lane]);
            let distance = to.iter().map(|v| v * v).sum::<f32>().sqrt();
            if distance > sphere.radius {
                let direction = to.map(|v| v / distance);
                let cosine = (0..3).map(|axis| direction[axis] * seers.normal[axis].0[lane]).sum();
                circle.direction.iter_mut().zip(direction).for_each(|(axis, v)| axis.0[lane] = v);
                circle.sine.0[lane] = sphere.radius / distance;
                circle.cosine.0[lane] = cosine;
                circle.open.0[lane] = open(circle.sine.0[lane], cosine);
            }
        }
        circle
    }
}

/// `1/π ∫ max(0, n·ω) dω` over a circle of angular radius θ by sin θ and the cosine of the angle between its middle and the normal: `sin²θ cos γ`
/// above the horizon, 0 below, and what a plane leaves of a circle between.
fn open(sine: f32, cosine: f32) -> f32 {
    let square = sine * sine;
    if cosine.abs() >= sine {
        return square * cosine.max(0.0);
    }
    let (cut, rest) = ((sine - cosine) * (sine + cosine), (1.0 - square).max(0.0));
    // Both of the same root, so that what it is off by cancels at the rim.
    let turn = cut.sqrt().atan2(-cosine * rest.sqrt());
    let chord = cut.sqrt().atan2(rest.sqrt());
    let kept = square * cosine * turn + segment(chord) + 0.5 * cosine * cosine * (2.0 * chord).sin();
    (kept / PI).max(0.0)
}

/// `x − sin(2x)/2`, to the last digits where it is small.
fn segment(x: f32) -> f32 {
    let square = x * x;
    if square < 0.1 {
        return x * square * (2.0 / 3.0 - square * (2.0 / 15.0 - square * (4.0 / 315.0 - square * (2.0 / 2835.0))));
    }
    x - 0.5 * (2.0 * x).sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral over the circle in rings about its middle.
    fn integral(angle: f64, tilt: f64) -> f64 {
        let (rings, turns) = (600, 600);
        let mut sum = 0.0;
        for ring in 0..rings {
            let theta = (f64::from(ring) + 0.5) / f64::from(rings) * angle;
            for turn in 0..turns {
                let phi = (f64::from(turn) + 0.5) / f64::from(turns) * std::f64::consts::TAU;
                let cosine = theta.cos() * tilt.cos() + theta.sin() * phi.cos() * tilt.sin();
                sum += cosine.max(0.0) * theta.sin();
            }
        }
        sum * angle / f64::from(rings) * 2.0 / f64::from(turns)
    }

    #[test]
    fn open_lamps_give_their_integral_at_every_tilt() {
        for angle in [0.01f64, 0.3, 0.9, 1.4] {
            for step in 0..=40 {
                let tilt = f64::from(step) / 40.0 * std::f64::consts::PI;
                let (exact, found) = (integral(angle, tilt), open(angle.sin() as f32, tilt.cos() as f32));
                let error = (f64::from(found) - exact).abs() / angle.sin().powi(2);
                assert!(error < 2e-4, "{angle} {tilt}: {found} for {exact}");
            }
        }
    }

    #[test]
    fn tiny_lamps_lose_no_digits_and_the_rim_does_not_jump() {
        for sine in [1e-6f32, 1e-3, 0.1, 0.999] {
            assert_eq!(open(sine, 1.0), sine * sine);
            assert_eq!(open(sine, -sine), 0.0);
            for side in [1.0, -1.0] {
                let (inside, outside) = (open(sine, side * sine * 0.999), open(sine, side * sine * 1.001));
                assert!((inside - outside).abs() < 4e-3 * sine.powi(3), "{sine}: {inside} and {outside}");
            }
        }
    }
}
