//! Scores: a cell's picture against its references. Only those that are not in the store are made.

use halflight_contract::{Cache, Meter, Quantity};
use halflight_metrics::VERSION;
use halflight_references::{Quality, Reference, ReferenceStore, Request, obtain};
use halflight_results::{Key, Layout, Picture, ReferencePicture, Run, Score, Store, StoreError};
use halflight_scenes::{Frame, Receivers, Scene};

/// A reference of a quantity on one frame, and the cells that lack a score against it.
pub(crate) struct Judgement {
    pub(crate) frame: usize,
    pub(crate) reference: Reference,
    pub(crate) quantity: Quantity,
    /// Of everything that decides the reference.
    pub(crate) key: Key,
    pub(crate) cells: Vec<Key>,
}

/// A reference as it lies in the store.
pub(crate) struct Judge {
    pub(crate) image: Key,
    pub(crate) picture: ReferencePicture,
    /// Whether it had to be made, rather than read from the cache.
    pub(crate) made: bool,
}

/// Whether a cell has its score against a reference, with both pictures at hand.
pub(crate) fn is_scored(cell: &Key, reference: &Key, store: &Store) -> bool {
    let score = store.score(cell, reference, VERSION);
    score.is_some_and(|score| store.has_image(&score.reference_image))
}

impl Judgement {
    /// The cells that wait still: those that failed have no picture, and a cell that was run again may have the picture that
    /// its old score is about.
    pub(crate) fn waiting(&self, store: &Store) -> Vec<&Key> {
        let waits = |cell: &&Key| store.run(cell).is_some() && !is_scored(cell, &self.key, store);
        self.cells.iter().filter(waits).collect()
    }

    /// Makes the reference, or takes it from the cache, and puts its picture into the store.
    pub(crate) fn judge(
        &self,
        scene: &Scene,
        frame: &Frame,
        with: &With<'_>,
        store: &Store,
        meter: &mut dyn Meter,
    ) -> Result<Judge, String> {
        let (reference, quantity) = (&self.reference, self.quantity);
        let request = Request { reference, quantity, scene, frame, quality: with.quality, seed: with.seed };
        let obtained = obtain(with.references, &request, with.cache, meter);
        let (estimate, _, made) = obtained.map_err(|e| e.to_string())?;
        let picture = ReferencePicture {
            layout: layout(&frame.receivers),
            mean: estimate.mean,
            variance: estimate.variance,
            samples: estimate.samples,
            valid: frame.receivers.valid.clone(),
        };
        let image = store.write_reference(&picture).map_err(|e| e.to_string())?;
        Ok(Judge { image, picture, made })
    }
}

/// The score of a run's picture against a reference of this id and key.
pub(crate) fn score(
    run: &Run,
    reference: &str,
    reference_key: &Key,
    store: &Store,
    judge: &Judge,
) -> Result<Score, String> {
    let cell = run.cell.key();
    let Some(image) = run.image.clone() else {
        return Err(format!("cell {}: expected a run with a picture", cell.short()));
    };
    let picture = store.read_picture(&image).map_err(|e| e.to_string())?;
    let standard_error = judge.picture.standard_error();
    let scores = halflight_metrics::compare(&view(&picture), &view(&judge.picture.picture()), &standard_error);
    let scores = scores.map_err(|e| e.to_string())?;
    Ok(Score {
        run: cell,
        image,
        reference: reference.to_owned(),
        reference_key: reference_key.clone(),
        reference_image: judge.image.clone(),
        metrics: VERSION,
        receivers: scores.receivers,
        resolved: scores.resolved,
        measures: scores.measures().map(|(name, value)| (name.to_owned(), value)).collect(),
    })
}

/// What references are made with.
pub(crate) struct With<'a> {
    pub(crate) references: &'a ReferenceStore,
    pub(crate) quality: &'a Quality,
    pub(crate) seed: u64,
    pub(crate) cache: &'a Cache,
}

/// Stores radiance at receivers as a picture.
pub(crate) fn write(
    store: &Store,
    receivers: &Receivers,
    radiance: Vec<halflight_scenes::Rgb>,
) -> Result<Key, StoreError> {
    store.write_picture(&Picture { layout: layout(receivers), radiance, valid: receivers.valid.clone() })
}

/// The layout of receivers as pictures have it.
pub(crate) fn layout(receivers: &Receivers) -> Layout {
    match receivers.layout {
        halflight_scenes::Layout::Image { width, height } => Layout::Image { width, height },
        halflight_scenes::Layout::List => Layout::List(receivers.len()),
    }
}

/// A stored picture as the metrics see it.
pub(crate) fn view(picture: &Picture) -> halflight_metrics::Picture<'_> {
    let layout = match picture.layout {
        Layout::Image { width, height } => halflight_metrics::Layout::Image { width, height },
        Layout::List(_) => halflight_metrics::Layout::List,
    };
    halflight_metrics::Picture { radiance: &picture.radiance, valid: &picture.valid, layout }
}
