//! A scene's figures in full: errors, times, derived data, counters, memory.

use crate::calibration::{Pace, Usual};
use crate::chip::chip;
use crate::format::{bytes, count, escape, number, time};
use crate::labels::value_text;
use crate::{Report, Row, Scene, threads};
use halflight_metrics::{median_interval, outliers};
use halflight_results::{Phase, Score, Timing};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The columns of the error table: name in results, heading, what it is.
const MEASURES: [(&str, &str, &str); 8] = [
    ("rmse", "RMSE", "root mean square error, radiance"),
    ("rel_mse", "relative MSE", "mean of d² / (r² + 0.01)"),
    ("mae", "mean abs.", "mean absolute error, radiance"),
    ("bias", "bias", "mean signed error, radiance; negative is too dark"),
    ("p99", "99th pct.", "99th percentile of the absolute error, radiance"),
    ("max", "max", "largest absolute error, radiance"),
    ("ssim", "SSIM", "structural similarity as displayed: 1 is equal"),
    ("flip", "FLIP", "perceived difference as displayed: 0 is equal"),
];

/// Every table of a scene.
pub(crate) fn tables(report: &Report, scene: &Scene) -> String {
    [
        errors(report, scene),
        times(report, scene),
        threads::table(report, scene),
        derived(report, scene),
        counters(report, scene),
        memory(report, scene),
    ]
    .concat()
}

fn details(title: &str, note: &str, table: &str) -> String {
    format!(
        "<details open><summary>{title}</summary><p class=\"note\">{note}</p><div class=\"wide\">{table}</div></details>"
    )
}

fn name(report: &Report, row: &Row) -> String {
    format!("<th>{}{}</th>", chip(report, row.label), escape(&report.labels[row.label]))
}

fn errors(report: &Report, scene: &Scene) -> String {
    let mut table = String::from("<table><thead><tr><th>setting</th>");
    for (_, heading, about) in MEASURES {
        let _ = write!(table, "<th title=\"{about}\">{heading}</th>");
    }
    table.push_str("<th title=\"RMSE in percent of the reference's root mean square\">RMSE / level</th>");
    table.push_str("<th title=\"receivers valid in both pictures\">receivers</th></tr></thead>");
    let columns = MEASURES.len() + 3;
    for reference in &scene.references {
        let noise = scene.standard_error(&reference.id);
        let _ = write!(
            table,
            "<tbody><tr class=\"group\"><th colspan=\"{columns}\">against {} · its own standard error {}</th></tr>",
            escape(&reference.id),
            number(noise)
        );
        for (row, score) in
            threads::distinct(scene).into_iter().filter_map(|row| Some((row, row.score(&reference.id)?)))
        {
            let _ = write!(table, "<tr>{}{}</tr>", name(report, row), error_cells(score));
        }
        table.push_str("</tbody>");
    }
    table.push_str("</table>");
    let note = "Over the receivers valid in both pictures, all three channels. Muted figures are not resolved: what the \
                reference's own noise leaves of the RMSE is below its standard error, so they say only that the difference is small.";
    details("Errors", note, &table)
}

fn error_cells(score: &Score) -> String {
    let class = if score.resolved { "" } else { " class=\"unresolved\" title=\"not resolved\"" };
    let value = |name: &str| score.measures.get(name).copied();
    let mut html = String::new();
    for (measure, ..) in MEASURES {
        // SSIM crowds near 1, where three digits say little.
        let text = |v: f64| if measure == "ssim" { format!("{v:.4}") } else { number(v) };
        let _ = write!(html, "<td{class}>{}</td>", value(measure).map_or("–".into(), text));
    }
    let share = value("rmse").zip(value("level")).filter(|(_, level)| *level > 0.0).map(|(e, level)| 100.0 * e / level);
    let share = share.map_or("–".into(), |s| format!("{} %", number(s)));
    let _ = write!(html, "<td{class}>{share}</td><td>{}</td>", count(score.receivers as u64));
    html
}

