//! Receivers as lines of `x,y,z,nx,ny,nz`.

use std::path::Path;

use glam::Vec3;

use crate::SceneError;
use crate::check::{Checker, FAR};

/// Reads positions and normals from a CSV file: six numbers a line, `x,y,z,nx,ny,nz`, after an optional header of
/// these names. Empty lines are skipped, normals normalised.
///
/// # Errors
/// A file that cannot be read or holds no point; a line without six finite numbers or with a zero normal.
pub fn read_points_csv(path: &Path) -> Result<Vec<(Vec3, Vec3)>, SceneError> {
    parse(Checker { file: path }, &super::read(path)?)
}

pub(super) fn parse(check: Checker, bytes: &[u8]) -> Result<Vec<(Vec3, Vec3)>, SceneError> {
    let text = str::from_utf8(bytes)
        .map_err(|error| check.malformed(format!("byte {}", error.valid_up_to()), "expected UTF-8 text"))?;
    let lines = text.trim_start_matches('\u{feff}').lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    let points = lines
        .filter(|(line, number)| *number > 1 || !is_header(line))
        .map(|(line, number)| point(check, &format!("line {number}"), line))
        .collect::<Result<Vec<_>, _>>()?;
    match points.is_empty() {
        true => Err(check.malformed("end of file", "expected at least one line x,y,z,nx,ny,nz")),
        false => Ok(points),
    }
}

fn is_header(line: &str) -> bool {
    line.split(',').map(str::trim).eq(["x", "y", "z", "nx", "ny", "nz"])
}

fn point(check: Checker, place: &str, line: &str) -> Result<(Vec3, Vec3), SceneError> {
    let invalid = |expected: &str| check.invalid(place, expected, line);
    let numbers: Vec<f32> = line
        .split(',')
        .map(|number| number.trim().parse().map_err(|_| invalid("six numbers x,y,z,nx,ny,nz")))
        .collect::<Result<_, _>>()?;
    let [x, y, z, nx, ny, nz] = numbers[..] else { return Err(invalid("six numbers x,y,z,nx,ny,nz")) };
    if !numbers.iter().all(|number| number.abs() <= FAR) {
        return Err(invalid("finite numbers of at most 1e9"));
    }
    let normal = glam::DVec3::new(nx.into(), ny.into(), nz.into()).try_normalize();
    let normal = normal.ok_or_else(|| invalid("a normal that is not zero"))?;
    Ok((Vec3::new(x, y, z), normal.as_vec3()))
}
