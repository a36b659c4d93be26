//! What is asked for.

use halflight_contract::Quantity;
use halflight_scenes::{Content, Emission, Frame, PosedObject, Scene};

use crate::{Error, Quality, REVISION, Reference, Result};

/// A reference of a quantity at the receivers of a frame, and how good it is to be.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// Which.
    pub reference: &'a Reference,
    /// Of what: direct, indirect or total light.
    pub quantity: Quantity,
    /// The scene.
    pub scene: &'a Scene,
    /// The frame, with its receivers.
    pub frame: &'a Frame,
    /// How good.
    pub quality: &'a Quality,
    /// Seed of everything random.
    pub seed: u64,
}

impl Request<'_> {
    /// Whether it can be answered.
    ///
    /// # Errors
    /// A quality out of range, or there is no such reference of this quantity in this scene.
    pub fn check(&self) -> Result<()> {
        self.quality.check()?;
        self.reference.serves(self.quantity, self.scene).map_err(|reason| self.not_served(reason))
    }

    pub(crate) fn not_served(&self, reason: String) -> Error {
        Error::NotServed { reference: self.reference.id(), quantity: self.quantity, reason }
    }

    /// Names its answer by all that it depends on and nothing else: the reference, the quantity, the posed objects that take
    /// part, the lights, the receivers, the quality, the seed and [`REVISION`]. Neither the scene's name nor its camera counts.
    pub fn key(&self) -> String {
        let quality = self.quality;
        let mut parts = vec![
            "reference".to_owned(),
            REVISION.to_owned(),
            self.reference.id(),
            self.quantity.to_string(),
            format!("seed {}, receivers {:016x}", self.seed, self.frame.receivers.revision.0),
            format!(
                "error {:08x}, samples {} to {}, batches {}",
                quality.standard_error.to_bits(),
                quality.min_samples,
                quality.max_samples,
                quality.batches
            ),
        ];
        parts.extend(self.frame.objects.iter().filter_map(|posed| self.part(posed)));
        parts.extend(self.frame.lights().map(|light| format!("light {}", light.content())));
        Content::of_parts(parts.iter().map(String::as_bytes)).to_string()
    }

    /// An object's part in the light; none if it has none.
    fn part(&self, posed: &PosedObject) -> Option<String> {
        let object = &self.scene.objects[posed.object];
        if !object.casts && !object.emits() {
            return None;
        }
        let bits = |values: &[f32]| values.iter().map(|v| format!("{:08x}", v.to_bits())).collect::<String>();
        let (turn, shift) = (posed.pose.rotation.to_array(), posed.pose.translation.to_array());
        let reflects = object.casts && self.quantity != Quantity::Direct;
        let texture = object.texture.as_ref().map_or(String::new(), |texture| texture.content().to_string());
        let albedo = if reflects { bits(&object.albedo.to_array()) + &texture } else { String::new() };
        let emission = match &object.emission {
            Emission::Even(radiance) => bits(&radiance.to_array()),
            triangles => triangles.content().to_string(),
        };
        let left_out = self.reference.leaves_out(&object.name);
        let (content, casts) = (posed.content, object.casts);
        Some(format!("object {content} {} {} casts {casts} {emission} {albedo} {left_out}", bits(&turn), bits(&shift)))
    }
}
