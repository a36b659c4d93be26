//! Pictures to PNG: exposed for display, or signed errors in false colour.

use crate::ReportError;
use base64::Engine;
use glam::Vec3;
use halflight_metrics::{Exposure, percentile};
use halflight_results::Picture;

/// Rec. 709 luminance weights, linear.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Diverging colours from −scale to +scale at even steps: ColorBrewer's RdBu turned round, so blue is too dark and red
/// too bright.
pub(crate) const DIVERGING: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

/// The picture as displayed, as a `data:` address. Receivers that do not count are transparent.
pub(crate) fn displayed(picture: &Picture, exposure: Exposure) -> Result<String, ReportError> {
    let pixels = picture.radiance.iter().zip(&picture.valid);
    data_address(picture, pixels.map(|(r, valid)| valid.then(|| exposure.display8(*r))))
}

/// Signed luminance error `picture − reference` in false colour, clipped at ±`scale`.
pub(crate) fn error_map(picture: &Picture, reference: &Picture, scale: f64) -> Result<String, ReportError> {
    data_address(picture, errors(picture, reference).map(|e| Some(false_colour(e? / scale))))
}

/// Probabilities in white to red by their logarithm, from 1 to `least`.
pub(crate) fn probability_map(map: &Picture, least: f64) -> Result<String, ReportError> {
    let pixels = map.radiance.iter().zip(&map.valid);
    let share = |p: f32| f64::from(p).max(least).ln() / least.ln();
    data_address(map, pixels.map(|(p, valid)| valid.then(|| false_colour(share(p.x)))))
}

/// The first channel as grey, from black at the first end to white at the second.
pub(crate) fn grey_map(map: &Picture, [black, white]: [f64; 2]) -> Result<String, ReportError> {
    let pixels = map.radiance.iter().zip(&map.valid);
    let grey = |value: f32| (((f64::from(value) - black) / (white - black)).clamp(0.0, 1.0) * 255.0).round() as u8;
    data_address(map, pixels.map(|(value, valid)| valid.then(|| [grey(value.x); 3])))
}

/// A scale that shows these errors: the 99th percentile of their sizes, rounded up to a number that reads well.
pub(crate) fn error_scale<'a>(pairs: impl Iterator<Item = (&'a Picture, &'a Picture)>) -> f64 {
    let mut sizes: Vec<f64> = pairs.flat_map(|(p, r)| errors(p, r).flatten().map(f64::abs)).collect();
    sizes.sort_by(f64::total_cmp);
    round_up(percentile(&sizes, 99.0).unwrap_or(0.0))
}

/// A scale on which the largest of such differences is seen, a number that reads well.
pub(crate) fn difference_scale(largest: f64) -> f64 {
    round_up(largest)
}

/// Luminance errors; none where a receiver does not count in both or is not finite.
fn errors<'a>(picture: &'a Picture, reference: &'a Picture) -> impl Iterator<Item = Option<f64>> + 'a {
    let radiance = picture.radiance.iter().zip(&reference.radiance);
    radiance.zip(picture.valid.iter().zip(&reference.valid)).map(|((x, r), (a, b))| {
        let error = f64::from((*x - *r).dot(LUMINANCE));
        (*a && *b && error.is_finite()).then_some(error)
    })
}

fn round_up(value: f64) -> f64 {
    if value <= 0.0 {
        return 1.0;
    }
    let power = 10f64.powf(value.log10().floor());
    let steps = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0];
    // The tolerance keeps a number that is round already as it is.
    steps.into_iter().find(|s| s * power >= value * (1.0 - 1e-9)).unwrap_or(10.0) * power
}

fn false_colour(t: f64) -> [u8; 3] {
    let last = DIVERGING.len() - 1;
    let place = (t.clamp(-1.0, 1.0) + 1.0) / 2.0 * last as f64;
    let below = (place as usize).min(last - 1);
    let share = place - below as f64;
    std::array::from_fn(|c| {
        let (a, b) = (f64::from(DIVERGING[below][c]), f64::from(DIVERGING[below + 1][c]));
        (a + (b - a) * share).round() as u8
    })
}

fn data_address(picture: &Picture, pixels: impl Iterator<Item = Option<[u8; 3]>>) -> Result<String, ReportError> {
    let (width, height) = picture.layout.size();
    let rgba: Vec<u8> = pixels.flat_map(|p| p.map_or([0; 4], |[r, g, b]| [r, g, b, 255])).collect();
    let size = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size(width), size(height));
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    // A fifth of the time for a page not twice as large: a run that has nothing to do still writes its report.
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgba)?;
    writer.finish()?;
    Ok(format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_results::Layout;

    fn picture(radiance: &[f32], valid: &[bool]) -> Picture {
        let radiance = radiance.iter().map(|v| Vec3::splat(*v)).collect();
        Picture { layout: Layout::Image { width: valid.len(), height: 1 }, radiance, valid: valid.to_vec() }
    }

    fn decode(address: &str) -> Vec<[u8; 4]> {
        let base64 = address.strip_prefix("data:image/png;base64,").unwrap();
        let bytes = base64::engine::general_purpose::STANDARD.decode(base64).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels.chunks(4).map(|p| p.try_into().unwrap()).collect()
    }

    #[test]
    fn displayed_pixels_are_exposed_and_invalid_ones_transparent() {
        let x = picture(&[0.0, 2.0, 0.431_721, 9.0], &[true, true, true, false]);
        let pixels = decode(&displayed(&x, Exposure { scale: 0.5 }).unwrap());
        assert_eq!(pixels, [[0, 0, 0, 255], [255; 4], [128, 128, 128, 255], [0; 4]]);
    }

    #[test]
    fn errors_are_blue_below_white_at_and_red_above_zero() {
        let valid = [true, true, true, true, false];
        let (x, r) = (picture(&[0.0, 1.0, 2.0, 9.0, 0.0], &valid), picture(&[1.0, 1.0, 1.0, 1.0, 1.0], &valid));
        let pixels = decode(&error_map(&x, &r, 1.0).unwrap());
        assert_eq!(pixels, [[5, 48, 97, 255], [247, 247, 247, 255], [103, 0, 31, 255], [103, 0, 31, 255], [0; 4]]);
        assert_eq!(false_colour(-0.9), [19, 75, 135]);
    }

    #[test]
    fn probabilities_run_from_white_to_dark_red() {
        let map = picture(&[1.0, 0.025_118_86, 1e-4, 0.0, 0.0], &[true, true, true, true, false]);
        let pixels = decode(&probability_map(&map, 1e-4).unwrap());
        assert_eq!(pixels, [[247, 247, 247, 255], [244, 165, 130, 255], [103, 0, 31, 255], [103, 0, 31, 255], [0; 4]]);
    }

    #[test]
    fn the_scale_reads_well_and_covers_the_99th_percentile() {
        for (value, round) in [(0.0123, 0.015), (0.2, 0.2), (0.95, 1.0), (6.1, 8.0), (0.0, 1.0)] {
            assert!((round_up(value) - round).abs() < 1e-12, "{value}");
        }
        let (x, r) = (picture(&[0.0; 4], &[true; 4]), picture(&[0.01, 0.02, 0.03, 7.0], &[true, true, true, false]));
        assert_eq!(error_scale([(&x, &r)].into_iter()), 0.03);
    }
}
