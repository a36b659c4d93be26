//! CPU and GPU of the same cell on the page.

use glam::Vec3;
use halflight_reports::{Report, build, twins};
use halflight_results::{
    Cell, Environment, Failure, Key, Layout, Phase, Picture, Record, Run, Skip, Storage, Store, Times, Timing,
};

const SOFTWARE: &str = "gpu: pipe, correctness only";
const REAL: &str = "gpu: Real 9000";

struct Results {
    dir: tempfile::TempDir,
    store: Store,
}

fn cell(method: &str, backend: &str) -> Cell {
    Cell {
        scene: "a".into(),
        scene_hash: "a".into(),
        method: method.into(),
        backend: backend.into(),
        ..Cell::default()
    }
}

impl Results {
    fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        let store = Store::open(dir.path()).unwrap();
        Self { dir, store }
    }

    /// A run of a picture of 4 by 3, grey but for what the function changes.
    fn run(&mut self, cell: Cell, change: impl Fn(&mut [Vec3])) -> Key {
        let mut radiance = vec![Vec3::splat(0.5); 12];
        change(&mut radiance);
        let layout = Layout::Image { width: 4, height: 3 };
        let image = self.store.write_picture(&Picture { layout, radiance, valid: vec![true; 12] }).unwrap();
        let key = cell.key();
        let run = Run {
            receivers: 12,
            image: Some(image),
            counters: [("bytes uploaded".to_owned(), 2048), ("bytes downloaded".to_owned(), 3072)].into(),
            footprint: vec![Storage { purpose: "all".into(), host_bytes: 1024, device_bytes: 4096 }],
            environment: Environment { threads: 2, ..Environment::default() },
            cell,
            ..Run::default()
        };
        self.store.append(Record::Run(Box::new(run))).unwrap();
        key
    }

    fn times(&mut self, run: &Key, shade: [f64; 6]) {
        let timing = |phase, nanoseconds: &[f64]| Timing { phase, nanoseconds: nanoseconds.to_vec() };
        let phases = [
            ("shade".to_owned(), timing(Phase::Shade, &shade)),
            ("shade/all/gather (gpu clock)".to_owned(), timing(Phase::Shade, &shade.map(|t| t / 2.0))),
        ];
        let (run, calibration) = (run.clone(), Default::default());
        let times = Times { run, taken: 1, beside: 2, phases: phases.into(), calibration };
        self.store.append(Record::Times(Box::new(times))).unwrap();
    }

    fn page(&self) -> (Report, String) {
        let report = build(&Store::open(self.dir.path()).unwrap(), "t");
        let html = report.html().unwrap();
        (report, html)
    }
}

#[test]
fn a_planted_difference_is_shown_where_it_is() {
    let mut results = Results::new();
    let cpu = results.run(cell("m/x", "cpu"), |_| ());
    let gpu = results.run(cell("m/x", SOFTWARE), |radiance| radiance[6].y += 0.25);
    let (_, html) = results.page();
    // Channel 1 of receiver 6 of 12: √(0.0625/36) = 0.0417 of 0.5.
    for part in ["<td>0.250</td><td>2, 1</td><td>0.0417</td>", "<td>8.33 %</td>", "GPU − CPU", "1 pairs of pictures"]
    {
        assert!(html.contains(part), "{part}");
    }
    let [found] = &twins(&results.store)[..] else { panic!("one pair") };
    assert_eq!((&found.cpu, &found.gpu), (&cpu, &gpu));
    let apart = found.apart.as_ref().unwrap();
    assert_eq!((apart.max, apart.worst), (0.25, Some(6)));
}

#[test]
fn equal_pictures_are_equal_and_have_no_map() {
    let mut results = Results::new();
    results.run(cell("m/x", "cpu"), |_| ());
    results.run(cell("m/x", REAL), |_| ());
    let (_, html) = results.page();
    assert!(html.contains("<td>equal</td>") && !html.contains("GPU − CPU"));
    assert!(twins(&results.store)[0].apart.as_ref().unwrap().is_nothing());
}

