//! Horizon wedges: a thread a receiver, its horizons one an azimuth.

use std::collections::BTreeMap;
use std::f32::consts::{PI, TAU};
use std::f64::consts::PI as PI_64;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use glam::Vec3;
use halflight_contract::{
    Backend, Cache, Flow, Job, Meter, Method, NoMeter, Params, Prepared, Quantity, Request, Support,
};
use halflight_scenes::{Environment, Frame, HeightField, Light, Placement, Scene, Shape, Sky};
use halflight_sh::evaluate;
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

use crate::{ROUNDING, on, with_order};

/// Wedge tables take longest.
static CACHE: LazyLock<Arc<Cache>> = LazyLock::new(Arc::default);

/// The members of the family with a GPU backend.
fn methods() -> Vec<&'static dyn Method> {
    crate::methods().filter(|method| method.info().family() == "horizon-wedges").collect()
}

fn method(id: &str) -> &'static dyn Method {
    methods().into_iter().find(|method| method.info().id == id).expect("is registered")
}

fn case<'a>(method: &'a dyn Method, scene: &'a Scene, quantity: Quantity) -> Case<'a> {
    Case { cache: CACHE.clone(), ..Case::new(method, scene, quantity) }
}

fn tuned<'a>(method: &'a dyn Method, scene: &'a Scene, settings: &[(&str, &str)]) -> Case<'a> {
    let params = Params::resolve(method.info().params, settings.iter().copied()).expect("in range");
    case(method, scene, Quantity::Direct).tuned(params)
}

fn shipped(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/data").join(name);
    Scene::load(&path).expect("a scene")
}

/// A white field under a sky, with receivers on its vertices.
fn white(field: &str, sky: &str) -> Scene {
    let text = format!(
        "purpose = 'test'\n[receivers]\nheights = {{ object = 'field' }}\n[[objects]]\nname = 'field'\nalbedo = [1, 1, 1]\n\
         [objects.heights]\n{field}\n[[lights]]\nsky = {{ {sky} = [1, 1, 1] }}\n"
    );
    Scene::parse(Path::new("test.toml"), &text).expect("a scene")
}

fn field(scene: &Scene) -> &HeightField {
    match &*scene.objects[0].shape {
        Shape::Heights(field) => field,
        _ => panic!("a height field"),
    }
}

/// How far two backends may be apart in an elevation: as `methods/horizons/tests/gpu.rs` derives it, and 3 roundings of a place in the
/// tables, which lies within a right angle.
fn elevation(field: &HeightField) -> f32 {
    let [columns, rows] = [field.columns(), field.rows()];
    let highest = field.heights().iter().fold(0.0, |highest: f32, height| highest.max(height.abs()));
    let nearest = field.cell().min_element();
    let heights = 4.0 * (2.0 * 2.0 * (2.0 * 6.0 + 40.0f32)).sqrt() * ROUNDING * highest / nearest;
    let steps = (0..columns * rows).flat_map(|vertex| {
        let (i, j) = (vertex % columns, vertex / columns);
        let here = field.height(i, j);
        [field.height((i + 1).min(columns - 1), j), field.height(i, (j + 1).min(rows - 1))]
            .map(|next| (next - here).abs())
    });
    let steepest = steps.fold(0.0, f32::max) / nearest;
    let places = (2 * columns.min(256) + 4 * columns.max(rows)) as f32 * ROUNDING;
    heights + 2.0 * places * steepest + 4.0 * 5.0 * ROUNDING * PI / 2.0
}

/// How far they may be apart in the vector of a visibility: an elevation off by δ opens or closes δ·cos ω times the step of azimuth of
/// basis functions whose vector is `n/√4π` long, at each azimuth by itself; a sum of as many wedges rounds 8 times for each.
fn visibility(order: f32, azimuths: f32, elevation: f32) -> f32 {
    let opened = TAU / azimuths.sqrt() * order / (4.0 * PI).sqrt() * elevation;
    opened + 4.0 * (2.0 * 8.0 * azimuths).sqrt() * ROUNDING * (4.0 * PI).sqrt()
}

