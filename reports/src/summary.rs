//! The summary matrix: who wins where, and who only seems to.

use crate::chip::chip;
use crate::format::{escape, number, time};
use crate::{Absent, Report, Row, Scene};
use halflight_metrics::Interval;
use std::fmt::Write;

/// What to say of one value in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mark {
    /// The best, by more than the noise.
    Best,
    /// Not told apart from the best.
    Tied,
    /// Smaller than can be measured.
    Unresolved,
    /// None of these.
    Plain,
}

/// Marks errors against one reference. A win must exceed the reference's standard error: within it of the smallest, all
/// are tied; where one error is itself not resolved, nobody else can have won; and nobody wins alone.
pub(crate) fn mark_errors(errors: &[Option<(f64, bool)>], standard_error: f64) -> Vec<Mark> {
    let known = || errors.iter().flatten();
    let smallest = known().map(|(e, _)| *e).fold(f64::INFINITY, f64::min);
    let contest = known().count() > 1 && known().all(|(_, resolved)| *resolved);
    let near = |e: f64| e - smallest <= standard_error;
    let tied = known().filter(|(e, _)| near(*e)).count() > 1;
    let mark = |error: &Option<(f64, bool)>| match error {
        Some((_, false)) => Mark::Unresolved,
        Some((e, true)) if contest && near(*e) => {
            if tied {
                Mark::Tied
            } else {
                Mark::Best
            }
        }
        _ => Mark::Plain,
    };
    errors.iter().map(mark).collect()
}

/// Marks times: the smallest median wins, those whose interval overlaps its interval are tied with it; nobody wins alone.
pub(crate) fn mark_times(times: &[Option<Interval>]) -> Vec<Mark> {
    let known = || times.iter().flatten();
    let first = match known().min_by(|a, b| a.median.total_cmp(&b.median)) {
        Some(first) if known().count() > 1 => first,
        _ => return vec![Mark::Plain; times.len()],
    };
    let near = |t: &Interval| t.low <= first.high;
    let tied = known().filter(|t| near(t)).count() > 1;
    let best = if tied { Mark::Tied } else { Mark::Best };
    times.iter().map(|t| if t.as_ref().is_some_and(near) { best } else { Mark::Plain }).collect()
}

