//! A scene's pictures: rows of picture, reference and error, and the viewer.

use crate::chip::chip;
use crate::format::{escape, number, time};
use crate::raster::{DIVERGING, displayed, error_map, error_scale};
use crate::{Report, ReportError, Row, Scene, threads};
use halflight_metrics::Exposure;
use halflight_results::{Layout, Picture};
use std::fmt::Write;

/// An image that is defined once and shown wherever it is needed.
struct Image {
    id: String,
    name: String,
    group: &'static str,
}

/// The pictures of one scene, all at one exposure and one error scale.
struct Gallery<'a> {
    report: &'a Report,
    scene: &'a Scene,
    section: usize,
    reference: &'a str,
    truth: &'a Picture,
    exposure: Exposure,
    scale: f64,
    images: Vec<Image>,
    definitions: String,
}

/// The section's pictures as HTML, or a sentence on why there are none.
pub(crate) fn figures(report: &Report, section: usize) -> Result<String, ReportError> {
    let scene = &report.scenes[section];
    let main = scene.references.first().and_then(|r| Some((r.id.as_str(), r.picture.as_ref()?)));
    let Some((reference, truth)) = main else {
        return Ok("<p class=\"note\">No pictures: there is no reference picture to set the exposure.</p>".into());
    };
    if let Layout::List(count) = truth.layout {
        return Ok(format!("<p class=\"note\">No pictures: the receivers are a list of {count} points.</p>"));
    }
    let comparable = scene.rows.iter().filter_map(|row| row.picture.as_ref()).filter(|p| p.layout == truth.layout);
    let mut gallery = Gallery {
        report,
        scene,
        section,
        reference,
        truth,
        exposure: Exposure::of_reference(&truth.radiance, &truth.valid),
        scale: error_scale(comparable.map(|p| (p, truth))),
        images: Vec::new(),
        definitions: String::new(),
    };
    let rows = gallery.rows()?;
    let viewer = gallery.viewer();
    let definitions =
        format!("<svg class=\"definitions\" aria-hidden=\"true\"><defs>{}</defs></svg>", gallery.definitions);
    Ok([definitions, gallery.legend(), rows, viewer].concat())
}

