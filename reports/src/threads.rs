//! The same setting on several numbers of threads.

use crate::chip::chip;
use crate::format::{escape, number, time};
use crate::{Report, Row, Scene};
use halflight_metrics::{Interval, median_interval};
use halflight_results::Cell;
use std::fmt::Write;

/// Whether two rows differ in nothing but where they were timed.
pub(crate) fn are_twins(a: &Row, b: &Row) -> bool {
    let untimed = |row: &Row| Cell { timed_on: None, ..row.run.cell.clone() };
    untimed(a) == untimed(b)
}

/// The rows of a scene without those that repeat another on other threads or machines: their pictures are the same.
pub(crate) fn distinct(scene: &Scene) -> Vec<&Row> {
    let mut rows: Vec<&Row> = Vec::new();
    for row in &scene.rows {
        if !rows.iter().any(|other| are_twins(other, row)) {
            rows.push(row);
        }
    }
    rows
}

/// Settings that were timed on one thread and on more, with the gain; nothing where there are none.
pub(crate) fn table(report: &Report, scene: &Scene) -> String {
    let threads = |row: &Row| row.run.environment.threads;
    let mut body = String::new();
    for one in scene.rows.iter().filter(|row| threads(row) == 1) {
        for many in scene.rows.iter().filter(|row| threads(row) > 1 && are_twins(one, row)) {
            let Some(gain) = gain(one, many) else { continue };
            let time = |row: &Row| row.shade_time().map_or("–".into(), |t| time(t.median));
            let Interval { median, low, high, .. } = gain;
            let _ = write!(
                body,
                "<tr><th>{}{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}<small>{} to {}</small></td><td>{} %</td></tr>",
                chip(report, many.label),
                escape(&report.labels[many.label]),
                time(one),
                time(many),
                threads(many),
                number(median),
                number(low),
                number(high),
                number(100.0 * median / threads(many) as f64)
            );
        }
    }
    if body.is_empty() {
        return body;
    }
    format!(
        "<details open><summary>Threads</summary><p class=\"note\">The gain is the median over rounds of the ratio of the \
         two times in a round, with its 95% interval.</p><div class=\"wide\"><table><thead><tr><th>setting</th>\
         <th>shade, 1 thread</th><th>shade, all</th><th>threads</th><th>gain</th><th>gain a thread</th></tr></thead>\
         <tbody>{body}</tbody></table></div></details>"
    )
}

/// How many times as fast the second is, round by round.
fn gain(one: &Row, many: &Row) -> Option<Interval> {
    let samples = |row: &'_ Row| row.span("shade").map(|timing| timing.nanoseconds.clone());
    let ratios: Vec<f64> = samples(one)?.iter().zip(&samples(many)?).map(|(one, many)| one / many).collect();
    median_interval(&ratios)
}
