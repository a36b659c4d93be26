//! The sign by which a setting is known on the whole page.

use crate::Report;

/// Colours that stay apart for colour-blind eyes (Okabe and Ito 2008) and stand on light and dark paper.
pub(crate) const PALETTE: [[u8; 3]; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [196, 140, 0], [86, 160, 213], [128, 128, 128]];

/// The number of a setting in its method's colour.
pub(crate) fn chip(report: &Report, label: usize) -> String {
    let [r, g, b] = colour(report, label);
    format!("<i class=\"chip\" style=\"background:rgb({r},{g},{b})\">{}</i>", label + 1)
}

/// The colour of a setting's method.
pub(crate) fn colour(report: &Report, label: usize) -> [u8; 3] {
    method_colour(report, &report.methods[label])
}

/// The colour of a method.
pub(crate) fn method_colour(report: &Report, method: &str) -> [u8; 3] {
    let mut methods: Vec<&String> = Vec::new();
    for method in &report.methods {
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    let place = methods.iter().position(|m| *m == method).unwrap_or(0);
    PALETTE[place % PALETTE.len()]
}
