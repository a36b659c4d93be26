//! Fingerprints: means over the blocks of a coarse grid, few enough to be kept as text, many enough to tell pictures apart.
//!
//! Error measures hardly move where a picture is off by 1% in the direction of its own error, and say nothing of *which*
//! picture it is; block means do both. What they do not see, changes inside a block that cancel, error measures see.

use crate::{CompareError, Layout, Picture};
use glam::Vec3;

/// Columns of blocks.
pub const COLUMNS: usize = 4;

/// Rows of blocks.
pub const ROWS: usize = 3;

/// The mean over a block's valid receivers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Mean of each channel, radiance.
    pub mean: [f64; 3],
    /// Its standard error, receivers' errors being independent; 0 without noise.
    pub error: [f64; 3],
    /// As many receivers of equal variance would know `error` as well as these do: `(Σσ²)²/Σσ⁴` of the least channel. 0 without
    /// noise. Times the degrees of freedom of one receiver's variance, those of the block's (Satterthwaite 1946).
    pub effective: f64,
}

/// What a picture is known by.
#[derive(Clone, Debug, PartialEq)]
pub struct Fingerprint {
    /// [`ROWS`] by [`COLUMNS`] blocks, row by row, from an image's top; of a list, stretches of equal length. None where no
    /// receiver is valid.
    pub blocks: Vec<Option<Block>>,
    /// Root mean square radiance over valid receivers and channels.
    pub level: f64,
    /// Valid receivers.
    pub receivers: usize,
}

/// Takes the fingerprint of a picture whose receivers have these variances, zeros where there is no noise.
///
/// # Errors
/// Lengths do not fit, no receiver is valid, or a value that counts is not finite.
pub fn fingerprint(picture: &Picture, variance: &[Vec3]) -> Result<Fingerprint, CompareError> {
    let count = picture.receivers();
    for (what, actual) in [
        ("the picture's radiance", picture.radiance.len()),
        ("the picture's validity", picture.valid.len()),
        ("the picture's variance", variance.len()),
    ] {
        if actual != count {
            return Err(CompareError::Length { what, actual, expected: count });
        }
    }
    let mut sums = [Sums::default(); ROWS * COLUMNS];
    let mut square = 0.0;
    for receiver in (0..count).filter(|receiver| picture.valid[*receiver]) {
        let (value, variance) = (picture.radiance[receiver], variance[receiver]);
        let not_finite = |what| Err(CompareError::NotFinite { what, receiver });
        if !value.is_finite() {
            return not_finite("the picture's radiance");
        }
        if !variance.is_finite() || variance.min_element() < 0.0 {
            return not_finite("the picture's variance");
        }
        sums[block_of(receiver, count, picture.layout)].add(value, variance);
        square += value.as_dvec3().length_squared();
    }
    let receivers: usize = sums.iter().map(|sums| sums.receivers).sum();
    if receivers == 0 {
        return Err(CompareError::NothingToCompare);
    }
    Ok(Fingerprint {
        blocks: sums.iter().map(Sums::block).collect(),
        level: (square / (3 * receivers) as f64).sqrt(),
        receivers,
    })
}

fn block_of(receiver: usize, count: usize, layout: Layout) -> usize {
    match layout {
        Layout::Image { width, height } => {
            receiver / width * ROWS / height * COLUMNS + receiver % width * COLUMNS / width
        }
        Layout::List => receiver * ROWS * COLUMNS / count,
    }
}

#[derive(Clone, Copy, Default)]
struct Sums {
    receivers: usize,
    value: [f64; 3],
    variance: [f64; 3],
    variance_squared: [f64; 3],
}

impl Sums {
    fn add(&mut self, value: Vec3, variance: Vec3) {
        self.receivers += 1;
        for c in 0..3 {
            let variance = f64::from(variance[c]);
            self.value[c] += f64::from(value[c]);
            self.variance[c] += variance;
            self.variance_squared[c] += variance * variance;
        }
    }

