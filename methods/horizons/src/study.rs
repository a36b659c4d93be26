//! Error of horizons over terrain, fractal, cone, trench, ramp, steps and noise.

use glam::Vec2;
use halflight_scenes::HeightField;

/// A fractal of `side` vertices a side: octaves of smooth noise, each half as wide and 0.55 as high as the one before, unit cells.
pub fn fractal(side: usize, seed: u32) -> HeightField {
    let mut heights = vec![0.0_f64; side * side];
    let (mut width, mut height, mut octave) = (side as f64 / 2.0, side as f64 / 4.0, 0);
    while width >= 2.0 {
        for (vertex, sum) in heights.iter_mut().enumerate() {
            let at = [vertex % side, vertex / side].map(|at| at as f64 / width);
            *sum += height * smooth(at, seed.wrapping_mul(31).wrapping_add(octave));
        }
        (width, height, octave) = (width / 2.0, height * 0.55, octave + 1);
    }
    let heights = heights.into_iter().map(|height| height as f32).collect();
    HeightField::new([side, side], Vec2::ZERO, Vec2::ONE, heights)
}

/// Noise in `[-1, 1]` with a smooth step between whole coordinates.
fn smooth(at: [f64; 2], seed: u32) -> f64 {
    let cell = at.map(f64::floor);
    let [u, v] = [0, 1].map(|axis| {
        let t = at[axis] - cell[axis];
        t * t * (3.0 - 2.0 * t)
    });
    let corner = |i: f64, j: f64| hash(cell[0] + i, cell[1] + j, seed);
    let low = corner(0.0, 0.0) * (1.0 - u) + corner(1.0, 0.0) * u;
    let high = corner(0.0, 1.0) * (1.0 - u) + corner(1.0, 1.0) * u;
    low * (1.0 - v) + high * v
}

/// A number in `[-1, 1]` by two whole ones.
fn hash(i: f64, j: f64, seed: u32) -> f64 {
    let mut bits = (i as i64 as u32).wrapping_mul(0x9e37_79b1)
        ^ (j as i64 as u32).wrapping_mul(0x85eb_ca77)
        ^ seed.wrapping_mul(0xc2b2_ae3d);
    for _ in 0..2 {
        bits ^= bits >> 16;
        bits = bits.wrapping_mul(0x45d9_f3b5);
    }
    bits ^= bits >> 16;
    f64::from(bits) / f64::from(u32::MAX) * 2.0 - 1.0
}
