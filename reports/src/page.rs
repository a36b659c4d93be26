//! The page: header, summary, a section a scene, what was not run, and how to read it all.

use crate::chip::chip;
use crate::format::escape;
use crate::summary::matrix;
use crate::{Absent, Report, ReportError, backends, criterion, crosschecks, figures, pareto, rates, scaling, tables};
use std::fmt::Write;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const GUIDE: &str = include_str!("guide.html");

/// The whole page.
pub(crate) fn html(report: &Report) -> Result<String, ReportError> {
    let mut sections = String::new();
    for section in 0..report.scenes.len() {
        sections += &scene(report, section)?;
    }
    let body = [
        header(report),
        warnings(report),
        GUIDE.to_owned(),
        "<h2 id=\"summary\">Summary</h2>".to_owned(),
        summary(report),
        pareto::over_scenes(report)?,
        backends::section(report),
        rates::section(&report.rates),
        sections,
        scaling::section(report)?,
        crosschecks::section(&report.cross_checks)?,
        criterion::section(&report.benchmarks),
        absent(report),
        "<h2>Settings in full</h2>".to_owned(),
        tables::settings(report),
    ];
    Ok(shell(&report.title, &body.concat(), SCRIPT))
}

/// A page that stands by itself.
pub(crate) fn shell(title: &str, body: &str, script: &str) -> String {
    let title = escape(title);
    [
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">",
        "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">",
        // Nothing may be loaded, whatever a name in the data says.
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
         script-src 'unsafe-inline'; img-src data:\">",
        &format!("<title>{title}</title><style>{STYLE}</style></head><body><main><h1>{title}</h1>"),
        body,
        &format!("</main><script>{script}</script></body></html>\n"),
    ]
    .concat()
}

fn header(report: &Report) -> String {
    let runs: usize = report.scenes.iter().map(|s| s.rows.len()).sum();
    let mut html = format!(
        "<p class=\"lead\">{runs} runs of {} settings in {} scenes; {} skipped, {} failed.</p><dl class=\"machine\">",
        report.labels.len(),
        report.scenes.len(),
        report.skips.len(),
        report.failures.len()
    );
    for e in &report.environments {
        let _ = write!(
            html,
            "<dt>machine</dt><dd>{}, {} logical cores, {} threads used, {}</dd><dt>build</dt><dd>halflight {}, {}, {}</dd>",
            escape(&e.cpu),
            e.cores,
            e.threads,
            escape(&e.os),
            escape(&e.halflight),
            escape(&e.profile),
            escape(&e.rustc)
        );
    }
    html + "</dl>"
}

fn warnings(report: &Report) -> String {
    let items = report.warnings.iter().map(|w| format!("<li>{}</li>", escape(w))).collect::<String>();
    if items.is_empty() { items } else { format!("<ul class=\"warnings\">{items}</ul>") }
}

fn summary(report: &Report) -> String {
    if report.labels.is_empty() {
        return "<p>The store is empty: nothing was run yet.</p>".into();
    }
    format!(
        "{}<p class=\"note\">Upper line: RMSE (radiance) against the reference named in the column, ± its own standard \
         error. Lower line: median shade time. ★ the best by more than the noise; ≈ not told apart from the best. Where an error is \
         not resolved, no error is marked.</p>",
        matrix(report)
    )
}

fn scene(report: &Report, section: usize) -> Result<String, ReportError> {
    let scene = &report.scenes[section];
    Ok([
        format!("<h2 id=\"scene-{section}\">{}</h2>", escape(&scene.name)),
        figures::figures(report, section)?,
        pareto::of_scene(report, &scene.name)?,
        backends::columns(report, scene),
        backends::maps(report, scene)?,
        tables::tables(report, scene),
    ]
    .concat())
}

fn absent(report: &Report) -> String {
    let mut html = String::from("<h2 id=\"absent\">Skipped and failed</h2>");
    if report.skips.is_empty() && report.failures.is_empty() {
        return html + "<p>None: every planned cell was run.</p>";
    }
    html +=
        "<div class=\"wide\"><table><thead><tr><th>setting</th><th>scene</th><th></th><th>why</th></tr></thead><tbody>";
    let list = |list: &[Absent], class: &str, html: &mut String| {
        for absent in list {
            let _ = write!(
                html,
                "<tr><th>{}{}</th><td class=\"text\">{}</td><td class=\"{class}\">{class}</td><td class=\"text\">{}</td></tr>",
                chip(report, absent.label),
                escape(&report.labels[absent.label]),
                escape(&absent.scene),
                escape(&absent.why)
            );
        }
    };
    list(&report.failures, "failed", &mut html);
    list(&report.skips, "skipped", &mut html);
    html + "</tbody></table></div>"
}
