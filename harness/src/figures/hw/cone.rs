//! Figs. 3, 4 and 6: the shadow of a cone, its pictures and its profiles.

use super::panels::{Panels, planned};
use crate::Error;
use crate::ledger::{Bench, number};
use crate::plan::Group;
use halflight_reports::{Axis, Mark, Plot, Series, Sheet};
use halflight_results::Picture;
use halflight_scenes::{HeightField, Light, Scene, Shape};

/// What tells the panels of a suite from each other.
type Name = fn(&Group) -> String;

pub(super) const LEVELS: (&str, Name) = ("paper/hw-fig3", |group| format!("k = {}", group.params.int("levels")));
pub(super) const OFFSETS: (&str, Name) = ("paper/hw-fig4", |group| format!("o = {}", group.params.float("offset")));
pub(super) const SWATHS: (&str, Name) = ("paper/hw-fig6", |group| format!("ΔΦ = {}°", group.params.float("swath")));
#[cfg(test)]
pub(super) const NAMES: [(&str, Name); 3] = [LEVELS, OFFSETS, SWATHS];

/// Metres from the cone's axis where its shadow is crossed; its foot is at 0.5 m.
const CIRCLE: f64 = 0.75;
/// Where the shadow's middle is followed, from the foot to where it has ended, a cell a step.
const MIDDLE: std::ops::Range<f64> = 0.55..2.4;
const STEP: f64 = 0.02;
/// Degrees off the shadow's middle where the ground is open.
const OPEN: f64 = 150.0;

/// Pictures of a suite on the cone, then what its shadow is along and across its middle.
pub(super) fn shadows(bench: &Bench, sheet: &mut Sheet, (suite, name): (&str, Name)) -> Result<(), Error> {
    let plan = planned(suite)?;
    let scene = &plan.scenes[0].scene;
    let panels = Panels::new(bench, &plan, 0, scene, name)?;
    panels.show(sheet)?;
    let shadow = |picture| Shadow::new(scene, picture);
    let truth = shadow(&panels.truth.picture)?;
    let mut lines = vec![("ray traced".to_owned(), truth)];
    for (name, seen) in &panels.cells {
        lines.push((name.clone(), shadow(&seen.picture)?));
    }
    let mut rows = Vec::new();
    for (i, (name, line)) in lines.iter().enumerate() {
        // The truth's noise bends it more than any shadow.
        let ripple = if i == 0 { "–".into() } else { number(1e3 * line.ripple()) };
        rows.push(vec![name.clone(), number(line.at(CIRCLE, 0.0)), format!("{}°", number(line.edge())), ripple]);
    }
    for (row, [_, rmse, bias]) in rows.iter_mut().skip(1).zip(panels.errors(&panels.truth)?) {
        row.extend([rmse, bias]);
    }
    let columns = ["", "darkest of the circle", "edge across", "ripple along, ‰", "RMSE / level", "bias / level"];
    sheet.table(&columns, &rows);
    sheet.note(&format!(
        "Profiles are shares of the open ground's radiance. Across: on a circle of {CIRCLE} m about the cone, its edge from a quarter to three \
         quarters of its depth. Along: outwards in the shadow's middle; the ripple is the root mean square second difference from vertex to \
         vertex. RMSE and bias are over the traced picture's mean level."
    ));
    let across = |line: &Shadow| (-90..=90).map(|d| (f64::from(d), line.at(CIRCLE, f64::from(d)))).collect();
    sheet.plot(&plotted("Across the shadow", "degrees off its middle", &lines, across))?;
    Ok(sheet.plot(&plotted("Along its middle", "metres from the cone's axis", &lines, Shadow::middle))?)
}

