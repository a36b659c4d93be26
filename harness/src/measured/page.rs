//! The page: papers' rates over all devices, then each device with its conditions, times, passes and differences.

use super::passes::{Pass, passes, span};
use super::{Cell, Conditions, Measured, Peak};
use crate::execute::AGAIN;
use crate::ledger::number;
use crate::rates::{NOT_TIMED, Outcome, among, processor, run_of};
use halflight_metrics::Interval;
use halflight_reports::Rate;
use halflight_results::{Cell as Place, Record};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The page of these devices, as Markdown.
pub fn page(devices: &[Measured]) -> String {
    let mut page = String::from(
        "# Measured on devices\n\n\
         Written by `halflight measured` from the files in `reports/measured`; do not edit. On a machine with a graphics processor\n\
         `halflight measured take --backend both` runs the suite `paper/rates` on the processor and on it, in turns, keeps what it finds as\n\
         `reports/measured/<device>.jsonl`, and writes this page again.\n\n\
         Times are medians with their 95% interval. A frame is an update from another frame and shading; reading the result is apart. Adapters\n\
         in software are held against the processor for correctness only: no time of theirs is kept.\n",
    );
    if !devices.iter().any(has_real_processor) {
        page += "\n**No graphics processor has been measured yet**: none was at hand. What follows is the processor's, and the agreement of \
                 adapters in software.\n";
    }
    rates(&mut page, devices);
    devices.iter().for_each(|device| section(&mut page, device));
    page
}

fn has_real_processor(device: &Measured) -> bool {
    let cells = device.cells.iter().filter_map(|cell| run_of(&cell.outcome));
    cells.into_iter().any(|run| run.cell.is_gpu() && !run.cell.is_software())
}

/// The papers' rates, a column a processor of a file.
fn rates(page: &mut String, devices: &[Measured]) {
    let mut columns: Vec<(&Measured, String)> = Vec::new();
    let all: Vec<Vec<Rate>> = devices.iter().map(|device| among(&outcomes(device))).collect();
    for (device, rates) in devices.iter().zip(&all) {
        for reached in rates.iter().flat_map(|rate| &rate.reached) {
            let known = columns.iter().any(|(of, on)| std::ptr::eq(*of, device) && *on == reached.on);
            if !known && reached.frames.as_ref().err().is_none_or(|why| why != NOT_TIMED) {
                columns.push((device, reached.on.clone()));
            }
        }
    }
    let mut cases: Vec<&Rate> = Vec::new();
    for rate in all.iter().flatten() {
        if !cases.iter().any(|known| is_same(known, rate)) {
            cases.push(rate);
        }
    }
    if cases.is_empty() {
        return;
    }
    let heads: String = columns.iter().map(|(_, on)| format!(" {on} |")).collect();
    let _ = write!(
        page,
        "\n## The papers' frame rates\n\n| case | of | the paper |{heads}\n|---|---|---|{}\n",
        "---|".repeat(columns.len())
    );
    for case in cases {
        let _ = write!(page, "| {} | {} | {}: {} |", case.case, case.work, case.device, case.printed);
        for (device, on) in &columns {
            let place = devices.iter().position(|other| std::ptr::eq(other, *device)).unwrap_or(0);
            let rate = all[place].iter().find(|rate| is_same(rate, case));
            let reached = rate.and_then(|rate| rate.reached.iter().find(|reached| reached.on == *on));
            let text = reached.map_or("–".to_owned(), |reached| match &reached.frames {
                Ok(frames) => format!(
                    "{} Hz ({} to {}){}",
                    number(frames.median),
                    number(frames.low),
                    number(frames.high),
                    reached
                        .passes
                        .map_or(String::new(), |passes| format!(", passes alone {} Hz", number(passes.median)))
                ),
                Err(why) => why.clone(),
            });
            let _ = write!(page, " {text} |");
        }
        page.push('\n');
    }
}

fn is_same(a: &Rate, b: &Rate) -> bool {
    (&a.case, &a.setting, &a.place) == (&b.case, &b.setting, &b.place)
}

fn outcomes(device: &Measured) -> Vec<Outcome<'_>> {
    device.cells.iter().map(|cell| (&cell.outcome, cell.times.as_ref())).collect()
}

fn section(page: &mut String, device: &Measured) {
    let _ = write!(page, "\n## {}\n\n", device.conditions.device);
    told(page, &device.conditions);
    let _ = writeln!(page, "- sources of the methods: {}", revisions(device));
    times(page, device);
    work(page, device);
    differences(page, device);
}

