//! Pictures of every format that OpenImageIO reads, in linear `f32` or as they are: tiled, mipmapped, half, whole numbers.
//!
//! The library is C++ and Debian's `libopenimageio-dev`; without the feature `oiio` this crate is empty. What comes of a
//! file is its first picture at its finest resolution. Numbers are as the file holds them: floating point bit for bit,
//! whole numbers divided by the greatest of their type. Colour spaces are told, not converted.

#![cfg(feature = "oiio")]

mod bridge;

use std::ops::Range;
use std::path::Path;

use bridge::ffi;

/// Most channels that are read at once.
pub const MOST_CHANNELS: usize = 4;

/// Most megabytes that the library may ask for by itself, where it minds (from 2.5 on).
const MOST_MEGABYTES: i32 = 2048;

/// Why a picture cannot be read: one line. The caller knows the file's name.
#[derive(Debug, thiserror::Error)]
pub enum OiioError {
    /// The library refuses the file.
    #[error("{0}")]
    Refused(String),
    /// The picture is empty or larger than the caller allows.
    #[error("expected a flat picture of 1 to {most} texels, found {width} x {height} x {depth}")]
    Size {
        /// Texels a row.
        width: i64,
        /// Rows.
        height: i64,
        /// Slices: 1 but for volumes.
        depth: i64,
        /// What is allowed.
        most: usize,
    },
    /// Several depths a texel.
    #[error("expected one value a texel and channel, found a deep picture")]
    Deep,
    /// Channels that the picture lacks, or too many at once.
    #[error("expected 1 to {MOST_CHANNELS} of {found} channels, asked for {wanted:?}")]
    Channels {
        /// What was asked for.
        wanted: Range<usize>,
        /// How many there are.
        found: usize,
    },
}

/// How a file holds its numbers, by its widest channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Half, float or double.
    Floating,
    /// Whole numbers of so many bits without sign, which become [0, 1].
    Unsigned(u32),
    /// Whole numbers of so many bits with sign, which become [−1, 1].
    Signed(u32),
}

/// An open picture of known size, none of whose texels has been read.
pub struct File {
    file: cxx::UniquePtr<ffi::File>,
    /// Texels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Names of the channels, as the library orders them: colours first.
    pub channels: Vec<String>,
    /// How the file holds them.
    pub numbers: Numbers,
    /// What the library calls the colour space; empty where it does not know.
    pub color_space: String,
    /// CIE xy of red, green, blue and white, where the file tells them.
    pub chromaticities: Option<[[f32; 2]; 4]>,
}

/// The library's version.
pub fn version() -> String {
    ffi::version()
}

impl File {
    /// Opens a file and checks its size against the caller's bound, before memory is taken for any texel.
    ///
    /// # Errors
    /// The library refuses the file; the picture is deep, a volume, empty or larger than `most_texels`.
    pub fn open(path: &Path, most_texels: usize) -> Result<File, OiioError> {
        let name = path.to_str().ok_or_else(|| OiioError::Refused("expected a path in UTF-8".into()))?;
        let file = ffi::open(name, MOST_MEGABYTES).map_err(|error| refused(&error))?;
        let header = ffi::header(&file).map_err(|error| refused(&error))?;
        if header.deep {
            return Err(OiioError::Deep);
        }
        let ffi::Header { width, height, depth, .. } = header;
        let side = |count: i64| usize::try_from(count).ok();
        let sides = side(width).zip(side(height)).filter(|_| depth <= 1);
        let within = |(width, height): &(usize, usize)| {
            width.checked_mul(*height).is_some_and(|texels| (1..=most_texels).contains(&texels))
        };
        let too_large = OiioError::Size { width, height, depth, most: most_texels };
        let (width, height) = sides.filter(within).ok_or(too_large)?;
        let numbers = match (header.floating, header.is_signed) {
            (true, _) => Numbers::Floating,
            (false, true) => Numbers::Signed(header.bits),
            (false, false) => Numbers::Unsigned(header.bits),
        };
        let chromaticities = <[f32; 8]>::try_from(header.chromaticities).ok();
        let chromaticities =
            chromaticities.map(|[rx, ry, gx, gy, bx, by, wx, wy]| [[rx, ry], [gx, gy], [bx, by], [wx, wy]]);
        let (channels, color_space) = (header.channels, header.color_space);
        Ok(File { file, width, height, channels, numbers, color_space, chromaticities })
    }

    /// Some channels of every texel, texel after texel, row by row from the top.
    ///
    /// # Errors
    /// There are no such channels, more than [`MOST_CHANNELS`] of them, or the file is broken.
    pub fn read(&mut self, wanted: Range<usize>) -> Result<Vec<f32>, OiioError> {
        let count = wanted.len();
        if !(1..=MOST_CHANNELS).contains(&count) || wanted.end > self.channels.len() {
            return Err(OiioError::Channels { wanted, found: self.channels.len() });
        }
        let mut values = vec![0.0; self.width * self.height * count];
        ffi::read(self.file.pin_mut(), wanted.start as u32, count as u32, &mut values)
            .map_err(|error| refused(&error))?;
        if let Numbers::Unsigned(bits @ ..=16) | Numbers::Signed(bits @ ..=16) = self.numbers {
            let most = ((1_u32 << (bits - u32::from(matches!(self.numbers, Numbers::Signed(_))))) - 1) as f32;
            // The library multiplies by an inverse, which rounds twice.
            values.iter_mut().for_each(|value| *value = (*value * most).round() / most);
        }
        Ok(values)
    }
}

/// The library's messages may run over several lines.
fn refused(error: &cxx::Exception) -> OiioError {
    let lines: Vec<&str> = error.what().lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    OiioError::Refused(lines.join("; "))
}
