//! Merging: everything that another store knows and this one does not.
//!
//! Records are told apart by their keys, so merging again adds nothing. Where both stores know a cell, the better outcome
//! stays: a run whose picture is whole, a run, a failure, a skip, in this order; between equals the one that was there
//! first. Equal keys promise equal pictures, so two runs of one cell with different pictures are told as a conflict.

use crate::{Cell, CrossCheck, Key, PictureError, Record, ReferenceMade, Score, Store, StoreError};

/// What came of a merge.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Merged {
    /// Cells whose outcome was taken over.
    pub cells: usize,
    /// Runs whose times were taken over.
    pub times: usize,
    /// Scores that were taken over.
    pub scores: usize,
    /// Images that were copied.
    pub images: usize,
    /// Cells or scores that the stores disagree about; what was there first stayed.
    pub conflicts: Vec<String>,
    /// Images that records name and the other store does not have whole.
    pub missing: Vec<String>,
}

impl Store {
    /// Takes over from another store what this one lacks: outcomes of cells, scores of their present pictures, images.
    ///
    /// Images are verified against their hash and copied before the records that name them, so a merge that is killed
    /// and done again is whole.
    ///
    /// # Errors
    /// Something cannot be written, or an image not be read for a reason other than its being missing or damaged.
    pub fn merge(&mut self, from: &Store) -> Result<Merged, StoreError> {
        let mut merged = Merged::default();
        for theirs in from.outcomes() {
            let Some(cell) = theirs.cell() else { continue };
            let key = cell.key();
            let ours = self.outcome(&key);
            if let Some(conflict) = ours.and_then(|ours| conflict(ours, theirs, &key)) {
                merged.conflicts.push(conflict);
            }
            if ours.is_none_or(|ours| from.rank(theirs) > self.rank(ours)) {
                if let Some(image) = image(theirs) {
                    self.copy_image(from, image, &label(cell), &mut merged)?;
                }
                self.append(theirs.clone())?;
                merged.cells += 1;
            }
            if let Some(times) = from.times(&key).filter(|_| self.times(&key).is_none()) {
                self.append(Record::Times(Box::new(times.clone())))?;
                merged.times += 1;
            }
            for score in from.scores(&key) {
                self.merge_score(from, score, cell, &mut merged)?;
            }
        }
        for made in from.references_made() {
            let same = |ours: &ReferenceMade| {
                ours.reference_key == made.reference_key && ours.environment.class() == made.environment.class()
            };
            if !self.references_made().any(same) {
                self.append(Record::Reference(made.clone()))?;
            }
        }
        for check in from.cross_checks() {
            self.merge_cross_check(from, check, &mut merged)?;
        }
        for figure in from.all_measured() {
            if !self.all_measured().any(|ours| ours == figure) {
                self.append(Record::Measured(Box::new(figure.clone())))?;
            }
        }
        Ok(merged)
    }

    /// Takes over a cross-check of what this store has none of.
    fn merge_cross_check(&mut self, from: &Store, check: &CrossCheck, merged: &mut Merged) -> Result<(), StoreError> {
        if self.cross_checks().iter().any(|ours| ours.same_subject(check)) {
            return Ok(());
        }
        let what = format!("{} · {}", check.scene, check.program);
        for image in [&check.ours, &check.theirs, &check.receiver_p] {
            self.copy_image(from, image, &what, merged)?;
        }
        self.append(Record::CrossCheck(Box::new(check.clone())))
    }

    fn merge_score(&mut self, from: &Store, score: &Score, cell: &Cell, merged: &mut Merged) -> Result<(), StoreError> {
        // Of a run that did not stay.
        if self.run(&score.run).and_then(|run| run.image.as_ref()) != Some(&score.image) {
            return Ok(());
        }
        match self.score(&score.run, &score.reference_key, score.metrics) {
            Some(ours) if ours == score => {}
            Some(_) => {
                let (scene, method, key) = (&cell.scene, &cell.method, score.run.short());
                let conflict = format!("{scene} · {method} ({key}): two scores against `{}` differ", score.reference);
                merged.conflicts.push(conflict);
            }
            None => {
                self.copy_image(from, &score.reference_image, &label(cell), merged)?;
                self.append(Record::Score(score.clone()))?;
                merged.scores += 1;
            }
        }
        Ok(())
    }

    fn copy_image(&self, from: &Store, image: &Key, what: &str, merged: &mut Merged) -> Result<(), StoreError> {
        if self.has_image(image) {
            return Ok(());
        }
        match from.read_image(image) {
            Ok(bytes) => {
                self.write_image(&bytes)?;
                merged.images += 1;
            }
            Err(error @ (PictureError::Io { .. } | PictureError::Damaged { .. })) => {
                merged.missing.push(format!("{what}: {error}"));
            }
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }

    /// How good an outcome is.
    fn rank(&self, outcome: &Record) -> usize {
        match outcome {
            Record::Run(run) if run.image.as_ref().is_none_or(|image| self.has_image(image)) => 3,
            Record::Run(_) => 2,
            Record::Failure(_) => 1,
            Record::Skip(_)
            | Record::Times(_)
            | Record::Score(_)
            | Record::Reference(_)
            | Record::CrossCheck(_)
            | Record::Measured(_) => 0,
        }
    }
}

fn label(cell: &Cell) -> String {
    format!("{} · {}", cell.scene, cell.method)
}

fn image(outcome: &Record) -> Option<&Key> {
    match outcome {
        Record::Run(run) => run.image.as_ref(),
        _ => None,
    }
}

fn conflict(ours: &Record, theirs: &Record, key: &Key) -> Option<String> {
    let (Record::Run(a), Record::Run(b)) = (ours, theirs) else { return None };
    let cell = &a.cell;
    (a.image != b.image).then(|| {
        let key = key.short();
        format!("{} · {} ({key}): two runs of this cell have different pictures", cell.scene, cell.method)
    })
}