fn times(report: &Report, scene: &Scene) -> String {
    let mut table = String::from(
        "<table><thead><tr><th>setting</th><th>prepare</th><th>update</th><th>shade</th><th>shade a receiver</th>\
         <th>derived data, apart</th><th>threads</th><th>machine</th></tr></thead><tbody>",
    );
    let usual = Usual::of(report.scenes.iter().flat_map(|scene| &scene.rows));
    for row in &scene.rows {
        let _ = write!(table, "<tr>{}", name(report, row));
        for phase in Phase::ALL {
            let _ = write!(table, "<td>{}</td>", row.span(phase.name()).map_or("–".into(), duration));
        }
        let shade = row.shade_time();
        let each = shade.filter(|_| row.run.receivers > 0).map(|t| time(t.median / row.run.receivers as f64));
        let derived: f64 = row.run.derived.values().sum();
        let derived = if row.run.derived.is_empty() { "–".into() } else { time(derived) };
        let threads = row.run.environment.threads;
        let machine = usual.pace(row).map_or("<td>–</td>".into(), |pace| machine(pace, row));
        let _ =
            write!(table, "<td>{}</td><td>{derived}</td><td>{threads}</td>{machine}</tr>", each.unwrap_or("–".into()));
        for (span, timing) in spans(row) {
            let mut cells = Phase::ALL.map(|_| String::new());
            cells[timing.phase as usize] = duration(timing);
            let inner = span.strip_prefix(timing.phase.name()).map_or(span.as_str(), |s| s.trim_start_matches('/'));
            let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
            let _ = write!(
                table,
                "<tr class=\"span\"><th>{}</th>{cells}<td></td><td></td><td></td><td></td></tr>",
                escape(inner)
            );
        }
    }
    table.push_str("</tbody></table>");
    let note = "Wall time: the median of samples taken in turns with the other settings of the scene, with the interval \
                that holds the true median with a probability of 95% (of fewer than six samples: their range; five: 94%, \
                three: 75%) and the count of samples. Outliers (modified z-score above 3.5) are counted, not dropped: a median \
                bears them. Derived data (sphere sets, lights, trees) is built once and shared; its build time is charged apart \
                to every setting that uses it. Machine: what fixed work took beside these samples, computing and reading \
                memory, over what it usually took in these results; where that is off by more than 10%, the shade time is \
                given normalised too, divided by the first ratio.";
    details("Time", note, &table)
}

/// Spans inside the phases.
fn spans(row: &Row) -> impl Iterator<Item = (&String, &Timing)> {
    row.times
        .iter()
        .flat_map(|times| &times.phases)
        .filter(|(name, _)| Phase::ALL.iter().all(|phase| phase.name() != name.as_str()))
}

fn duration(timing: &Timing) -> String {
    let outliers = match outliers(&timing.nanoseconds).into_iter().filter(|far| *far).count() {
        0 => String::new(),
        1 => ", 1 outlier".to_owned(),
        n => format!(", {n} outliers"),
    };
    match median_interval(&timing.nanoseconds) {
        None => "–".into(),
        Some(i) if i.count == 1 => format!("{}<small>once</small>", time(i.median)),
        Some(i) => {
            let [median, low, high] = [i.median, i.low, i.high].map(time);
            format!("{median}<small>{low} to {high}, ×{}{outliers}</small>", i.count)
        }
    }
}

/// How fast the machine was, as a table's cell.
fn machine(pace: Pace, row: &Row) -> String {
    let ratios = format!("{:.2} · {:.2}", pace.compute, pace.memory);
    match row.shade_time().filter(|_| pace.is_apart()) {
        None => format!("<td>{ratios}</td>"),
        Some(shade) => {
            format!(
                "<td class=\"failed\">{ratios}<small>normalised: {}</small></td>",
                time(shade.median / pace.compute)
            )
        }
    }
}

