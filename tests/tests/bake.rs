//! Blockers that never move, baked at receivers that stay where they are: the same light, less work.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Quat, Vec3};
use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, Output, Params, Prepared, Quantity};
use halflight_scenes::{Frame, Light, Placement, Pose, Revision, Rgb, Scene, Sky, Sphere};
use halflight_tests::fixtures;

/// A heap that stays and one that wanders within three frames, over points that stay.
fn scene() -> Scene {
    let wave = |i: usize, phase: f32| (2.4 * i as f32 + phase).sin();
    let heap = |phase: f32| -> Vec<Sphere> {
        let sphere = |i| {
            let center = Vec3::new(wave(i, phase), wave(3 * i, phase + 1.0), 0.4 + 0.3 * wave(5 * i, 2.0));
            fixtures::sphere(center, 0.08 + 0.1 * wave(7 * i, phase).abs())
        };
        (0..14).map(sphere).collect()
    };
    let mut wanderer = fixtures::spheres("wanderer", heap(0.7));
    let there = |x| Pose { translation: Vec3::new(x, 0.3, 0.0), rotation: Quat::IDENTITY };
    wanderer.motion = vec![(0.0, there(-1.0)), (2.0, there(1.0))];
    let objects = vec![fixtures::spheres("still", heap(0.1)), wanderer];
    let points =
        (0..23 * 11).map(|i| (Vec3::new(0.2 * (i % 23) as f32 - 2.2, 0.4 * (i / 23) as f32 - 2.0, 0.0), Vec3::Z));
    let sky = vec![Light::Sky(Sky::Overcast(Rgb::new(1.0, 0.8, 0.6)))];
    Scene { frame_count: 3, ..fixtures::scene("bake", objects, sky, Placement::Points(Arc::new(points.collect()))) }
}

fn methods() -> Vec<&'static dyn Method> {
    let bakes = |method: &&'static dyn Method| method.info().params.iter().any(|param| param.name == "bake");
    let methods: Vec<_> = halflight_registry::methods().into_iter().filter(bakes).collect();
    assert!(methods.len() >= 7, "all sums of logs and the product in order");
    methods
}

/// A method made ready, and what it counted last.
struct Running<'s> {
    prepared: Box<dyn Prepared + 's>,
    counted: BTreeMap<&'static str, u64>,
}

impl<'s> Running<'s> {
    fn new(method: &dyn Method, scene: &'s Scene, settings: &str) -> Self {
        let settings = settings.split(' ').filter_map(|setting| setting.split_once('='));
        let params = Params::resolve(method.info().params, settings).expect("its parameters");
        let cache = Cache::in_memory();
        let job = Job::new(scene, &params, 1, Backend::Cpu, &cache);
        let prepared = method.prepare(&job, &mut Counters::default()).expect("spheres need no preparation");
        Running { prepared, counted: BTreeMap::new() }
    }

    fn radiance(&mut self, frame: &Frame) -> Vec<Rgb> {
        self.counted.clear();
        let mut meter = Counters::default();
        self.prepared.update(frame, &mut meter).expect("a frame");
        self.counted = meter.0;
        self.evaluated(frame)
    }

    fn evaluated(&mut self, frame: &Frame) -> Vec<Rgb> {
        let mut meter = Counters(std::mem::take(&mut self.counted));
        let mut out = vec![Rgb::ZERO; frame.receivers.len()];
        self.prepared.evaluate(frame, Quantity::Direct, &mut meter).expect("direct light");
        self.prepared.read(Output::Radiance(&mut out), &mut meter).expect("as many");
        self.counted = meter.0;
        out
    }

    fn count(&self, name: &str) -> u64 {
        self.counted.get(name).copied().unwrap_or(0)
    }
}

fn worst(a: &[Rgb], b: &[Rgb]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max)
}

