//! Height fields of a scene file.

mod fractal;
mod generate;
mod holes;

use glam::{Vec2, Vec3};

use crate::animation::{Growth, Swell, Wave};
use crate::assets::{Asset, Assets, HeightMap};
use crate::check::{Checker, FAR};
use crate::format::{GrowFile, HeightsFile, ObjectFile};
use crate::{HeightField, SceneError};

use super::objects::Rest;
use super::{MOST_PIXELS, MOST_RECEIVERS};

/// The field about the origin.
pub(super) fn load(
    check: Checker,
    assets: &Assets,
    field: &str,
    file: &HeightsFile,
    notices: &mut Vec<String>,
) -> Result<HeightField, SceneError> {
    let [x, y] = file.cell.map(|side| check.positive(&format!("{field}.cell"), side));
    let cell = Vec2::new(x?, y?);
    let (size, heights) = match &file.file {
        Some(_) => read(check, assets, field, file, notices)?,
        None => generate(check, field, file, cell)?,
    };
    Ok(HeightField::new(size, first_vertex(size, cell), cell, heights))
}

/// The vertex (0, 0) of a field about the origin.
fn first_vertex([columns, rows]: [usize; 2], cell: Vec2) -> Vec2 {
    -0.5 * Vec2::new((columns - 1) as f32, (rows - 1) as f32) * cell
}

fn read(
    check: Checker,
    assets: &Assets,
    field: &str,
    file: &HeightsFile,
    notices: &mut Vec<String>,
) -> Result<([usize; 2], Vec<f32>), SceneError> {
    let name = file.file.as_deref().unwrap_or_default();
    if file.resolution.is_some() || generate::any(file) {
        return Err(check.invalid(field, "either a file or a resolution with a generator", "both"));
    }
    let asset = assets.read(field, name, file.sha256.as_deref())?;
    let mut map = asset.height_map()?;
    stretch(check, field, file, &mut map)?;
    if let Some(nodata) = file.nodata {
        fill(check, field, nodata, &asset, &mut map, notices)?;
    }
    map.check(asset.check())?;
    let size = [map.width, map.height];
    check.ensure(map.width >= 2 && map.height >= 2, &format!("{field}.file"), "at least 2 x 2 heights", size)?;
    // The top row of a picture is the far edge, +y.
    Ok((size, map.heights.rchunks_exact(map.width).flatten().copied().collect()))
}

/// Whole numbers without sign are shares of a range.
fn stretch(check: Checker, field: &str, file: &HeightsFile, map: &mut HeightMap) -> Result<(), SceneError> {
    let field = format!("{field}.range");
    match (file.range, map.shares) {
        (None, false) => Ok(()),
        (Some([low, high]), true) => {
            let (low, high) = (check.number(&field, low)?, check.number(&field, high)?);
            map.heights.iter_mut().for_each(|height| *height = low + (high - low) * *height);
            Ok(())
        }
        (range, _) => {
            let expected = "the heights of black and white beside a picture of whole numbers (a PNG), and only there";
            Err(check.invalid(&field, expected, range))
        }
    }
}

/// Heights that the picture lacks come from their neighbours.
fn fill(
    check: Checker,
    field: &str,
    nodata: f32,
    asset: &Asset,
    map: &mut HeightMap,
    notices: &mut Vec<String>,
) -> Result<(), SceneError> {
    let nothing = || check.invalid(&format!("{field}.nodata"), "a value that not all of the picture has", nodata);
    let filled = holes::fill(map.width, &mut map.heights, nodata).ok_or_else(nothing)?;
    if filled > 0 {
        let (file, all) = (asset.path.display(), map.heights.len());
        notices.push(format!("{file}: {filled} of {all} heights without data: filled from their neighbours"));
    }
    Ok(())
}

