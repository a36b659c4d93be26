//! Checks of single values, each of which knows how to complain.

use std::fmt::Debug;
use std::path::Path;

use glam::{Quat, Vec3};

use crate::SceneError;
use crate::format::Rotation;

/// Largest coordinate in metres: far beyond any scene, and its square is still well within `f32`.
pub(crate) const FAR: f32 = 1e9;

/// Smallest length and scale: its inverse is [`FAR`].
const NEAR: f32 = 1e-9;

/// The file whose values are checked.
#[derive(Clone, Copy)]
pub(crate) struct Checker<'a> {
    pub(crate) file: &'a Path,
}

impl Checker<'_> {
    /// The error that says what `field` should have held.
    pub(crate) fn invalid(&self, field: &str, expected: impl Into<String>, found: impl Debug) -> SceneError {
        SceneError::Invalid {
            file: self.file.to_owned(),
            field: field.to_owned(),
            expected: expected.into(),
            found: format!("{found:?}"),
        }
    }

    /// The error that says where the file stops following its format.
    pub(crate) fn malformed(&self, place: impl Into<String>, problem: impl Into<String>) -> SceneError {
        SceneError::Malformed { file: self.file.to_owned(), place: place.into(), problem: problem.into() }
    }

    /// `value` if `holds`, the error otherwise.
    pub(crate) fn ensure<T: Debug>(&self, holds: bool, field: &str, expected: &str, value: T) -> Result<T, SceneError> {
        if holds { Ok(value) } else { Err(self.invalid(field, expected, value)) }
    }

    /// The error for a table that must hold exactly one of several fields.
    pub(crate) fn not_one(&self, field: &str, fields: &[(&str, bool)]) -> SceneError {
        let names: Vec<&str> = fields.iter().map(|(name, _)| *name).collect();
        let given: Vec<&str> = fields.iter().filter(|(_, given)| *given).map(|(name, _)| *name).collect();
        self.invalid(field, format!("exactly one of {}", names.join(", ")), given)
    }

    pub(crate) fn number(&self, field: &str, value: f32) -> Result<f32, SceneError> {
        self.ensure(value.abs() <= FAR, field, "a finite number of at most 1e9", value)
    }

    pub(crate) fn positive(&self, field: &str, value: f32) -> Result<f32, SceneError> {
        self.ensure(
            (NEAR..=FAR).contains(&value),
            field,
            "a positive finite number of at least 1e-9, at most 1e9",
            value,
        )
    }

    pub(crate) fn point(&self, field: &str, value: [f32; 3]) -> Result<Vec3, SceneError> {
        self.ensure(value.iter().all(|v| v.abs() <= FAR), field, "three finite numbers of at most 1e9", value)?;
        Ok(value.into())
    }

    /// Radiance: finite and not negative.
    pub(crate) fn radiance(&self, field: &str, value: [f32; 3]) -> Result<Vec3, SceneError> {
        let holds = value.iter().all(|v| *v >= 0.0 && *v <= FAR);
        self.ensure(holds, field, "three numbers from 0 to 1e9", value)?;
        Ok(value.into())
    }

    pub(crate) fn albedo(&self, field: &str, value: [f32; 3]) -> Result<Vec3, SceneError> {
        let holds = value.iter().all(|v| (0.0..=1.0).contains(v));
        self.ensure(holds, field, "three numbers in [0, 1]", value)?;
        Ok(value.into())
    }

    /// A direction, normalised.
    pub(crate) fn direction(&self, field: &str, value: [f32; 3]) -> Result<Vec3, SceneError> {
        let unit = Vec3::from(value).as_dvec3().try_normalize().map(|d| d.as_vec3());
        unit.filter(|d| d.is_finite()).ok_or_else(|| self.invalid(field, "a finite direction that is not zero", value))
    }

    pub(crate) fn rotation(&self, field: &str, value: &Rotation) -> Result<Quat, SceneError> {
        let axis = self.direction(&format!("{field}.axis"), value.axis)?;
        let degrees = self.number(&format!("{field}.degrees"), value.degrees)?;
        Ok(Quat::from_axis_angle(axis, degrees.to_radians()).normalize())
    }

    /// A number of pixels, grid cells or things in `1..=most`.
    pub(crate) fn count(&self, field: &str, value: usize, most: usize) -> Result<usize, SceneError> {
        self.ensure((1..=most).contains(&value), field, &format!("a whole number in 1..={most}"), value)
    }
}
