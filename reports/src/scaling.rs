//! How cost grows with one number: a plot of times with the power laws that fit them, and a table of their exponents.

use crate::chip::method_colour;
use crate::format::{escape, number, time_unit};
use crate::labels::Labels;
use crate::plot::{Axis, tick};
use crate::{Report, ReportError};
use halflight_metrics::Interval;
use halflight_results::Cell;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::fmt::Write;

const SIZE: (u32, u32) = (860, 430);

/// Fits whose scatter the intervals of the times explain with less probability are said to lack.
const LACKS: f64 = 0.01;

/// Shading times of a method at several values of one number, all else equal.
#[derive(Clone, Debug)]
pub struct Scaling {
    /// The scene's name.
    pub scene: String,
    /// What varies: a parameter's name, or `receivers`.
    pub over: String,
    /// What all points have in common: one of their cells, without what varies.
    pub cell: Cell,
    /// Its values in rising order, with the shading time there in nanoseconds.
    pub points: Vec<(f64, Interval)>,
    /// The power law that fits best.
    pub fit: Option<Fit>,
}

/// A power law `factor·xᵉˣᵖᵒⁿᵉⁿᵗ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The exponent.
    pub exponent: f64,
    /// Lower end of its 95% interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The time at 1, in nanoseconds.
    pub factor: f64,
    /// The share of the variance of the logarithms that the law explains.
    pub r_squared: f64,
    /// Probability of so much scatter about the law by the intervals of the times alone: near 0, the law is none.
    pub lack_of_fit: f64,
}

impl Scaling {
    /// The slopes, in logarithms, between the first two points and the last two.
    fn slopes(&self) -> Option<[f64; 2]> {
        let slope = |[a, b]: &[(f64, Interval); 2]| (b.1.median / a.1.median).ln() / (b.0 / a.0).ln();
        Some([slope(self.points.first_chunk()?), slope(self.points.last_chunk()?)])
    }
}

/// The section, or nothing where there are no series.
pub(crate) fn section(report: &Report) -> Result<String, ReportError> {
    if report.scalings.is_empty() {
        return Ok(String::new());
    }
    let mut html = String::from(
        "<h2 id=\"scaling\">Scaling</h2><p class=\"note\">Shade time against one number, all else equal, with the power law \
         that fits best: least squares in logarithms, weighted by the times' intervals. The interval of an exponent (95%) \
         takes in the scatter about the law. Where that is more than the intervals of the times explain (p below 0.01), the \
         cost is no pure power, and the slopes at both ends say how it bends.</p>",
    );
    let same = |a: &Scaling, b: &Scaling| a.scene == b.scene && a.over == b.over;
    for series in report.scalings.chunk_by(same) {
        html += &figure(report, series)?;
    }
    Ok(html)
}

fn figure(report: &Report, series: &[Scaling]) -> Result<String, ReportError> {
    let labels = Labels::of(series.iter().map(|one| &one.cell));
    let colours: Vec<[u8; 3]> = series.iter().map(|one| method_colour(report, &one.cell.method)).collect();
    let mut svg = String::new();
    draw(&mut svg, series, &colours).map_err(|e| ReportError::Plot(e.to_string()))?;
    let mut rows = String::new();
    for (i, (one, [r, g, b])) in series.iter().zip(&colours).enumerate() {
        let Some(fit) = one.fit else { continue };
        let slopes = one.slopes().map_or("–".into(), |[a, b]| format!("{} to {}", number(a), number(b)));
        let lacks = if fit.lack_of_fit < LACKS { " class=\"failed\"" } else { "" };
        let _ = write!(
            rows,
            "<tr><th><i class=\"chip\" style=\"background:rgb({r},{g},{b})\">{}</i>{}</th><td>{}</td>\
             <td>{}<small>{} to {}</small></td><td>{:.4}</td><td{lacks}>{}</td><td>{slopes}</td></tr>",
            i + 1,
            escape(&labels.label(&one.cell)),
            one.points.len(),
            number(fit.exponent),
            number(fit.low),
            number(fit.high),
            fit.r_squared,
            probability(fit.lack_of_fit),
        );
    }
    let (scene, over) = (escape(&series[0].scene), escape(&series[0].over));
    Ok(format!(
        "<h4 class=\"series\">{scene}: shade time against {over}</h4><figure class=\"plot\"><div class=\"plotted\">{svg}</div></figure>\
         <div class=\"wide\"><table><thead><tr><th>setting</th><th>points</th><th>exponent</th><th>R²</th>\
         <th>lack of fit, p</th><th>slope, first to last</th></tr></thead><tbody>{rows}</tbody></table></div>"
    ))
}

