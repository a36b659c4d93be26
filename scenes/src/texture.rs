//! Pictures on surfaces.

use std::sync::Arc;

use glam::{IVec2, Vec2};

use crate::content::Collector;
use crate::{Content, Rgb};

/// A picture that repeats over texture coordinates; `(0, 0)` is the outer corner of its first texel, v runs down its rows.
#[derive(Clone, Debug)]
pub struct Texture {
    width: usize,
    texels: Arc<Vec<Rgb>>,
    content: Content,
}

impl Texture {
    /// A picture of rows of `width > 0` texels; there is at least one row.
    pub(crate) fn new(width: usize, texels: Vec<Rgb>) -> Self {
        assert!(width > 0 && texels.len() >= width && texels.len().is_multiple_of(width), "whole rows");
        let content = Collector::new("texture").word(width).list(&texels, |all, texel| all.vec3(*texel)).finish();
        Texture { width, texels: Arc::new(texels), content }
    }

    /// Hash of the picture.
    pub fn content(&self) -> Content {
        self.content
    }

    /// Texels a row.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Row major.
    pub(crate) fn texels(&self) -> &[Rgb] {
        &self.texels
    }

    /// Bilinear between texel centres.
    pub fn at(&self, uv: Vec2) -> Rgb {
        let size = IVec2::new(self.width as i32, (self.texels.len() / self.width) as i32);
        let turned = uv - uv.floor();
        let at = turned * size.as_vec2() - 0.5;
        let (first, weight) = (at.floor().as_ivec2(), at - at.floor());
        let texel = |dx, dy| {
            let at = (first + IVec2::new(dx, dy)).rem_euclid(size);
            self.texels[at.y as usize * self.width + at.x as usize]
        };
        let row = |dy| texel(0, dy).lerp(texel(1, dy), weight.x);
        row(0).lerp(row(1), weight.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_are_texels_and_borders_repeat() {
        let texture = Texture::new(2, vec![Rgb::ZERO, Rgb::X, Rgb::Y, Rgb::Z]);
        assert_eq!(texture.at(Vec2::new(0.75, 0.25)), Rgb::X);
        assert_eq!(texture.at(Vec2::new(-1.75, 4.75)), Rgb::Y);
        assert_eq!(texture.at(Vec2::new(0.5, 0.25)), Rgb::X * 0.5);
        assert_eq!(texture.at(Vec2::new(1.0, 0.25)), Rgb::X * 0.5);
        assert_eq!(texture.at(Vec2::ZERO), Rgb::new(0.25, 0.25, 0.25));
    }
}
