//! Textures as PNG, surroundings as OpenEXR.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage};
use image::{DynamicImage, ImageBuffer, ImageFormat, Rgb};

use crate::assets::linear;
use crate::{Environment, Texture};

/// The bytes of a PNG in sRGB, of 8 bits where these hold it to the last bit, else of 16.
pub(super) fn png(texture: &Texture) -> Result<Vec<u8>, image::ImageError> {
    let values: Vec<u16> = texture.texels().iter().flat_map(|texel| texel.to_array()).map(coded).collect();
    let (width, height) = (texture.width() as u32, (texture.texels().len() / texture.width()) as u32);
    let whole = "three values a texel";
    let picture = match values.iter().all(|value| value % 257 == 0) {
        true => {
            let bytes = values.iter().map(|value| (value / 257) as u8).collect();
            DynamicImage::ImageRgb8(ImageBuffer::<Rgb<u8>, _>::from_raw(width, height, bytes).expect(whole))
        }
        false => DynamicImage::ImageRgb16(ImageBuffer::<Rgb<u16>, _>::from_raw(width, height, values).expect(whole)),
    };
    let mut file = Cursor::new(Vec::new());
    picture.write_to(&mut file, ImageFormat::Png)?;
    Ok(file.into_inner())
}

/// The sRGB value in 16 bits whose linear one is nearest (IEC 61966-2-1).
fn coded(value: f32) -> u16 {
    let v = f64::from(value.clamp(0.0, 1.0));
    let coded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
    let near = (coded * 65535.0).round() as u16;
    let error = |code: &u16| (linear(f32::from(*code) / 65535.0) - value).abs();
    let candidates = [near.saturating_sub(1), near, near.saturating_add(1)];
    candidates.into_iter().min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(near)
}

/// Writes radiance as it is, 32-bit floats, rows running as in photographs: mirrored against ours.
pub(super) fn write_exr(map: &Environment, path: &Path) -> Result<(), exr::error::Error> {
    let texel = |at: Vec2<usize>| {
        let [r, g, b] = map.texels[at.y() * map.width + map.width - 1 - at.x()].to_array();
        (r, g, b)
    };
    let layer = Layer::new(
        (map.width, map.height),
        LayerAttributes::named("radiance"),
        Encoding::SMALL_FAST_LOSSLESS,
        SpecificChannels::rgb(texel),
    );
    Image::from_layer(layer).write().to_file(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_is_found_again() {
        for code in 0..=u16::MAX {
            assert_eq!(coded(linear(f32::from(code) / 65535.0)), code);
        }
    }
}
