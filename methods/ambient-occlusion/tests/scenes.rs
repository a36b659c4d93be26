//! The method on whole scenes: closed forms, and what it says that it supports.

use std::path::Path;

use halflight_ambient_occlusion::Elements;
use halflight_contract::{Backend, Cache, Job, Method, NoMeter, Output, ParamSpec, Params, Quantity, Request, Support};
use halflight_scenes::{Rgb, Scene, SceneFacts};

/// A white receiver at the origin that looks up, beneath objects.
fn scene(objects: &str, lights: &str) -> Scene {
    let text = format!(
        "purpose = 'test'\n[receivers]\ngrid = {{ center = [0, 0, 0], size = [1e-3, 1e-3], resolution = [1, 1] }}\n{objects}\n{lights}\n"
    );
    Scene::parse(Path::new("test.toml"), &text).expect("a scene")
}

fn radiance(scene: &Scene, settings: &[(&str, &str)]) -> Rgb {
    radiance_at(scene, 0, settings)
}

fn radiance_at(scene: &Scene, frame: usize, settings: &[(&str, &str)]) -> Rgb {
    let params = Params::resolve(Elements.info().params, settings.iter().copied()).expect("in range");
    let cache = Cache::in_memory();
    let job = Job::new(scene, &params, 0, Backend::Cpu, &cache);
    let mut prepared = Elements.prepare(&job, &mut NoMeter).expect("prepared");
    let frame = scene.frame(frame);
    prepared.update(&frame, &mut NoMeter).expect("updated");
    prepared.evaluate(&frame, Quantity::Direct, &mut NoMeter).expect("evaluated");
    let mut out = [Rgb::ZERO];
    prepared.read(Output::Radiance(&mut out), &mut NoMeter).expect("read");
    out[0]
}

const SKY: &str = "[[lights]]\nsky = { uniform = [1, 2, 3] }";

fn ball(radius: f64) -> String {
    format!("[[objects]]\nname = 'ball'\nsphere = {{ center = [0, 0, 2], radius = {radius} }}\nalbedo = [1, 1, 1]")
}

/// The back of a ball that is wholly above 15° hides its solid angle over 2π, `1 − cos θ`, whatever its distance.
#[test]
fn a_ball_overhead_leaves_the_cosine_of_its_angular_radius() {
    for radius in [0.02, 0.5, 1.0, 1.7] {
        let left = (1.0 - (radius / 2.0f64).powi(2)).sqrt();
        let open = Rgb::new(1.0, 2.0, 3.0);
        for settings in [[("opening", "0"), ("passes", "1")], [("opening", "0.25"), ("passes", "2")]] {
            let found = radiance(&scene(&ball(radius), SKY), &settings) / open;
            let [red, green, blue] = found.to_array().map(f64::from);
            assert!((red - left).abs() < 0.015, "radius {radius}: {red} for {left}");
            assert!((green - red).abs() < 1e-5 && (blue - red).abs() < 1e-5, "all colours alike: {found}");
        }
    }
}

/// Elements of a ball inside another are in the dark: they cast in the first pass alone.
#[test]
fn a_second_pass_takes_back_what_cast_from_the_dark() {
    let inner = ball(0.5).replace("'ball'", "'inner'");
    let [alone, both] = [ball(1.0), ball(1.0) + "\n" + &inner].map(|objects| scene(&objects, SKY));
    let [first, second] = ["1", "2"].map(|passes| radiance(&both, &[("passes", passes)]).x);
    let alone = radiance(&alone, &[]).x;
    assert!(first < alone - 0.02 && (second - alone).abs() < 0.01, "{first}, {second}, alone {alone}");
}

#[test]
fn elements_go_where_their_object_goes() {
    let moving = ball(1.0) + "\nmotion = [{ time = 0, translate = [0, 0, 0] }, { time = 1, translate = [0, 0, 2] }]";
    let scene = scene(&moving, &format!("{SKY}\n[frames]\ncount = 2\nfps = 1"));
    for (frame, distance) in [(0, 2.0f32), (1, 4.0)] {
        let left = (1.0 - distance.powi(-2)).sqrt();
        let found = radiance_at(&scene, frame, &[]).x;
        assert!((found - left).abs() < 0.01, "frame {frame}: {found} for {left}");
    }
}

/// Shadows have no direction: a ball between receiver and light and one beside it darken alike.
#[test]
fn a_shadow_is_the_same_wherever_the_light_comes_from() {
    let key =
        |x: f32| format!("[[lights]]\nkey = {{ direction = [{x}, 0, 1], angular_radius = 10, radiance = [1, 1, 1] }}");
    let aside = "[[objects]]\nname = 'ball'\nsphere = { center = [1, 0, 1], radius = 0.5 }\nalbedo = [1, 1, 1]";
    let [towards, away] = [1.0, -1.0].map(|x| {
        let [open, shadowed] =
            ["\ncasts = false", ""].map(|casts| radiance(&scene(&(aside.to_owned() + casts), &key(x)), &[]));
        shadowed.y / open.y
    });
    assert!(towards < 0.97 && (towards - away).abs() < 1e-4, "{towards} and {away}");
}

#[test]
fn height_fields_are_taken_and_what_emits_is_left_out_by_name() {
    let specs: &'static [ParamSpec] = Elements.info().params;
    let answer = |facts: SceneFacts, quantity| {
        let params = Params::defaults(specs);
        Elements.supports(&facts, &Request { quantity, backend: Backend::Cpu, params: &params })
    };
    let facts = SceneFacts { height_fields: 1, skies: 1, ..SceneFacts::default() };
    assert_eq!(answer(facts.clone(), Quantity::Direct), Support::Exact);
    let lamps = SceneFacts { emitters: 2, lamps: 1, ..facts.clone() };
    assert!(matches!(answer(lamps.clone(), Quantity::Direct), Support::Approximate(why) if why.contains("2 objects")));
    let alone = SceneFacts { skies: 0, ..lamps };
    assert!(matches!(answer(alone, Quantity::Direct), Support::Skip(why) if why.contains("none from afar")));
    for quantity in [Quantity::Visibility { order: 1 }, Quantity::Total, Quantity::Indirect { bounces: 1 }] {
        assert!(matches!(answer(facts.clone(), quantity), Support::Skip(_)));
    }
}
