//! How far the pictures of graphics processors are from the processor's.

use super::columns::heading;
use super::pairs::{Outcome, Pair, pairs};
use crate::format::{count, escape, number};
use crate::raster::{difference_scale, error_map};
use crate::{Report, ReportError, Scene};
use halflight_metrics::Apart;
use halflight_results::Layout;
use std::fmt::Write;

const COLUMNS: &str = "<tr><th>setting</th><th title=\"largest absolute difference of a channel, radiance\">largest</th>\
    <th title=\"of a picture from its upper left corner, or a receiver's number\">at</th>\
    <th title=\"root mean square difference of a channel, radiance\">RMSE apart</th>\
    <th title=\"mean signed difference, GPU less CPU, radiance\">bias</th>\
    <th title=\"RMSE apart over the root mean square of the CPU's picture\">over level</th>\
    <th title=\"RMSE apart over the CPU's own error against the reference\">over its error</th>\
    <th title=\"receivers with a NaN or infinity in one picture\">not finite</th><th>receivers</th></tr>";

/// The section: every pair of every scene; nothing where nothing was meant for a graphics processor.
pub(crate) fn section(report: &Report) -> String {
    let scenes: Vec<(&Scene, Vec<Pair<'_>>)> =
        report.scenes.iter().map(|scene| (scene, pairs(report, &scene.name))).collect();
    if scenes.iter().all(|(_, pairs)| pairs.is_empty()) {
        return String::new();
    }
    let mut body = String::new();
    for (scene, pairs) in scenes.iter().filter(|(_, pairs)| !pairs.is_empty()) {
        let error = scene.main_reference().map_or(String::new(), |id| format!(" · errors against {}", escape(id)));
        let _ = write!(body, "<tbody><tr class=\"group\"><th colspan=\"9\">{}{error}</th></tr>", escape(&scene.name));
        pairs.iter().for_each(|pair| body += &row(report, scene, pair));
        body += "</tbody>";
    }
    let note = "A difference is a channel of a receiver, GPU less CPU, in radiance: what is left is rounding, or a mistake. What each \
                method may differ by is derived and tested (docs/gpu.md); here is what it does.";
    format!(
        "<h2 id=\"backends\">CPU against GPU</h2><p class=\"lead\">{}</p><p class=\"note\">{note}</p><div class=\"wide\">\
         <table><thead>{COLUMNS}</thead>{body}</table></div>",
        told(&scenes)
    )
}

/// In a sentence: how many pairs, which differs most, and what is wrong or missing.
fn told(scenes: &[(&Scene, Vec<Pair<'_>>)]) -> String {
    let (mut compared, mut broken, mut single) = (0, 0, 0);
    let mut worst: Option<(f64, &Scene)> = None;
    for (scene, pair) in scenes.iter().flat_map(|(scene, pairs)| pairs.iter().map(move |pair| (*scene, pair))) {
        match pair.apart() {
            None => single += 1,
            Some(Ok(apart)) if apart.is_whole() => {
                compared += 1;
                let share = share(apart.rmse, Some(apart.level)).unwrap_or(0.0);
                if worst.is_none_or(|(worst, _)| share > worst) {
                    worst = Some((share, scene));
                }
            }
            Some(_) => broken += 1,
        }
    }
    let mut text = match worst {
        Some((share, scene)) => {
            format!(
                "{compared} pairs of pictures; most apart are two of {}, by {} of the level.",
                escape(&scene.name),
                number(share)
            )
        }
        None => "No pair of pictures could be compared.".to_owned(),
    };
    if broken > 0 {
        let _ = write!(text, " <b class=\"failed\">{broken} pairs have values that cannot be compared.</b>");
    }
    if single > 0 {
        let _ = write!(text, " {single} cells have no twin to be held against.");
    }
    let elsewhere: Vec<String> =
        scenes.iter().filter(|(_, pairs)| pairs.is_empty()).map(|(scene, _)| escape(&scene.name)).collect();
    if !elsewhere.is_empty() {
        let _ = write!(text, " On the CPU alone: {}.", elsewhere.join(", "));
    }
    text
}

fn row(report: &Report, scene: &Scene, pair: &Pair<'_>) -> String {
    let heading = heading(report, pair);
    let apart = match pair.apart() {
        None => return format!("<tr>{heading}<td class=\"skipped text\" colspan=\"8\">{}</td></tr>", alone(pair)),
        Some(Err(why)) => {
            return format!("<tr>{heading}<td class=\"failed text\" colspan=\"8\">{}</td></tr>", escape(&why));
        }
        Some(Ok(apart)) => apart,
    };
    let layout = pair.cpu.row().and_then(|row| row.picture.as_ref()).map(|picture| picture.layout);
    let error = pair.cpu.row().zip(scene.main_reference()).and_then(|(row, id)| row.measure(id, "rmse"));
    let percent = |of| share(apart.rmse, of).map_or("–".into(), |share| format!("{} %", number(100.0 * share)));
    let finite = match (apart.not_finite, apart.lone) {
        (0, 0) => "<td>0</td>".into(),
        (bad, 0) => format!("<td class=\"failed\"><b>{}</b></td>", count(bad as u64)),
        (bad, lone) => {
            format!(
                "<td class=\"failed\"><b>{}</b><small>{} valid in one alone</small></td>",
                count(bad as u64),
                count(lone as u64)
            )
        }
    };
    let [max, rmse, bias] = match apart {
        Apart { receivers: 0, .. } => ["–".into(), "–".into(), "–".into()],
        _ if apart.is_nothing() => ["equal".into(), "0".into(), "0".into()],
        _ => [apart.max, apart.rmse, apart.bias].map(number),
    };
    let at = apart.worst.zip(layout).map_or("–".into(), |(receiver, layout)| place(receiver, layout));
    format!(
        "<tr>{heading}<td>{max}</td><td>{at}</td><td>{rmse}</td><td>{bias}</td><td>{}</td><td>{}</td>{finite}<td>{}</td></tr>",
        percent(Some(apart.level)),
        percent(error),
        count(apart.receivers as u64)
    )
}

/// Why a cell has no twin.
fn alone(pair: &Pair<'_>) -> String {
    let side = |name: &str, outcome: Outcome<'_>| match outcome {
        Outcome::Run(_) => None,
        Outcome::Skipped(absent) => Some(format!("{name} skipped: {}", absent.why)),
        Outcome::Failed(absent) => Some(format!("{name} failed: {}", absent.why)),
        Outcome::Missing => Some(format!("no twin on the {name} in these results")),
    };
    let told: Vec<String> = [side("CPU", pair.cpu), side("GPU", pair.gpu)].into_iter().flatten().collect();
    escape(&told.join("; "))
}

fn share(part: f64, whole: Option<f64>) -> Option<f64> {
    whole.filter(|whole| *whole > 0.0).map(|whole| part / whole)
}

/// A receiver as people find it.
fn place(receiver: usize, layout: Layout) -> String {
    match layout {
        Layout::Image { width, .. } => format!("{}, {}", receiver % width, receiver / width),
        Layout::List(_) => format!("receiver {receiver}"),
    }
}

/// Maps of what differs, each at its own scale; nothing where nothing does or receivers make no picture.
pub(crate) fn maps(report: &Report, scene: &Scene) -> Result<String, ReportError> {
    let mut html = String::new();
    for pair in pairs(report, &scene.name) {
        let (Some(Ok(apart)), [Some(cpu), Some(gpu)]) = (pair.apart(), [pair.cpu, pair.gpu].map(Outcome::row)) else {
            continue;
        };
        let (Some(cpu), Some(gpu)) = (&cpu.picture, &gpu.picture) else { continue };
        if apart.is_nothing() || matches!(cpu.layout, Layout::List(_)) {
            continue;
        }
        let (scale, (width, height)) = (difference_scale(apart.max), cpu.layout.size());
        let address = error_map(gpu, cpu, scale)?;
        let name = escape(&report.settings[pair.label()]);
        let _ = write!(
            html,
            "<figure><svg class=\"picture\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"GPU less CPU, {name}\">\
             <image width=\"{width}\" height=\"{height}\" href=\"{address}\"/></svg><figcaption>{name}: GPU − CPU, blue to red \
             ±{}</figcaption></figure>",
            number(scale)
        );
    }
    Ok(if html.is_empty() { html } else { format!("<div class=\"triple maps\">{html}</div>") })
}
