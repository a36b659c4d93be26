//! Writing a scene for another renderer, to hold our truth against its.

mod mitsuba;
mod ply;
mod radiance_map;

use crate::progress::Progress;
use crate::recorder::Recorder;
use crate::{Error, probe};
use halflight_contract::{Cache, Quantity};
use halflight_references::{Estimate, Quality, Reference, ReferenceStore, Request, obtain};
use halflight_scenes::{Frame, Receivers, Scene};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// What the other renderer is to be held against.
#[derive(Clone, Copy, Debug)]
pub struct Check {
    /// Most receivers, spread evenly over those of the scene.
    pub receivers: usize,
    /// Samples of the truth at each.
    pub samples: u32,
    /// Seed of the truth.
    pub seed: u64,
}

/// What else a reader needs to know, `export.json`.
#[derive(Serialize)]
struct Contents<'a> {
    scene: &'a str,
    frame: usize,
    /// Files, one a light: outgoing radiance is the sum of what each gives.
    lights: Vec<String>,
    /// Of the truth's standard errors.
    degrees_of_freedom: u32,
}

/// Writes a frame of a scene as Mitsuba 3 reads it, with receivers and their truth, into a folder that is made if need be:
/// `export.json` (the files of the lights), `light-N.xml` (a scene with the `N`th light alone, since Mitsuba takes no two
/// environments), `shapes.xml` with its meshes (blockers only: what casts no shadow is left out), and `receivers.csv`.
///
/// # Errors
/// No such frame, samples out of range, a light that Mitsuba has no counterpart for, or a file that cannot be written.
pub fn export_to_mitsuba(scene: &Scene, frame: usize, check: &Check, cache: &Path, out: &Path) -> Result<(), Error> {
    probe::check_frame(scene, frame)?;
    let quality = Quality::fixed(check.samples);
    quality.check()?;
    let frame = spread(scene.frame(frame), check.receivers);
    let lights = mitsuba::write_scenes(scene, &frame, out)?;

    let truth = truth(scene, &frame, &quality, check.seed, cache)?;
    write(&out.join("receivers.csv"), table(&frame.receivers, &truth).as_bytes())?;
    let contents = Contents { scene: &scene.name, frame: frame.index, lights, degrees_of_freedom: quality.batches - 1 };
    let json = serde_json::to_string_pretty(&contents).map_err(|error| Error::Other(error.to_string()))?;
    write(&out.join("export.json"), json.as_bytes())
}

/// The frame with at most so many of its valid receivers.
fn spread(frame: Frame, most: usize) -> Frame {
    let valid: Vec<usize> = (0..frame.receivers.len()).filter(|i| frame.receivers.valid[*i]).collect();
    let count = valid.len().min(most);
    let chosen: Vec<usize> = (0..count).map(|i| valid[i * valid.len() / count]).collect();
    Frame { receivers: Arc::new(frame.receivers.select(&chosen)), ..frame }
}

fn truth(scene: &Scene, frame: &Frame, quality: &Quality, seed: u64, cache: &Path) -> Result<Estimate, Error> {
    let store = ReferenceStore::open(cache.join("references"))?;
    let derived = Cache::in_folder(&cache.join("derived"));
    let mut progress = Progress::new(1);
    let mut steps = |what: &str, done, total| progress.within("truth", what, done, total);
    let mut meter = Recorder::new(&mut steps);
    let (reference, quantity) = (&Reference::TRUTH, Quantity::Direct);
    let request = Request { reference, quantity, scene, frame, quality, seed };
    let (estimate, _, _) = obtain(&store, &request, &derived, &mut meter)?;
    Ok(estimate)
}

/// A line a receiver: position, geometric and shading normal, albedo, truth and its standard error.
fn table(receivers: &Receivers, truth: &Estimate) -> String {
    let mut table = "x,y,z,gx,gy,gz,nx,ny,nz,albedo_r,albedo_g,albedo_b,r,g,b,se_r,se_g,se_b\n".to_owned();
    let surface = receivers.position.iter().zip(&receivers.geometric_normal).zip(&receivers.normal);
    let light = receivers.albedo.iter().zip(&truth.mean).zip(truth.standard_error());
    for (((position, geometric), normal), ((albedo, mean), error)) in surface.zip(light) {
        let numbers = [*position, *geometric, *normal, *albedo, *mean, error].into_iter().flat_map(|v| v.to_array());
        let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
        let _ = writeln!(table, "{}", numbers.join(","));
    }
    table
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    std::fs::write(path, bytes).map_err(|source| Error::Io { path: path.to_owned(), source })
}
