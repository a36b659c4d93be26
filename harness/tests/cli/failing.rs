//! What fails leaves a line, and the rest goes on.

use crate::bench::{Bench, of_kind};
use halflight::{Group, Options, Plan, Selection, State, Terms};
use halflight_contract::{
    Backend, Coupling, Error, Footprint, Info, Job, Meter, Method, Output, Params, Prepared, Quantity, Request, Result,
    Support,
};
use halflight_results::{Cell, Store};
use halflight_scenes::{Frame, Rgb, SceneFacts};

/// A method that goes wrong in one of the ways.
#[derive(Clone, Copy, PartialEq)]
enum Fault {
    None,
    Refuses,
    Panics,
    NotFinite,
}

struct Faulty(Fault, Info);

const fn faulty(fault: Fault, id: &'static str) -> Faulty {
    let info =
        Info { id, about: "", paper: "", backends: &[Backend::Cpu], params: &[], coupling: Coupling::Independent };
    Faulty(fault, info)
}

static METHODS: [Faulty; 4] = [
    faulty(Fault::Refuses, "faulty/refuses"),
    faulty(Fault::Panics, "faulty/panics"),
    faulty(Fault::NotFinite, "faulty/not-finite"),
    faulty(Fault::None, "faulty/none"),
];

impl Method for Faulty {
    fn info(&self) -> &'static Info {
        &METHODS.iter().find(|method| method.0 == self.0).unwrap().1
    }
    fn supports(&self, _: &SceneFacts, _: &Request<'_>) -> Support {
        Support::Approximate("for the test".into())
    }
    fn prepare<'s>(&self, _: &Job<'s, '_>, _: &mut dyn Meter) -> Result<Box<dyn Prepared + 's>> {
        match self.0 {
            Fault::Refuses => Err(Error::Input("no way".into())),
            fault => Ok(Box::new(Ready(fault))),
        }
    }
}

struct Ready(Fault);

impl Prepared for Ready {
    fn footprint(&self) -> Footprint {
        Footprint::default().host("nothing", 7)
    }
    fn retune(&mut self, _: &Params) -> Result<()> {
        Ok(())
    }
    fn update(&mut self, _: &Frame, _: &mut dyn Meter) -> Result<()> {
        Ok(())
    }
    fn evaluate(&mut self, frame: &Frame, _: Quantity, meter: &mut dyn Meter) -> Result<()> {
        meter.count("receivers", frame.receivers.len() as u64);
        let index = if self.0 == Fault::Panics { usize::MAX } else { 0 };
        assert!(index < frame.receivers.len(), "out of reach");
        Ok(())
    }
    fn read(&mut self, out: Output<'_>, _: &mut dyn Meter) -> Result<()> {
        let Output::Radiance(out) = out else { unreachable!() };
        out.fill(Rgb::ONE);
        if self.0 == Fault::NotFinite {
            out[3] = Rgb::NAN;
        }
        Ok(())
    }
}

/// A plan of the four methods on the tiny scene.
fn plan(bench: &Bench) -> Plan {
    let scene = bench.path("tiny.toml").display().to_string();
    let selection = Selection {
        scenes: vec![scene],
        methods: vec!["shexp/hyb".into()],
        references: vec!["truth".into()],
        ..Default::default()
    };
    let terms = Terms { seed: 1, timed_on: "a test".into() };
    let mut plan = Plan::new(&selection.entries().unwrap(), &terms).unwrap();
    let model = plan.groups.remove(0);
    plan.groups.extend(METHODS.iter().map(|method| Group {
        method,
        threads: None,
        params: Params::default(),
        support: Support::Approximate("for the test".into()),
        cells: vec![Cell { method: method.1.id.into(), params: Default::default(), ..model.cells[0].clone() }],
        references: model.references.clone(),
        empty: Vec::new(),
        ..model
    }));
    plan
}

#[test]
fn a_failing_cell_is_a_line_and_the_rest_goes_on() {
    let bench = Bench::new();
    let plan = plan(&bench);
    let options = Options { show_progress: false, ..Options::new(bench.path("cache")) };
    let mut store = Store::open(bench.path("out")).unwrap();
    let summary = halflight::run(&plan, &mut store, &options).unwrap();
    assert_eq!((summary.ran, summary.failed, summary.scored, summary.unjudged), (1, 3, 1, 0));

    let lines = bench.lines("out");
    let errors: Vec<_> = of_kind(&lines, "failure").iter().map(|line| line["error"].as_str().unwrap()).collect();
    assert_eq!(errors[0], "no way");
    assert_eq!(errors[1], "panicked: out of reach");
    assert!(errors[2].starts_with("radiance at receiver 3 is"), "{}", errors[2]);
    let runs = of_kind(&lines, "run");
    assert_eq!(runs[0]["method"], "faulty/none");
    assert_eq!(runs[0]["approximate"], "for the test");
    // Counters are those of one evaluation, however often it was repeated.
    assert_eq!(runs[0]["counters"]["receivers"], 12);
    assert_eq!(runs[0]["footprint"][0]["host_bytes"], 7);

    // Failures are tried again, the finished cell is not.
    let states: Vec<_> = plan.cells().map(|(group, cell)| group.state(cell, &store)).collect();
    assert_eq!(states, [State::Run, State::Run, State::Run, State::Cached]);
    let summary = halflight::run(&plan, &mut store, &options).unwrap();
    assert_eq!((summary.ran, summary.cached, summary.failed, summary.scored), (0, 1, 3, 0));
}
