//! Pictures of colours and of heights: PNG and JPEG.

use std::io::Cursor;

use ::image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::color::{ToRec709, linear};
use super::image::{check_size, radiance};
use super::{HeightMap, Image};
use crate::check::Checker;
use crate::{Rgb, SceneError, Texture};

/// Most bytes that a decoder may take.
const MOST_BYTES: u64 = 1 << 30;

/// Whether bytes begin as a PNG or JPEG does.
pub(super) fn knows(bytes: &[u8]) -> bool {
    matches!(::image::guess_format(bytes), Ok(ImageFormat::Png | ImageFormat::Jpeg))
}

/// Colours in sRGB, made linear.
pub(super) fn texture(check: Checker, field: &str, bytes: &[u8]) -> Result<Texture, SceneError> {
    let image = colors(check, field, bytes)?;
    Ok(Texture::new(image.width, image.texels))
}

/// Colours in sRGB, made linear.
pub(super) fn colors(check: Checker, field: &str, bytes: &[u8]) -> Result<Image, SceneError> {
    let picture = decode(check, field, bytes)?.into_rgb16();
    let texels = picture.pixels().map(|pixel| Rgb::from_array(pixel.0.map(|v| linear(f32::from(v) / 65535.0))));
    Ok(Image { width: picture.width() as usize, height: picture.height() as usize, texels: texels.collect() })
}

/// Reflectances of a picture that need not keep to [0, 1].
pub(super) fn reflectances(
    check: Checker,
    (image, to_rec709): (Image, ToRec709),
    notices: &mut Vec<String>,
) -> Result<Texture, SceneError> {
    let mut image = radiance(check, image, &to_rec709, notices)?;
    let bright = image.texels.iter().filter(|texel| texel.max_element() > 1.0).count();
    if bright > 0 {
        image.texels.iter_mut().for_each(|texel| *texel = texel.min(Rgb::ONE));
        let (file, all) = (check.file.display(), image.texels.len());
        notices.push(format!("{file}: {bright} of {all} texels reflected more than 1: lowered to 1"));
    }
    Ok(Texture::new(image.width, image.texels))
}

/// Heights in units of the greatest that 8 or 16 bits hold: within [0, 1].
pub(super) fn heights(check: Checker, bytes: &[u8]) -> Result<HeightMap, SceneError> {
    let picture = decode(check, "PNG", bytes)?;
    if picture.color().has_color() {
        return Err(check.invalid("colour", "a grey picture", picture.color()));
    }
    let grey = picture.into_luma16();
    let (width, height) = (grey.width() as usize, grey.height() as usize);
    let heights = grey.pixels().map(|pixel| f32::from(pixel.0[0]) / 65535.0).collect();
    Ok(HeightMap { width, height, heights, shares: true })
}

fn decode(check: Checker, field: &str, bytes: &[u8]) -> Result<DynamicImage, SceneError> {
    let malformed = |error: ImageError| check.malformed(field, format!("expected a PNG or JPEG: {error}"));
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| malformed(e.into()))?;
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    check_size(check, width as usize, height as usize)?;
    DynamicImage::from_decoder(decoder).map_err(malformed)
}
