//! Fields to hold horizons against.

use glam::Vec2;
use halflight_scenes::HeightField;

/// A field of `side` vertices a side and unit cells by a function of its vertices' coordinates.
fn square(side: usize, height: impl Fn(f64, f64) -> f64) -> HeightField {
    let vertices = (0..side).flat_map(|j| (0..side).map(move |i| (i as f64, j as f64)));
    let heights = vertices.map(|(x, y)| height(x, y) as f32).collect();
    HeightField::new([side, side], Vec2::ZERO, Vec2::ONE, heights)
}

/// One field of each kind, with its name: terrain, fractal, cone, trench, ramp, steps, noise.
pub fn fields(side: usize) -> [(&'static str, HeightField); 7] {
    let (middle, unit) = ((side / 2) as f64, side as f64 / 16.0);
    let cone = move |x: f64, y: f64| (4.0 * unit - 1.5 * (x - middle).hypot(y - middle)).max(0.0);
    [
        ("terrain", terrain(side, 7)),
        ("fractal", fractal(side, 1)),
        ("cone", square(side, cone)),
        ("trench", trench(side, std::f64::consts::FRAC_PI_4)),
        ("ramp", square(side, |x, y| 0.4 * x + 0.3 * y)),
        ("steps", square(side, move |x, _| 0.5 * unit * (x / unit).floor())),
        ("noise", square(side, |x, y| 2.0 * hash(x, y, 3))),
    ]
}

/// A trench along x through vertex row `side / 2`, its walls rising by `slope` radians to both borders.
pub fn trench(side: usize, slope: f64) -> HeightField {
    let (tangent, middle) = (slope.tan(), (side / 2) as f64);
    square(side, move |_, y| tangent * (y - middle).abs())
}

/// Smooth hills with ridges: two octaves of smooth noise folded at 0 over two that are not.
fn terrain(side: usize, seed: u32) -> HeightField {
    let wide = side as f64 / 3.0;
    square(side, move |x, y| {
        let octave = |width: f64, salt: u32| smooth([x / width, y / width], seed.wrapping_add(salt));
        let ridges = 0.16 * (1.0 - octave(wide, 0).abs()) + 0.05 * (1.0 - octave(wide / 3.0, 1).abs());
        wide * (ridges + 0.25 * octave(wide * 1.7, 2) + 0.02 * octave(wide / 8.0, 3))
    })
}

/// A fractal of `side` vertices a side: octaves of smooth noise, each half as wide and 0.55 as high as the one before, unit cells.
pub fn fractal(side: usize, seed: u32) -> HeightField {
    let octaves = side.ilog2().saturating_sub(1);
    square(side, |x, y| {
        let octave = |octave: u32| {
            let (width, height) =
                (side as f64 / f64::from(2 << octave), side as f64 / 4.0 * 0.55_f64.powi(octave as i32));
            height * smooth([x / width, y / width], seed.wrapping_mul(31).wrapping_add(octave))
        };
        (0..octaves).map(octave).sum()
    })
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