fn told(page: &mut String, c: &Conditions) {
    let e = &c.environment;
    let mut line = |name: &str, text: Option<String>| {
        if let Some(text) = text.filter(|text| !text.is_empty()) {
            let _ = writeln!(page, "- {name}: {text}");
        }
    };
    line("adapter", c.adapter.clone());
    line(
        "processor",
        Some(format!("{}, {} logical cores, {} threads used; {}", e.cpu, e.cores, e.threads, c.features.join(" "))),
    );
    line("build", Some(format!("halflight {}, {}, {}, {}", e.halflight, e.profile, e.rustc, e.os)));
    let clock = c.clock.map(|[low, high]| format!("{} to {} MHz when the run began", number(low), number(high)));
    line(
        "clock",
        clock.map(|clock| format!("{clock}, governor {}", c.governor.as_deref().unwrap_or("not told by the system"))),
    );
    line(
        "load",
        c.load.map(|load| format!("{} processes ready to run, on average over the minute before", number(load))),
    );
    for (side, peak) in &c.peaks {
        let text = format!("{} Gflop/s, {} GB/s", number(peak.flops * 1e-9), number(peak.bytes * 1e-9));
        line(&format!("peak of the {}", if side == "gpu" { "adapter" } else { "processor" }), Some(text));
    }
    line("note", Some(c.note.clone()));
    line("taken", Some(format!("`{}`, {} UTC", c.command, date(c.taken))));
}

/// The families that took part, with the hash of their sources.
fn revisions(device: &Measured) -> String {
    let cells = device.cells.iter().filter_map(|cell| cell.outcome.cell());
    let family = |cell: &Place| {
        let family = cell.method.split('/').next().unwrap_or_default();
        format!("{family} {}", cell.revision.get(..12).unwrap_or(&cell.revision))
    };
    cells.map(family).collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>().join(", ")
}

/// Phases of every cell that was timed.
fn times(page: &mut String, device: &Measured) {
    let timed: Vec<&Cell> = device.cells.iter().filter(|cell| cell.times.is_some()).collect();
    if timed.is_empty() {
        let _ = write!(page, "\nCorrectness only: no time was kept.\n");
        return;
    }
    let _ = write!(page, "\n| cell | on | update again | shade | read | up, down |\n|---|---|---|---|---|---|\n");
    for cell in timed {
        let _ = write!(page, "| {} | {} |", name(device, cell), processor(&cell.outcome));
        for phase in [AGAIN, "shade", "read"] {
            let _ = write!(page, " {} |", span(cell.times.as_ref(), phase).map_or("–".into(), duration));
        }
        let count = |name: &str| run_of(&cell.outcome)?.counters.get(name).copied();
        let traffic = count("bytes uploaded").zip(count("bytes downloaded"));
        let _ = writeln!(
            page,
            " {} |",
            traffic.map_or("–".into(), |(up, down)| format!(
                "{} kB, {} kB",
                number(up as f64 / 1e3),
                number(down as f64 / 1e3)
            ))
        );
    }
}

/// Passes with the share of the device's peak.
fn work(page: &mut String, device: &Measured) {
    let rows: Vec<(&Cell, Pass)> =
        device.cells.iter().flat_map(|cell| passes(cell).into_iter().map(move |pass| (cell, pass))).collect();
    if rows.is_empty() {
        return;
    }
    let _ = write!(
        page,
        "\n| cell | pass | time | arithmetic | of the peak | bandwidth | of the peak |\n|---|---|---|---|---|---|---|\n"
    );
    for (cell, pass) in &rows {
        let side = if cell.outcome.cell().is_some_and(Place::is_gpu) { "gpu" } else { "cpu" };
        let [arithmetic, bandwidth] =
            device.conditions.peaks.get(side).map_or([None; 2], |peak: &Peak| pass.shares(peak));
        let rate =
            |rate: Option<f64>, unit: &str| rate.map_or("–".into(), |rate| format!("{} {unit}", number(rate * 1e-9)));
        let share = |share: Option<f64>| share.map_or("–".into(), |share| format!("{}%", number(100.0 * share)));
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} |",
            name(device, cell),
            pass.name,
            duration(pass.time),
            rate(pass.arithmetic(), "Gflop/s"),
            share(arithmetic),
            rate(pass.bandwidth(), "GB/s"),
            share(bandwidth)
        );
    }
    if rows.iter().all(|(_, pass)| pass.flops.is_none() && pass.bytes.is_none()) {
        *page += "\nNo method states the work of these passes.\n";
    }
}

