//! Scenes of one field, and methods on them.

use std::path::Path;
use std::sync::LazyLock;

use halflight_contract::{Backend, Cache, Job, Method, NoMeter, Output, Params, Quantity};
use halflight_horizon_wedges::{AMBIENT, BLOCKERS, COMPLETE, HARD, MARCH, PARTIAL, SWEEP, Variant};
use halflight_scenes::{Frame, HeightField, Rgb, Scene, Shape};

pub(crate) const ALL: [Variant; 7] = [COMPLETE, PARTIAL, MARCH, SWEEP, HARD, AMBIENT, BLOCKERS];
/// Wedge tables take longest.
pub(crate) static CACHE: LazyLock<Cache> = LazyLock::new(Cache::in_memory);

pub(crate) const WHITE: &str = "[[lights]]\nsky = { uniform = [1, 1, 1] }\n";

/// A scene of one white field with receivers on its vertices.
pub(crate) fn scene(field: &str, lights: &str) -> Scene {
    let text = format!(
        "purpose = 'test'\n[receivers]\nheights = {{ object = 'field' }}\n[[objects]]\nname = 'field'\nalbedo = [1, 1, 1]\n\
         [objects.heights]\n{field}\n{lights}"
    );
    Scene::parse(Path::new("test.toml"), &text).expect("a scene")
}

pub(crate) fn field(scene: &Scene) -> &HeightField {
    match &*scene.objects[0].shape {
        Shape::Heights(field) => field,
        _ => panic!("a height field"),
    }
}

/// The scene with other heights on the grid.
pub(crate) fn with_heights(scene: &Scene, height: impl Fn(usize, usize) -> f32) -> Scene {
    let mut scene = scene.clone();
    let old = field(&scene);
    let (columns, rows) = (old.columns(), old.rows());
    let heights = (0..rows * columns).map(|i| height(i % columns, i / columns)).collect();
    let new = HeightField::new([columns, rows], old.origin(), old.cell(), heights);
    scene.objects[0].shape = std::sync::Arc::new(Shape::Heights(new));
    scene.objects[0].content = scene.objects[0].shape.content();
    scene
}

/// Direct light at the first frame, as a picture with +y at the top.
pub(crate) fn shade(method: &Variant, scene: &Scene, settings: &[(&str, &str)]) -> Vec<Rgb> {
    shade_frame(method, scene, &scene.frame(0), settings)
}

pub(crate) fn shade_frame(method: &Variant, scene: &Scene, frame: &Frame, settings: &[(&str, &str)]) -> Vec<Rgb> {
    // Some variants lack some parameters.
    let known = |name: &str| method.info().params.iter().any(|spec| spec.name == name);
    let settings = settings.iter().copied().filter(|(name, _)| known(name));
    let params = Params::resolve(method.info().params, settings).expect("in range");
    let job = Job::new(scene, &params, 1, Backend::Cpu, &CACHE);
    let mut ready = method.prepare(&job, &mut NoMeter).expect("prepares");
    ready.update(frame, &mut NoMeter).expect("updates");
    ready.evaluate(frame, Quantity::Direct, &mut NoMeter).expect("evaluates");
    let mut out = vec![Rgb::NAN; frame.receivers.len()];
    ready.read(Output::Radiance(&mut out), &mut NoMeter).expect("reads");
    out
}

/// Radiance at vertex `(column, row)` of a picture of the field.
pub(crate) fn at(picture: &[Rgb], field: &HeightField, column: usize, row: usize) -> f32 {
    picture[(field.rows() - 1 - row) * field.columns() + column].x
}
