//! Curves and points over one number, as SVG.

use crate::ReportError;
use crate::chip::PALETTE;
use crate::format::escape;
use crate::plot::tick;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;

const SIZE: (u32, u32) = (860, 380);

/// A plot of several curves.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// Above it: what it shows.
    pub title: String,
    /// What goes across.
    pub across: Axis,
    /// What goes upwards.
    pub upwards: Axis,
    /// The curves.
    pub series: Vec<Series>,
}

/// One axis. It holds all values of all series, or between limits those that lie there.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// The quantity with its unit.
    pub label: String,
    /// Whether steps are equal ratios; what has no logarithm is left out.
    pub logarithmic: bool,
    /// Its ends, where not those of the values.
    pub limits: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis from the least value to the largest.
    pub fn linear(label: impl Into<String>) -> Axis {
        Axis { label: label.into(), ..Axis::default() }
    }

    /// The same between two ends.
    pub fn within(self, low: f64, high: f64) -> Axis {
        Axis { limits: Some([low, high]), ..self }
    }

    fn place(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }

    fn tick(&self, place: f64) -> String {
        let value = if self.logarithmic { 10f64.powf(place) } else { place };
        if value == 0.0 || (!self.logarithmic && value.abs() < 1e-12) { "0".into() } else { signed(value) }
    }

    /// Ends and ticks, in places.
    fn ends(&self, values: impl Iterator<Item = f64>) -> Option<([f64; 2], Vec<f64>)> {
        let [low, high] = match self.limits {
            Some(limits) => limits.map(|limit| self.place(limit)),
            None => {
                let places = values.map(|v| self.place(v)).filter(|p| p.is_finite());
                let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], p| [l.min(p), h.max(p)]);
                let room = if high > low { 0.04 * (high - low) } else { 0.5 * high.abs().max(1e-9) };
                [low - room, high + room]
            }
        };
        (low < high).then(|| ([low, high], if self.logarithmic { powers(low, high) } else { ticks(low, high) }))
    }
}

/// A curve or a cloud of points.
#[derive(Clone, Debug)]
pub struct Series {
    /// Beside the plot.
    pub name: String,
    /// Its points, in the order in which a line joins them; those that are not finite are left out.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub mark: Mark,
}

impl Series {
    /// A series.
    pub fn new(name: impl Into<String>, mark: Mark, points: impl IntoIterator<Item = (f64, f64)>) -> Series {
        Series { name: name.into(), points: points.into_iter().collect(), mark }
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line.
    Line,
    /// A broken line.
    Dashed,
    /// Points.
    Dots,
}

/// The figure with its legend; a sentence where there is nothing to draw.
pub(crate) fn figure(plot: &Plot) -> Result<String, ReportError> {
    let title = escape(&plot.title);
    let mut svg = String::new();
    if !draw(&mut svg, plot).map_err(|e| ReportError::Plot(e.to_string()))? {
        return Ok(format!("<p class=\"note\">{title}: there is nothing to draw.</p>"));
    }
    let names: String = plot.series.iter().enumerate().map(|(i, series)| name(i, series)).collect();
    Ok(format!(
        "<figure class=\"plot\"><figcaption>{title}</figcaption><div class=\"plotted\">{svg}<ul>{names}</ul></div></figure>"
    ))
}

fn name(i: usize, series: &Series) -> String {
    let ([r, g, b], text) = (PALETTE[i % PALETTE.len()], escape(&series.name));
    let sign = match series.mark {
        Mark::Line => "—",
        Mark::Dashed => "- -",
        Mark::Dots => "•",
    };
    format!("<li><b style=\"color:rgb({r},{g},{b})\">{sign}</b> {text}</li>")
}

/// Whether there was anything to draw.
fn draw(svg: &mut String, plot: &Plot) -> Result<bool, Box<dyn std::error::Error>> {
    let (x, y) = (&plot.across, &plot.upwards);
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let Some((across, columns)) = x.ends(points().map(|p| p.0)) else { return Ok(false) };
    let Some((upwards, rows)) = y.ends(points().map(|p| p.1)) else { return Ok(false) };
    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .margin_right(28)
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(Places { ends: across, ticks: columns }, Places { ends: upwards, ticks: rows })?;
    chart
        .configure_mesh()
        .x_desc(&x.label)
        .y_desc(&y.label)
        .x_label_formatter(&|place| x.tick(*place))
        .y_label_formatter(&|place| y.tick(*place))
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.15))
        .axis_style(BLACK)
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;
    for (i, series) in plot.series.iter().enumerate() {
        let [r, g, b] = PALETTE[i % PALETTE.len()];
        let colour = RGBColor(r, g, b);
        let inside = |v: f64, [low, high]: [f64; 2]| (low <= v && v <= high).then_some(v);
        let place = |p: &(f64, f64)| Some((inside(x.place(p.0), across)?, inside(y.place(p.1), upwards)?));
        let places = series.points.iter().filter_map(place);
        match series.mark {
            Mark::Line => chart.draw_series(LineSeries::new(places, colour.stroke_width(2))).map(|_| ())?,
            Mark::Dashed => {
                chart.draw_series(DashedLineSeries::new(places, 6, 4, colour.stroke_width(2))).map(|_| ())?;
            }
            Mark::Dots => chart.draw_series(places.map(|p| Circle::new(p, 3, colour.mix(0.7).filled()))).map(|_| ())?,
        }
    }
    root.present()?;
    drop(chart);
    Ok(true)
}