/// How far they may be apart in radiance: the vector of light times what multiplication by a cosine over π, at most 0.4 where its bands end,
/// makes of that; a product and a sum round 4n + n² times.
fn radiance(order: f32, light: f32, visibility: f32) -> f32 {
    let rounded = 4.0 * (2.0 * (4.0 * order + order * order)).sqrt() * ROUNDING * (4.0 * PI).sqrt();
    light * 0.4 * (visibility + rounded)
}

/// The length of the vector of a frame's light, or more: key lights are scaled to what passes their swaths by less than 3.
fn light(frame: &Frame, order: u8) -> f32 {
    let of = |light: &Light| match light {
        Light::Key(key) => {
            let solid_angle = PI * key.angular_radius.sin().powi(2);
            3.0 * key.radiance.max_element() * solid_angle * f32::from(order) / (4.0 * PI).sqrt()
        }
        Light::Environment(map) => length(map, order),
        Light::Sky(Sky::Overcast(zenith) | Sky::Uniform(zenith)) => zenith.max_element() * (4.0 * PI).sqrt(),
    };
    frame.lights().map(of).sum()
}

/// The length of the vector of a map, each texel as bright as its brightest colour.
fn length(map: &Environment, order: u8) -> f32 {
    let order = usize::from(order);
    let (mut sum, mut basis) = (vec![0.0; order * order], vec![0.0; order * order]);
    for (number, texel) in map.texels.iter().enumerate() {
        let size = [map.width, map.height].map(|count| count as f64);
        let [polar, azimuth] = [number / map.width, number % map.width].map(|at| at as f64 + 0.5);
        let ((sin, cos), (y, x)) = ((polar * PI_64 / size[1]).sin_cos(), (azimuth * 2.0 * PI_64 / size[0]).sin_cos());
        evaluate(order, [sin * x, sin * y, cos], &mut basis);
        let area = sin * 2.0 * PI_64 * PI_64 / (size[0] * size[1]);
        let bright = f64::from(texel.max_element()) * area;
        sum.iter_mut().zip(&basis).for_each(|(sum, y)| *sum += bright * y);
    }
    sum.iter().map(|value| value * value).sum::<f64>().sqrt() as f32
}

/// Azimuths of a key light's swath.
const FEWEST: f32 = 3.0;

/// The greatest distance between backends, and what is allowed.
fn compared(case: &Case<'_>, azimuths: f32) -> [f32; 2] {
    let [cpu, gpu] = [Backend::Cpu, Backend::GPU].map(|backend| on(backend, case));
    let found = cpu.iter().zip(&gpu).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
    assert!(gpu.iter().all(|value| value.is_finite()) && cpu.iter().any(|value| *value != 0.0));
    let order = case.params.int("order") as u8;
    let seen = visibility(f32::from(order), azimuths, elevation(field(case.scene)));
    let allowed = match case.quantity {
        Quantity::Direct => radiance(f32::from(order), light(&case.frames[0], order), seen),
        _ => seen,
    };
    [found, allowed]
}

/// Hills seen from points anywhere above, on and beside the field.
fn anywhere() -> Scene {
    let hills = fixtures::hills();
    let point = |i: usize| {
        let [x, y, z] = [0.618, 0.414, 0.732].map(|share| (i as f32 * share).fract());
        let normal = Vec3::new(x - 0.5, z - 0.5, 0.3 + y).normalize();
        (Vec3::new(5.0 * x - 2.5, 5.0 * y - 2.5, 2.0 * z - 0.5), normal)
    };
    Scene { placement: Placement::Points(Arc::new((0..150).map(point).collect())), ..hills }
}

