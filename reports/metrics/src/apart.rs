//! How far apart two pictures are that ought to be equal but for rounding.

use crate::picture::comparable;
use crate::{CompareError, Picture};

/// Two pictures of the same receivers by one method on two processors. Neither is the truth of the other, and neither has noise: what
/// differs is rounding, or a mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// Receivers compared: valid and finite in both.
    pub receivers: usize,
    /// Largest absolute difference of a channel, radiance.
    pub max: f64,
    /// The receiver where it is, the first of several; none where nothing differs.
    pub worst: Option<usize>,
    /// Root mean square difference of a channel, radiance.
    pub rmse: f64,
    /// Mean signed difference of a channel, first less second, radiance.
    pub bias: f64,
    /// Root mean square of the second picture over the receivers compared, radiance: what differences are large or small to.
    pub level: f64,
    /// Receivers valid in both with a NaN or infinity in one; they are not compared, so that one of them hides no other difference.
    pub not_finite: usize,
    /// Receivers that are valid in one picture alone.
    pub lone: usize,
}

impl Apart {
    /// Whether everything that should be compared could be.
    pub fn is_whole(&self) -> bool {
        self.not_finite == 0 && self.lone == 0
    }

    /// Whether the pictures are equal, bit by bit but for the sign of zeros.
    pub fn is_nothing(&self) -> bool {
        self.is_whole() && self.worst.is_none()
    }
}

/// Measures how far a picture is from another.
///
/// # Errors
/// Lengths or layouts differ, no receiver is valid in both, or both are the same memory. Values that are not finite are counted, not
/// refused: to find them is what this is for.
pub fn apart(x: &Picture, other: &Picture) -> Result<Apart, CompareError> {
    let receivers = comparable(x, other)?;
    let lone = x.valid.iter().zip(other.valid).filter(|(a, b)| a != b).count();
    let (mut square, mut signed, mut level) = (0.0, 0.0, 0.0);
    let (mut compared, mut max, mut worst) = (0, 0.0, None);
    for &receiver in &receivers {
        let (a, b) = (x.radiance[receiver], other.radiance[receiver]);
        if !a.is_finite() || !b.is_finite() {
            continue;
        }
        compared += 1;
        for (a, b) in a.to_array().into_iter().zip(b.to_array()).map(|(a, b)| (f64::from(a), f64::from(b))) {
            let difference = a - b;
            square += difference * difference;
            signed += difference;
            level += b * b;
            if difference.abs() > max {
                (max, worst) = (difference.abs(), Some(receiver));
            }
        }
    }
    let count = (3 * compared).max(1) as f64;
    Ok(Apart {
        receivers: compared,
        max,
        worst,
        rmse: (square / count).sqrt(),
        bias: signed / count,
        level: (level / count).sqrt(),
        not_finite: receivers.len() - compared,
        lone,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Layout;
    use glam::Vec3;

    const COUNT: usize = 12;

    /// A gradient, and the same with one channel of one receiver changed.
    fn pictures(receiver: usize, change: f32) -> [Vec<Vec3>; 2] {
        let base: Vec<Vec3> = (0..COUNT).map(|i| Vec3::new(0.25, 0.5, 1.0) * (1.0 + i as f32 / 4.0)).collect();
        let mut changed = base.clone();
        changed[receiver].y += change;
        [changed, base]
    }

    fn measured(x: &[Vec3], other: &[Vec3], x_valid: &[bool], other_valid: &[bool]) -> Apart {
        let picture = |radiance, valid| Picture { radiance, valid, layout: Layout::Image { width: 4, height: 3 } };
        apart(&picture(x, x_valid), &picture(other, other_valid)).unwrap()
    }

    #[test]
    fn a_planted_difference_is_found_where_it_is() {
        for (receiver, change) in [(0, 0.5), (7, -0.25), (COUNT - 1, 1.0)] {
            let [x, other] = pictures(receiver, change);
            let found = measured(&x, &other, &[true; COUNT], &[true; COUNT]);
            let size = f64::from(change);
            assert_eq!((found.max, found.worst), (size.abs(), Some(receiver)));
            assert!((found.rmse - size.abs() / 6.0).abs() < 1e-15 && (found.bias - size / 36.0).abs() < 1e-15);
            assert!(found.is_whole() && !found.is_nothing());
        }
    }

    #[test]
    fn equal_pictures_differ_in_nothing() {
        let [x, other] = pictures(3, 0.0);
        let found = measured(&x, &other, &[true; COUNT], &[true; COUNT]);
        assert!(found.is_nothing() && found.receivers == COUNT, "{found:?}");
        assert_eq!((found.max, found.rmse, found.bias, found.worst), (0.0, 0.0, 0.0, None));
        // Of squares from 1 to 3.75: the mean of 1.3125·(1 + i/4)²/3.
        let squares: f64 = (0..COUNT).map(|i| (1.0 + i as f64 / 4.0).powi(2)).sum();
        assert!((found.level - (1.3125 / 3.0 * squares / COUNT as f64).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_hides_nothing() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let [mut x, other] = pictures(7, 0.5);
            x[2].z = value;
            let found = measured(&x, &other, &[true; COUNT], &[true; COUNT]);
            assert_eq!((found.not_finite, found.receivers, found.worst, found.max), (1, COUNT - 1, Some(7), 0.5));
            assert!(!found.is_whole());
            // The other way round, and where nobody looks.
            assert_eq!(measured(&other, &x, &[true; COUNT], &[true; COUNT]).not_finite, 1);
            let mut valid = [true; COUNT];
            valid[2] = false;
            assert!(measured(&x, &other, &valid, &valid).is_whole());
        }
        let all = [Vec3::NAN; COUNT];
        let [_, other] = pictures(0, 0.0);
        let found = measured(&all, &other, &[true; COUNT], &[true; COUNT]);
        assert!(found.not_finite == COUNT && found.receivers == 0 && !found.is_nothing(), "{found:?}");
    }

    #[test]
    fn receivers_of_one_picture_alone_are_told() {
        let [x, other] = pictures(5, 0.5);
        let mut valid = [true; COUNT];
        valid[5] = false;
        let found = measured(&x, &other, &valid, &[true; COUNT]);
        assert_eq!((found.lone, found.receivers, found.worst), (1, COUNT - 1, None));
        assert!(!found.is_whole() && !found.is_nothing());
    }

    #[test]
    fn what_says_nothing_is_refused() {
        let [x, other] = pictures(0, 0.5);
        let picture = |radiance, valid, width| Picture { radiance, valid, layout: Layout::Image { width, height: 3 } };
        let (all, none) = ([true; COUNT], [false; COUNT]);
        let whole = picture(&x, &all, 4);
        assert_eq!(apart(&whole, &whole), Err(CompareError::SamePicture));
        assert_eq!(apart(&whole, &picture(&other, &none, 4)), Err(CompareError::NothingToCompare));
        assert!(matches!(apart(&whole, &picture(&other[1..], &all, 4)), Err(CompareError::Length { .. })));
        assert!(matches!(apart(&whole, &picture(&other, &all, 5)), Err(CompareError::Layout { .. })));
    }
}
