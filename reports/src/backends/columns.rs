//! CPU and GPU columns side by side: times, errors, traffic and memory of the same cell.

use super::pairs::{Outcome, Pair, pairs};
use crate::chip::chip;
use crate::format::{bytes, escape, number, time};
use crate::{Report, Row, Scene};
use halflight_metrics::{Interval, median, median_interval};
use halflight_results::Phase;
use std::fmt::Write;

/// How spans by the device's own clock are told from wall times.
const CLOCK: &str = " (gpu clock)";

/// What is said in the place of a time of a processor in software.
pub(crate) const SOFTWARE: &str = "correctness only";

/// The table of a scene; nothing where it was not meant for a graphics processor.
pub(crate) fn columns(report: &Report, scene: &Scene) -> String {
    let pairs = pairs(report, &scene.name);
    if pairs.is_empty() {
        return String::new();
    }
    let reference = scene.main_reference();
    let errors = reference.map_or("RMSE".into(), |reference| format!("RMSE against {}", escape(reference)));
    let both =
        ["prepare", "update", "shade"].map(str::to_owned).into_iter().chain(["read".into(), errors, "memory".into()]);
    let heads: String = both.map(|name| format!("<th colspan=\"2\">{name}</th>")).collect();
    let sides = "<th>CPU</th><th>GPU</th>";
    let mut table = format!(
        "<table class=\"backends\"><thead><tr><th rowspan=\"2\">setting</th>{heads}<th rowspan=\"2\">CPU over GPU,<br>shade</th>\
         <th rowspan=\"2\">passes,<br>GPU's clock</th><th rowspan=\"2\">up<br>down</th></tr><tr>{}</tr></thead><tbody>",
        sides.repeat(6)
    );
    for pair in &pairs {
        let _ = write!(table, "<tr>{}{}</tr>", heading(report, pair), cells(scene, pair));
    }
    table += "</tbody></table>";
    format!(
        "<details open><summary>CPU and GPU side by side</summary><p class=\"note\">Wall times of the phases, medians, taken in turns; \
         the shade of a GPU ends when the device is done, and reading the result is apart. Passes are timed by the device's own \
         clock. Up and down: bytes moved to and from the device in one prepare, update, shade and read. Memory: main memory, and on the \
         device. An adapter in software is there for correctness only: it is not timed.</p>\
         <div class=\"wide\">{table}</div></details>"
    )
}

/// The setting with the signs of both its cells, and the adapter.
pub(crate) fn heading(report: &Report, pair: &Pair<'_>) -> String {
    let chips: String =
        [pair.cpu, pair.gpu].iter().filter_map(|o| o.row()).map(|row| chip(report, row.label)).collect();
    let adapter = escape(pair.adapter());
    let threads = pair.cpu.row().map_or(String::new(), |row| format!("{} threads", row.run.environment.threads));
    let small: Vec<String> = [threads, adapter].into_iter().filter(|text| !text.is_empty()).collect();
    format!("<th>{chips}{}<small>{}</small></th>", escape(&report.settings[pair.label()]), small.join(" · "))
}

fn cells(scene: &Scene, pair: &Pair<'_>) -> String {
    let [cpu, gpu] = [pair.cpu.row(), pair.gpu.row()];
    let mut html = String::new();
    for span in [Phase::Prepare.name(), Phase::Update.name(), Phase::Shade.name(), "read"] {
        let _ = write!(
            html,
            "<td>{}</td>{}",
            cpu.map_or("–".into(), |row| duration(row, span)),
            timed(pair, |row| duration(row, span))
        );
    }
    for row in [cpu, gpu] {
        let error = row.zip(scene.main_reference()).and_then(|(row, id)| row.score(id));
        let rmse = error.and_then(|score| Some((number(*score.measures.get("rmse")?), score.resolved)));
        html += &match rmse {
            Some((rmse, true)) => format!("<td>{rmse}</td>"),
            Some((rmse, false)) => format!("<td class=\"unresolved\" title=\"not resolved\">{rmse}</td>"),
            None => "<td>–</td>".into(),
        };
    }
    for row in [cpu, gpu] {
        let _ = write!(html, "<td>{}</td>", row.map_or("–".into(), memory));
    }
    html += &timed(pair, |gpu| cpu.and_then(|cpu| gain(cpu, gpu)).map_or("–".into(), ratio));
    html += &timed(pair, passes);
    let traffic = gpu.map_or("–".into(), |row| {
        let count = |name: &str| row.run.counters.get(name).map_or("–".into(), |count| bytes(*count));
        format!("{}<small>{}</small>", count("bytes uploaded"), count("bytes downloaded"))
    });
    let _ = write!(html, "<td>{traffic}</td>");
    html
}

/// A time of the graphics processor, or why there is none.
fn timed(pair: &Pair<'_>, text: impl FnOnce(&Row) -> String) -> String {
    match pair.gpu {
        Outcome::Run(_) if pair.is_software() => format!("<td class=\"skipped\">{SOFTWARE}</td>"),
        Outcome::Run(row) => format!("<td>{}</td>", text(row)),
        Outcome::Skipped(absent) => format!("<td class=\"skipped\" title=\"{}\">skipped</td>", escape(&absent.why)),
        Outcome::Failed(absent) => format!("<td class=\"failed\" title=\"{}\">failed</td>", escape(&absent.why)),
        Outcome::Missing => "<td class=\"skipped\">not run</td>".into(),
    }
}

fn duration(row: &Row, span: &str) -> String {
    let found = row.span(span).and_then(|timing| median_interval(&timing.nanoseconds));
    found.map_or("–".into(), |Interval { median, low, high, count }| match count {
        1 => format!("{}<small>once</small>", time(median)),
        _ => format!("{}<small>{} to {}</small>", time(median), time(low), time(high)),
    })
}

fn memory(row: &Row) -> String {
    let sum = |bytes: fn(&halflight_results::Storage) -> u64| row.run.footprint.iter().map(bytes).sum::<u64>();
    let (host, device) = (sum(|s| s.host_bytes), sum(|s| s.device_bytes));
    if device == 0 { bytes(host) } else { format!("{}<small>{} on device</small>", bytes(host), bytes(device)) }
}

/// How many times as fast the second shades, round by round where the rounds were the same.
fn gain(cpu: &Row, gpu: &Row) -> Option<Interval> {
    let samples = |row: &'_ Row| row.span(Phase::Shade.name()).map(|timing| timing.nanoseconds.clone());
    let (cpu, gpu) = (samples(cpu)?, samples(gpu)?);
    if cpu.len() != gpu.len() {
        let value = median(&cpu)? / median(&gpu)?;
        return Some(Interval { median: value, low: value, high: value, count: 1 });
    }
    median_interval(&cpu.iter().zip(&gpu).map(|(cpu, gpu)| cpu / gpu).collect::<Vec<_>>())
}

fn ratio(Interval { median, low, high, count }: Interval) -> String {
    let interval =
        if count > 1 { format!("<small>{} to {}</small>", number(low), number(high)) } else { String::new() };
    format!("{}×{interval}", number(median))
}

/// Each pass with its median by the device's clock.
fn passes(row: &Row) -> String {
    let spans = row.times.iter().flat_map(|times| &times.phases);
    let clocked = spans.filter_map(|(path, timing)| {
        let pass = path.strip_suffix(CLOCK)?.rsplit('/').next()?;
        Some(format!("{} <small>{}</small>", time(median(&timing.nanoseconds)?), escape(pass)))
    });
    let passes = clocked.collect::<String>();
    if passes.is_empty() { "no clock".into() } else { passes }
}