fn probability(p: f64) -> String {
    if p < 0.001 { "&lt; 0.001".to_owned() } else { number(p) }
}

/// Log–log: the number across, time upwards; points with their intervals, laws as lines.
fn draw(svg: &mut String, series: &[Scaling], colours: &[[u8; 3]]) -> Result<(), Box<dyn std::error::Error>> {
    let times = || series.iter().flat_map(|one| one.points.iter().map(|(_, time)| *time));
    let middle = times().map(|time| time.median.ln()).sum::<f64>() / times().count().max(1) as f64;
    let (unit, unit_name) = time_unit(middle.exp());
    let x = Axis::around(series.iter().flat_map(|one| one.points.iter().map(|(x, _)| *x)));
    let mut numbers: Vec<f64> = series.iter().flat_map(|one| one.points.iter().map(|(x, _)| *x)).collect();
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    let y = Axis::around(times().flat_map(|time| [time.low / unit, time.high / unit]));
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .margin_right(28)
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(x.coordinate_at(numbers), y.coordinate())?;
    chart
        .configure_mesh()
        .x_desc(series.first().map_or("", |one| one.over.as_str()))
        .y_desc(format!("shade time, {unit_name} (median and 95% interval)"))
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.15))
        .axis_style(BLACK)
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;
    for (i, (one, [r, g, b])) in series.iter().zip(colours).enumerate() {
        let colour = RGBColor(*r, *g, *b);
        let ends = one.points.first().zip(one.points.last()).map(|(first, last)| [first.0, last.0]);
        if let Some((fit, ends)) = one.fit.zip(ends) {
            let law = ends.map(|x| (x, fit.factor * x.powf(fit.exponent) / unit));
            chart.draw_series(LineSeries::new(law, colour.mix(0.7).stroke_width(1)))?;
        }
        for (x, time) in &one.points {
            let [low, median, high] = [time.low, time.median, time.high].map(|time| time / unit);
            chart.draw_series([PathElement::new([(*x, low), (*x, high)], colour.stroke_width(2))])?;
            chart.draw_series([Circle::new((*x, median), 4, colour.filled())])?;
        }
        let Some((x, time)) = one.points.last() else { continue };
        let font = ("sans-serif", 14).into_font().style(FontStyle::Bold);
        let style = font.into_text_style(&root).pos(Pos::new(HPos::Left, VPos::Center));
        let name = Text::new((i + 1).to_string(), (9, 0), style);
        chart.draw_series([EmptyElement::at((*x, time.median / unit)) + name])?;
    }
    root.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_laws_are_drawn_and_a_misfit_is_marked() {
        let time = |median: f64| Interval { median, low: 0.9 * median, high: 1.1 * median, count: 6 };
        let points: Vec<_> = [1.0, 2.0, 4.0, 8.0].map(|x: f64| (x, time(1e6 * x * x))).to_vec();
        let fit = Fit { exponent: 2.0, low: 1.9, high: 2.1, factor: 1e6, r_squared: 0.99, lack_of_fit: 0.5 };
        let series = |method: &str, lack_of_fit| Scaling {
            scene: "<s>".into(),
            over: "order".into(),
            cell: Cell { method: method.into(), ..Cell::default() },
            points: points.clone(),
            fit: Some(Fit { lack_of_fit, ..fit }),
        };
        let report = Report { scalings: vec![series("a/b", 0.5), series("a/c", 1e-9)], ..Report::empty("t") };
        let html = section(&report).unwrap();
        assert_eq!((html.matches("<svg").count(), html.matches("<circle").count()), (1, 8));
        for part in ["&lt;s&gt;: shade time against order", "a/c", "2.00<small>1.90 to 2.10", "2.00 to 2.00"] {
            assert!(html.contains(part), "{part}");
        }
        assert_eq!(html.matches("class=\"failed\">&lt; 0.001").count(), 1);
        assert_eq!(section(&Report::empty("t")).unwrap(), "");
    }
}
