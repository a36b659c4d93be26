//! What objects of a scene file emit.

use super::objects::Source;
use crate::assets::Image;
use crate::{Emission, Object, Rgb, SceneError, Shape, Texture};

/// Most texels of a picture that a plane is cut by.
const MOST_CELLS: usize = 1 << 16;

impl Source<'_> {
    /// Models bring their own pictures.
    pub(super) fn only_plain_emission(&self) -> Result<(), SceneError> {
        let plain = self.file.gltf.is_none() && self.file.character.is_none() || self.file.emission_map.is_none();
        let (field, expected) = (format!("{}.emission_map", self.field), "beside a plane or a mesh");
        self.check.ensure(plain, &field, expected, &self.file.name).map(drop)
    }

    /// The picture by which the emission is multiplied.
    pub(super) fn emission_map(&self, notices: &mut Vec<String>) -> Result<Option<Image>, SceneError> {
        let Some(file) = &self.file.emission_map else { return Ok(None) };
        let field = format!("{}.emission_map", self.field);
        let bright = self.file.emission != [0.0; 3];
        self.check.ensure(bright, &format!("{}.emission", self.field), "what the picture is multiplied by", "none")?;
        let picture = self.assets.read(&field, &file.file, file.sha256.as_deref())?.image(notices)?;
        let texels = picture.texels.len();
        let fits = self.file.plane.is_none() || texels <= MOST_CELLS;
        self.check.ensure(fits, &field, &format!("at most {MOST_CELLS} texels on a plane"), texels)?;
        Ok(Some(picture))
    }

    /// The emission of an object that has it even so far, with the picture on it.
    pub(super) fn emission(&self, object: &Object, picture: Option<Image>) -> Result<Emission, SceneError> {
        let (even, Some(picture)) = (object.emission.of(0), picture) else { return Ok(object.emission.clone()) };
        let check = self.check;
        let bright = |radiance: Rgb| check.radiance(&format!("{}.emission", self.field), radiance.to_array());
        let greatest = picture.texels.iter().fold(Rgb::ZERO, |most, texel| most.max(*texel));
        bright(even * greatest)?;
        match &*object.shape {
            Shape::Mesh(_) if self.file.plane.is_some() => {
                Ok(Emission::of_triangles(picture.texels.iter().flat_map(|texel| [even * *texel; 2]).collect()))
            }
            Shape::Mesh(mesh) if !mesh.uvs.is_empty() => {
                Ok(Emission::of_picture(even, &Texture::new(picture.width, picture.texels), mesh))
            }
            _ => {
                let expected = "a plane, or a mesh with texture coordinates, to lie on";
                Err(check.invalid(&format!("{}.emission_map", self.field), expected, &self.file.name))
            }
        }
    }
}
