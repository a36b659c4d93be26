//! A device that is lost while times are taken leaves every picture; alone in this program on the first adapter's shared device.
#![cfg(feature = "gpu")]

use crate::bench::Bench;
use halflight::{Group, Options, Plan, Selection, State, Terms, Where, processor};
use halflight_contract::{
    Backend, Error, Footprint, Info, Job, Meter, Method, Output, Params, Prepared, Quantity, Request, Result, Support,
};
use halflight_gpu::Gpu;
use halflight_results::{Cell, Record, Store};
use halflight_scenes::{Frame, SceneFacts};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A method that loses the device before an evaluation of this number, from 1, then goes on as the real one does.
struct Unlucky {
    real: &'static dyn Method,
    at: usize,
    evaluations: Arc<AtomicUsize>,
}

impl Method for Unlucky {
    fn info(&self) -> &'static Info {
        self.real.info()
    }
    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        self.real.supports(facts, request)
    }
    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        Ok(Box::new(Ready { real: self.real.prepare(job, meter)?, at: self.at, evaluations: self.evaluations.clone() }))
    }
}

struct Ready<'s> {
    real: Box<dyn Prepared + 's>,
    at: usize,
    evaluations: Arc<AtomicUsize>,
}

impl Prepared for Ready<'_> {
    fn footprint(&self) -> Footprint {
        self.real.footprint()
    }
    fn retune(&mut self, params: &Params) -> Result<()> {
        self.real.retune(params)
    }
    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        self.real.update(frame, meter)
    }
    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        if self.evaluations.fetch_add(1, Ordering::Relaxed) + 1 == self.at {
            Gpu::shared(Backend::GPU).map_err(|error| Error::Device(error.to_string()))?.give_up();
        }
        self.real.evaluate(frame, quantity, meter)
    }
    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()> {
        self.real.read(out, meter)
    }
}

/// Three cells by one method on both backends, the second of them unlucky at this evaluation; all are timed.
fn plan(bench: &Bench, at: usize) -> Plan {
    let selection = Selection {
        scenes: vec![bench.path("tiny.toml").display().to_string()],
        methods: vec!["sh-product/ordered".into()],
        set: vec!["order=2".parse().unwrap(), "self-shadow=off,paper,continuous".parse().unwrap()],
        references: vec!["sphere-proxies".into()],
        ..Default::default()
    };
    let terms = Terms { seed: 1, timed_on: "a test".into() };
    let plan = Plan::new(&selection.entries().unwrap(), &terms).unwrap();
    let mut plan = plan.on_backends(Where::Both, &processor(None).unwrap());
    // Where times mean nothing they serve the test all the same.
    let gpus: Vec<&mut Group> = plan.groups.iter_mut().filter(|group| group.backend != Backend::Cpu).collect();
    for (place, group) in gpus.into_iter().enumerate() {
        let timed = |cell: &Cell| Cell { timed_on: Some("a test".into()), ..cell.clone() };
        group.cells = group.cells.iter().map(timed).collect();
        if place == 1 {
            group.method = Box::leak(Box::new(Unlucky { real: group.method, at, evaluations: Arc::default() }));
        }
    }
    plan
}

/// Which cells of the graphics processor have a picture that can be read.
fn pictures(store: &Store) -> Vec<bool> {
    let gpu = store.outcomes().filter(|record| record.cell().is_some_and(Cell::is_gpu));
    let whole = |record: &Record| match record {
        Record::Run(run) => store.read_picture(run.image.as_ref().unwrap()).is_ok(),
        _ => false,
    };
    gpu.map(whole).collect()
}

#[test]
fn a_device_lost_while_it_is_timed_leaves_every_picture() {
    let bench = Bench::new();
    // The first evaluation is for the picture, the second to warm up; by the third all are held ready.
    let plan = plan(&bench, 3);
    let options = Options { show_progress: false, ..Options::new(bench.path("cache")) };
    let mut store = Store::open(bench.path("out")).unwrap();
    let summary = halflight::run(&plan, &mut store, &options).unwrap();
    assert_eq!((summary.ran, summary.timed, summary.failed, summary.scored), (6, 3, 3, 6));
    assert_eq!(pictures(&store), [true; 3]);
    let states: Vec<_> = plan.cells().map(|(group, cell)| group.state(cell, &store)).collect();
    assert_eq!(states.iter().filter(|state| **state == State::Time).count(), 3, "{states:?}");

    let summary = halflight::run(&plan, &mut store, &options).unwrap();
    assert_eq!((summary.ran, summary.timed, summary.failed), (0, 3, 0));
}
