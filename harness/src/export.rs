//! Writing a scene for another renderer, to hold our truth against its.

mod mitsuba;
mod ply;
mod radiance_map;

use crate::progress::Progress;
use crate::recorder::Recorder;
use crate::{Error, probe};
use halflight_contract::{Cache, Quantity};
use halflight_references::{Estimate, Quality, Reference, ReferenceStore, Request, obtain};
use halflight_results::Layout;
use halflight_scenes::{Frame, Receivers, Scene};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

/// What the other renderer is to be held against.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Check {
    /// The scene: a shipped one's name, or the path of its file.
    pub scene: String,
    /// The frame.
    pub frame: usize,
    /// Which light: `direct`, `indirect-N` or `total`.
    pub quantity: String,
    /// Most receivers, spread evenly over those of the scene.
    pub receivers: usize,
    /// Samples of the truth at each.
    pub samples: u32,
    /// Seed of the truth.
    pub seed: u64,
}

/// What else a reader needs to know, `export.json`.
#[derive(Serialize, Deserialize)]
pub(crate) struct Contents {
    #[serde(flatten)]
    pub(crate) check: Check,
    /// Of the scene.
    pub(crate) content: String,
    /// Files, one a light: outgoing radiance is the sum of what each gives.
    pub(crate) lights: Vec<String>,
}

/// The file of [`Contents`].
pub(crate) const CONTENTS: &str = "export.json";

/// Writes a frame of a scene as Mitsuba 3 reads it into a folder that is made if need be: `export.json` (what is asked, and
/// the files of the lights), `light-N.xml` (a scene with some of the light), `shapes.xml` with its meshes (what takes part in
/// light transport), and `receivers.csv` with the truth.
///
/// # Errors
/// No such scene, frame or quantity, samples out of range, something that Mitsuba has no counterpart for, or a file that cannot
/// be written.
pub fn export_to_mitsuba(check: &Check, cache: &Path, out: &Path) -> Result<(), Error> {
    let case = Case::new(check)?;
    let lights = mitsuba::write_scenes(&case.scene, &case.frame, out)?;
    let truth = case.truth(cache)?;
    write(&out.join("receivers.csv"), table(&case.frame.receivers, &truth).as_bytes())?;
    let contents = Contents { check: check.clone(), content: case.scene.content.to_string(), lights };
    let json = serde_json::to_string_pretty(&contents).map_err(|error| Error::Other(error.to_string()))?;
    write(&out.join(CONTENTS), json.as_bytes())
}

/// A check with its scene.
pub(crate) struct Case {
    pub(crate) scene: Scene,
    /// With the chosen receivers alone.
    pub(crate) frame: Frame,
    /// Where they lie in a picture.
    pub(crate) spread: Spread,
    quantity: Quantity,
    quality: Quality,
    seed: u64,
}

impl Case {
    pub(crate) fn new(check: &Check) -> Result<Self, Error> {
        let quantity = crate::plan::quantity(&check.quantity)?;
        let quality = Quality::fixed(check.samples);
        quality.check()?;
        let scene = halflight_scenes::find(&check.scene)?;
        probe::check_frame(&scene, check.frame)?;
        let frame = scene.frame(check.frame);
        let spread = Spread::of(&frame.receivers, check.receivers);
        let chosen: Vec<usize> = spread.chosen().collect();
        let frame = Frame { receivers: Arc::new(frame.receivers.select(&chosen)), ..frame };
        Ok(Case { scene, frame, spread, quantity, quality, seed: check.seed })
    }

    /// The truth at the chosen receivers, made or taken from the cache.
    pub(crate) fn truth(&self, cache: &Path) -> Result<Estimate, Error> {
        let store = ReferenceStore::open(cache.join("references"))?;
        let derived = Cache::in_folder(&cache.join("derived"));
        let mut progress = Progress::new(1);
        let mut steps = |what: &str, done, total| progress.within("truth", what, done, total);
        let mut meter = Recorder::new(&mut steps);
        let Case { scene, frame, quality, .. } = self;
        let (reference, quantity, seed) = (&Reference::TRUTH, self.quantity, self.seed);
        let request = Request { reference, quantity, scene, frame, quality, seed };
        let (estimate, _, _) = obtain(&store, &request, &derived, &mut meter)?;
        Ok(estimate)
    }
}

/// Some of a frame's receivers, spread evenly, with a layout of their own: of an image every so many pixels both ways.
pub(crate) struct Spread {
    pub(crate) layout: Layout,
    /// Receivers in the order of the layout; none where they are not valid.
    pub(crate) slots: Vec<Option<usize>>,
}

impl Spread {
    /// At most so many valid ones; of an image at least one pixel is asked.
    fn of(receivers: &Receivers, most: usize) -> Self {
        let valid = |i: usize| receivers.valid[i].then_some(i);
        match receivers.layout {
            halflight_scenes::Layout::Image { width, height } => {
                let grid = |step: usize| {
                    let along = move |length: usize| ((step / 2).min(length - 1)..length).step_by(step);
                    let slots = along(height).flat_map(|y| along(width).map(move |x| valid(y * width + x)));
                    let layout = Layout::Image { width: along(width).count(), height: along(height).count() };
                    Spread { layout, slots: slots.collect() }
                };
                let fits = |spread: &Spread| spread.chosen().count() <= most;
                (1..width.max(height)).map(grid).find(fits).unwrap_or_else(|| grid(width.max(height)))
            }
            halflight_scenes::Layout::List => {
                let valid: Vec<usize> = (0..receivers.len()).filter_map(valid).collect();
                let count = valid.len().min(most);
                let slots = (0..count).map(|i| Some(valid[i * valid.len() / count])).collect();
                Spread { layout: Layout::List(count), slots }
            }
        }
    }

    fn chosen(&self) -> impl Iterator<Item = usize> {
        self.slots.iter().copied().flatten()
    }
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
