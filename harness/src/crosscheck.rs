//! Holding the truth against what another program found in an exported scene.

use crate::Error;
use crate::export::{CONTENTS, Case, Contents};
use halflight_references::Estimate;
use halflight_references::statistics::compare;
use halflight_results::{CrossCheck, Key, Picture, Record, ReferencePicture, Store};
use halflight_scenes::Rgb;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Probability that a cross-check of an honest program fails.
pub const SIGNIFICANCE: f64 = 0.001;

/// The file in which the other program answers.
const ANSWER: &str = "mitsuba.json";

/// What the other program found at the exported receivers, in their order.
#[derive(Deserialize)]
struct Answer {
    program: String,
    /// Independent samples a receiver.
    samples: u32,
    mean: Vec<[f32; 3]>,
    /// Of the mean.
    variance: Vec<[f32; 3]>,
}

/// Holds the truth against `mitsuba.json` in a folder of [`export_to_mitsuba`](crate::export_to_mitsuba), keeps both pictures and
/// the map of p in the store, and returns the record that was appended.
///
/// # Errors
/// A file that is missing or not what was expected, a scene that has changed since, or a store that cannot be written.
pub fn cross_check(folder: &Path, store: &mut Store, cache: &Path) -> Result<CrossCheck, Error> {
    let contents: Contents = read(&folder.join(CONTENTS))?;
    let answer: Answer = read(&folder.join(ANSWER))?;
    let case = Case::new(&contents.check)?;
    if case.scene.content.to_string() != contents.content {
        let message = "the scene has changed since, expected a new export";
        return Err(Error::Other(format!("{}: {message}", folder.display())));
    }
    let theirs = answer
        .estimate(case.frame.receivers.len())
        .map_err(|message| Error::Other(format!("{}: {message}", folder.join(ANSWER).display())))?;
    let ours = case.truth(cache)?;
    let found = compare(&ours, &theirs);

    let receiver_p: Vec<Rgb> = found.receiver_p.iter().map(|p| Rgb::splat(p.unwrap_or(1.0) as f32)).collect();
    let (radiance, valid) = (case.scatter(&receiver_p), case.valid());
    let record = CrossCheck {
        scene: case.scene.name.clone(),
        scene_hash: contents.content,
        frame: contents.check.frame as u32,
        quantity: contents.check.quantity,
        program: answer.program,
        samples: [contents.check.samples, answer.samples],
        ours: case.keep(&ours, store)?,
        theirs: case.keep(&theirs, store)?,
        receiver_p: store.write_picture(&Picture { layout: case.spread.layout, radiance, valid })?,
        receivers: found.receivers,
        largest: Some(found.largest).filter(|largest| largest.is_finite()),
        family_p: found.family_p,
        bias: found.bias,
        bias_error: found.bias_error,
        bias_p: found.bias_p,
        level: level(&theirs),
        p: found.p(),
        agrees: found.passes(SIGNIFICANCE),
    };
    store.append(Record::CrossCheck(Box::new(record.clone())))?;
    Ok(record)
}

impl Answer {
    fn estimate(&self, receivers: usize) -> Result<Estimate, String> {
        if [self.mean.len(), self.variance.len()] != [receivers; 2] {
            return Err(format!("{} means, {} variances; expected {receivers}", self.mean.len(), self.variance.len()));
        }
        if self.samples < 2 {
            return Err(format!("`samples` is {}, expected at least 2", self.samples));
        }
        let numbers = self.mean.iter().chain(&self.variance).flatten();
        if numbers.into_iter().any(|number| !number.is_finite()) || self.variance.iter().flatten().any(|v| *v < 0.0) {
            return Err("expected finite means and variances, and the latter not below 0".into());
        }
        let colours = |values: &[[f32; 3]]| values.iter().copied().map(Rgb::from_array).collect();
        Ok(Estimate {
            mean: colours(&self.mean),
            variance: colours(&self.variance),
            samples: vec![self.samples; receivers],
            batches: self.samples,
        })
    }
}

impl Case {
    /// Values of the chosen receivers in the picture's order.
    fn scatter<T: Copy + Default>(&self, values: &[T]) -> Vec<T> {
        let mut values = values.iter().copied();
        let value = |slot: &Option<usize>| slot.and_then(|_| values.next()).unwrap_or_default();
        self.spread.slots.iter().map(value).collect()
    }

    fn valid(&self) -> Vec<bool> {
        self.spread.slots.iter().map(Option::is_some).collect()
    }

    fn keep(&self, estimate: &Estimate, store: &Store) -> Result<Key, Error> {
        Ok(store.write_reference(&ReferencePicture {
            layout: self.spread.layout,
            mean: self.scatter(&estimate.mean),
            variance: self.scatter(&estimate.variance),
            samples: self.scatter(&estimate.samples),
            valid: self.valid(),
        })?)
    }
}

/// Mean over receivers and channels.
fn level(estimate: &Estimate) -> f64 {
    let sum: f64 = estimate.mean.iter().map(|mean| f64::from(mean.element_sum())).sum();
    sum / (3 * estimate.mean.len().max(1)) as f64
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, Error> {
    let bytes = std::fs::read(path).map_err(|source| Error::Io { path: path.to_owned(), source })?;
    serde_json::from_slice(&bytes).map_err(|error| Error::Other(format!("{}: {error}", path.display())))
}
