//! Pictures of heights: OpenEXR.

use std::io::Cursor;

use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};

use super::image::read_meta;
use super::oiio;
use crate::SceneError;
use crate::check::{Checker, FAR};

/// Heights, row major from the top of the picture.
#[derive(Debug, PartialEq)]
pub(crate) struct HeightMap {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) heights: Vec<f32>,
    /// Whether heights are shares of a range rather than metres.
    pub(crate) shares: bool,
}

/// The first layer's channel `Y`, else its `R`, else the only one that it has.
pub(super) fn read_exr(check: Checker, bytes: &[u8]) -> Result<HeightMap, SceneError> {
    let meta = read_meta(check, bytes)?;
    let names: Vec<_> = meta.headers.iter().take(1).flat_map(|header| &header.channels.list).map(|c| &c.name).collect();
    let named = |wanted: &str| names.iter().find(|name| **name == wanted);
    let channel = named("Y").or(named("R")).or(names.first().filter(|_| names.len() == 1));
    let expected = "a channel Y or R, or one channel alone";
    let channel = channel.ok_or_else(|| check.invalid("channels", expected, &names))?;
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required((*channel).clone())
        .collect_pixels(
            |size, _| HeightMap {
                width: size.width(),
                height: size.height(),
                heights: vec![0.0; size.width() * size.height()],
                shares: false,
            },
            |map, at, (height,): (f32,)| {
                let index = at.y() * map.width + at.x();
                map.heights[index] = height;
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel();
    match read.from_buffered(Cursor::new(bytes)) {
        Ok(read) => Ok(read.layer_data.channel_data.pixels),
        Err(exr::error::Error::NotSupported(_)) if oiio::BUILT_IN => oiio::heights(check),
        Err(error) => {
            let expected = "expected a whole file with a channel of heights";
            Err(check.malformed("OpenEXR", format!("{expected}: {error}")))
        }
    }
}

impl HeightMap {
    /// Whether all heights are numbers within bounds.
    pub(crate) fn check(&self, check: Checker) -> Result<(), SceneError> {
        match self.heights.iter().position(|height| height.is_nan() || height.abs() > FAR) {
            None => Ok(()),
            Some(index) => {
                let place = format!("texel ({}, {})", index % self.width, index / self.width);
                let expected = "a finite height of at most 1e9 metres, or a scene file whose `nodata` is that";
                Err(check.invalid(&place, expected, self.heights[index]))
            }
        }
    }
}
