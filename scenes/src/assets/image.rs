//! Pictures of radiance: OpenEXR and Radiance HDR.

use std::io::Cursor;

use ::image::codecs::hdr::HdrDecoder;
use ::image::{DynamicImage, ImageDecoder, ImageError};
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};
use glam::Vec3;

use crate::check::{Checker, FAR};
use crate::{Rgb, SceneError};

/// Most texels of a picture: 8192 × 4096. A broken header must not ask for all memory.
const MOST_TEXELS: usize = 1 << 25;

/// A picture of radiance, row major from its top.
#[derive(Debug, PartialEq)]
pub(crate) struct Image {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) texels: Vec<Rgb>,
}

/// The first layer with channels `R`, `G` and `B`, half or float.
pub(super) fn read_exr(check: Checker, bytes: &[u8]) -> Result<Image, SceneError> {
    let malformed = |error: exr::error::Error| {
        check.malformed("OpenEXR", format!("expected a whole file with channels R, G, B: {error}"))
    };
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(malformed)?;
    for header in &meta.headers {
        check_size(check, header.layer_size.width(), header.layer_size.height())?;
    }
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
    let image = read.from_buffered(Cursor::new(bytes)).map_err(malformed)?.layer_data.channel_data.pixels;
    checked(check, image)
}

pub(super) fn read_hdr(check: Checker, bytes: &[u8]) -> Result<Image, SceneError> {
    let malformed = |error: ImageError| check.malformed("Radiance HDR", format!("expected a whole file: {error}"));
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    check_size(check, width as usize, height as usize)?;
    let pixels = DynamicImage::from_decoder(decoder).map_err(malformed)?.into_rgb32f();
    let texels = pixels.pixels().map(|pixel| Vec3::from(pixel.0)).collect();
    checked(check, Image { width: width as usize, height: height as usize, texels })
}

pub(super) fn check_size(check: Checker, width: usize, height: usize) -> Result<(), SceneError> {
    let texels = width.checked_mul(height).filter(|texels| (1..=MOST_TEXELS).contains(texels));
    let expected = format!("a picture of 1 to {MOST_TEXELS} texels");
    texels.map(drop).ok_or_else(|| check.invalid("size", expected, [width, height]))
}

fn checked(check: Checker, image: Image) -> Result<Image, SceneError> {
    let proper = |texel: &Rgb| texel.to_array().iter().all(|value| *value >= 0.0 && *value <= FAR);
    match image.texels.iter().position(|texel| !proper(texel)) {
        None => Ok(image),
        Some(index) => {
            let place = format!("texel ({}, {})", index % image.width, index / image.width);
            Err(check.invalid(&place, "finite radiance, not negative", image.texels[index].to_array()))
        }
    }
}
