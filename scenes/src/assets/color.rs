//! From the primaries of a file to those of Rec. 709.

use glam::{DMat3, DVec2, DVec3, Mat3};

use crate::Rgb;
use crate::SceneError;
use crate::check::Checker;

/// CIE xy of red, green, blue and white.
pub(super) type Chromaticities = [[f32; 2]; 4];

pub(super) const REC_709: Chromaticities = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];

/// Chromaticities that are no further from Rec. 709 are taken for it: writers round.
const SAME: f32 = 1e-3;

/// Bradford's cone responses (Lam 1985), by columns.
const BRADFORD: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

/// What makes linear colours of some primaries those of Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ToRec709 {
    /// None where the primaries are Rec. 709's own: such colours keep their bits.
    matrix: Option<Mat3>,
}

impl ToRec709 {
    /// From the primaries that a file names, if it does.
    ///
    /// # Errors
    /// Chromaticities that span no colours.
    pub(super) fn new(check: Checker, from: Option<Chromaticities>) -> Result<Self, SceneError> {
        let wide = from.filter(|given| !same(given));
        let expected = "CIE xy of red, green, blue and white that span colours";
        let matrix =
            wide.map(|given| to_rec709(&given).ok_or_else(|| check.invalid("chromaticities", expected, given)));
        Ok(ToRec709 { matrix: matrix.transpose()? })
    }

    pub(super) fn of(&self, color: Rgb) -> Rgb {
        self.matrix.map_or(color, |matrix| matrix * color)
    }
}

fn same(given: &Chromaticities) -> bool {
    given.iter().flatten().zip(REC_709.iter().flatten()).all(|(a, b)| (a - b).abs() <= SAME)
}

/// The light of a number in sRGB (IEC 61966-2-1).
pub(crate) fn linear(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// White stays white (Bradford); none where the primaries or whites are no colours.
fn to_rec709(from: &Chromaticities) -> Option<Mat3> {
    let white = |given: &Chromaticities| BRADFORD * xyz(given[3]);
    let adapt = DMat3::from_diagonal(white(&REC_709) / white(from));
    let matrix = to_xyz(&REC_709)?.inverse() * BRADFORD.inverse() * adapt * BRADFORD * to_xyz(from)?;
    matrix.is_finite().then(|| matrix.as_mat3())
}

/// The XYZ of linear colours whose white has Y = 1.
fn to_xyz(of: &Chromaticities) -> Option<DMat3> {
    let [red, green, blue] = [0, 1, 2].map(|i| xyz(of[i]));
    let primaries = DMat3::from_cols(red, green, blue);
    (primaries.is_finite() && primaries.determinant().abs() > 1e-6)
        .then(|| primaries * DMat3::from_diagonal(primaries.inverse() * xyz(of[3])))
}

/// At Y = 1.
fn xyz([x, y]: [f32; 2]) -> DVec3 {
    let at = DVec2::new(x.into(), y.into());
    DVec3::new(at.x / at.y, 1.0, (1.0 - at.x - at.y) / at.y)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const AP0: Chromaticities = [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]];
    const AP1: Chromaticities = [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]];

    fn close(found: Mat3, published: [f32; 9]) {
        let published = Mat3::from_cols_array(&published).transpose();
        assert!(found.abs_diff_eq(published, 2e-5), "{found}");
    }

    /// As the Academy's `Utility - Linear - sRGB` transforms have them.
    #[test]
    fn the_academys_spaces_as_published() {
        close(
            to_rec709(&AP1).unwrap(),
            [1.70505, -0.62179, -0.08326, -0.13026, 1.14080, -0.01055, -0.02400, -0.12897, 1.15297],
        );
        close(
            to_rec709(&AP0).unwrap(),
            [2.52169, -1.13413, -0.38756, -0.27648, 1.37272, -0.09624, -0.01538, -0.15298, 1.16835],
        );
    }

    #[test]
    fn own_primaries_keep_their_bits_and_white_stays_white() {
        let check = Checker { file: Path::new("a.exr") };
        let color = Rgb::new(0.1, 1e-30, 7e4);
        let near = REC_709.map(|xy| xy.map(|v| v + 5e-4));
        for given in [None, Some(REC_709), Some(near)] {
            assert_eq!(ToRec709::new(check, given).unwrap().of(color), color);
        }
        let wide = ToRec709::new(check, Some(AP1)).unwrap();
        assert!(wide.of(Rgb::ONE).abs_diff_eq(Rgb::ONE, 1e-6) && wide.of(Rgb::X).x > 1.5);
        for broken in [[[0.3, 0.3]; 4], [[0.0, 0.0]; 4], [[f32::NAN, 1.0]; 4]] {
            let error = ToRec709::new(check, Some(broken)).unwrap_err().to_string();
            assert!(error.starts_with("a.exr: chromaticities: expected CIE xy"), "{error}");
        }
    }
}
