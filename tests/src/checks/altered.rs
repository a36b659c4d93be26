//! Scenes and frames with one thing changed, and with revisions that tell so.

use std::sync::Arc;

use glam::Vec3;
use halflight_scenes::{
    Content, DistantLight, Emission, Environment, Frame, KeyLight, Layout, Light, Mesh, Object, Receivers, Revision,
    Rgb, Scene, Shape, Sky, Sphere,
};

/// The scene under other lights.
pub(super) fn relit(scene: &Scene, lights: Vec<DistantLight>) -> Scene {
    let hashes: Vec<String> = lights.iter().map(|light| light.content().to_string()).collect();
    Scene { content: after(scene.content, &hashes.concat()), lights, ..scene.clone() }
}

/// The scene with the radiance of every light and lamp multiplied.
pub(super) fn brighter(scene: &Scene, factor: Rgb) -> Scene {
    let lights = scene.lights.iter();
    let relit =
        relit(scene, lights.map(|light| DistantLight { rest: scaled(&light.rest, factor), ..light.clone() }).collect());
    let emission = |object: &Object| match &object.emission {
        Emission::Even(radiance) => Emission::Even(*radiance * factor),
        Emission::Triangles(triangles) => {
            let brighter: Vec<Rgb> = triangles.iter().map(|radiance| *radiance * factor).collect();
            Emission::Triangles(brighter.into())
        }
    };
    let objects = scene.objects.iter().map(|object| Object { emission: emission(object), ..object.clone() });
    let content = after(relit.content, &format!("emission times {factor}"));
    Scene { content, objects: objects.collect(), ..relit }
}

fn scaled(light: &Light, factor: Rgb) -> Light {
    match light {
        Light::Environment(map) => {
            let texels = Arc::new(map.texels.iter().map(|texel| *texel * factor).collect());
            Light::Environment(Environment { texels, ..map.clone() })
        }
        Light::Sky(Sky::Uniform(radiance)) => Light::Sky(Sky::Uniform(*radiance * factor)),
        Light::Sky(Sky::Overcast(zenith)) => Light::Sky(Sky::Overcast(*zenith * factor)),
        Light::Key(key) => Light::Key(KeyLight { radiance: key.radiance * factor, ..*key }),
    }
}

/// A scene of the same name whose lights and shapes all differ.
pub(super) fn changed(scene: &Scene) -> Scene {
    let relit = brighter(scene, Rgb::new(0.5, 1.5, 2.0));
    let objects: Vec<Object> = scene.objects.iter().map(grown).collect();
    let hashes: Vec<String> = objects.iter().map(|object| object.content.to_string()).collect();
    Scene { content: after(relit.content, &hashes.concat()), objects, ..relit }
}

fn grown(object: &Object) -> Object {
    let shape = match &*object.shape {
        Shape::Mesh(mesh) => {
            let positions = mesh.positions.iter().map(|position| 1.25 * *position).collect();
            Shape::Mesh(Mesh { positions, ..mesh.clone() })
        }
        Shape::Spheres(spheres) => {
            Shape::Spheres(spheres.iter().map(|s| Sphere { radius: 0.75 * s.radius, ..*s }).collect())
        }
        Shape::Heights(field) => Shape::Heights(field.translated(Vec3::Z)),
    };
    Object { content: shape.content(), shape: Arc::new(shape), ..object.clone() }
}

fn after(content: Content, what: &str) -> Content {
    Content::of_parts([content.to_string().as_bytes(), what.as_bytes()])
}

/// The frame with some of its receivers, in the given order.
pub(super) fn with_receivers(frame: &Frame, order: &[usize]) -> Frame {
    let all = &*frame.receivers;
    fn pick<T: Clone>(values: &[T], order: &[usize]) -> Vec<T> {
        order.iter().map(|i| values[*i].clone()).collect()
    }
    let receivers = Receivers {
        layout: Layout::List,
        position: pick(&all.position, order),
        geometric_normal: pick(&all.geometric_normal, order),
        normal: pick(&all.normal, order),
        albedo: pick(&all.albedo, order),
        valid: pick(&all.valid, order),
        place: pick(&all.place, order),
        revision: successor(all.revision, &format!("{order:?}")),
    };
    Frame { receivers: Arc::new(receivers), ..frame.clone() }
}

/// The frame with every `step`-th receiver invalid, from the first on.
pub(super) fn with_holes(frame: &Frame, step: usize) -> Frame {
    let mut receivers = (*frame.receivers).clone();
    for i in (0..receivers.len()).step_by(step) {
        receivers.position[i] = Vec3::ZERO;
        receivers.geometric_normal[i] = Vec3::ZERO;
        receivers.normal[i] = Vec3::ZERO;
        receivers.albedo[i] = Rgb::ZERO;
        receivers.valid[i] = false;
    }
    receivers.revision = successor(receivers.revision, &format!("holes {step}"));
    Frame { receivers: Arc::new(receivers), ..frame.clone() }
}

/// The frame with white receivers.
pub(super) fn of_unit_albedo(frame: &Frame) -> Frame {
    let mut receivers = (*frame.receivers).clone();
    receivers.albedo.fill(Rgb::ONE);
    receivers.revision = successor(receivers.revision, "unit albedo");
    Frame { receivers: Arc::new(receivers), ..frame.clone() }
}

fn successor(revision: Revision, what: &str) -> Revision {
    Content::of_parts([&revision.0.to_le_bytes()[..], what.as_bytes()]).revision()
}