/// The matrix as a table: a row a setting, a column a scene.
pub(crate) fn matrix(report: &Report) -> String {
    let names = scene_names(report);
    let mut html = String::from("<div class=\"wide\"><table class=\"matrix\"><thead><tr><th>setting</th>");
    names.iter().for_each(|name| html += &heading(report, name));
    html += "</tr></thead><tbody>";
    let columns: Vec<Vec<String>> = names.iter().map(|name| column(report, name)).collect();
    for (label, name) in report.labels.iter().enumerate() {
        let _ = write!(html, "<tr><th>{}{}</th>", chip(report, label), escape(name));
        columns.iter().for_each(|column| html += &column[label]);
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}

fn heading(report: &Report, name: &str) -> String {
    let Some(section) = report.scenes.iter().position(|s| s.name == *name) else {
        return format!("<th>{}</th>", escape(name));
    };
    let scene = &report.scenes[section];
    let against = scene.main_reference().map_or("no reference".into(), |reference| {
        format!("against {}, ±{}", escape(reference), number(scene.standard_error(reference)))
    });
    format!("<th><a href=\"#scene-{section}\">{}</a><small>{against}</small></th>", escape(name))
}

/// All scenes, those without a single run last.
fn scene_names(report: &Report) -> Vec<String> {
    let mut names: Vec<String> = report.scenes.iter().map(|s| s.name.clone()).collect();
    for absent in report.skips.iter().chain(&report.failures) {
        if !names.contains(&absent.scene) {
            names.push(absent.scene.clone());
        }
    }
    names
}

/// One scene's cells, a label each.
fn column(report: &Report, name: &str) -> Vec<String> {
    let scene = report.scenes.iter().find(|s| s.name == *name);
    let row = |label: usize| scene.and_then(|s| s.rows.iter().find(|r| r.label == label));
    let rows: Vec<Option<&Row>> = (0..report.labels.len()).map(row).collect();
    let reference = scene.and_then(Scene::main_reference).unwrap_or_default();
    let errors: Vec<_> = rows.iter().map(|r| error(r.as_ref()?, reference)).collect();
    let times: Vec<_> = rows.iter().map(|r| r.as_ref()?.shade_time()).collect();
    let noise = scene.map_or(0.0, |s| s.standard_error(reference));
    let marks = mark_errors(&errors, noise).into_iter().zip(mark_times(&times));
    marks
        .enumerate()
        .map(|(label, (error_mark, time_mark))| match rows[label] {
            Some(_) => format!("<td>{}{}</td>", error_cell(errors[label], noise, error_mark), {
                let time = times[label].map_or("–".into(), |t| time(t.median));
                format!("<small>{}</small>", marked(&time, time_mark, "fastest"))
            }),
            None => absent_cell(report, name, label),
        })
        .collect()
}

fn error(row: &Row, reference: &str) -> Option<(f64, bool)> {
    let score = row.score(reference)?;
    Some((*score.measures.get("rmse")?, score.resolved))
}

fn error_cell(error: Option<(f64, bool)>, noise: f64, mark: Mark) -> String {
    match (error, mark) {
        (None, _) => "not scored".into(),
        (_, Mark::Unresolved) => format!("<span class=\"unresolved\">&lt; {} not resolved</span>", number(noise)),
        (Some((e, _)), _) => marked(&number(e), mark, "lowest error"),
    }
}

fn marked(text: &str, mark: Mark, what: &str) -> String {
    match mark {
        Mark::Best => format!("<b title=\"{what}\">{text}&nbsp;★</b>"),
        Mark::Tied => format!("<b title=\"{what}, tied\">{text}&nbsp;≈</b>"),
        Mark::Unresolved | Mark::Plain => text.to_owned(),
    }
}

fn absent_cell(report: &Report, scene: &str, label: usize) -> String {
    let find = |list: &[Absent]| list.iter().find(|a| a.scene == scene && a.label == label).map(|a| escape(&a.why));
    if let Some(why) = find(&report.failures) {
        return format!("<td class=\"failed\" title=\"{why}\"><a href=\"#absent\">failed</a></td>");
    }
    match find(&report.skips) {
        Some(why) => format!("<td class=\"skipped\" title=\"{why}\"><a href=\"#absent\">skipped</a></td>"),
        None => "<td class=\"skipped\">–</td>".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_win_exceeds_the_noise() {
        use Mark::{Best, Plain, Tied, Unresolved};
        let ok = |e| Some((e, true));
        assert_eq!(mark_errors(&[ok(0.5), ok(0.2), None, ok(0.9)], 0.1), [Plain, Best, Plain, Plain]);
        assert_eq!(mark_errors(&[ok(0.5), ok(0.2), ok(0.25)], 0.1), [Plain, Tied, Tied]);
        assert_eq!(mark_errors(&[ok(0.2), Some((0.05, false))], 0.1), [Plain, Unresolved]);
        assert_eq!(mark_errors(&[ok(0.2), None], 0.1), [Plain, Plain]);
        assert_eq!(mark_errors(&[], 0.1), []);
    }

    #[test]
    fn times_win_when_intervals_do_not_touch() {
        let t = |median, low, high| Some(Interval { median, low, high, count: 5 });
        assert_eq!(mark_times(&[t(3.0, 2.5, 3.5), t(1.0, 0.9, 1.1), None]), [Mark::Plain, Mark::Best, Mark::Plain]);
        assert_eq!(mark_times(&[t(1.2, 1.05, 3.5), t(1.0, 0.9, 1.1)]), [Mark::Tied, Mark::Tied]);
        assert_eq!(mark_times(&[None, t(1.0, 0.9, 1.1)]), [Mark::Plain, Mark::Plain]);
    }
}