/// Every third point elsewhere.
fn moved(frame: &Frame) -> Frame {
    let mut receivers = (*frame.receivers).clone();
    receivers.position.iter_mut().step_by(3).for_each(|position| *position += Vec3::new(0.05, 0.1, 0.02));
    receivers.revision = Revision(receivers.revision.0 ^ 1);
    Frame { receivers: Arc::new(receivers), ..frame.clone() }
}

#[test]
fn baked_is_what_is_gathered_every_frame() {
    let scene = scene();
    let frames: Vec<Frame> = (0..3).map(|index| scene.frame(index)).collect();
    let sequence = [&frames[0], &frames[1], &moved(&frames[2]), &frames[2]];
    for method in methods() {
        for order in 1..=8 {
            let settings = format!("order={order}");
            let [mut baked, mut plain] =
                [" bake=true", ""].map(|bake| Running::new(method, &scene, &(settings.clone() + bake)));
            for (step, frame) in sequence.into_iter().enumerate() {
                let error = worst(&baked.radiance(frame), &plain.radiance(frame));
                assert!(error < 5e-5, "{}, order {order}, frame {step}: {error}", method.info().id);
                let all = frame.receivers.len() as u64;
                let new = [all, 0, all.div_ceil(3), all.div_ceil(3)][step];
                assert_eq!(baked.count("receivers baked"), new, "{}, frame {step}", method.info().id);
                let (kept, gathered) = (baked.count("blockers kept from before"), baked.count("blockers accumulated"));
                assert_eq!(kept + gathered, plain.count("blockers accumulated"), "{}", method.info().id);
                assert!(kept > 0 && gathered > 0 && plain.count("blockers kept from before") == 0);
            }
        }
    }
}

/// What is kept was accumulated under parameters that a sweep may change, whether or not an update follows.
#[test]
fn retuned_is_baked_again() {
    let scene = scene();
    let frame = scene.frame(1);
    for method in methods() {
        let mut changed = 0;
        for setting in ["self-shadow=off", "self-shadow=paper", "min-angle=8", "guard=false", "window-visibility=true"]
        {
            let mut retuned = Running::new(method, &scene, "bake=true");
            let before = retuned.radiance(&frame);
            let settings = ["bake=true", setting].into_iter().filter_map(|setting| setting.split_once('='));
            let params = Params::resolve(method.info().params, settings).expect("its parameters");
            retuned.prepared.retune(&params).expect("no phase before evaluation");
            let after = retuned.evaluated(&frame);
            let fresh = Running::new(method, &scene, &format!("bake=true {setting}")).radiance(&frame);
            assert_eq!(after, fresh, "{} {setting}", method.info().id);
            changed += usize::from(after != before);
        }
        assert!(changed >= 4, "{}", method.info().id);
    }
}

/// A cut goes through what moves alone: what stays is exact.
#[test]
fn cuts_leave_baked_blockers_whole() {
    let scene = scene();
    let frame = scene.frame(1);
    for method in methods().into_iter().filter(|method| method.info().params.iter().any(|param| param.name == "cut")) {
        let exact = Running::new(method, &scene, "").radiance(&frame);
        let [cut, both] = ["cut=60 ratio=false cluster=64", "cut=60 ratio=false cluster=64 bake=true"]
            .map(|settings| worst(&exact, &Running::new(method, &scene, settings).radiance(&frame)));
        assert!(0.0 < both && both < cut, "{}: {both} with what is baked, {cut} without", method.info().id);
    }
}

#[test]
fn what_is_baked_is_in_the_footprint() {
    let scene = scene();
    for method in methods() {
        let bytes = |settings: &str| {
            let mut running = Running::new(method, &scene, settings);
            running.radiance(&scene.frame(0));
            running.prepared.footprint().host_bytes() as usize
        };
        let sums = scene.frame(0).receivers.len() * 16 * size_of::<f32>();
        assert!(bytes("bake=true") >= bytes("") + sums, "{}", method.info().id);
    }
}

/// Keeps what is counted.
#[derive(Default)]
struct Counters(BTreeMap<&'static str, u64>);

impl Meter for Counters {
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
