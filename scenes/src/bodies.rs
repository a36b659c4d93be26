//! Shapes made ready for tracing, once for all frames.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use halflight_trace::{Body, Geometry};

use crate::{Content, Object};

/// Bodies by their content, kept as long as the scene or a copy of it: all copies share them.
#[derive(Clone, Default)]
pub struct Bodies(Arc<Mutex<HashMap<Key, Arc<Body>>>>);

/// The objects of a body, each with the index of its geometry.
type Key = Vec<(u32, Content)>;

impl Bodies {
    /// The body of some objects in rest position. Geometry indices ascend; those left out are of empty geometries.
    pub(crate) fn of(&self, objects: &[(u32, &Object)]) -> Arc<Body> {
        let key: Key = objects.iter().map(|(index, object)| (*index, object.content)).collect();
        if let Some(body) = self.held().get(&key) {
            return body.clone();
        }
        // Not under the lock: the builder may hand this thread other work, which may ask for a body. Whoever is second
        // to build the same one throws his away.
        let body = Arc::new(build(objects));
        self.held().entry(key).or_insert(body).clone()
    }

    fn held(&self) -> std::sync::MutexGuard<'_, HashMap<Key, Arc<Body>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn build(objects: &[(u32, &Object)]) -> Body {
    let count = objects.last().map_or(0, |(index, _)| *index as usize + 1);
    let mut geometries = vec![Geometry::Spheres(&[]); count];
    for (index, object) in objects {
        geometries[*index as usize] = object.shape.geometry();
    }
    Body::build(&geometries)
}

impl fmt::Debug for Bodies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Bodies({})", self.held().len())
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{Rgb, Shape, Sphere};

    fn ball(radius: f32) -> Object {
        let shape = Shape::Spheres(vec![Sphere { center: Vec3::ZERO, radius }]);
        let (name, content, pivot) = (String::new(), shape.content(), Vec3::ZERO);
        Object {
            name,
            shape: Arc::new(shape),
            content,
            albedo: Rgb::ONE,
            emission: Rgb::ZERO,
            casts: true,
            motion: Vec::new(),
            pivot,
        }
    }

    #[test]
    fn what_has_the_same_content_is_built_once() {
        let (bodies, small, large) = (Bodies::default(), ball(1.0), ball(2.0));
        let first = bodies.of(&[(0, &small), (2, &large)]);
        assert!(Arc::ptr_eq(&first, &bodies.clone().of(&[(0, &ball(1.0)), (2, &large)])));
        for other in [vec![(0, &large), (2, &small)], vec![(0, &small), (1, &large)], vec![(0, &small)], Vec::new()] {
            assert!(!Arc::ptr_eq(&first, &bodies.of(&other)));
        }
        assert_eq!(format!("{bodies:?}"), "Bodies(5)");
    }
}