fn derived(report: &Report, scene: &Scene) -> String {
    let mut pieces: BTreeMap<&str, (f64, String)> = BTreeMap::new();
    for row in &scene.rows {
        for (piece, nanoseconds) in &row.run.derived {
            let entry = pieces.entry(piece).or_default();
            entry.0 = entry.0.max(*nanoseconds);
            entry.1 += &chip(report, row.label);
        }
    }
    if pieces.is_empty() {
        return String::new();
    }
    let mut table =
        String::from("<table><thead><tr><th>derived data</th><th>build</th><th>used by</th></tr></thead><tbody>");
    for (piece, (nanoseconds, users)) in pieces {
        let _ = write!(table, "<tr><th>{}</th><td>{}</td><td>{users}</td></tr>", escape(piece), time(nanoseconds));
    }
    table.push_str("</tbody></table>");
    details("Derived data", "What was built before any method could run, and who needed it.", &table)
}

fn counters(report: &Report, scene: &Scene) -> String {
    let names: BTreeSet<&String> = scene.rows.iter().flat_map(|row| row.run.counters.keys()).collect();
    if names.is_empty() {
        return String::new();
    }
    let cell = |name: &str, row: &Row| row.run.counters.get(name).map_or("–".into(), |v| count(*v));
    let table = by_setting(report, scene, "counter", names.into_iter().map(String::as_str), cell);
    details("Counters", "Work done and skipped over one run, and how often a guard stepped in.", &table)
}

fn memory(report: &Report, scene: &Scene) -> String {
    let names: BTreeSet<&str> =
        scene.rows.iter().flat_map(|row| row.run.footprint.iter().map(|s| s.purpose.as_str())).collect();
    if names.is_empty() {
        return String::new();
    }
    const TOTAL: &str = "total";
    let cell = |name: &str, row: &Row| {
        let of = row.run.footprint.iter().filter(|s| name == TOTAL || s.purpose == name);
        let (host, device) = of.clone().fold((0, 0), |(h, d), s| (h + s.host_bytes, d + s.device_bytes));
        match (of.count(), device) {
            (0, _) => "–".into(),
            (_, 0) => bytes(host),
            _ => format!("{} + {} on device", bytes(host), bytes(device)),
        }
    };
    let names = names.into_iter().filter(|n| *n != TOTAL).chain([TOTAL]);
    let table = by_setting(report, scene, "purpose", names, cell);
    details(
        "Memory",
        "What each method holds after shading, counted by itself; tables that all methods share are not in it.",
        &table,
    )
}

/// A table with a row a name and a column a setting.
fn by_setting<'a>(
    report: &Report,
    scene: &Scene,
    heading: &str,
    names: impl Iterator<Item = &'a str>,
    cell: impl Fn(&str, &Row) -> String,
) -> String {
    let mut table = format!("<table><thead><tr><th>{heading}</th>");
    for row in &scene.rows {
        let _ = write!(table, "<th title=\"{}\">{}</th>", escape(&report.labels[row.label]), chip(report, row.label));
    }
    table.push_str("</tr></thead><tbody>");
    for name in names {
        let _ = write!(table, "<tr><th>{}</th>", escape(name));
        for row in &scene.rows {
            let _ = write!(table, "<td>{}</td>", cell(name, row));
        }
        table.push_str("</tr>");
    }
    table + "</tbody></table>"
}

/// Every setting with all its parameters.
pub(crate) fn settings(report: &Report) -> String {
    let mut table = String::from(
        "<div class=\"wide\"><table><thead><tr><th>setting</th><th>parameters</th><th>quantity</th><th>backend</th>\
         <th>seed</th><th>revision</th></tr></thead><tbody>",
    );
    for label in 0..report.labels.len() {
        let rows = || report.scenes.iter().flat_map(|s| &s.rows);
        let Some(row) = rows().find(|row| row.label == label) else { continue };
        let cell = &row.run.cell;
        let params: Vec<String> = cell.params.iter().map(|(n, v)| format!("{n} = {}", value_text(v))).collect();
        let revision: String = cell.revision.chars().take(12).collect();
        let _ = write!(
            table,
            "<tr>{}<td class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td><td><code>{}</code></td></tr>",
            name(report, row),
            escape(&params.join(", ")),
            escape(&cell.quantity),
            escape(&cell.backend),
            cell.seed,
            escape(&revision)
        );
    }
    table + "</tbody></table></div>"
}
