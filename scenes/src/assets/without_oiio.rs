//! What is said of other formats where OpenImageIO is not built in.

use super::color::ToRec709;
use super::{HeightMap, Image};
use crate::SceneError;
use crate::check::Checker;

pub(super) const BUILT_IN: bool = false;

/// The version of OpenImageIO that is built in, if it is: then pictures of all its formats are read.
pub fn open_image_io() -> Option<String> {
    None
}

pub(super) fn image(check: Checker, _: &mut Vec<String>) -> Result<Image, SceneError> {
    Err(refused(check, "a picture as .exr, .hdr, .png or .jpg"))
}

pub(super) fn colors(check: Checker) -> Result<(Image, ToRec709), SceneError> {
    Err(refused(check, "a picture as PNG or JPEG"))
}

pub(super) fn heights(check: Checker) -> Result<HeightMap, SceneError> {
    Err(refused(check, "a picture of heights as .exr or .png"))
}

fn refused(check: Checker, expected: &str) -> SceneError {
    let found = check.file.extension().unwrap_or_default().to_string_lossy();
    check.invalid("format", format!("{expected} (others need Halflight built with the feature `oiio`)"), found)
}
