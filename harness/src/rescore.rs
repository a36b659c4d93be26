//! Scoring again from what a store holds: pictures and references, without running anything.

use crate::score;
use halflight_metrics::VERSION;
use halflight_results::{Key, Record, Run, Score, Store, StoreError};

/// What was done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rescored {
    /// Scores that were added.
    pub added: usize,
    /// Scores that were of the present measures already.
    pub present: usize,
    /// Scores that could not be taken, and why.
    pub failed: Vec<String>,
}

/// Adds the scores of the present error measures wherever a run's picture has scores of older ones alone.
///
/// # Errors
/// The store cannot be written. A picture that is missing or damaged stops that score only.
pub fn rescore(store: &mut Store) -> Result<Rescored, StoreError> {
    let mut done = Rescored::default();
    let cells: Vec<Key> = store.outcomes().filter_map(|record| Some(record.cell()?.key())).collect();
    for cell in cells {
        let Some(run) = store.run(&cell).cloned() else { continue };
        for old in newest(store.scores(&cell)) {
            if old.metrics >= VERSION {
                done.present += 1;
                continue;
            }
            match again(store, &run, &old) {
                Ok(score) => {
                    store.append(Record::Score(score))?;
                    done.added += 1;
                }
                Err(error) => {
                    let (scene, method, reference) = (&run.cell.scene, &run.cell.method, &old.reference);
                    done.failed.push(format!("{scene} · {method} against {reference}: {error}"));
                }
            }
        }
    }
    Ok(done)
}

/// The scores with the newest measures, one a reference's key.
pub(crate) fn newest(scores: Vec<&Score>) -> Vec<Score> {
    let mut best: Vec<&Score> = Vec::new();
    for score in scores {
        match best.iter_mut().find(|held| held.reference_key == score.reference_key) {
            Some(held) if score.metrics > held.metrics => *held = score,
            Some(_) => {}
            None => best.push(score),
        }
    }
    best.into_iter().cloned().collect()
}

fn again(store: &Store, run: &Run, old: &Score) -> Result<Score, String> {
    let reference = store.read_reference(&old.reference_image).map_err(|e| e.to_string())?;
    let judge = score::Judge { image: old.reference_image.clone(), picture: reference, made: false };
    score::score(run, &old.reference, &old.reference_key, store, &judge)
}
