//! A graphics processor that goes away in the middle of a run.

use crate::bench::{Bench, of_kind};
use halflight::{Options, Plan, Processor, Selection, State, Terms, Where};
use halflight_contract::{
    Backend, Footprint, Info, Job, Meter, Method, Output, Params, Prepared, Quantity, Request, Result, Support,
};
use halflight_gpu::Gpu;
use halflight_results::Store;
use halflight_scenes::{Frame, SceneFacts};

/// The device under a number of its own, which nobody else uses.
const DEVICE: Backend = Backend::Gpu(77);

/// A method under whose hands the device is lost.
struct Unlucky(&'static dyn Method);

impl Method for Unlucky {
    fn info(&self) -> &'static Info {
        self.0.info()
    }
    fn supports(&self, facts: &SceneFacts, request: &Request<'_>) -> Support {
        self.0.supports(facts, request)
    }
    fn prepare<'s>(&self, job: &Job<'s, '_>, meter: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        Ok(Box::new(Ready(self.0.prepare(job, meter)?)))
    }
}

struct Ready<'s>(Box<dyn Prepared + 's>);

impl Prepared for Ready<'_> {
    fn footprint(&self) -> Footprint {
        self.0.footprint()
    }
    fn retune(&mut self, params: &Params) -> Result<()> {
        self.0.retune(params)
    }
    fn update(&mut self, frame: &Frame, meter: &mut dyn Meter) -> Result<()> {
        self.0.update(frame, meter)
    }
    fn evaluate(&mut self, frame: &Frame, quantity: Quantity, meter: &mut dyn Meter) -> Result<()> {
        Gpu::shared(DEVICE)?.give_up();
        self.0.evaluate(frame, quantity, meter)
    }
    fn read(&mut self, out: Output<'_>, meter: &mut dyn Meter) -> Result<()> {
        self.0.read(out, meter)
    }
}

#[test]
fn cells_before_and_after_stay_and_the_one_at_hand_names_the_adapter() {
    let gpu = Gpu::open(0).unwrap().share(DEVICE);
    let bench = Bench::new();
    let selection = Selection {
        scenes: vec![bench.path("tiny.toml").display().to_string()],
        methods: ["sh-product/ordered", "shexp/ol", "ambient-occlusion/elements"].map(String::from).to_vec(),
        set: vec!["order=2".parse().unwrap()],
        references: vec!["sphere-proxies".into()],
        ..Default::default()
    };
    let terms = Terms { seed: 1, timed_on: "a test".into() };
    let processor = Processor {
        backend: DEVICE,
        name: format!("gpu: {}", gpu.adapter()),
        timed_on: None,
        device: gpu.adapter().name.clone(),
        about: String::new(),
    };
    let plan = Plan::new(&selection.entries().unwrap(), &terms).unwrap();
    let mut plan = plan.on_backends(Where::Gpu, &Ok(processor));
    plan.groups[1].method = Box::leak(Box::new(Unlucky(plan.groups[1].method)));

    let options = Options { show_progress: false, ..Options::new(bench.path("cache")) };
    let mut store = Store::open(bench.path("out")).unwrap();
    let summary = halflight::run(&plan, &mut store, &options).unwrap();
    assert_eq!((summary.ran, summary.failed), (2, 1));
    let lines = bench.lines("out");
    let failures = of_kind(&lines, "failure");
    let error = failures[0]["error"].as_str().unwrap();
    assert!(error.contains(&gpu.adapter().name) && error.contains("the device was lost"), "{error}");
    let states: Vec<_> = plan.cells().map(|(group, cell)| group.state(cell, &store)).collect();
    assert_eq!(states, [State::Cached, State::Run, State::Cached]);
}