#[test]
fn both_backends_agree_to_rounding() {
    let scenes = [fixtures::hills(), shipped("ripples.toml"), anywhere()];
    let mut cases = Vec::new();
    for (scene, method) in scenes.iter().flat_map(|scene| methods().into_iter().map(move |method| (scene, method))) {
        for order in [3, 4] {
            cases.push(case(method, scene, Quantity::Direct).tuned(with_order(method, order)));
        }
    }
    let complete = method("horizon-wedges/complete");
    for order in [2, 5] {
        let quantity = Quantity::Visibility { order };
        cases.push(case(complete, &scenes[0], quantity).tuned(with_order(complete, order)));
    }
    for case in &cases {
        let (id, name, order) = (case.method.info().id, &case.scene.name, case.params.int("order"));
        let [found, allowed] = compared(case, FEWEST);
        println!("{id} on {name}, {}, order {order}: {found:.1e} apart, {allowed:.1e} allowed", case.quantity);
        assert!(found <= allowed, "{id} on {name}, {}, order {order}: {found:e} > {allowed:e}", case.quantity);
    }
}

#[test]
#[ignore = "minutes in software"]
fn fields_of_the_papers_sizes_are_the_same_on_both() {
    let partial = method("horizon-wedges/partial");
    for name in ["fractal-256.toml", "fractal-512.toml", "fractal-1024.toml"] {
        let scene = shipped(name);
        let [found, allowed] = compared(&case(partial, &scene, Quantity::Direct), FEWEST);
        println!("{name}: {found:.1e} apart, {allowed:.1e} allowed");
        assert!(found <= allowed, "{name}: {found:e} > {allowed:e}");
    }
}

/// What a method uploads, and what it counts beside.
#[derive(Debug, Default)]
struct Counted(BTreeMap<&'static str, u64>);

impl Meter for Counted {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        *self.0.entry(counter).or_default() += amount;
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

impl Counted {
    fn uploaded(&self) -> u64 {
        self.0.get("bytes uploaded").copied().unwrap_or(0)
    }
}

fn ready<'s>(method: &dyn Method, scene: &'s Scene, backend: Backend) -> Box<dyn Prepared + 's> {
    let params = with_order(method, 2);
    method.prepare(&Job::new(scene, &params, 1, backend, &CACHE), &mut NoMeter).expect("is supported")
}

fn updated(prepared: &mut dyn Prepared, frame: &Frame) -> Counted {
    let mut counted = Counted::default();
    prepared.update(frame, &mut counted).expect("updates");
    counted
}

fn evaluated(prepared: &mut dyn Prepared, frame: &Frame) -> Counted {
    let mut counted = Counted::default();
    prepared.evaluate(frame, Quantity::Direct, &mut counted).expect("shades");
    counted
}

#[test]
fn both_backends_count_the_same_work() {
    let scene = fixtures::hills();
    for method in methods() {
        let [cpu, mut gpu] = [Backend::Cpu, Backend::GPU].map(|backend| {
            let mut prepared = ready(method, &scene, backend);
            updated(&mut *prepared, &scene.frame(0));
            evaluated(&mut *prepared, &scene.frame(0)).0
        });
        gpu.retain(|counter, _| !counter.starts_with("bytes"));
        assert_eq!(cpu, gpu, "{}", method.info().id);
        assert!(cpu["height samples"] > 0);
    }
}

/// Of a sea that runs the heights and the receivers' normals and albedos are new, each time, and no more; of what rests nothing is.
#[test]
fn frames_upload_what_is_new() {
    let scene = shipped("ripples.toml");
    let vertices = 64 * 48;
    for method in methods() {
        let mut prepared = ready(method, &scene, Backend::GPU);
        let first = updated(&mut *prepared, &scene.frame(0));
        assert!(first.uploaded() > vertices * (4 + 16 + 32) && first.0["levels made"] > 0);
        let shaded = evaluated(&mut *prepared, &scene.frame(0));
        // Settings, a window and the light of each view.
        let views = if method.info().id.ends_with("partial") { 2 } else { 1 };
        assert_eq!(shaded.uploaded(), views * 4 * (4 + 4 + 3 * 4), "{}", method.info().id);
        assert_eq!(updated(&mut *prepared, &scene.frame(0)).uploaded(), 0, "an unchanged frame");
        let second = updated(&mut *prepared, &scene.frame(1));
        assert_eq!(second.uploaded(), vertices * (4 + 32), "{}", method.info().id);
        assert!(second.0["levels made"] > 0 && !second.0.contains_key("azimuths aimed"));
    }
}