    fn block(&self) -> Option<Block> {
        let count = self.receivers as f64;
        let effective = |c: usize| self.variance[c] * self.variance[c] / self.variance_squared[c];
        (self.receivers > 0).then(|| Block {
            mean: self.value.map(|sum| sum / count),
            error: self.variance.map(|sum| sum.sqrt() / count),
            effective: (0..3).map(effective).filter(|e| e.is_finite()).reduce(f64::min).unwrap_or(0.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 10;
    const HEIGHT: usize = 7;

    fn of(radiance: &[Vec3], variance: &[Vec3], valid: &[bool], layout: Layout) -> Result<Fingerprint, CompareError> {
        fingerprint(&Picture { radiance, valid, layout }, variance)
    }

    #[test]
    fn blocks_cover_an_image_once_and_in_order() {
        // One receiver after another lit: each lights one block, by its share of it.
        let layout = Layout::Image { width: WIDTH, height: HEIGHT };
        let (valid, zeros) = ([true; WIDTH * HEIGHT], [Vec3::ZERO; WIDTH * HEIGHT]);
        let mut receivers = [0.0; ROWS * COLUMNS];
        for lit in 0..WIDTH * HEIGHT {
            let mut radiance = zeros;
            radiance[lit] = Vec3::new(1.0, 2.0, 0.0);
            let f = of(&radiance, &zeros, &valid, layout).unwrap();
            let bright: Vec<_> = (0..f.blocks.len()).filter(|b| f.blocks[*b].unwrap().mean[0] > 0.0).collect();
            let (x, y) = (lit % WIDTH, lit / WIDTH);
            assert_eq!(bright, [y * ROWS / HEIGHT * COLUMNS + x * COLUMNS / WIDTH], "{x} {y}");
            let block = f.blocks[bright[0]].unwrap();
            assert_eq!((block.mean[1], block.mean[2], block.error), (2.0 * block.mean[0], 0.0, [0.0; 3]));
            receivers[bright[0]] += block.mean[0];
        }
        receivers.iter().for_each(|share| assert!((share - 1.0).abs() < 1e-12, "{receivers:?}"));
    }

    #[test]
    fn errors_are_those_of_means() {
        let variance: Vec<Vec3> = (0..24).map(|i| if i % 2 == 0 { Vec3::splat(4.0) } else { Vec3::ZERO }).collect();
        let valid: Vec<bool> = (0..24).map(|i| i != 23).collect();
        let f = of(&[Vec3::ONE; 24], &variance, &valid, Layout::List).unwrap();
        assert_eq!((f.receivers, f.level, f.blocks.len()), (23, 1.0, 12));
        assert_eq!(f.blocks[0], Some(Block { mean: [1.0; 3], error: [1.0; 3], effective: 1.0 }));
        assert_eq!(f.blocks[11], Some(Block { mean: [1.0; 3], error: [2.0; 3], effective: 1.0 }));
        let few = of(&[Vec3::ONE; 3], &[Vec3::ONE; 3], &[true, true, false], Layout::List).unwrap();
        assert_eq!(few.blocks.iter().flatten().count(), 2);
    }

    #[test]
    fn what_says_nothing_is_an_error() {
        let layout = Layout::Image { width: 2, height: 1 };
        let (ones, both) = ([Vec3::ONE; 2], [true; 2]);
        assert_eq!(of(&ones, &ones, &[false; 2], layout), Err(CompareError::NothingToCompare));
        assert!(matches!(of(&ones, &ones[1..], &both, layout), Err(CompareError::Length { .. })));
        assert!(matches!(of(&[], &[], &[], Layout::List), Err(CompareError::NothingToCompare)));
        let nan = [Vec3::ONE, Vec3::NAN];
        assert!(matches!(of(&nan, &ones, &both, layout), Err(CompareError::NotFinite { receiver: 1, .. })));
        assert!(matches!(of(&ones, &nan, &both, layout), Err(CompareError::NotFinite { receiver: 1, .. })));
        assert!(of(&nan, &nan, &[true, false], layout).is_ok());
    }
}
