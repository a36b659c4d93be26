//! Shapes made ready for tracing, once for all frames.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use halflight_trace::{Body, Geometry};

use crate::{Content, PosedObject, Shape};

/// Bodies by their content, kept as long as the scene or a copy of it: all copies share them.
#[derive(Clone, Default)]
pub struct Bodies(Arc<Mutex<Held>>);

#[derive(Default)]
struct Held {
    lasting: HashMap<Key, Arc<Body>>,
    /// The last shape of each object that deforms.
    passing: HashMap<u32, (Content, Arc<Body>)>,
}

/// The objects of a body, each with the index of its geometry.
type Key = Vec<(u32, Content)>;

/// A shape in a body.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a> {
    /// Of its geometry.
    pub(crate) index: u32,
    pub(crate) shape: &'a Shape,
    pub(crate) content: Content,
}

impl<'a> Part<'a> {
    pub(crate) fn new(index: u32, posed: &'a PosedObject) -> Self {
        Part { index, shape: &posed.shape, content: posed.content }
    }
}

impl Bodies {
    /// The body of some shapes, none carried along by a pose. Indices ascend; those left out are of empty geometries.
    pub(crate) fn of(&self, parts: &[Part]) -> Arc<Body> {
        let key: Key = parts.iter().map(|part| (part.index, part.content)).collect();
        if let Some(body) = self.held().lasting.get(&key) {
            return body.clone();
        }
        // Not under the lock: the builder may hand this thread other work, which may ask for a body. Whoever is second
        // to build the same one throws his away.
        let body = Arc::new(build(parts));
        self.held().lasting.entry(key).or_insert(body).clone()
    }

    /// The body of an object that has another shape in the next frame; only the last one is kept.
    pub(crate) fn passing(&self, object: u32, part: Part) -> Arc<Body> {
        if let Some((content, body)) = self.held().passing.get(&object)
            && *content == part.content
        {
            return body.clone();
        }
        let body = Arc::new(build(&[part]));
        self.held().passing.insert(object, (part.content, body.clone()));
        body
    }

    fn held(&self) -> MutexGuard<'_, Held> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn build(parts: &[Part]) -> Body {
    let count = parts.last().map_or(0, |part| part.index as usize + 1);
    let mut geometries = vec![Geometry::Spheres(&[]); count];
    for part in parts {
        geometries[part.index as usize] = part.shape.geometry();
    }
    Body::build(&geometries)
}

impl fmt::Debug for Bodies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let held = self.held();
        write!(f, "Bodies({} and {} that deform)", held.lasting.len(), held.passing.len())
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::Sphere;

    fn ball(radius: f32) -> Shape {
        Shape::Spheres(vec![Sphere { center: Vec3::ZERO, radius }])
    }

    fn part(index: u32, shape: &Shape) -> Part<'_> {
        Part { index, shape, content: shape.content() }
    }

    #[test]
    fn what_has_the_same_content_is_built_once() {
        let (bodies, small, large) = (Bodies::default(), ball(1.0), ball(2.0));
        let first = bodies.of(&[part(0, &small), part(2, &large)]);
        assert!(Arc::ptr_eq(&first, &bodies.clone().of(&[part(0, &ball(1.0)), part(2, &large)])));
        let others = [
            vec![part(0, &large), part(2, &small)],
            vec![part(0, &small), part(1, &large)],
            vec![part(0, &small)],
            Vec::new(),
        ];
        for other in others {
            assert!(!Arc::ptr_eq(&first, &bodies.of(&other)));
        }
        assert_eq!(format!("{bodies:?}"), "Bodies(5 and 0 that deform)");
    }

    #[test]
    fn of_what_deforms_the_last_shape_is_kept() {
        let (bodies, small, large) = (Bodies::default(), ball(1.0), ball(2.0));
        let first = bodies.passing(3, part(0, &small));
        assert!(Arc::ptr_eq(&first, &bodies.passing(3, part(0, &small))));
        let second = bodies.passing(3, part(0, &large));
        assert!(!Arc::ptr_eq(&first, &second) && Arc::ptr_eq(&second, &bodies.passing(3, part(0, &large))));
        assert!(!Arc::ptr_eq(&first, &bodies.passing(3, part(0, &small))));
        assert_eq!(format!("{bodies:?}"), "Bodies(0 and 1 that deform)");
    }
}
