//! The page of an error budget: the walk from the truth to a method, one approximation a step.

use crate::ReportError;
use crate::figures::legend;
use crate::format::{escape, number, plus_minus};
use crate::page::shell;
use crate::raster::{displayed, error_map, error_scale};
use crate::report::replace;
use halflight_metrics::{Difference, Exposure};
use halflight_results::{Layout, Picture};
use std::fmt::Write;
use std::path::Path;

/// An error budget.
#[derive(Clone, Debug)]
pub struct Budget {
    /// Scene, method and quantity.
    pub title: String,
    /// The method's parameters.
    pub settings: String,
    /// Approximations that could not be walked, each with its reason.
    pub left_out: Vec<String>,
    /// The steps; the first is the truth.
    pub steps: Vec<BudgetStep>,
}

/// A step of an error budget.
#[derive(Clone, Debug)]
pub struct BudgetStep {
    /// What it adds to the step before.
    pub name: String,
    /// One line: what that is.
    pub about: String,
    /// Radiance with everything so far.
    pub picture: Picture,
    /// Its difference from the truth; none for the truth itself.
    pub from_truth: Option<Difference>,
    /// Its difference from the step before; none for the truth.
    pub change: Option<Difference>,
}

impl Budget {
    /// Writes the page; an older one is replaced whole or not at all.
    ///
    /// # Errors
    /// A picture could not be encoded, or the page not be written.
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        replace(path, &self.html()?)
    }

    /// The page, which loads nothing from anywhere.
    ///
    /// # Errors
    /// A picture could not be encoded.
    pub fn html(&self) -> Result<String, ReportError> {
        let left_out: String = self.left_out.iter().map(|why| format!("<li>left out: {}</li>", escape(why))).collect();
        let body = [
            format!(
                "<p class=\"lead\">From the truth to the method, one approximation a step.</p><p class=\"note\">{}</p>",
                escape(&self.settings)
            ),
            self.table(),
            if left_out.is_empty() { left_out } else { format!("<ul class=\"warnings\">{left_out}</ul>") },
            self.pictures()?,
        ];
        Ok(shell(&format!("Error budget: {}", self.title), &body.concat(), ""))
    }

    fn table(&self) -> String {
        let largest = self.steps.iter().filter_map(|step| Some(step.change?.rmse)).fold(0.0, f64::max);
        let mut html = String::from(
            "<div class=\"wide\"><table><thead><tr><th>step</th><th>RMSE from truth</th><th>RMSE of the step</th>\
             <th></th><th>bias of the step</th><th>noise</th></tr></thead><tbody>",
        );
        for step in &self.steps {
            let share = step.change.map_or(0.0, |d| if d.resolved { 100.0 * d.rmse / largest } else { 0.0 });
            let _ = write!(
                html,
                "<tr><th>{}<small>{}</small></th><td>{}</td><td>{}</td>\
                 <td class=\"text\"><span class=\"share\"><i style=\"width:{share:.1}%\"></i></span></td><td>{}</td><td>{}</td></tr>",
                escape(&step.name),
                escape(&step.about),
                step.from_truth.as_ref().map_or("–".into(), rmse),
                step.change.as_ref().map_or("–".into(), rmse),
                step.change.as_ref().map_or("–".into(), bias),
                step.change.map_or("–".into(), |d| number(d.noise)),
            );
        }
        html + "</tbody></table></div><p class=\"note\">Radiance. Every step keeps all that came before. References are sampled and have \
                noise: its mean square (last column: the root, of one receiver's difference) is taken out of every RMSE, and ± is the standard error of \
                what remains. <i>Not resolved</i>: the difference does not stand out of the noise by two standard errors, \
                and is known only to lie below the bound. Steps may undo one another's errors, so their RMSE do not add up.</p>"
    }

    fn pictures(&self) -> Result<String, ReportError> {
        let Some(truth) = self.steps.first().map(|step| &step.picture) else { return Ok(String::new()) };
        if let Layout::List(count) = truth.layout {
            return Ok(format!("<p class=\"note\">No pictures: the receivers are a list of {count} points.</p>"));
        }
        let exposure = Exposure::of_reference(&truth.radiance, &truth.valid);
        let pairs = || self.steps.windows(2).map(|pair| (&pair[1].picture, &pair[0].picture));
        let scale = error_scale(pairs());
        let mut html =
            legend(exposure, "truth", "luminance difference from the step before", ["darker", "brighter"], scale);
        html += "<div class=\"walk\">";
        for (i, step) in self.steps.iter().enumerate() {
            let shown = figure(&displayed(&step.picture, exposure)?, &step.name);
            let change = match i.checked_sub(1).map(|before| &self.steps[before]) {
                Some(before) => figure(
                    &error_map(&step.picture, &before.picture, scale)?,
                    &format!("{} − {}", step.name, before.name),
                ),
                None => String::new(),
            };
            let told = step
                .change
                .as_ref()
                .map_or("the scene itself".to_owned(), |d| format!("RMSE {} · bias {}", rmse(d), bias(d)));
            let _ = write!(
                html,
                "<section><h4>{}</h4><p class=\"caption\">{told}</p>{shown}{change}</section>",
                escape(&step.name)
            );
        }
        Ok(html + "</div>")
    }
}

fn figure(address: &str, name: &str) -> String {
    format!("<img class=\"picture\" src=\"{address}\" alt=\"{}\">", escape(name))
}

fn rmse(d: &Difference) -> String {
    if d.resolved {
        plus_minus(d.rmse, d.rmse_error)
    } else {
        format!("<span class=\"unresolved\">not resolved, &lt; {}</span>", number(d.rmse_bound))
    }
}

fn bias(d: &Difference) -> String {
    let sign = if d.bias > 0.0 { "+" } else { "" };
    format!("{sign}{}", plus_minus(d.bias, d.bias_error))
}
