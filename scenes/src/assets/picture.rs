//! Pictures of colours and of heights: PNG and JPEG.

use std::io::Cursor;

use ::image::{DynamicImage, ImageError, ImageReader, Limits};

use super::HeightMap;
use super::image::{Image, check_size};
use crate::check::Checker;
use crate::{Rgb, SceneError, Texture};

/// Most bytes that a decoder may take.
const MOST_BYTES: u64 = 1 << 30;

/// Colours in sRGB, made linear.
pub(super) fn colours(check: Checker, field: &str, bytes: &[u8]) -> Result<Image, SceneError> {
    let picture = decode(check, field, bytes)?.into_rgb16();
    let texels = picture.pixels().map(|pixel| Rgb::from_array(pixel.0.map(|v| linear(f32::from(v) / 65535.0))));
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    Ok(Image { width, height, texels: texels.collect() })
}

/// The same as a texture.
pub(super) fn texture(check: Checker, field: &str, bytes: &[u8]) -> Result<Texture, SceneError> {
    colours(check, field, bytes).map(|picture| Texture::new(picture.width, picture.texels))
}

/// Heights in units of the greatest that 8 or 16 bits hold: within [0, 1].
pub(super) fn heights(check: Checker, bytes: &[u8]) -> Result<HeightMap, SceneError> {
    let picture = decode(check, "PNG", bytes)?;
    if picture.color().has_color() {
        return Err(check.invalid("colour", "a grey picture", picture.color()));
    }
    let grey = picture.into_luma16();
    let (width, height) = (grey.width() as usize, grey.height() as usize);
    Ok(HeightMap { width, height, heights: grey.pixels().map(|pixel| f32::from(pixel.0[0]) / 65535.0).collect() })
}

fn decode(check: Checker, field: &str, bytes: &[u8]) -> Result<DynamicImage, SceneError> {
    let malformed = |error: ImageError| check.malformed(field, format!("expected a PNG or JPEG: {error}"));
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| malformed(e.into()))?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let picture = reader.decode().map_err(malformed)?;
    check_size(check, picture.width() as usize, picture.height() as usize)?;
    Ok(picture)
}

/// IEC 61966-2-1.
pub(crate) fn linear(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