impl Gallery<'_> {
    fn rows(&mut self) -> Result<String, ReportError> {
        let scene = self.scene;
        for reference in &scene.references {
            if let Some(picture) = reference.picture.as_ref().filter(|p| p.layout == self.truth.layout) {
                let address = displayed(picture, self.exposure)?;
                self.define(reference.id.clone(), "references", &address);
            }
        }
        let truth = self.images[0].id.clone();
        let mut html = String::from("<div class=\"rows\">");
        for row in threads::distinct(scene) {
            let Some(picture) = row.picture.as_ref().filter(|p| p.layout == self.truth.layout) else { continue };
            let name = &self.report.labels[row.label];
            let shown = displayed(picture, self.exposure)?;
            let error = error_map(picture, self.truth, self.scale)?;
            let shown = self.define(name.clone(), "methods", &shown);
            let error = self.define(format!("error of {name}"), "signed errors", &error);
            let _ = write!(
                html,
                "<section class=\"row\"><h4>{}{}</h4>{}<div class=\"triple\">{}{}{}</div></section>",
                chip(self.report, row.label),
                escape(name),
                self.caption(row),
                self.figure(&shown, "picture"),
                self.figure(&truth, self.reference),
                self.figure(&error, &format!("picture − {}", self.reference)),
            );
        }
        html.push_str("</div>");
        Ok(html)
    }

    fn define(&mut self, name: String, group: &'static str, address: &str) -> String {
        let id = format!("image-{}-{}", self.section, self.images.len());
        let (width, height) = self.truth.layout.size();
        let _ =
            write!(self.definitions, "<image id=\"{id}\" width=\"{width}\" height=\"{height}\" href=\"{address}\"/>");
        self.images.push(Image { id: id.clone(), name, group });
        id
    }

    fn figure(&self, id: &str, caption: &str) -> String {
        let (width, height) = self.truth.layout.size();
        let caption = escape(caption);
        format!(
            "<figure><svg class=\"picture\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{caption}\">\
             <use href=\"#{id}\"/></svg><figcaption>{caption}</figcaption></figure>"
        )
    }

    fn caption(&self, row: &Row) -> String {
        let mut parts = Vec::new();
        if let Some(score) = row.score(self.reference) {
            let measure = |name: &str| score.measures.get(name).copied();
            match (measure("rmse"), measure("reference_standard_error")) {
                (Some(_), Some(noise)) if !score.resolved => {
                    parts.push(format!("RMSE not resolved (below {})", number(noise)));
                }
                (Some(rmse), _) => parts.push(format!("RMSE {}", number(rmse))),
                _ => {}
            }
            parts.extend(measure("bias").map(|b| format!("bias {}", number(b))));
            parts.extend(measure("flip").map(|f| format!("FLIP {}", number(f))));
        }
        parts.extend(row.shade_time().map(|t| format!("shade {}", time(t.median))));
        parts.extend(guarded(row.run.counters.get("receivers guarded").copied(), row.run.receivers));
        parts.extend(row.run.approximate.as_ref().map(|why| format!("approximate here: {}", escape(why))));
        format!("<p class=\"caption\">{}</p>", parts.join(" · "))
    }

    fn legend(&self) -> String {
        legend(self.exposure, self.reference, "luminance error", ["too dark", "too bright"], self.scale)
    }

    /// Two pictures over each other with a divider to drag, and a button that flips between them.
    fn viewer(&self) -> String {
        let (width, height) = self.truth.layout.size();
        let Some(method) = self.images.iter().position(|i| i.group == "methods") else { return String::new() };
        let (left, right) = (&self.images[0].id, &self.images[method].id);
        let clip = format!("clip-{}", self.section);
        format!(
            "<div class=\"viewer\"><div class=\"controls\"><label>left {}</label><label>right {}</label>\
             <button type=\"button\" title=\"Show the left picture whole, then the right one\">flip</button></div>\
             <svg class=\"picture\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"two pictures to compare\">\
             <clipPath id=\"{clip}\"><rect x=\"{half}\" y=\"0\" width=\"{width}\" height=\"{height}\"/></clipPath>\
             <clipPath id=\"{clip}-left\"><rect x=\"0\" y=\"0\" width=\"{half}\" height=\"{height}\"/></clipPath>\
             <g clip-path=\"url(#{clip}-left)\"><use class=\"left\" href=\"#{left}\"/></g>\
             <g clip-path=\"url(#{clip})\"><use class=\"right\" href=\"#{right}\"/></g>\
             <line class=\"divider\" x1=\"{half}\" x2=\"{half}\" y1=\"0\" y2=\"{height}\"/></svg>\
             <input type=\"range\" min=\"0\" max=\"1000\" value=\"500\" aria-label=\"divider\"></div>",
            self.choice(left),
            self.choice(right),
            half = width as f64 / 2.0,
        )
    }

    fn choice(&self, chosen: &str) -> String {
        let mut html = String::from("<select>");
        for group in ["references", "methods", "signed errors"] {
            let _ = write!(html, "<optgroup label=\"{group}\">");
            for image in self.images.iter().filter(|i| i.group == group) {
                let selected = if image.id == chosen { " selected" } else { "" };
                let _ = write!(html, "<option value=\"{}\"{selected}>{}</option>", image.id, escape(&image.name));
            }
            html.push_str("</optgroup>");
        }
        html + "</select>"
    }
}

/// How pictures are exposed, by which reference, and the colours of signed differences up to a scale.
pub(crate) fn legend(exposure: Exposure, reference: &str, what: &str, [below, above]: [&str; 2], scale: f64) -> String {
    let stops: Vec<String> = DIVERGING.iter().map(|[r, g, b]| format!("rgb({r},{g},{b})")).collect();
    let scale = number(scale);
    format!(
        "<p class=\"legend\">One exposure for all pictures: radiance × {} (the 99th percentile of {} becomes white), \
         sRGB. Signed {what}, one scale for all: <span class=\"scale\"><span>−{scale} {below}</span>\
         <span class=\"bar\" style=\"background:linear-gradient(to right,{})\"></span><span>+{scale} {above}</span>\
         </span> (clipped beyond). Hatched: no receiver.</p>",
        number(f64::from(exposure.scale)),
        escape(reference),
        stops.join(","),
    )
}

/// How many receivers lay outside the method's domain.
fn guarded(count: Option<u64>, receivers: usize) -> Option<String> {
    let share = 100.0 * count? as f64 / receivers.max(1) as f64;
    Some(format!("overlap guard at {} % of receivers", number(share)))
}
