//! Pictures of heights: OpenEXR.

use std::io::Cursor;

use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel};

use super::image::check_size;
use crate::SceneError;
use crate::check::{Checker, FAR};

/// Heights in metres, row major from the top of the picture.
#[derive(Debug, PartialEq)]
pub(crate) struct HeightMap {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) heights: Vec<f32>,
}

/// The first layer's channel `Y`, else its `R`, else the only one that it has.
pub(super) fn read_exr(check: Checker, bytes: &[u8]) -> Result<HeightMap, SceneError> {
    let malformed = |error: exr::error::Error| {
        check.malformed("OpenEXR", format!("expected a whole file with a channel of heights: {error}"))
    };
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(malformed)?;
    for header in &meta.headers {
        check_size(check, header.layer_size.width(), header.layer_size.height())?;
    }
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
            },
            |map, at, (height,): (f32,)| {
                let index = at.y() * map.width + at.x();
                map.heights[index] = height;
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel();
    let map = read.from_buffered(Cursor::new(bytes)).map_err(malformed)?.layer_data.channel_data.pixels;
    match map.heights.iter().position(|height| height.is_nan() || height.abs() > FAR) {
        None => Ok(map),
        Some(index) => {
            let place = format!("texel ({}, {})", index % map.width, index / map.width);
            Err(check.invalid(&place, "a finite height of at most 1e9 metres", map.heights[index]))
        }
    }
}