fn generate(check: Checker, field: &str, file: &HeightsFile, cell: Vec2) -> Result<([usize; 2], Vec<f32>), SceneError> {
    check.ensure(file.sha256.is_none(), &format!("{field}.sha256"), "a hash only beside a file", &file.sha256)?;
    check.ensure(file.range.is_none(), &format!("{field}.range"), "a range only beside a file", file.range)?;
    check.ensure(file.nodata.is_none(), &format!("{field}.nodata"), "a value only beside a file", file.nodata)?;
    let place = format!("{field}.resolution");
    let missing = || check.invalid(&place, "vertices along x and y, since no file is given", "none");
    let size @ [columns, rows] = file.resolution.ok_or_else(missing)?;
    let holds = size.iter().all(|count| (2..=MOST_PIXELS).contains(count)) && columns * rows <= MOST_RECEIVERS;
    let expected = format!("two numbers in 2..={MOST_PIXELS} whose product is at most {MOST_RECEIVERS}");
    check.ensure(holds, &place, &expected, size)?;
    let height = generate::heights(check, field, file, cell)?;
    let first = first_vertex(size, cell).as_dvec2();
    let vertex = |index: usize| {
        let grid = glam::DVec2::new((index % columns) as f64, (index / columns) as f64);
        height(first + grid * cell.as_dvec2()) as f32
    };
    let heights: Vec<f32> = (0..columns * rows).map(vertex).collect();
    match heights.iter().find(|height| height.is_nan() || height.abs() > FAR) {
        None => Ok((size, heights)),
        Some(height) => Err(check.invalid(field, "heights of at most 1e9", height)),
    }
}

/// What the field does over time.
pub(super) fn swell(check: Checker, field: &str, file: &HeightsFile, rest: &Rest) -> Result<Option<Swell>, SceneError> {
    let waves = file.waves.as_deref().map(|waves| generate::waves(check, field, waves)).transpose()?;
    let waves: Vec<Wave> = waves.into_iter().flatten().filter(|wave| wave.pace != 0.0).collect();
    let growth = file.grow.as_ref().map(|file| growth(check, &format!("{field}.grow"), file)).transpose()?;
    let highest: f64 = waves.iter().map(|wave| wave.amplitude.abs()).sum::<f64>() * f64::from(rest.scale);
    check.ensure(2.0 * highest <= f64::from(FAR), field, "heights of at most 1e9 at all times", highest)?;
    let swells = !waves.is_empty() || growth.is_some();
    let (scale, place) = (f64::from(rest.scale), rest.translation.as_dvec3());
    Ok(swells.then_some(Swell { waves, growth, scale, place }))
}

fn growth(check: Checker, field: &str, file: &GrowFile) -> Result<Growth, SceneError> {
    let from =
        check.ensure((0.0..=1.0).contains(&file.from), &format!("{field}.from"), "a share in 0..=1", file.from)?;
    let seconds = check.positive(&format!("{field}.seconds"), file.seconds)?;
    Ok(Growth { from: from.into(), seconds: seconds.into() })
}

/// Refuses what would turn a field.
pub(super) fn upright(check: Checker, field: &str, file: &ObjectFile) -> Result<(), SceneError> {
    const EXPECTED: &str = "none: height fields stand upright";
    check.ensure(file.rotate.is_none(), &format!("{field}.rotate"), EXPECTED, &file.rotate)?;
    for (index, key) in file.motion.iter().enumerate() {
        check.ensure(key.rotate.is_none(), &format!("{field}.motion[{index}].rotate"), EXPECTED, &key.rotate)?;
    }
    Ok(())
}

/// The field scaled and moved into its rest position.
pub(super) fn at_rest(
    check: Checker,
    field: &str,
    heights: &HeightField,
    scale: f32,
    translation: Vec3,
) -> Result<HeightField, SceneError> {
    let size @ [columns, rows] = [heights.columns(), heights.rows()];
    let origin = scale * heights.origin() + translation.truncate();
    let cell = scale * heights.cell();
    let raised: Vec<f32> = heights.heights().iter().map(|height| height * scale + translation.z).collect();
    let far = |value: &f32| value.abs() > FAR;
    let last = origin + Vec2::new((columns - 1) as f32, (rows - 1) as f32) * cell;
    if let Some(value) = raised.iter().chain(&origin.to_array()).chain(&last.to_array()).find(|value| far(value)) {
        return Err(check.invalid(field, "coordinates of at most 1e9 after scale and translate", value));
    }
    let apart = |first: f32, step: f32, count: usize| {
        (1..count).all(|i| first + i as f32 * step > first + (i - 1) as f32 * step)
    };
    let grown = cell.min_element() > 0.0 && apart(origin.x, cell.x, columns) && apart(origin.y, cell.y, rows);
    let expected = "a scale and translation under which no two vertices fall together by rounding";
    check.ensure(grown, field, expected, cell)?;
    Ok(HeightField::new(size, origin, cell, raised))
}
