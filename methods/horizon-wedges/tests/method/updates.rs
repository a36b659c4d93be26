//! What `update` makes again, and what it leaves.

use std::collections::BTreeMap;
use std::sync::Arc;

use halflight_contract::{Backend, Flow, Job, Meter, Method, NoMeter, Output, Params, Prepared, Quantity};
use halflight_horizon_wedges::{COMPLETE, MARCH, PARTIAL, SWEEP, Variant};
use halflight_scenes::{Frame, HeightField, Revision, Rgb, Scene, Shape};

use crate::common::{CACHE, WHITE, scene};

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

const LEVELS: &str = "levels made";
const AZIMUTHS: &str = "azimuths aimed";
const WEDGES: &str = "wedges aimed";
const TABLES: &str = "wedge tables made";

/// Hills under a sky and a key light that turns.
fn turning() -> Scene {
    let light = "[[lights]]\nkey = { direction = [1, 0.2, 0.5], angular_radius = 4, radiance = [9, 9, 9] }\n\
                 turn = { degrees_a_second = 45 }\n[frames]\ncount = 4\n";
    let hills =
        "resolution = [40, 30]\ncell = [1, 1]\nfractal = { seed = 3, amplitude = 6, wavelength = 20, octaves = 3 }";
    scene(hills, &format!("{WHITE}{light}"))
}

fn ready<'s>(method: &Variant, scene: &'s Scene) -> Box<dyn Prepared + 's> {
    let params = Params::defaults(method.info().params);
    let job = Job::new(scene, &params, 1, Backend::Cpu, &CACHE);
    method.prepare(&job, &mut NoMeter).expect("prepares")
}

/// The frame with heights by a function of the old ones and their row.
fn risen(frame: &Frame, height: impl Fn(usize, f32) -> f32) -> Frame {
    let mut frame = frame.clone();
    let posed = &mut frame.objects[0];
    if let Shape::Heights(field) = &*posed.shape {
        let (size, heights) = ([field.columns(), field.rows()], field.heights().iter().enumerate());
        let heights = heights.map(|(vertex, old)| height(vertex / size[0], *old)).collect();
        posed.shape = Arc::new(Shape::Heights(HeightField::new(size, field.origin(), field.cell(), heights)));
        posed.revision = Revision(posed.revision.0 ^ 1);
    }
    frame
}

fn updated(prepared: &mut dyn Prepared, frame: &Frame) -> BTreeMap<&'static str, u64> {
    let mut counters = Counters::default();
    prepared.update(frame, &mut counters).expect("updates");
    counters.0
}

fn lit(prepared: &mut dyn Prepared, frame: &Frame) -> Vec<Rgb> {
    prepared.evaluate(frame, Quantity::Direct, &mut NoMeter).expect("evaluates");
    let mut out = vec![Rgb::NAN; frame.receivers.len()];
    prepared.read(Output::Radiance(&mut out), &mut NoMeter).expect("reads");
    out
}

#[test]
fn what_rests_is_not_made_again() {
    let scene = turning();
    let first = scene.frame(0);
    for method in [COMPLETE, PARTIAL, MARCH, SWEEP] {
        let mut prepared = ready(&method, &scene);
        let made = updated(&mut *prepared, &first);
        assert!(made[AZIMUTHS] >= 16 && made[WEDGES] >= 16 && !made.contains_key(TABLES), "{made:?}");
        assert_eq!(updated(&mut *prepared, &first), BTreeMap::new(), "{}", method.info().id);
    }
}

#[test]
fn a_light_that_turns_leaves_the_pyramid() {
    let scene = turning();
    // The complete swath turns for no light.
    for (method, azimuths) in [(COMPLETE, None), (PARTIAL, Some(19)), (MARCH, Some(19)), (SWEEP, Some(3))] {
        let mut prepared = ready(&method, &scene);
        updated(&mut *prepared, &scene.frame(0));
        let made = updated(&mut *prepared, &scene.frame(1));
        assert!(made[WEDGES] >= 16 && !made.contains_key(LEVELS) && !made.contains_key(TABLES), "{made:?}");
        assert_eq!(made.get(AZIMUTHS).copied(), azimuths, "{}", method.info().id);
    }
}

#[test]
fn a_field_that_moves_is_all_that_is_made_again() {
    let scene = turning();
    let first = scene.frame(0);
    for (method, made) in
        [(COMPLETE, (LEVELS, 23)), (PARTIAL, (LEVELS, 23)), (MARCH, (LEVELS, 1)), (SWEEP, (AZIMUTHS, 19))]
    {
        let mut prepared = ready(&method, &scene);
        updated(&mut *prepared, &first);
        let moved = risen(&first, |_, height| 1.1 * height);
        assert_eq!(updated(&mut *prepared, &moved), BTreeMap::from([made]), "{}", method.info().id);
    }
}

/// Frames one after another are those that each would be alone.
#[test]
fn what_is_left_is_what_would_be_made() {
    let scene = turning();
    let (first, second) = (scene.frame(0), scene.frame(1));
    let part = |row: usize, height: f32| if (11..14).contains(&row) { height + 2.0 } else { height };
    let frames = [risen(&first, part), first, risen(&second, part), second];
    for method in [COMPLETE, PARTIAL, MARCH, SWEEP] {
        let mut running = ready(&method, &scene);
        for frame in &frames {
            updated(&mut *running, frame);
            let mut anew = ready(&method, &scene);
            updated(&mut *anew, frame);
            assert_eq!(lit(&mut *running, frame), lit(&mut *anew, frame), "{}", method.info().id);
        }
    }
}
