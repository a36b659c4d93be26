//! Pareto fronts as plots and tables of the page, and as text.

use crate::chip::{chip, colour};
use crate::format::{bytes, escape, number, time, time_unit};
use crate::plot::{Axes, Point, pareto};
use crate::{Against, Entry, Front, Report, ReportError};
use halflight_metrics::{Measured, Standing};
use std::fmt::Write;

/// The fronts over all scenes; nothing where there are none.
pub(crate) fn over_scenes(report: &Report) -> Result<String, ReportError> {
    let fronts = Against::ALL.map(|against| report.fronts_over_scenes(against, None)).concat();
    let html = html(report, &fronts)?;
    let heading = "<h2 id=\"pareto\">Error against cost, over scenes</h2>";
    Ok(if html.is_empty() { html } else { format!("{heading}{html}") })
}

/// The fronts of one scene.
pub(crate) fn of_scene(report: &Report, scene: &str) -> Result<String, ReportError> {
    let of = |against| report.fronts(against).into_iter().filter(|front| front.scene.as_deref() == Some(scene));
    html(report, &Against::ALL.into_iter().flat_map(of).collect::<Vec<_>>())
}

fn html(report: &Report, fronts: &[Front]) -> Result<String, ReportError> {
    let several =
        fronts.iter().any(|front| (&front.quantity, &front.machine) != (&fronts[0].quantity, &fronts[0].machine));
    let mut html = String::new();
    for front in fronts {
        let points: Vec<Point> = front.entries.iter().map(|entry| point(report, entry)).collect();
        let Some(svg) = pareto(&points, &axes(report, front))? else { continue };
        let what = if several {
            format!(" {} on {}.", escape(&front.quantity), escape(&front.machine))
        } else {
            String::new()
        };
        let _ = write!(
            html,
            "<figure class=\"plot\"><figcaption><b>Error against {}.</b>{what} {}</figcaption><div class=\"plotted\">{svg}<ul>{}</ul></div></figure>",
            front.against.name(),
            caption(report, front),
            key(report, front)
        );
        html += &table(report, front);
    }
    Ok(html)
}

fn point(report: &Report, entry: &Entry) -> Point {
    let Entry { label, cost, error, resolved, standing } = *entry;
    Point { number: label + 1, colour: colour(report, label), cost, error, resolved, standing }
}

fn axes(report: &Report, front: &Front) -> Axes {
    let least = front.entries.iter().map(|e| e.cost.value()).filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
    let (unit, name) = match front.against {
        Against::Time => time_unit(least),
        Against::Memory => memory_unit(least),
    };
    let (what, interval) = match front.against {
        Against::Time => ("shade time", "median and 95% interval"),
        Against::Memory => ("memory held after shading", "exact"),
    };
    match &front.relative {
        Some(relative) => {
            let base = format!(
                "relative to number {}, geometric mean over {} scenes",
                relative.base + 1,
                relative.scenes.len()
            );
            Axes {
                cost: format!("{what} {base}"),
                unit: 1.0,
                error: format!("RMSE against {}, relative", front.reference),
                noise: None,
            }
        }
        None => {
            let scene = report.scenes.iter().find(|scene| Some(&scene.name) == front.scene.as_ref());
            let noise = scene.map(|scene| (scene.standard_error(&front.reference), front.reference.clone()));
            let error = format!("RMSE against {}, radiance", front.reference);
            Axes { cost: format!("{what}, {name} ({interval})"), unit, error, noise }
        }
    }
}

fn memory_unit(bytes: f64) -> (f64, &'static str) {
    match bytes {
        b if b >= 1_048_576.0 => (1_048_576.0, "MiB"),
        b if b >= 1024.0 => (1024.0, "KiB"),
        _ => (1.0, "bytes"),
    }
}

fn caption(report: &Report, front: &Front) -> String {
    let mut text = String::from(
        "Lower left is better. On the line and listed: the Pareto front, which no setting beats. Small and faint: dominated, by \
         more than the uncertainty. Off the line and full: beaten by less than that. Hollow: the error is not resolved.",
    );
    if let Some(relative) = &front.relative {
        let scenes: Vec<String> = relative.scenes.iter().map(|scene| escape(scene)).collect();
        let _ = write!(
            text,
            " Figures are geometric means, over {}, of the ratio to {}{}: every scene weighs alike, and another base would change no \
             order. Whiskers: how well these scenes' mean is known.",
            scenes.join(", "),
            chip(report, relative.base),
            escape(&report.labels[relative.base])
        );
        if relative.left_out > 0 {
            let _ = write!(text, " Not in it: {} settings that lack one of the scenes.", relative.left_out);
        }
    }
    text
}