/// Under a white sky a level field is white, at every number of azimuths.
#[test]
fn a_flat_field_is_a_furnace() {
    let scene = white("resolution = [9, 7]\ncell = [1, 2]\nramp = { slope = 0 }", "uniform");
    for (method, azimuths) in methods().into_iter().flat_map(|method| ["4", "7", "16"].map(|count| (method, count))) {
        let case = tuned(method, &scene, &[("order", "2"), ("azimuths", azimuths)]);
        let apart = on(Backend::GPU, &case).iter().map(|value| (value - 1.0).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-5, "{}, {azimuths} azimuths: {apart:e}", method.info().id);
    }
}

/// A slope of angle α that goes on sees `(1 + cos α)/2` of a white sky above the horizontal plane.
#[test]
fn a_slope_without_end_sees_what_its_angle_leaves() {
    let scene = white("resolution = [33, 33]\ncell = [1, 1]\nramp = { slope = 35 }", "uniform");
    let rise = field(&scene).height(32, 16) - field(&scene).height(31, 16);
    let expected = 0.5 * (1.0 + 1.0 / rise.hypot(1.0));
    assert!((0.6..0.95).contains(&expected), "{expected}");
    let case = tuned(method("horizon-wedges/complete"), &scene, &[("order", "4"), ("border", "extend")]);
    let found = on(Backend::GPU, &case)[3 * (16 * 33 + 16)];
    assert!((found - expected).abs() < 0.02, "{found} for {expected}");
}

/// The floor of a trench without end, of walls of 45° and no width, sees `cos 45°` of a white sky, where nothing smooths it. Between azimuths
/// the horizon is linear, which lets more light in; the truncation of order 4 takes some away.
#[test]
fn the_bottom_of_a_long_trench_gets_the_cosine_of_its_walls() {
    let trench = "resolution = [129, 17]\ncell = [0.5, 0.5]\ntrench = { width = 0, depth = 30, wall = 45 }";
    let scene = white(trench, "uniform");
    let settings = [("order", "4"), ("border", "extend"), ("scale", "linear"), ("plane", "bilinear")];
    let case = tuned(method("horizon-wedges/complete"), &scene, &settings);
    let found = on(Backend::GPU, &case)[3 * (8 * 129 + 64)];
    assert!((0.709..0.716).contains(&found), "{found}");
}

#[test]
fn odd_fields_are_shaded_as_on_the_cpu() {
    let fields = [
        "resolution = [2, 2]\ncell = [1, 1]\nramp = { slope = 30 }",
        "resolution = [2, 37]\ncell = [1, 0.3]\nfractal = { seed = 3, amplitude = 2, wavelength = 9, octaves = 3 }",
        "resolution = [30, 3]\ncell = [0.1, 2]\nfractal = { seed = 5, amplitude = 1, wavelength = 9, octaves = 3 }",
    ];
    for (text, method) in fields.iter().flat_map(|text| methods().into_iter().map(move |method| (text, method))) {
        let scene = white(text, "overcast");
        let [found, allowed] = compared(&tuned(method, &scene, &[("order", "2")]), FEWEST);
        assert!(found <= allowed, "{}, {text}: {found:e} > {allowed:e}", method.info().id);
    }
}

#[test]
fn what_the_gpu_does_not_do_is_skipped_with_a_reason() {
    let scene = fixtures::hills();
    let family = halflight_registry::methods().into_iter().filter(|method| method.info().family() == "horizon-wedges");
    for method in family {
        let settings: &[_] = if method.info().runs_on(Backend::GPU) { &[("storage", "decimated")] } else { &[] };
        let params = Params::resolve(method.info().params, settings.iter().copied()).expect("in range");
        let request = Request { quantity: Quantity::Direct, backend: Backend::GPU, params: &params };
        let answer = method.supports(&scene.facts(), &request);
        let Support::Skip(why) = answer else { panic!("{}: {answer:?}", method.info().id) };
        assert!(why.contains("GPU"), "{why}");
    }
}