#[test]
fn what_is_not_finite_is_flagged() {
    let mut results = Results::new();
    results.run(cell("m/x", "cpu"), |_| ());
    results.run(cell("m/x", REAL), |radiance| (radiance[3].x, radiance[5].z) = (f32::NAN, f32::INFINITY));
    let (_, html) = results.page();
    assert!(html.contains("<td class=\"failed\"><b>2</b></td>"), "the count");
    assert!(html.contains("1 pairs have values that cannot be compared"), "the sentence");
}

#[test]
fn a_cell_without_its_twin_says_so_and_why() {
    let mut results = Results::new();
    for method in ["m/skipped", "m/failed", "m/missing"] {
        results.run(cell(method, "cpu"), |_| ());
    }
    results.run(cell("m/alone", REAL), |_| ());
    let skipped = cell("m/skipped", REAL);
    results.store.append(Record::Skip(Skip { cell: skipped, reason: "no <lamps>".into() })).unwrap();
    let failed = cell("m/failed", REAL);
    results.store.append(Record::Failure(Failure { cell: failed, error: "the device was lost".into() })).unwrap();
    let (_, html) = results.page();
    for part in [
        "GPU skipped: no &lt;lamps&gt;",
        "GPU failed: the device was lost",
        "no twin on the GPU in these results",
        "no twin on the CPU in these results",
        "4 cells have no twin",
    ] {
        assert!(html.contains(part), "{part}");
    }
}

#[test]
fn cells_of_other_work_are_no_twins() {
    let mut results = Results::new();
    results.run(cell("m/x", "cpu"), |_| ());
    results.run(Cell { revision: "another".into(), ..cell("m/x", REAL) }, |_| ());
    assert!(twins(&results.store).is_empty());
    assert!(results.page().1.contains("2 cells have no twin"));
}

#[test]
fn results_of_the_processor_alone_have_no_such_section() {
    let mut results = Results::new();
    results.run(cell("m/x", "cpu"), |_| ());
    let (_, html) = results.page();
    assert!(!html.contains("CPU against GPU") && !html.contains("CPU and GPU side by side"));
}

#[test]
fn a_skip_for_want_of_an_adapter_gives_way_to_what_ran_later() {
    let mut results = Results::new();
    results.run(cell("m/x", "cpu"), |_| ());
    let skip = Skip { cell: cell("m/x", "gpu"), reason: "no graphics adapter was found".into() };
    results.store.append(Record::Skip(skip)).unwrap();
    assert!(results.page().1.contains("GPU skipped: no graphics adapter was found"));
    results.run(cell("m/x", REAL), |_| ());
    assert!(!results.page().1.contains("GPU skipped"));
}

#[test]
fn times_stand_side_by_side_and_ratios_are_of_the_same_rounds() {
    let mut results = Results::new();
    let cpu = results.run(cell("m/x", "cpu"), |_| ());
    let gpu = results.run(cell("m/x", REAL), |_| ());
    results.times(&cpu, [8e6; 6]);
    results.times(&gpu, [1e6, 2e6, 2e6, 2e6, 2e6, 4e6]);
    let (_, html) = results.page();
    for part in [
        "8.00\u{a0}ms<small>8.00\u{a0}ms to 8.00\u{a0}ms",
        "2.00\u{a0}ms<small>1.00\u{a0}ms to 4.00\u{a0}ms",
        "4.00×<small>2.00 to 8.00",
        "1.00 ms <small>gather",
    ] {
        assert!(html.contains(part), "{part}");
    }
    assert!(html.contains("1.00 KiB<small>4.00 KiB on device") && html.contains("<td>2.00 KiB</td><td>3.00 KiB</td>"));
}

#[test]
fn no_time_of_an_adapter_in_software_stands_anywhere() {
    let mut results = Results::new();
    let cpu = results.run(cell("m/x", "cpu"), |_| ());
    let gpu = results.run(cell("m/x", SOFTWARE), |_| ());
    results.times(&cpu, [8e6; 6]);
    // Nothing writes such a line; who does is not believed.
    results.times(&gpu, [1.25e6; 6]);
    let (report, html) = results.page();
    assert!(report.scenes[0].rows.iter().all(|row| row.times.is_some() == (row.run.cell.backend == "cpu")));
    let html = html.replace('\u{a0}', " ");
    assert!(!html.contains("1.25 ms") && !html.contains("625 µs"));
    assert_eq!(html.matches("<td class=\"skipped\">correctness only</td>").count(), 7);
    assert!(html.contains("8.00 ms"));
}
