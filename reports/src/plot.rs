//! Error against time, as SVG.
//!
//! Colours of text and rules are left to the page's style sheet, which knows light from dark.

use crate::ReportError;
use crate::format::time_unit;
use halflight_metrics::Interval;
use plotters::coord::combinators::WithKeyPoints;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

const SIZE: (u32, u32) = (860, 430);

/// One setting in the plot.
pub(crate) struct Point {
    /// The setting's number on the page.
    pub(crate) number: usize,
    /// Its method's colour.
    pub(crate) colour: [u8; 3],
    /// Shade time in nanoseconds.
    pub(crate) time: Interval,
    /// RMSE.
    pub(crate) error: f64,
    /// Where not, the error is known only to lie below the reference's standard error: drawn hollow, at that.
    pub(crate) resolved: bool,
}

/// Log–log: shade time across, RMSE against `reference` upwards, and a dashed line at the reference's standard error.
/// None where nothing can be drawn on logarithmic axes.
pub(crate) fn error_against_time(
    points: &[Point],
    standard_error: f64,
    reference: &str,
) -> Result<Option<String>, ReportError> {
    let drawn = |p: &&Point| p.time.low > 0.0 && p.error > 0.0 && p.time.high.is_finite() && p.error.is_finite();
    let points: Vec<&Point> = points.iter().filter(drawn).collect();
    if points.is_empty() {
        return Ok(None);
    }
    let mut svg = String::new();
    draw(&mut svg, &points, standard_error, reference).map_err(|e| ReportError::Plot(e.to_string()))?;
    Ok(Some(svg))
}

fn draw(svg: &mut String, points: &[&Point], noise: f64, reference: &str) -> Result<(), Box<dyn std::error::Error>> {
    let (unit, unit_name) = time_unit(points.iter().map(|p| p.time.median).fold(f64::INFINITY, f64::min));
    let x = Axis::around(points.iter().flat_map(|p| [p.time.low / unit, p.time.high / unit]));
    let noise_line = (noise > 0.0).then_some(noise);
    let height = |p: &Point| if p.resolved { p.error } else { p.error.max(noise) };
    let y = Axis::around(points.iter().map(|p| height(p)).chain(noise_line));

    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .margin_right(28)
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(x.coordinate(), y.coordinate())?;
    chart
        .configure_mesh()
        .x_desc(format!("shade time, {unit_name} (median and 95% interval)"))
        .y_desc(format!("RMSE against {reference}, radiance"))
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.15))
        .axis_style(BLACK)
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;

    if let Some(level) = noise_line {
        let ends = [(x.low, level), (x.high, level)];
        chart.draw_series(DashedLineSeries::new(ends, 5, 4, BLACK.mix(0.6).into()))?;
        let style = ("sans-serif", 13).into_font().into_text_style(&root).pos(Pos::new(HPos::Left, VPos::Top));
        let text = format!("standard error of {reference}: below, nothing is resolved");
        chart.draw_series([EmptyElement::at((x.low, level)) + Text::new(text, (8, 5), style)])?;
    }
    for point in points {
        let colour = RGBColor(point.colour[0], point.colour[1], point.colour[2]);
        let (low, middle, high) = (point.time.low / unit, point.time.median / unit, point.time.high / unit);
        let error = height(point);
        chart.draw_series([PathElement::new([(low, error), (high, error)], colour.stroke_width(2))])?;
        let style = if point.resolved { colour.filled() } else { colour.stroke_width(2) };
        chart.draw_series([Circle::new((middle, error), 6, style)])?;
        let font = ("sans-serif", 14).into_font().style(FontStyle::Bold);
        let style = font.into_text_style(&root).pos(Pos::new(HPos::Left, VPos::Bottom));
        let label = EmptyElement::at((middle, error)) + Text::new(point.number.to_string(), (7, -5), style);
        chart.draw_series([label])?;
    }
    root.present()?;
    Ok(())
}

/// The ends of a logarithmic axis.
pub(crate) struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    /// All values with room around them, and at least a factor of 6 from end to end so that ticks fall inside.
    pub(crate) fn around(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0f64), |(l, h), v| (l.min(v), h.max(v)));
        let room = (6.0 * low / high).sqrt().max(1.35);
        Self { low: low / room, high: high * room }
    }

    /// 1, 2, 5 times powers of ten, or the powers alone where those are many.
    fn ticks(&self) -> Vec<f64> {
        let powers = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let steps: &[f64] = if self.high / self.low > 2000.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all = powers.flat_map(|p| steps.iter().map(move |s| s * 10f64.powi(p)));
        all.filter(|t| (self.low..=self.high).contains(t)).collect()
    }

    pub(crate) fn coordinate(&self) -> WithKeyPoints<LogCoord<f64>> {
        (self.low..self.high).log_scale().with_key_points(self.ticks())
    }
}

/// A tick's label: `0.02`, `50`, or `5e−6`. Ticks have one significant digit.
pub(crate) fn tick(value: f64) -> String {
    if (0.000_9..=100_000.0).contains(&value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.0e}").replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(number: usize, time: f64, error: f64) -> Point {
        let time = Interval { median: time, low: time * 0.9, high: time * 1.2, count: 5 };
        Point { number, colour: [0, 114, 178], time, error, resolved: true }
    }

    #[test]
    fn every_point_and_the_noise_are_drawn() {
        let points = [point(1, 1e6, 0.1), point(2, 5e7, 0.01), point(3, 1e8, 0.002)];
        let svg = error_against_time(&points, 1e-3, "truth").unwrap().unwrap();
        assert_eq!(svg.matches("<circle").count(), 3);
        for part in ["shade time, ms", "RMSE against truth", "standard error of truth", "0.01"] {
            assert!(svg.contains(part), "{part}");
        }
    }

    #[test]
    fn what_has_no_logarithm_is_left_out() {
        assert!(error_against_time(&[point(1, 1e6, 0.0), point(2, 0.0, 1.0)], 0.0, "truth").unwrap().is_none());
    }

    #[test]
    fn axes_hold_their_values_and_have_ticks() {
        for values in [vec![3.0], vec![0.011, 0.012], vec![1e-6, 1e3]] {
            let axis = Axis::around(values.iter().copied());
            assert!(values.iter().all(|v| axis.low < *v && *v < axis.high));
            assert!((2..=12).contains(&axis.ticks().len()), "{:?}", axis.ticks());
        }
        assert_eq!([0.02, 50.0, 1e-6].map(tick), ["0.02", "50", "1e−6"]);
    }
}