/// An axis with its own ticks.
struct Places {
    ends: [f64; 2],
    ticks: Vec<f64>,
}

impl Ranged for Places {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (low, high): (i32, i32)) -> i32 {
        let share = (value - self.ends[0]) / (self.ends[1] - self.ends[0]);
        low + (share * f64::from(high - low)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.ends[0]..self.ends[1]
    }
}

/// Places at even steps of 1, 2 or 5 times a power of ten, 4 to 10 of them.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let power = 10f64.powf(((high - low) / 4.0).log10().floor());
    let step = [5.0, 2.0, 1.0].into_iter().find(|s| (high - low) / (s * power) >= 4.0).unwrap_or(1.0) * power;
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Logarithms of 1, 2 and 5 times powers of ten; of the powers alone over more than three of them.
fn powers(low: f64, high: f64) -> Vec<f64> {
    let steps: &[f64] = if high - low > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let all =
        (low.floor() as i32..=high.ceil() as i32).flat_map(|p| steps.iter().map(move |s| f64::from(p) + s.log10()));
    all.filter(|tick| (low..=high).contains(tick)).collect()
}

fn signed(value: f64) -> String {
    if value < 0.0 { format!("−{}", tick(-value)) } else { tick(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(0.0, 1.0), [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]);
        assert_eq!(ticks(-3.0, 61.0), [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0]);
        for (low, high) in [(0.013, 0.0171), (-1e6, 3.0), (5.0, 5.01)] {
            let ticks = ticks(low, high);
            assert!((4..=10).contains(&ticks.len()) && ticks.iter().all(|t| (low..=high).contains(t)), "{ticks:?}");
        }
        let values: Vec<f64> =
            powers(-1.5, 1.1).iter().map(|tick| (100.0 * 10f64.powf(*tick)).round() / 100.0).collect();
        assert_eq!(values, [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0]);
    }

    #[test]
    fn every_series_is_drawn_and_named() {
        let points = [(0.0, 1.0), (1.0, 10.0), (2.0, f64::NAN), (3.0, 100.0)];
        let series = [("a<b", Mark::Line), ("c", Mark::Dashed), ("d", Mark::Dots)];
        let series = series.map(|(name, mark)| Series::new(name, mark, points)).to_vec();
        let upwards = Axis { logarithmic: true, ..Axis::linear("error") };
        let html = figure(&Plot { title: "t".into(), across: Axis::linear("frame"), upwards, series }).unwrap();
        assert_eq!(html.matches("<circle").count(), 3, "what is not finite is left out");
        assert!(
            html.contains("a&lt;b") && html.contains("frame\n</text>") && html.contains("error\n</text>"),
            "{html}"
        );
    }

    #[test]
    fn nothing_is_told_not_drawn() {
        let html = figure(&Plot { title: "t".into(), ..Plot::default() }).unwrap();
        assert!(!html.contains("<svg") && html.contains("nothing to draw"));
    }
}
