//! What other programs say to the truth: its picture, theirs, and how probable the difference is.

use crate::format::{count, escape, number};
use crate::raster::{DIVERGING, displayed, probability_map};
use crate::{CrossCheck, ReportError};
use halflight_metrics::Exposure;
use halflight_results::{Layout, Picture};
use std::fmt::Write;

/// Receivers below this p are at most this share of honest ones.
const RARE: f32 = 0.05;

/// The section; nothing where there are no cross-checks.
pub(crate) fn section(checks: &[CrossCheck]) -> Result<String, ReportError> {
    if checks.is_empty() {
        return Ok(String::new());
    }
    let agree = checks.iter().filter(|check| check.record.agrees).count();
    let mut html = format!(
        "<h2 id=\"cross-checks\">Cross-checks with Mitsuba 3</h2><p class=\"note\">The truth held against an independent renderer \
         at the same receivers: {agree} of {} agree. Two tests, Bonferroni-corrected, each with p as given: whether any receiver \
         is off (family-wise p over receivers and channels), and whether all are on average. {}</p><div class=\"rows\">",
        checks.len(),
        scale()
    );
    for check in checks {
        let class = if check.record.agrees { "agrees" } else { "failed" };
        let _ = write!(
            html,
            "<section class=\"row\"><h4>{} · {}</h4><p class=\"caption\"><b class=\"{class}\">{}</b> · {}</p>{}</section>",
            escape(&check.record.scene),
            escape(&check.record.quantity),
            if check.record.agrees { "agrees" } else { "differs" },
            figures(check),
            pictures(check)?
        );
    }
    Ok(html + "</div>")
}

/// The numbers of a check.
fn figures(check: &CrossCheck) -> String {
    let record = &check.record;
    let [ours, theirs] = record.samples;
    let percent = |sum: f64| number(100.0 * sum / (3.0 * record.level));
    let mut parts = vec![
        escape(&record.program),
        format!("{} receivers", count(record.receivers as u64)),
        format!("{} and {} samples", count(ours.into()), count(theirs.into())),
        format!("largest |z| {}, p {}", record.largest.map_or("∞".into(), number), number(record.family_p)),
        format!(
            "truth's excess {}\u{a0}±\u{a0}{}\u{a0}%, p {}",
            percent(record.bias.iter().sum()),
            percent(record.bias_error.iter().sum()),
            number(record.bias_p)
        ),
    ];
    let rare = |map: &Picture| {
        let tested = map.radiance.iter().zip(&map.valid).filter(|(_, valid)| **valid);
        let below = tested.clone().filter(|(p, _)| p.x < RARE).count();
        100.0 * below as f64 / tested.count().max(1) as f64
    };
    parts.extend(
        check.receiver_p.as_ref().map(|map| format!("p below {RARE} at {}\u{a0}% of receivers", number(rare(map)))),
    );
    parts.join(" · ")
}

fn pictures(check: &CrossCheck) -> Result<String, ReportError> {
    let (Some(ours), Some(theirs), Some(map)) = (&check.ours, &check.theirs, &check.receiver_p) else {
        return Ok(String::new());
    };
    if let Layout::List(count) = ours.layout {
        return Ok(format!("<p class=\"note\">No pictures: the receivers are a list of {count} points.</p>"));
    }
    let exposure = Exposure::of_reference(&ours.radiance, &ours.valid);
    Ok([
        "<div class=\"triple\">".to_owned(),
        figure(ours, &displayed(ours, exposure)?, "truth"),
        figure(theirs, &displayed(theirs, exposure)?, &check.record.program),
        figure(map, &probability_map(map, odd(check.record.receivers))?, "p of each receiver"),
        "</div>".to_owned(),
    ]
    .concat())
}

fn figure(picture: &Picture, address: &str, caption: &str) -> String {
    let ((width, height), caption) = (picture.layout.size(), escape(caption));
    format!(
        "<figure><svg class=\"picture\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{caption}\">\
         <image width=\"{width}\" height=\"{height}\" href=\"{address}\"/></svg><figcaption>{caption}</figcaption></figure>"
    )
}

/// Any receiver below this p is seen once in twenty honest pictures.
fn odd(receivers: usize) -> f64 {
    0.05 / receivers.max(1) as f64
}

fn scale() -> String {
    let stops: Vec<String> =
        DIVERGING[DIVERGING.len() / 2..].iter().map(|[r, g, b]| format!("rgb({r},{g},{b})")).collect();
    format!(
        "Maps show each receiver's p (uniform at most, if both are right): <span class=\"scale\"><span>1</span><span class=\"bar\" \
         style=\"background:linear-gradient(to right,{})\"></span><span>0.05 over the number of receivers</span></span>, by its \
         logarithm; what one honest map in twenty has anywhere is darkest.",
        stops.join(",")
    )
}