/// Every cell of an adapter, against the processor's.
fn differences(page: &mut String, device: &Measured) {
    let is_gpu = |cell: &&Cell| cell.outcome.cell().is_some_and(Place::is_gpu);
    let cells: Vec<&Cell> = device.cells.iter().filter(is_gpu).collect();
    if cells.is_empty() {
        return;
    }
    let _ = write!(
        page,
        "\n| against the processor | on | largest difference | at receiver | RMSE apart | over level | over its error against the truth | not finite |\n\
         |---|---|---|---|---|---|---|---|\n"
    );
    for cell in cells {
        let _ = write!(page, "| {} | {} |", name(device, cell), processor(&cell.outcome));
        let why = match (&cell.outcome, &cell.twin) {
            (Record::Skip(skip), _) => format!("skipped: {}", skip.reason),
            (Record::Failure(failure), _) => format!("failed: {}", failure.error),
            (_, None) => "not run on the processor".to_owned(),
            (_, Some(twin)) if !twin.error.is_empty() => twin.error.clone(),
            (_, Some(twin)) => {
                let error = cell
                    .scores
                    .iter()
                    .find(|score| score.reference == "truth")
                    .and_then(|score| score.measures.get("rmse"));
                let share = |of: Option<f64>| {
                    of.filter(|of| *of > 0.0).map_or("–".into(), |of| format!("{}%", number(100.0 * twin.rmse / of)))
                };
                let finite = match (twin.not_finite, twin.lone) {
                    (0, 0) => "0".to_owned(),
                    (bad, lone) => format!("**{bad}**, {lone} valid in one alone"),
                };
                let at = twin.worst.map_or("–".into(), |receiver| receiver.to_string());
                let _ = writeln!(
                    page,
                    " {} | {at} | {} | {} | {} | {finite} |",
                    number(twin.max),
                    number(twin.rmse),
                    share(Some(twin.level)),
                    share(error.copied())
                );
                continue;
            }
        };
        let _ = writeln!(page, " {why} | | | | | |");
    }
}

/// A cell's scene and method with the parameters in which the method's cells on this scene differ.
fn name(device: &Measured, cell: &Cell) -> String {
    let Some(own) = cell.outcome.cell() else { return String::new() };
    let kin = || {
        device
            .cells
            .iter()
            .filter_map(|cell| cell.outcome.cell())
            .filter(|other| (&other.method, &other.scene) == (&own.method, &own.scene))
    };
    let differs = |name: &String| kin().any(|other| other.params.get(name) != own.params.get(name));
    let text = |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let set: String = own
        .params
        .iter()
        .filter(|(name, _)| differs(name))
        .map(|(name, value)| format!(" {name}={}", text(value)))
        .collect();
    let frame =
        if kin().any(|other| other.frame != own.frame) { format!(" frame {}", own.frame) } else { String::new() };
    format!("{} · {}{set}{frame}", own.scene, own.method)
}

fn duration(time: Interval) -> String {
    let one = |time: f64| match time {
        t if t >= 1e6 => format!("{} ms", number(t * 1e-6)),
        t => format!("{} µs", number(t * 1e-3)),
    };
    if time.count < 2 {
        one(time.median)
    } else {
        format!("{} ({} to {})", one(time.median), one(time.low), one(time.high))
    }
}

/// A date of the Gregorian calendar (Fliegel and van Flandern 1968), with hours and minutes.
fn date(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    let l = days as i64 + 2_440_588 + 68_569;
    let n = 4 * l / 146_097;
    let l = l - (146_097 * n + 3) / 4;
    let i = 4000 * (l + 1) / 1_461_001;
    let l = l - 1461 * i / 4 + 31;
    let j = 80 * l / 2447;
    let (day, l) = (l - 2447 * j / 80, j / 11);
    let (month, year) = (j + 2 - 12 * l, 100 * (n - 49) + i + l);
    format!("{year}-{month:02}-{day:02} {:02}:{:02}", rest / 3600, rest % 3600 / 60)
}

#[cfg(test)]
mod tests {
    use super::super::{Difference, read_all};
    use super::*;
    use halflight_results::{Environment, Key, Phase, Run, Times, Timing};
    use std::path::Path;

    fn cell(backend: &str, shade: Option<f64>) -> Cell {
        let place = Place { scene: "a".into(), method: "m/x".into(), backend: backend.into(), ..Place::default() };
        let environment = Environment { cpu: "a CPU".into(), threads: 2, ..Environment::default() };
        let counters = [("flops (gather)".to_owned(), 6_000_000)].into();
        let run = Run { cell: place, environment, counters, ..Run::default() };
        let times = shade.map(|shade| {
            let timing = |phase, time: f64| Timing { phase, nanoseconds: vec![time; 6] };
            let phases = [
                (AGAIN.to_owned(), timing(Phase::Update, 1e6)),
                ("shade".to_owned(), timing(Phase::Shade, shade)),
                ("shade/gather (gpu clock)".to_owned(), timing(Phase::Shade, 2e5)),
            ];
            Times { run: run.cell.key(), taken: 0, beside: 1, phases: phases.into(), calibration: Default::default() }
        });
        Cell { outcome: Record::Run(Box::new(run)), times, scores: Vec::new(), twin: None }
    }

