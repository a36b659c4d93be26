//! Probing: what a method or a reference says at given points.

use crate::execute::{Runner, Task};
use crate::progress::Progress;
use crate::recorder::Recorder;
use crate::{Error, Setting, judge, plan};
use halflight_contract::{Backend, Cache, Method, Params, Quantity, Request, Support};
use halflight_references::{Quality, Reference, ReferenceStore, obtain};
use halflight_scenes::{Rgb, Scene};
use std::path::Path;

/// Who is asked.
pub enum Source {
    /// A method with its parameters.
    Method(&'static dyn Method, Params),
    /// A reference.
    Reference {
        /// Which.
        reference: Reference,
        /// Samples at every point.
        samples: u32,
        /// SH order in which visibility is asked for too; a method gives its own order's.
        visibility: Option<u8>,
    },
}

/// What is asked.
#[derive(Clone, Copy)]
pub struct Question<'a> {
    /// A scene with its receivers at the points.
    pub scene: &'a Scene,
    /// Its frame.
    pub frame: usize,
    /// Which light.
    pub quantity: Quantity,
    /// Seed of everything random.
    pub seed: u64,
}

/// The answers, one entry a point.
pub struct Answers {
    /// Outgoing radiance for albedo 1.
    pub radiance: Vec<Rgb>,
    /// Its standard error, from a reference.
    pub standard_error: Option<Vec<Rgb>>,
    /// Visibility coefficients, `order²` a point, from a method that has them or a reference that is asked for them.
    pub visibility: Option<Vec<Vec<f32>>>,
    /// Their standard errors, from a reference.
    pub visibility_error: Option<Vec<Vec<f32>>>,
}

impl Source {
    /// A method by id, with settings of one value each.
    ///
    /// # Errors
    /// The method or a parameter is unknown, or a value is out of range.
    pub fn method(id: &str, set: &[Setting]) -> Result<Self, Error> {
        let method = plan::method(id)?;
        Ok(Source::Method(method, plan::single(method, set)?))
    }

    /// A reference by id, with so many samples at every point, and visibility in an SH order.
    ///
    /// # Errors
    /// There is no such reference, or its quality cannot be met by that number.
    pub fn reference(id: &str, samples: u32, visibility: Option<u8>) -> Result<Self, Error> {
        Quality::fixed(samples).check()?;
        Ok(Source::Reference { reference: judge::parse(id)?, samples, visibility })
    }
}

/// Asks at the receivers of one frame of a scene, which [`Scene::with_receivers`] has placed.
///
/// # Errors
/// The scene has no such frame, the method does not serve it, or the computation fails; the message says which.
pub fn probe(question: &Question<'_>, source: &Source, cache: &Path) -> Result<Answers, Error> {
    check_frame(question.scene, question.frame)?;
    match source {
        Source::Method(method, params) => of_method(question, *method, params, cache),
        Source::Reference { reference, samples, visibility } => {
            of_reference(question, reference, &Quality::fixed(*samples), *visibility, cache)
        }
    }
}

/// Whether a scene has a frame.
pub(crate) fn check_frame(scene: &Scene, frame: usize) -> Result<(), Error> {
    if frame < scene.frame_count {
        return Ok(());
    }
    Err(Error::Other(format!("frame {frame}: expected one below {}, the scene's count", scene.frame_count)))
}

fn of_method(
    question: &Question<'_>,
    method: &'static dyn Method,
    params: &Params,
    cache: &Path,
) -> Result<Answers, Error> {
    let Question { scene, quantity, seed, .. } = *question;
    let (id, backend) = (method.info().id, Backend::Cpu);
    let serves = |quantity| method.supports(&scene.facts(), &Request { quantity, backend, params });
    if let Support::Skip(why) = serves(quantity) {
        return Err(Error::Other(format!("{id} does not serve {quantity} of {}: {why}", scene.name)));
    }
    let failed = |error| Error::Other(format!("{id} failed on {}: {error}", scene.name));
    let cache = Cache::in_folder(&cache.join("derived"));
    let frame = scene.frame(question.frame);
    let mut runner = Runner::new(Task { scene, method, params, quantity, backend, seed, cache: &cache });
    let mut progress = Progress::new(1);
    let mut steps = |what: &str, done, total| progress.within(id, what, done, total);
    let shaded = runner.picture(&frame, &mut steps).map_err(failed)?;

    let order = order(params);
    let has = |order: &u8| !matches!(serves(Quantity::Visibility { order: *order }), Support::Skip(_));
    let visibility = order.filter(has).map(|order| -> Result<_, Error> {
        let all = runner.visibility(&frame, order, &mut steps).map_err(failed)?;
        Ok(all.chunks(usize::from(order).pow(2)).map(<[f32]>::to_vec).collect())
    });
    let visibility = visibility.transpose()?;
    Ok(Answers { radiance: shaded.radiance, standard_error: None, visibility, visibility_error: None })
}

/// The SH order that a method works at, where it declares one.
fn order(params: &Params) -> Option<u8> {
    let declared = params.iter().any(|(name, _)| name == "order");
    declared.then(|| u8::try_from(params.int("order")).ok()).flatten()
}

fn of_reference(
    question: &Question<'_>,
    reference: &Reference,
    quality: &Quality,
    visibility: Option<u8>,
    cache: &Path,
) -> Result<Answers, Error> {
    let Question { scene, quantity, seed, .. } = *question;
    let store = ReferenceStore::open(cache.join("references"))?;
    let derived = Cache::in_folder(&cache.join("derived"));
    let label = reference.id();
    let mut progress = Progress::new(1);
    let mut steps = |what: &str, done, total| progress.within(&label, what, done, total);
    let frame = &scene.frame(question.frame);
    let mut meter = Recorder::new(&mut steps);
    let request = halflight_references::Request { reference, quantity, scene, frame, quality, seed };
    let (estimate, _, _) = obtain(&store, &request, &derived, &mut meter)?;
    let standard_error = Some(estimate.standard_error());
    let visibility = visibility.map(|order| {
        let request = halflight_references::Request { quantity: Quantity::Visibility { order }, ..request };
        halflight_references::visibility(&request, &derived, &mut meter)
    });
    let (visibility, visibility_error) = match visibility.transpose()? {
        Some(found) => {
            let rows = |all: &[f32]| all.chunks_exact(found.order * found.order).map(<[f32]>::to_vec).collect();
            let errors: Vec<f32> = found.variance.iter().map(|variance| variance.sqrt()).collect();
            (Some(rows(&found.mean)), Some(rows(&errors)))
        }
        None => (None, None),
    };
    Ok(Answers { radiance: estimate.mean, standard_error, visibility, visibility_error })
}
