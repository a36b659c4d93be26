//! The error budget of a method: what each approximation on the way from the truth adds.

pub(crate) mod chain;

use crate::execute::{Runner, Task};
use crate::probe::{Question, check_frame};
use crate::progress::Progress;
use crate::recorder::Recorder;
use crate::{Error, score};
use chain::{What, walk};
use halflight_contract::{Backend, Cache, Method, Params, Request, Support};
use halflight_metrics::{Difference, difference};
use halflight_references::{Quality, ReferenceStore, obtain};
use halflight_reports::{Budget, BudgetStep};
use halflight_results::Picture;
use halflight_scenes::{Frame, Rgb};
use std::path::Path;

/// A picture and its variance.
#[derive(Clone)]
pub(crate) struct Seen {
    pub(crate) picture: Picture,
    pub(crate) variance: Vec<Rgb>,
}

/// Walks from the truth to a method on a scene. References are taken from the cache's store, or made and kept there.
///
/// # Errors
/// The method does not serve the scene, or a step fails.
pub fn budget(
    question: &Question<'_>,
    method: &'static dyn Method,
    params: &Params,
    quality: &Quality,
    cache: &Path,
) -> Result<Budget, Error> {
    let Question { scene, quantity, .. } = *question;
    let id = method.info().id;
    check_frame(scene, question.frame)?;
    if let Support::Skip(why) = method.supports(&scene.facts(), &Request { quantity, backend: Backend::Cpu, params }) {
        return Err(Error::Other(format!("{id} does not serve {quantity} of {}: {why}", scene.name)));
    }
    let asked = Asked::new(question, quality, cache)?;
    let walk = walk(scene, quantity, method, params);
    let mut progress = Progress::new(walk.steps.len());
    let mut seen: Vec<Seen> = Vec::new();
    let mut steps = Vec::new();
    for step in walk.steps {
        let label = format!("{} · {}", scene.name, step.name);
        progress.begin(&label);
        let mut tell = |what: &str, done, total| progress.within(&label, what, done, total);
        let this = asked.see(&step.what, &mut tell)?;
        progress.end(&label, "done");
        let against = |other: Option<&Seen>| other.map(|other| apart(&this, other)).transpose();
        let (from_truth, change) = (against(seen.first())?, against(seen.last())?);
        let picture = this.picture.clone();
        steps.push(BudgetStep { name: step.name, about: step.about, picture, from_truth, change });
        seen.push(this);
    }
    let settings: String = params.iter().map(|(name, value)| format!(" {name}={value}")).collect();
    let frame = if scene.frame_count > 1 { format!(" · frame {}", question.frame) } else { String::new() };
    Ok(Budget {
        title: format!("{} · {id} · {quantity}{frame}", scene.name),
        settings: settings.trim().to_owned(),
        left_out: walk.left_out,
        steps,
    })
}

/// What all steps have in common.
pub(crate) struct Asked<'a> {
    question: &'a Question<'a>,
    pub(crate) frame: Frame,
    quality: &'a Quality,
    store: ReferenceStore,
    cache: Cache,
}

impl<'a> Asked<'a> {
    pub(crate) fn new(question: &'a Question<'a>, quality: &'a Quality, cache: &Path) -> Result<Self, Error> {
        Ok(Asked {
            question,
            frame: question.scene.frame(question.frame),
            quality,
            store: ReferenceStore::open(cache.join("references"))?,
            cache: Cache::in_folder(&cache.join("derived")),
        })
    }

    pub(crate) fn see(&self, what: &What, steps: &mut crate::recorder::Steps<'_>) -> Result<Seen, Error> {
        let Question { scene, quantity, seed, .. } = *self.question;
        let (radiance, variance) = match what {
            What::Reference(reference) => {
                let (frame, quality) = (&self.frame, self.quality);
                let request = halflight_references::Request { reference, quantity, scene, frame, quality, seed };
                let (estimate, ..) = obtain(&self.store, &request, &self.cache, &mut Recorder::new(steps))?;
                (estimate.mean, estimate.variance)
            }
            What::Method(method, params) => {
                let (backend, cache) = (Backend::Cpu, &self.cache);
                let task = Task { scene, method: *method, params, quantity, backend, seed, cache };
                let shaded = Runner::new(task).picture(&self.frame, steps);
                let failed = |error| Error::Other(format!("{} failed on {}: {error}", method.info().id, scene.name));
                let radiance = shaded.map_err(failed)?.radiance;
                let variance = vec![Rgb::ZERO; radiance.len()];
                (radiance, variance)
            }
        };
        Ok(Seen { picture: self.picture(radiance), variance })
    }

    /// The picture that the frame's receivers make with these values.
    pub(crate) fn picture(&self, radiance: Vec<Rgb>) -> Picture {
        let receivers = &self.frame.receivers;
        Picture { layout: score::layout(receivers), radiance, valid: receivers.valid.clone() }
    }
}

pub(crate) fn apart(this: &Seen, other: &Seen) -> Result<Difference, Error> {
    difference(&score::view(&this.picture), &this.variance, &score::view(&other.picture), &other.variance)
        .map_err(|error| Error::Other(error.to_string()))
}
