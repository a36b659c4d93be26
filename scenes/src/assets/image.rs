//! Pictures of radiance: OpenEXR and Radiance HDR, in linear Rec. 709.

use std::io::Cursor;

use ::image::codecs::hdr::HdrDecoder;
use ::image::{DynamicImage, ImageDecoder, ImageError};
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};
use glam::Vec3;

use super::color::ToRec709;
use super::oiio;
use crate::check::{Checker, FAR};
use crate::{Rgb, SceneError};

/// Most texels of a picture: 8192 × 4096. A broken header must not ask for all memory.
pub(super) const MOST_TEXELS: usize = 1 << 25;

/// A picture of radiance, row major from its top.
#[derive(Debug, PartialEq)]
pub(crate) struct Image {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) texels: Vec<Rgb>,
}

/// The first layer with channels `R`, `G` and `B`, half or float.
pub(super) fn read_exr(check: Checker, bytes: &[u8], notices: &mut Vec<String>) -> Result<Image, SceneError> {
    let meta = read_meta(check, bytes)?;
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("R")
        .required("G")
        .required("B")
        .collect_pixels(
            |size, _| Image {
                width: size.width(),
                height: size.height(),
                texels: vec![Rgb::ZERO; size.width() * size.height()],
            },
            |image, at, (r, g, b): (f32, f32, f32)| {
                let index = at.y() * image.width + at.x();
                image.texels[index] = Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel();
    let image = match read.from_buffered(Cursor::new(bytes)) {
        Ok(read) => read.layer_data.channel_data.pixels,
        Err(exr::error::Error::NotSupported(_)) if oiio::BUILT_IN => return oiio::image(check, notices),
        Err(error) => {
            let expected = "expected a whole file with channels R, G, B";
            return Err(check.malformed("OpenEXR", format!("{expected}: {error}")));
        }
    };
    let xy = meta.headers.iter().find_map(|header| header.shared_attributes.chromaticities);
    let xy = xy.map(|of| [of.red, of.green, of.blue, of.white].map(|at| [at.x(), at.y()]));
    radiance(check, image, &ToRec709::new(check, xy)?, notices)
}

/// The headers of an OpenEXR file, with sizes within bounds.
pub(super) fn read_meta(check: Checker, bytes: &[u8]) -> Result<exr::meta::MetaData, SceneError> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false);
    let meta = meta.map_err(|error| check.malformed("OpenEXR", format!("expected a whole file: {error}")))?;
    for header in &meta.headers {
        check_size(check, header.layer_size.width(), header.layer_size.height())?;
    }
    Ok(meta)
}

pub(super) fn read_hdr(check: Checker, bytes: &[u8], notices: &mut Vec<String>) -> Result<Image, SceneError> {
    let malformed = |error: ImageError| check.malformed("Radiance HDR", format!("expected a whole file: {error}"));
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    check_size(check, width as usize, height as usize)?;
    let pixels = DynamicImage::from_decoder(decoder).map_err(malformed)?.into_rgb32f();
    let texels = pixels.pixels().map(|pixel| Vec3::from(pixel.0)).collect();
    let image = Image { width: width as usize, height: height as usize, texels };
    radiance(check, image, &ToRec709::new(check, None)?, notices)
}

pub(super) fn check_size(check: Checker, width: usize, height: usize) -> Result<(), SceneError> {
    let texels = width.checked_mul(height).filter(|texels| (1..=MOST_TEXELS).contains(texels));
    let expected = format!("a picture of 1 to {MOST_TEXELS} texels");
    texels.map(drop).ok_or_else(|| check.invalid("size", expected, [width, height]))
}

/// A picture's colours as radiance: an error where one is not finite, with a notice where negative ones, which filters
/// and narrower primaries leave behind, were raised to 0.
pub(super) fn radiance(
    check: Checker,
    mut image: Image,
    to_rec709: &ToRec709,
    notices: &mut Vec<String>,
) -> Result<Image, SceneError> {
    // NaN is not at most anything.
    let finite = |texel: &Rgb| texel.to_array().iter().all(|value| value.abs() <= FAR);
    let mut negative = 0;
    let mut least = 0.0_f32;
    for (index, texel) in image.texels.iter_mut().enumerate() {
        let linear = if finite(texel) { to_rec709.of(*texel) } else { *texel };
        if !finite(&linear) {
            let place = format!("texel ({}, {})", index % image.width, index / image.width);
            return Err(check.invalid(&place, "finite radiance of at most 1e9", linear.to_array()));
        }
        negative += usize::from(linear.min_element() < 0.0);
        least = least.min(linear.min_element());
        *texel = linear.max(Rgb::ZERO);
    }
    if negative > 0 {
        let (file, all) = (check.file.display(), image.texels.len());
        notices.push(format!("{file}: {negative} of {all} texels had negative radiance, down to {least}: raised to 0"));
    }
    Ok(image)
}
