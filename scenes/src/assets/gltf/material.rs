//! What a material reflects and emits, as far as diffuse surfaces go.

use gltf::image::Source;
use gltf::{Material, texture::Info};

use super::File;
use crate::assets::picture;
use crate::{Emission, Mesh, Rgb, SceneError, Texture};

pub(super) struct Look {
    pub(super) albedo: Rgb,
    pub(super) texture: Option<Texture>,
    pub(super) emission: Emission,
}

pub(super) fn look(
    file: &File,
    material: &Material,
    mesh: &Mesh,
    notices: &mut Vec<String>,
) -> Result<Look, SceneError> {
    let base = material.pbr_metallic_roughness();
    let [red, green, blue, _] = base.base_color_factor();
    let place = material.index().map_or("material".to_owned(), |index| format!("materials[{index}]"));
    let emission = Rgb::from_array(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0);
    let emission = file.check.radiance(&format!("{place}.emissiveFactor"), emission.to_array())?;
    let mut picture = |info: Option<Info>| match info {
        Some(info) if !mesh.uvs.is_empty() && info.tex_coord() == 0 => {
            texture(file, &info.texture(), notices).map(Some)
        }
        Some(_) => {
            notices.push(format!("{}: {place}: texture without its coordinates left out", file.check.file.display()));
            Ok(None)
        }
        None => Ok(None),
    };
    let texture = picture(base.base_color_texture())?;
    let emission = match picture(material.emissive_texture().filter(|_| emission != Rgb::ZERO))? {
        Some(picture) => Emission::of_picture(emission, &picture, mesh),
        None => emission.into(),
    };
    Ok(Look { albedo: file.check.albedo(&format!("{place}.baseColorFactor"), [red, green, blue])?, texture, emission })
}

fn texture(file: &File, texture: &gltf::Texture, notices: &mut Vec<String>) -> Result<Texture, SceneError> {
    let image = texture.source();
    let field = format!("images[{}]", image.index());
    match image.source() {
        Source::View { view, .. } => picture::texture(file.check, &field, file.buffers.view(file.check, &view)?),
        Source::Uri { uri, .. } if !uri.starts_with("data:") => {
            super::bytes::beside(file.asset, &field, uri)?.texture(&field, notices)
        }
        Source::Uri { uri, .. } => {
            let bytes = super::bytes::fetch(file.asset, &field, uri)?;
            picture::texture(file.check, &field, &bytes)
        }
    }
}
