//! Closed meshes by formula of a scene file.

use glam::Vec3;

use crate::check::Checker;
use crate::format::{BlobFile, ObjectFile};
use crate::solids::{Capsule, ball, blob, block, cylinder};
use crate::{Mesh, SceneError};

/// Most cuts of a ball, cells along a side, and capsules.
const MOST_CUTS: usize = 8;
const MOST_CELLS: usize = 512;
const MOST_CAPSULES: usize = 256;

/// The solid that an entry describes.
pub(super) fn load(check: Checker, field: &str, file: &ObjectFile) -> Result<Mesh, SceneError> {
    let cells = |name: &str, count: usize, least: usize| {
        let expected = format!("a whole number in {least}..={MOST_CELLS}");
        let holds = (least..=MOST_CELLS).contains(&count);
        check.ensure(holds, &format!("{field}.{name}"), &expected, count).map(|count| count as u32)
    };
    let length = |name: &str, value: f32| check.positive(&format!("{field}.{name}"), value);
    if let Some(file) = &file.ball {
        let holds = file.cuts <= MOST_CUTS;
        check.ensure(holds, &format!("{field}.ball.cuts"), &format!("at most {MOST_CUTS}"), file.cuts)?;
        Ok(ball(length("ball.radius", file.radius)?, file.cuts as u32))
    } else if let Some(file) = &file.block {
        let [x, y, z] = file.size.map(|side| length("block.size", side));
        let [i, j, k] = file.cells.map(|count| cells("block.cells", count, 1));
        Ok(block(Vec3::new(x?, y?, z?), [i?, j?, k?]))
    } else if let Some(file) = &file.cylinder {
        let (radius, height) = (length("cylinder.radius", file.radius)?, length("cylinder.height", file.height)?);
        let (sides, rings) = (cells("cylinder.sides", file.sides, 3)?, cells("cylinder.rings", file.rings, 1)?);
        Ok(cylinder(radius, height, sides, rings))
    } else if let Some(file) = &file.blob {
        let resolution = cells("blob.resolution", file.resolution, 4)?;
        Ok(blob(&capsules(check, field, file)?, file.blend, resolution))
    } else {
        unreachable!("the entry has one shape, and it is none of the others")
    }
}

fn capsules(check: Checker, field: &str, file: &BlobFile) -> Result<Vec<Capsule>, SceneError> {
    let field = format!("{field}.blob");
    check.count(&format!("{field}.capsules"), file.capsules.len(), MOST_CAPSULES)?;
    let mut capsules = Vec::new();
    for (index, capsule) in file.capsules.iter().enumerate() {
        let field = format!("{field}.capsules[{index}]");
        let (from, to) =
            (check.point(&format!("{field}.from"), capsule.from)?, check.point(&format!("{field}.to"), capsule.to)?);
        let [start, end] = capsule.radii.map(|radius| check.positive(&format!("{field}.radii"), radius));
        let radii = [start?, end?];
        // Else one ball swallows the other, and the surface is no cone.
        let holds = from == to || (radii[1] - radii[0]).abs() < from.distance(to);
        check.ensure(holds, &format!("{field}.radii"), "radii that differ by less than the length", radii)?;
        capsules.push(Capsule { from, to, radii });
    }
    let thinnest = capsules.iter().flat_map(|capsule| capsule.radii).fold(f32::INFINITY, f32::min);
    let holds = (0.0..=thinnest).contains(&file.blend);
    check.ensure(holds, &format!("{field}.blend"), &format!("0 to the least radius, {thinnest}"), file.blend)?;
    Ok(capsules)
}
