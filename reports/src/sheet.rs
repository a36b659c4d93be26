//! The page of one figure: pictures, plots, tables, and a sentence of what to look at.

use crate::ReportError;
use crate::figures::legend;
use crate::format::escape;
use crate::lines::{Plot, figure};
use crate::page::shell;
use crate::raster::{displayed, error_map, error_scale, grey_map};
use crate::report::replace;
use halflight_metrics::Exposure;
use halflight_results::Picture;
use std::fmt::Write;
use std::path::Path;

/// The page of one figure, put together from top to bottom.
#[derive(Clone, Debug)]
pub struct Sheet {
    title: String,
    body: String,
}

/// A picture on a sheet.
#[derive(Clone, Debug)]
pub struct Shown<'a> {
    /// Above it.
    pub name: String,
    /// Below the name: its numbers.
    pub caption: String,
    /// The picture.
    pub picture: &'a Picture,
    /// What it is held against: the signed difference is shown under it.
    pub against: Option<&'a Picture>,
}

impl Sheet {
    /// A page that begins with what to look at.
    pub fn new(title: &str, look: &str) -> Sheet {
        Sheet { title: title.to_owned(), body: format!("<p class=\"lead\">{}</p>", escape(look)) }
    }

    /// A heading.
    pub fn heading(&mut self, text: &str) {
        let _ = write!(self.body, "<h2>{}</h2>", escape(text));
    }

    /// A paragraph in small print.
    pub fn note(&mut self, text: &str) {
        let _ = write!(self.body, "<p class=\"note\">{}</p>", escape(text));
    }

    /// A table; a row may have fewer cells than there are columns.
    pub fn table(&mut self, columns: &[&str], rows: &[Vec<String>]) {
        let cell = |tag: &str, text: &str| format!("<{tag}>{}</{tag}>", escape(text));
        let head: String = columns.iter().map(|column| cell("th", column)).collect();
        let row = |row: &Vec<String>| {
            let cells = row.iter().enumerate().map(|(i, text)| cell(if i == 0 { "th" } else { "td" }, text));
            format!("<tr>{}</tr>", cells.collect::<String>())
        };
        let rows: String = rows.iter().map(row).collect();
        let _ = write!(
            self.body,
            "<div class=\"wide numbers\"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>"
        );
    }

    /// A plot.
    ///
    /// # Errors
    /// It cannot be drawn.
    pub fn plot(&mut self, plot: &Plot) -> Result<(), ReportError> {
        self.body += &figure(plot)?;
        Ok(())
    }

    /// Pictures side by side, all exposed by the first one; signed differences are all on one scale.
    ///
    /// # Errors
    /// A picture cannot be encoded.
    pub fn pictures(&mut self, pictures: &[Shown<'_>]) -> Result<(), ReportError> {
        let Some(first) = pictures.first() else { return Ok(()) };
        let exposure = Exposure::of_reference(&first.picture.radiance, &first.picture.valid);
        let held = || pictures.iter().filter_map(|shown| Some((shown.picture, shown.against?)));
        let scale = error_scale(held());
        if held().next().is_some() {
            self.body += &legend(exposure, &first.name, "luminance difference", ["darker", "brighter"], scale);
        }
        self.body += "<div class=\"walk sheet\">";
        for Shown { name, caption, picture, against } in pictures {
            let (name, caption) = (escape(name), escape(caption));
            let address = displayed(picture, exposure)?;
            let _ = write!(
                self.body,
                "<section><h4>{name}</h4><p class=\"caption\">{caption}</p>{}",
                image(&address, &name)
            );
            if let Some(against) = against {
                self.body += &image(&error_map(picture, against, scale)?, &format!("difference of {name}"));
            }
            self.body += "</section>";
        }
        self.body += "</div>";
        Ok(())
    }

    /// Numbers as pictures side by side, from black at the first end to white at the second, no transfer curve.
    ///
    /// # Errors
    /// A picture cannot be encoded.
    pub fn maps(&mut self, ends: [f64; 2], maps: &[Shown<'_>]) -> Result<(), ReportError> {
        self.note(&format!("Black is {} or less, white {} or more.", ends[0], ends[1]));
        self.body += "<div class=\"walk sheet\">";
        for Shown { name, caption, picture, .. } in maps {
            let (name, caption) = (escape(name), escape(caption));
            let image = image(&grey_map(picture, ends)?, &name);
            let _ = write!(self.body, "<section><h4>{name}</h4><p class=\"caption\">{caption}</p>{image}</section>");
        }
        self.body += "</div>";
        Ok(())
    }

    /// The page, which loads nothing from anywhere.
    pub fn html(&self) -> String {
        shell(&self.title, &self.body, "")
    }

    /// Writes the page; an older one is replaced whole or not at all.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        replace(path, &self.html())
    }
}

fn image(address: &str, name: &str) -> String {
    format!("<img class=\"picture\" src=\"{address}\" alt=\"{name}\">")
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use halflight_results::Layout;

    #[test]
    fn a_sheet_holds_what_is_put_on_it_and_loads_nothing() {
        let of = |level: f32| Picture {
            layout: Layout::Image { width: 2, height: 1 },
            radiance: vec![Vec3::splat(level); 2],
            valid: vec![true, false],
        };
        let (truth, method) = (of(1.0), of(0.5));
        let shown =
            |name: &str, picture, against| Shown { name: name.into(), caption: String::new(), picture, against };
        let mut sheet = Sheet::new("a & b", "Look.");
        sheet.pictures(&[shown("truth", &truth, None), shown("method", &method, Some(&truth))]).unwrap();
        sheet.maps([0.0, 1.0], &[shown("share", &method, None)]).unwrap();
        sheet.table(&["what", "ours"], &[vec!["x < y".into(), "1".into()]]);
        let html = sheet.html();
        assert_eq!(html.matches("<img ").count(), 4);
        assert!(html.contains("a &amp; b") && html.contains("<th>x &lt; y</th><td>1</td>"));
        assert!(html.contains("+0.500 brighter"), "differences of −0.5 need a scale of 0.5");
        assert!(!html.contains("://"));
    }
}