/// The settings on the front.
fn key(report: &Report, front: &Front) -> String {
    let shown = front.entries.iter().filter(|entry| entry.standing == Standing::Front);
    shown
        .map(|entry| format!("<li>{}{}</li>", chip(report, entry.label), escape(&report.labels[entry.label])))
        .collect()
}

fn table(report: &Report, front: &Front) -> String {
    let mut rows = String::new();
    for entry in &front.entries {
        let (class, standing) = match entry.standing {
            Standing::Front => ("best", "on the front".to_owned()),
            Standing::Undecided => ("", "beaten within the uncertainty".to_owned()),
            Standing::Dominated { by } => {
                ("skipped", format!("dominated by {}", chip(report, front.entries[by].label)))
            }
        };
        let _ = write!(
            rows,
            "<tr><th>{}{}</th><td>{}</td><td>{}</td><td class=\"text {class}\">{standing}</td></tr>",
            chip(report, entry.label),
            escape(&report.labels[entry.label]),
            cost(front, entry),
            error(entry),
        );
    }
    let counts = counts(front);
    format!(
        "<details><summary>Standing by error and {}: {counts}</summary><div class=\"wide\"><table><thead><tr><th>setting</th>\
         <th>{}</th><th>RMSE</th><th class=\"text\">standing</th></tr></thead><tbody>{rows}</tbody></table></div></details>",
        front.against.name(),
        front.against.name()
    )
}

/// How many settings stand how.
fn counts(front: &Front) -> String {
    let count = |wanted: fn(&Standing) -> bool| front.entries.iter().filter(|entry| wanted(&entry.standing)).count();
    let dominated = count(|s| matches!(s, Standing::Dominated { .. }));
    let (on, undecided) = (count(|s| *s == Standing::Front), count(|s| *s == Standing::Undecided));
    format!("{on} on the front, {undecided} beaten within the uncertainty, {dominated} dominated")
}

fn cost(front: &Front, entry: &Entry) -> String {
    let one = |value: f64| match (&front.relative, front.against) {
        (Some(_), _) => format!("×{}", number(value)),
        (None, Against::Time) => time(value),
        (None, Against::Memory) => bytes(value as u64),
    };
    interval(&entry.cost, one)
}

fn error(entry: &Entry) -> String {
    match entry.resolved {
        true => interval(&entry.error, number),
        false => format!("&lt; {} not resolved", number(entry.error.high())),
    }
}

fn interval(value: &Measured, text: impl Fn(f64) -> String) -> String {
    let (low, middle, high) = (text(value.low()), text(value.value()), text(value.high()));
    if low == high { middle } else { format!("{middle}<small>{low} to {high}</small>") }
}

impl Front {
    /// The front as lines of text. What is dominated is counted only, unless `all` is asked for.
    pub fn text(&self, report: &Report, all: bool) -> String {
        let place = match (&self.scene, &self.relative) {
            (Some(scene), _) => scene.clone(),
            (None, Some(relative)) => {
                let base = &report.labels[relative.base];
                let scenes = relative.scenes.join(", ");
                format!("over {scenes} (geometric means of ratios to {base})")
            }
            (None, None) => String::new(),
        };
        let mut text =
            format!("{} · {place}: error against {}; {}\n", self.quantity, self.against.name(), counts(self));
        let line = |entry: &Entry| {
            let (mark, by) = match entry.standing {
                Standing::Front => ("★", String::new()),
                Standing::Undecided => ("≈", " (beaten within the uncertainty)".to_owned()),
                Standing::Dominated { by } => {
                    ("·", format!(" (dominated by {})", report.labels[self.entries[by].label]))
                }
            };
            [
                mark.to_owned(),
                plain(&cost(self, entry)),
                plain(&error(entry)),
                format!("{}{by}", report.labels[entry.label]),
            ]
        };
        let shown = |entry: &&Entry| all || !matches!(entry.standing, Standing::Dominated { .. });
        let lines: Vec<[String; 4]> = self.entries.iter().filter(shown).map(line).collect();
        let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let (cost, error) = (width(1), width(2));
        for [mark, c, e, setting] in &lines {
            let _ = writeln!(text, "  {mark} {c:cost$}  RMSE {e:error$}  {setting}");
        }
        text
    }
}

/// A figure of the page as text.
fn plain(html: &str) -> String {
    html.replace("<small>", " (").replace("</small>", ")").replace("&lt;", "<")
}
