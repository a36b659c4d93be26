//! Pictures to EXR and back, bit for bit.

use crate::{Layout, Picture, PictureError, ReferencePicture};
use ::exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatImage, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, WritableImage, f16, read,
};
use glam::Vec3;
use std::io::Cursor;
use std::path::Path;

/// The attribute that says that an image is a list of receivers.
const LAYOUT: &str = "halflightLayout";

/// A channel to be written.
struct Channel {
    name: &'static str,
    samples: FlatSamples,
}

impl Picture {
    /// The picture as an EXR file. Equal pictures give equal bytes.
    ///
    /// # Errors
    /// A field's length does not fit the layout, or the layout is empty.
    pub fn to_exr(&self) -> Result<Vec<u8>, PictureError> {
        check(self.layout, &[("radiance", self.radiance.len()), ("valid", self.valid.len())])?;
        let mut channels = rgb(["R", "G", "B"], &self.radiance);
        channels.push(mask(&self.valid));
        encode(self.layout, channels)
    }

    /// Reads a picture: channels `R`, `G`, `B` or, for a reference, `mean.*`. Without a channel `valid` every pixel
    /// counts. `path` is named in errors.
    ///
    /// # Errors
    /// Not an EXR, or a channel is missing.
    pub fn from_exr(bytes: &[u8], path: &Path) -> Result<Self, PictureError> {
        let file = Decoded::new(bytes, path)?;
        let names = if file.has("mean.R") { ["mean.R", "mean.G", "mean.B"] } else { ["R", "G", "B"] };
        Ok(Self { layout: file.layout, radiance: file.rgb(names)?, valid: file.mask() })
    }

    /// Reads a picture from a file; see [`Picture::from_exr`].
    ///
    /// # Errors
    /// The file cannot be read, is not an EXR, or a channel is missing.
    pub fn load(path: &Path) -> Result<Self, PictureError> {
        Self::from_exr(&read_bytes(path)?, path)
    }
}

impl ReferencePicture {
    /// The reference as an EXR file. Equal references give equal bytes.
    ///
    /// # Errors
    /// A field's length does not fit the layout, or the layout is empty.
    pub fn to_exr(&self) -> Result<Vec<u8>, PictureError> {
        let lengths = [
            ("mean", self.mean.len()),
            ("variance", self.variance.len()),
            ("samples", self.samples.len()),
            ("valid", self.valid.len()),
        ];
        check(self.layout, &lengths)?;
        let mut channels = rgb(["mean.R", "mean.G", "mean.B"], &self.mean);
        channels.extend(rgb(["variance.R", "variance.G", "variance.B"], &self.variance));
        channels.push(Channel { name: "samples", samples: FlatSamples::U32(self.samples.clone()) });
        channels.push(mask(&self.valid));
        encode(self.layout, channels)
    }

    /// Reads a reference; `path` is named in errors.
    ///
    /// # Errors
    /// Not an EXR, or a channel is missing.
    pub fn from_exr(bytes: &[u8], path: &Path) -> Result<Self, PictureError> {
        let file = Decoded::new(bytes, path)?;
        Ok(Self {
            layout: file.layout,
            mean: file.rgb(["mean.R", "mean.G", "mean.B"])?,
            variance: file.rgb(["variance.R", "variance.G", "variance.B"])?,
            samples: file.counts("samples")?,
            valid: file.mask(),
        })
    }

    /// Reads a reference from a file.
    ///
    /// # Errors
    /// The file cannot be read, is not an EXR, or a channel is missing.
    pub fn load(path: &Path) -> Result<Self, PictureError> {
        Self::from_exr(&read_bytes(path)?, path)
    }
}

pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, PictureError> {
    std::fs::read(path).map_err(|source| PictureError::Io { path: path.to_owned(), source })
}