fn plotted<'a>(
    title: &str,
    across: &str,
    lines: &[(String, Shadow<'a>)],
    of: impl Fn(&Shadow<'a>) -> Vec<(f64, f64)>,
) -> Plot {
    let series = lines.iter().enumerate().map(|(i, (name, line))| {
        let mark = if i == 0 { Mark::Dashed } else { Mark::Line };
        Series::new(name.clone(), mark, of(line))
    });
    let (across, upwards) = (Axis::linear(across), Axis::linear("share of the open ground's radiance"));
    Plot { title: title.into(), across, upwards, series: series.collect() }
}

/// The shadow of what stands at a field's origin, in a picture of its vertices.
struct Shadow<'a> {
    field: &'a HeightField,
    picture: &'a Picture,
    /// Radians: where it lies, opposite to the light.
    azimuth: f64,
    /// Radiance of open ground.
    open: f64,
}

impl<'a> Shadow<'a> {
    fn new(scene: &'a Scene, picture: &'a Picture) -> Result<Shadow<'a>, Error> {
        let fields = scene.objects.iter().find_map(|object| match &*object.shape {
            Shape::Heights(field) => Some(field),
            _ => None,
        });
        let lights = scene.lights.iter().find_map(|light| match &light.rest {
            Light::Key(key) => Some(key.direction),
            _ => None,
        });
        let (Some(field), Some(light)) = (fields, lights) else {
            return Err(Error::Other(format!("{}: expected a height field under a key light", scene.name)));
        };
        let shadow = Shadow { field, picture, azimuth: f64::from(-light.y).atan2(f64::from(-light.x)), open: 1.0 };
        Ok(Shadow { open: shadow.at(CIRCLE, OPEN), ..shadow })
    }

    /// Share of the open radiance, green, so many metres from the origin and degrees off the shadow's middle; bilinear between vertices.
    fn at(&self, radius: f64, degrees: f64) -> f64 {
        let (sin, cos) = (self.azimuth + degrees.to_radians()).sin_cos();
        let (origin, cell) = (self.field.origin().as_dvec2(), self.field.cell().as_dvec2());
        let (columns, rows) = (self.field.columns(), self.field.rows());
        let x = ((radius * cos - origin.x) / cell.x).clamp(0.0, (columns - 1) as f64);
        let y = ((radius * sin - origin.y) / cell.y).clamp(0.0, (rows - 1) as f64);
        let (i, j) = ((x as usize).min(columns - 2), (y as usize).min(rows - 2));
        let (u, v) = (x - i as f64, y - j as f64);
        // Rows of the picture run from +y down.
        let value = |i: usize, j: usize| f64::from(self.picture.radiance[(rows - 1 - j) * columns + i].y);
        let low = (1.0 - u) * value(i, j) + u * value(i + 1, j);
        let high = (1.0 - u) * value(i, j + 1) + u * value(i + 1, j + 1);
        ((1.0 - v) * low + v * high) / self.open
    }

    /// Degrees over which the edge goes from a quarter to three quarters of its depth.
    fn edge(&self) -> f64 {
        let deep = self.at(CIRCLE, 0.0);
        let level = |part: f64| deep + part * (1.0 - deep);
        let reached = |part| (0..1500).map(|i| 0.1 * f64::from(i)).find(|d| self.at(CIRCLE, *d) > level(part));
        reached(0.75).unwrap_or(f64::NAN) - reached(0.25).unwrap_or(f64::NAN)
    }

    /// Metres from the origin, and the share there.
    fn middle(&self) -> Vec<(f64, f64)> {
        let steps = ((MIDDLE.end - MIDDLE.start) / STEP) as usize;
        (0..=steps).map(|i| MIDDLE.start + STEP * i as f64).map(|radius| (radius, self.at(radius, 0.0))).collect()
    }

    /// Root mean square second difference along the middle.
    fn ripple(&self) -> f64 {
        let bends: Vec<f64> = self.middle().windows(3).map(|w| w[0].1 - 2.0 * w[1].1 + w[2].1).collect();
        (bends.iter().map(|bend| bend * bend).sum::<f64>() / bends.len() as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A wedge of shadow of the open ground's tenth, whose edges are linear from 20° to 60° off its middle.
    #[test]
    fn a_shadow_of_known_shape_is_measured() {
        let scene = halflight_scenes::find("cone").unwrap();
        let receivers = scene.frame(0).receivers;
        let value = |at: &Vec3| {
            let along = Vec3::new(0.7, 0.4, 0.0).normalize();
            let off = at.truncate().angle_to(along.truncate()).abs().to_degrees();
            Vec3::splat(3.0 * (0.1 + 0.9 * ((off - 20.0) / 40.0).clamp(0.0, 1.0)))
        };
        let (width, height) = (256, 256);
        let layout = halflight_results::Layout::Image { width, height };
        let radiance = receivers.position.iter().map(value).collect();
        let picture = Picture { layout, radiance, valid: vec![true; width * height] };
        let shadow = Shadow::new(&scene, &picture).unwrap();
        assert!((shadow.open - 3.0).abs() < 1e-5 && (shadow.at(CIRCLE, 0.0) - 0.1).abs() < 1e-5);
        assert!((shadow.at(CIRCLE, 40.0) - 0.55).abs() < 0.005 && (shadow.at(1.5, -40.0) - 0.55).abs() < 0.005);
        assert!((shadow.edge() - 20.0).abs() < 0.3, "{}", shadow.edge());
        assert!(shadow.ripple() < 1e-6 && shadow.middle().len() > 90);
    }
}
