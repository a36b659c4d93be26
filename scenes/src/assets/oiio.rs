//! Pictures of every other format, by OpenImageIO.

#[cfg(test)]
mod agreement;
mod spaces;

use halflight_oiio::{File, Numbers, OiioError};

use super::color::ToRec709;
use super::image::{MOST_TEXELS, radiance};
use super::{HeightMap, Image};
use crate::check::Checker;
use crate::{Rgb, SceneError};

pub(super) const BUILT_IN: bool = true;

/// The version of OpenImageIO that is built in, if it is: then pictures of all its formats are read.
pub fn open_image_io() -> Option<String> {
    Some(halflight_oiio::version())
}

/// A picture of radiance in linear Rec. 709.
pub(super) fn image(check: Checker, notices: &mut Vec<String>) -> Result<Image, SceneError> {
    let (image, to_rec709) = colors(check)?;
    radiance(check, image, &to_rec709, notices)
}

/// Linear colours of the file's own primaries, and what makes them Rec. 709's.
pub(super) fn colors(check: Checker) -> Result<(Image, ToRec709), SceneError> {
    let mut file = open(check)?;
    let known = spaces::space(&file.color_space, file.numbers);
    let (transfer, primaries) = known.ok_or_else(|| check.invalid("colour space", spaces::KNOWN, &file.color_space))?;
    let to_rec709 = ToRec709::new(check, Some(file.chromaticities.unwrap_or(primaries)))?;
    let named = |at: usize, name: &str| file.channels.get(at).is_some_and(|found| found.eq_ignore_ascii_case(name));
    let red = (0..file.channels.len()).find(|&at| named(at, "R") && named(at + 1, "G") && named(at + 2, "B"));
    let expected = "channels R, G and B, or grey";
    let mut texels: Vec<Rgb> = match (red, file.channels.len()) {
        (Some(red), _) => read(check, &mut file, red..red + 3)?.chunks_exact(3).map(Rgb::from_slice).collect(),
        // Alone, or with alpha.
        (None, 1 | 2) => read(check, &mut file, 0..1)?.into_iter().map(Rgb::splat).collect(),
        _ => return Err(check.invalid("channels", expected, &file.channels)),
    };
    texels.iter_mut().for_each(|texel| *texel = texel.map(|value| transfer.linear(value)));
    Ok((Image { width: file.width, height: file.height, texels }, to_rec709))
}

/// Heights: the channel `Y`, else `R`, else the only one.
pub(super) fn heights(check: Checker) -> Result<HeightMap, SceneError> {
    let mut file = open(check)?;
    let named = |wanted: &str| file.channels.iter().position(|name| name.eq_ignore_ascii_case(wanted));
    let channel = named("Y").or(named("R")).or((file.channels.len() == 1).then_some(0));
    let expected = "a channel Y or R, or one channel alone";
    let channel = channel.ok_or_else(|| check.invalid("channels", expected, &file.channels))?;
    let mut heights = read(check, &mut file, channel..channel + 1)?;
    if let Numbers::Signed(bits @ ..=32) = file.numbers {
        let most = ((1_u64 << (bits - 1)) - 1) as f32;
        heights.iter_mut().for_each(|height| *height = (*height * most).round());
    }
    let shares = matches!(file.numbers, Numbers::Unsigned(_));
    Ok(HeightMap { width: file.width, height: file.height, heights, shares })
}

fn open(check: Checker) -> Result<File, SceneError> {
    File::open(check.file, MOST_TEXELS).map_err(|error| complaint(check, &error))
}

fn read(check: Checker, file: &mut File, channels: std::ops::Range<usize>) -> Result<Vec<f32>, SceneError> {
    file.read(channels).map_err(|error| complaint(check, &error))
}

/// The library's lines name the file as well.
fn complaint(check: Checker, error: &OiioError) -> SceneError {
    check.malformed("OpenImageIO", error.to_string())
}