fn check(layout: Layout, lengths: &[(&'static str, usize)]) -> Result<(), PictureError> {
    let expected = layout.receivers().filter(|n| *n > 0).ok_or(PictureError::Empty(layout))?;
    match lengths.iter().find(|(_, actual)| *actual != expected) {
        Some(&(field, actual)) => Err(PictureError::Length { field, actual, expected, layout }),
        None => Ok(()),
    }
}

fn rgb(names: [&'static str; 3], values: &[Vec3]) -> Vec<Channel> {
    let component = |c: usize| FlatSamples::F32(values.iter().map(|v| v[c]).collect());
    names.into_iter().enumerate().map(|(c, name)| Channel { name, samples: component(c) }).collect()
}

fn mask(valid: &[bool]) -> Channel {
    let samples = FlatSamples::F32(valid.iter().map(|v| f32::from(u8::from(*v))).collect());
    Channel { name: "valid", samples }
}

fn encode(layout: Layout, channels: Vec<Channel>) -> Result<Vec<u8>, PictureError> {
    // Scan lines in increasing order, compressed in this thread: the bytes must depend on the picture alone.
    let encoding =
        Encoding { compression: Compression::ZIP16, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let channels = channels.into_iter().map(|c| AnyChannel::new(c.name, c.samples)).collect();
    let mut attributes = LayerAttributes::default();
    if let Layout::List(_) = layout {
        attributes.other.insert(Text::from(LAYOUT), AttributeValue::Text(Text::from("list")));
    }
    let layer = Layer::new(layout.size(), attributes, encoding, AnyChannels::sort(channels));
    let mut bytes = Vec::new();
    let written = Image::from_layer(layer).write().non_parallel().to_buffered(Cursor::new(&mut bytes));
    written.map_err(|e| PictureError::Exr { path: "(in memory)".into(), message: e.to_string() })?;
    Ok(bytes)
}

/// An EXR file's channels.
struct Decoded<'a> {
    path: &'a Path,
    layout: Layout,
    image: FlatImage,
}

impl<'a> Decoded<'a> {
    fn new(bytes: &[u8], path: &'a Path) -> Result<Self, PictureError> {
        let image: FlatImage = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))
            .map_err(|e| PictureError::Exr { path: path.to_owned(), message: e.to_string() })?;
        let Some(layer) = image.layer_data.first() else {
            return Err(PictureError::Exr { path: path.to_owned(), message: "it has no layer".into() });
        };
        let (width, height) = (layer.size.width(), layer.size.height());
        let list = layer.attributes.other.contains_key(&Text::from(LAYOUT));
        let layout = if list { Layout::List(width * height) } else { Layout::Image { width, height } };
        Ok(Self { path, layout, image })
    }

    fn find(&self, name: &str) -> Option<&FlatSamples> {
        let channels = &self.image.layer_data[0].channel_data.list;
        channels.iter().find(|c| c.name.eq(name)).map(|c| &c.sample_data)
    }

    fn has(&self, name: &str) -> bool {
        self.find(name).is_some()
    }

    fn channel(&self, name: &'static str) -> Result<&FlatSamples, PictureError> {
        self.find(name).ok_or_else(|| {
            let names = self.image.layer_data[0].channel_data.list.iter().map(|c| format!("`{}`", c.name));
            PictureError::Channel {
                path: self.path.to_owned(),
                channel: name,
                found: names.collect::<Vec<_>>().join(", "),
            }
        })
    }

    fn rgb(&self, names: [&'static str; 3]) -> Result<Vec<Vec3>, PictureError> {
        let [r, g, b] = names.map(|name| self.channel(name).map(floats));
        let (r, g, b) = (r?, g?, b?);
        Ok(r.into_iter().zip(g).zip(b).map(|((r, g), b)| Vec3::new(r, g, b)).collect())
    }

    fn counts(&self, name: &'static str) -> Result<Vec<u32>, PictureError> {
        Ok(match self.channel(name)? {
            FlatSamples::U32(values) => values.clone(),
            // A count out of range saturates, as `as` does.
            other => floats(other).into_iter().map(|v| v as u32).collect(),
        })
    }

    fn mask(&self) -> Vec<bool> {
        match self.find("valid") {
            Some(samples) => floats(samples).into_iter().map(|v| v > 0.5).collect(),
            None => vec![true; self.layout.receivers().unwrap_or(0)],
        }
    }
}

fn floats(samples: &FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F32(values) => values.clone(),
        FlatSamples::F16(values) => values.iter().copied().map(f16::to_f32).collect(),
        FlatSamples::U32(values) => values.iter().map(|v| *v as f32).collect(),
    }
}
