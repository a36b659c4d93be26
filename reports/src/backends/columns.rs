//! CPU and GPU columns side by side: times, errors, traffic and memory of the same cell.

use super::pairs::{Outcome, Pair, pairs};
use crate::chip::chip;
use crate::format::{bytes, escape, number, time};
use crate::{Report, Row, Scene};
use halflight_metrics::{Interval, median, median_interval};
use halflight_results::Phase;

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
    let times = SPANS.iter().map(|(_, name)| (*name).to_owned());
    let times = table(report, &pairs, times, &["CPU over GPU, shade", "passes, by the GPU's clock"], times_of);
    let errors = scene.references.iter().map(|reference| format!("RMSE against {}", escape(&reference.id)));
    let rest = errors.chain(["memory".to_owned()]);
    let rest = table(report, &pairs, rest, &["uploaded", "downloaded"], |pair| rest_of(scene, pair));
    format!(
        "<details open><summary>CPU and GPU side by side</summary><p class=\"note\">Wall times of the phases, medians, taken in turns; \
         the shade of a GPU ends when the device is done, and reading the result is apart. Passes are timed by the device's own \
         clock. Uploaded, downloaded: bytes moved to and from the device in one prepare, update, shade and read. Memory: main memory, and \
         on the device. An adapter in software is there for correctness only: it is not timed.</p>\
         <div class=\"wide\">{times}</div><div class=\"wide\">{rest}</div></details>"
    )
}

/// Spans that both backends have, and what they are called.
const SPANS: [(&str, &str); 5] = [
    ("prepare", "prepare"),
    ("update", "first update"),
    ("update again", "update again"),
    ("shade", "shade"),
    ("read", "read"),
];

/// A row a pair; a column each for CPU and GPU under these headings, then those of the pair as a whole.
fn table(
    report: &Report,
    pairs: &[Pair<'_>],
    both: impl Iterator<Item = String>,
    whole: &[&str],
    cells: impl Fn(&Pair<'_>) -> String,
) -> String {
    let both: Vec<String> = both.map(|name| format!("<th colspan=\"2\">{name}</th>")).collect();
    let whole: String = whole.iter().map(|name| format!("<th rowspan=\"2\">{name}</th>")).collect();
    let sides = "<th>CPU</th><th>GPU</th>".repeat(both.len());
    let rows: String = pairs.iter().map(|pair| format!("<tr>{}{}</tr>", heading(report, pair), cells(pair))).collect();
    format!(
        "<table class=\"backends\"><thead><tr><th rowspan=\"2\">setting</th>{}{whole}</tr><tr>{sides}</tr></thead><tbody>{rows}</tbody></table>",
        both.concat()
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

fn times_of(pair: &Pair<'_>) -> String {
    let cpu = pair.cpu.row();
    let both = SPANS.iter().map(|(span, _)| {
        let cpu = cpu.map_or("–".into(), |row| duration(row, span));
        format!("<td>{cpu}</td>{}", timed(pair, |row| duration(row, span)))
    });
    let gain = timed(pair, |gpu| cpu.and_then(|cpu| gain(cpu, gpu)).map_or("–".into(), ratio));
    both.chain([gain, timed(pair, passes)]).collect()
}

fn rest_of(scene: &Scene, pair: &Pair<'_>) -> String {
    let [cpu, gpu] = [pair.cpu.row(), pair.gpu.row()];
    let errors = scene.references.iter().flat_map(|reference| [cpu, gpu].map(|row| error(row, &reference.id)));
    let memory = [cpu, gpu].map(|row| format!("<td>{}</td>", row.map_or("–".into(), memory)));
    let traffic = ["bytes uploaded", "bytes downloaded"].map(|name| {
        let count = gpu.and_then(|row| row.run.counters.get(name));
        format!("<td>{}</td>", count.map_or("–".into(), |count| bytes(*count)))
    });
    errors.chain(memory).chain(traffic).collect()
}

fn error(row: Option<&Row>, reference: &str) -> String {
    let score = row.and_then(|row| row.score(reference));
    match score.and_then(|score| Some((number(*score.measures.get("rmse")?), score.resolved))) {
        Some((rmse, true)) => format!("<td>{rmse}</td>"),
        Some((rmse, false)) => format!("<td class=\"unresolved\" title=\"not resolved\">{rmse}</td>"),
        None => "<td>–</td>".into(),
    }
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
    // Columns are narrow: an interval may break between its ends, a time before its unit may not.
    let time = |nanoseconds| time(nanoseconds).replace(' ', "\u{a0}");
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