    fn device(cells: Vec<Cell>) -> Measured {
        let peaks = [("gpu".to_owned(), Peak { flops: 1.2e11, bytes: 1e9 })].into();
        let conditions = Conditions { device: "Real 9000".into(), peaks, taken: 951_782_400, ..Conditions::default() };
        Measured { conditions, cells }
    }

    fn apart(max: f64, not_finite: usize) -> Difference {
        let cpu = Key::of_bytes(b"cpu");
        Difference {
            cpu,
            receivers: 9,
            max,
            worst: Some(7),
            rmse: max / 4.0,
            bias: 0.0,
            level: 2.0,
            not_finite,
            lone: 0,
            error: String::new(),
        }
    }

    #[test]
    fn the_shipped_page_is_what_the_shipped_files_say() {
        let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports");
        let devices = read_all(&reports.join("measured")).unwrap();
        assert!(!devices.is_empty());
        let shipped = std::fs::read_to_string(reports.join("measured.md")).unwrap();
        assert!(page(&devices) == shipped, "reports/measured.md: `halflight measured` writes it");
        for measured in &devices {
            let path = reports.join("measured").join(measured.conditions.file_name().unwrap());
            assert_eq!(Measured::read(&path).unwrap(), *measured, "a file is called by its device");
            let timed = measured.cells.iter().filter(|cell| cell.times.is_some());
            assert!(timed.filter_map(|cell| cell.outcome.cell()).all(|cell| !cell.is_software()));
        }
    }

    #[test]
    fn a_planted_difference_and_what_is_not_finite_are_shown() {
        let twin = |backend: &str, twin| Cell { twin, ..cell(backend, None) };
        let shown = page(&[device(vec![twin("gpu: Real 9000", Some(apart(0.5, 0)))])]);
        assert!(shown.contains("| Real 9000 | 0.500 | 7 | 0.125 | 6.25% | – | 0 |"), "{shown}");
        let shown = page(&[device(vec![twin("gpu: Real 9000", Some(apart(0.5, 3)))])]);
        assert!(shown.contains("**3**"), "{shown}");
        let shown = page(&[device(vec![twin("gpu: Real 9000", None)])]);
        assert!(shown.contains("not run on the processor"), "{shown}");
    }

    #[test]
    fn passes_have_their_share_of_the_peak() {
        let shown = page(&[device(vec![cell("gpu: Real 9000", Some(5e5))])]);
        // 6e6 in 0.2 ms are 30 Gflop/s of 120.
        assert!(shown.contains("| gather | 200 µs (200 µs to 200 µs) | 30.0 Gflop/s | 25% | – | – |"), "{shown}");
        assert!(shown.contains("- taken: ``, 2000-02-29 00:00 UTC"), "{shown}");
        assert!(!shown.contains("No graphics processor has been measured"), "{shown}");
    }

    #[test]
    fn it_says_that_no_graphics_processor_was_there() {
        for cells in [vec![cell("cpu", Some(1e6))], vec![cell("gpu: pipe, correctness only", None)]] {
            assert!(page(&[device(cells)]).contains("**No graphics processor has been measured yet**"));
        }
    }

    #[test]
    fn files_read_back_and_wrong_ones_name_the_line() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("sub/real-9000.jsonl");
        let measured = device(vec![
            Cell { twin: Some(apart(0.5, 1)), ..cell("gpu: Real 9000", Some(5e5)) },
            cell("cpu", Some(1e6)),
        ]);
        measured.write(&path).unwrap();
        assert_eq!(read_all(path.parent().unwrap()).unwrap(), [measured]);
        let text = std::fs::read_to_string(&path).unwrap();
        let (first, rest) = text.split_once('\n').unwrap();
        for (wrong, part) in [
            (rest.to_owned(), "line 1: expected the conditions"),
            (first.replace("\"schema\":1", "\"schema\":9"), "line 1: `schema` is 9, expected 1"),
            (format!("{first}\n{first}\n"), "line 2: conditions a second time"),
            (format!("{text}{{\"line\":\"row\"}}\n"), "line 4"),
            (text.replace("\"max\":0.5", "\"max\":0.5,\"extra\":1"), "line 2"),
        ] {
            std::fs::write(&path, wrong).unwrap();
            let error = Measured::read(&path).unwrap_err().to_string();
            assert!(error.contains("real-9000.jsonl") && error.contains(part), "{error}");
        }
    }

    #[test]
    fn values_that_json_lacks_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let bad = device(vec![Cell { twin: Some(apart(f64::INFINITY, 0)), ..cell("gpu: x", None) }]);
        assert!(bad.write(&dir.path().join("a.jsonl")).is_err());
        assert!(read_all(dir.path()).unwrap().is_empty());
    }
}
