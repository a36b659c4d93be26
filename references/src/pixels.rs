//! Estimates as OpenEXR pictures: channels `mean.*`, `variance.*` and `samples`, provenance (JSON) in the comments.

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes, ReadChannels,
    ReadLayers, SmallVec, Text, WritableImage, read,
};
use halflight_scenes::{Layout, Rgb};
use std::io::Cursor;

use crate::{Estimate, Provenance};

const COLOURS: [&str; 3] = ["R", "G", "B"];
const BATCHES: &str = "batches";

/// The bytes of a picture with its provenance. A layout that does not fit the receivers is taken for a list.
pub(crate) fn encode(
    estimate: &Estimate,
    layout: Layout,
    provenance: &Provenance,
) -> Result<Vec<u8>, exr::error::Error> {
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = SmallVec::new();
    for (name, values) in [("mean", &estimate.mean), ("variance", &estimate.variance)] {
        for (i, colour) in COLOURS.iter().enumerate() {
            let samples = FlatSamples::F32(values.iter().map(|rgb| rgb[i]).collect());
            channels.push(AnyChannel::new(text(&format!("{name}.{colour}")), samples));
        }
    }
    channels.push(AnyChannel::new(text("samples"), FlatSamples::U32(estimate.samples.clone())));

    let mut attributes = LayerAttributes::default();
    // The only one of its kind: several would be written in random order, and equal estimates as different bytes.
    attributes.other.insert(text(BATCHES), AttributeValue::I32(estimate.batches as i32));
    attributes.comments = Some(text(&provenance.to_ascii()));
    let size = size(layout, estimate.mean.len());
    let layer = Layer::new(size, attributes, Encoding::FAST_LOSSLESS, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

/// The estimate in a picture of [`encode`], with its provenance; `None` for any other.
pub(crate) fn decode(bytes: &[u8]) -> Option<(Estimate, Provenance)> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .ok()?;
    let channels = &image.layer_data.channel_data.list;
    let find = |name: &str| channels.iter().find(|c| c.name == *name).map(|c| &c.sample_data);
    let colours = |name: &str| -> Option<Vec<Rgb>> {
        let [r, g, b] = COLOURS.map(|colour| match find(&format!("{name}.{colour}")) {
            Some(FlatSamples::F32(values)) => Some(values),
            _ => None,
        });
        let (r, g, b) = (r?, g?, b?);
        Some(r.iter().zip(g).zip(b).map(|((r, g), b)| Rgb::new(*r, *g, *b)).collect())
    };
    let samples = match find("samples")? {
        FlatSamples::U32(samples) => samples.clone(),
        _ => return None,
    };
    let batches = match image.layer_data.attributes.other.get(&text(BATCHES))? {
        AttributeValue::I32(batches) => u32::try_from(*batches).ok()?,
        _ => return None,
    };
    let provenance = Provenance::read(&image.layer_data.attributes.comments.as_ref()?.to_string())?;
    Some((Estimate { mean: colours("mean")?, variance: colours("variance")?, samples, batches }, provenance))
}

fn size(layout: Layout, receivers: usize) -> (usize, usize) {
    match layout {
        Layout::Image { width, height } if width * height == receivers => (width, height),
        _ => (receivers, 1),
    }
}

fn text(ascii: &str) -> Text {
    Text::new_or_panic(ascii)
}
