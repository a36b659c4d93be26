//! Error against cost with the Pareto front, as SVG.
//!
//! Colours of text and rules are left to the page's style sheet, which knows light from dark.

use crate::ReportError;
use halflight_metrics::{Measured, Standing};
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
    /// What it costs.
    pub(crate) cost: Measured,
    /// Its error.
    pub(crate) error: Measured,
    /// Whether the error stands out of the reference's noise; drawn hollow where not.
    pub(crate) resolved: bool,
    /// What is dominated is drawn small and faint.
    pub(crate) standing: Standing,
}

/// What the axes say.
pub(crate) struct Axes {
    /// Below the plot.
    pub(crate) cost: String,
    /// What the plot's unit of cost is in the points' units.
    pub(crate) unit: f64,
    /// Beside the plot.
    pub(crate) error: String,
    /// Where errors are not resolved, with the reference's name: a dashed line.
    pub(crate) noise: Option<(f64, String)>,
}

/// Log–log: cost across, error upwards, with their intervals; the front as a staircase. None where nothing can be drawn on
/// logarithmic axes.
pub(crate) fn pareto(points: &[Point], axes: &Axes) -> Result<Option<String>, ReportError> {
    let points: Vec<&Point> = points.iter().filter(|p| p.cost.value() > 0.0 && p.error.value() > 0.0).collect();
    if points.is_empty() {
        return Ok(None);
    }
    let mut svg = String::new();
    draw(&mut svg, &points, axes).map_err(|e| ReportError::Plot(e.to_string()))?;
    Ok(Some(svg))
}

fn draw(svg: &mut String, points: &[&Point], axes: &Axes) -> Result<(), Box<dyn std::error::Error>> {
    let unit = axes.unit;
    let positive = |v: &f64| *v > 0.0;
    let ends = |m: &Measured| [m.low(), m.value(), m.high()];
    let x = Axis::around(points.iter().flat_map(|p| ends(&p.cost)).filter(positive).map(|v| v / unit));
    let noise = axes.noise.as_ref().filter(|(level, _)| *level > 0.0);
    // The lower end of what is not resolved is 0: its whisker leaves the plot.
    let heights = points.iter().flat_map(|p| if p.resolved { ends(&p.error) } else { [p.error.value(); 3] });
    let y = Axis::around(heights.filter(positive).chain(noise.map(|(level, _)| *level)));

    let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .margin_right(28)
        .x_label_area_size(52)
        .y_label_area_size(84)
        .build_cartesian_2d(x.coordinate(), y.coordinate())?;
    chart
        .configure_mesh()
        .x_desc(&axes.cost)
        .y_desc(&axes.error)
        .x_label_formatter(&|v| tick(*v))
        .y_label_formatter(&|v| tick(*v))
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.15))
        .axis_style(BLACK)
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;

    if let Some((level, reference)) = noise {
        let ends = [(x.low, *level), (x.high, *level)];
        chart.draw_series(DashedLineSeries::new(ends, 5, 4, BLACK.mix(0.6).into()))?;
        let style = ("sans-serif", 13).into_font().into_text_style(&root).pos(Pos::new(HPos::Left, VPos::Top));
        let text = format!("standard error of {reference}: below, nothing is resolved");
        chart.draw_series([EmptyElement::at((x.low, *level)) + Text::new(text, (8, 5), style)])?;
    }
    let stairs = stairs(points, unit, &x, &y);
    chart.draw_series([PathElement::new(stairs, BLACK.mix(0.35).stroke_width(2))])?;
    // What is on the front lies over the rest.
    let mut ordered = points.to_vec();
    ordered.sort_by_key(|p| match p.standing {
        Standing::Dominated { .. } => 0,
        Standing::Undecided => 1,
        Standing::Front => 2,
    });
    let spot = |p: &Point| (p.cost.value() / unit, p.error.value());
    for point in &ordered {
        let dominated = matches!(point.standing, Standing::Dominated { .. });
        let strength = if dominated { 0.4 } else { 1.0 };
        let [r, g, b] = point.colour;
        let colour = RGBColor(r, g, b).mix(strength);
        let (cost, error) = spot(point);
        let across = [point.cost.low(), point.cost.high()].map(|end| ((end / unit).max(x.low), error));
        let upwards = [point.error.low(), point.error.high()].map(|end| (cost, end.max(y.low)));
        let whiskers = [across, upwards].map(|ends| PathElement::new(ends.to_vec(), colour.stroke_width(2)));
        chart.draw_series(whiskers)?;
        let style = if point.resolved { colour.filled() } else { colour.stroke_width(2) };
        chart.draw_series([Circle::new((cost, error), if dominated { 4 } else { 6 }, style)])?;
    }
    // Numbers where there is room for them: the front's first, those of what is dominated nowhere.
    let mut taken: Vec<Pixels> = points.iter().map(|p| Pixels::around(chart.backend_coord(&spot(p)), 5)).collect();
    ordered.reverse();
    for point in ordered.iter().filter(|p| !matches!(p.standing, Standing::Dominated { .. })) {
        let text = point.number.to_string();
        let Some(place) = Pixels::beside(chart.backend_coord(&spot(point)), text.len() as i32, &taken) else {
            continue;
        };
        taken.push(place);
        let font = ("sans-serif", 14).into_font();
        let font = if point.standing == Standing::Front { font.style(FontStyle::Bold) } else { font };
        root.draw(&Text::new(text, (place.left, place.top), font.into_text_style(&root)))?;
    }
    root.present()?;
    Ok(())
}

/// A rectangle of the picture.
#[derive(Clone, Copy)]
struct Pixels {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
}

impl Pixels {
    fn around((x, y): (i32, i32), radius: i32) -> Self {
        Self { left: x - radius, top: y - radius, width: 2 * radius, height: 2 * radius }
    }

    fn meets(&self, other: &Self) -> bool {
        self.left < other.left + other.width
            && other.left < self.left + self.width
            && self.top < other.top + other.height
            && other.top < self.top + self.height
    }

    /// Where a number of so many digits stands free beside a point, if anywhere.
    fn beside((x, y): (i32, i32), digits: i32, taken: &[Self]) -> Option<Self> {
        let (width, height) = (8 * digits, 13);
        let near = [(7, -16), (7, 4), (-7 - width, -16), (-7 - width, 4), (-width / 2, -21), (-width / 2, 9)];
        let far = [(12, -30), (12, 18), (-12 - width, -30), (-12 - width, 18), (-width / 2, -34), (-width / 2, 22)];
        let at = |(right, down): &(i32, i32)| Self { left: x + right, top: y + down, width, height };
        near.iter().chain(&far).map(at).find(|place| !taken.iter().any(|other| place.meets(other)))
    }
}

/// The front from the plot's top to its right: at every cost the least error to be had for it.
fn stairs(points: &[&Point], unit: f64, x: &Axis, y: &Axis) -> Vec<(f64, f64)> {
    let mut front: Vec<(f64, f64)> = points
        .iter()
        .filter(|p| p.standing == Standing::Front)
        .map(|p| (p.cost.value() / unit, p.error.value()))
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mut height = y.high;
    let mut path = Vec::new();
    for (cost, error) in front {
        path.extend([(cost, height), (cost, error)]);
        height = error;
    }
    path.push((x.high, height));
    path
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

    /// 1, 2, 5 times powers of ten; more of them on a short axis, the powers alone on a long one.
    fn ticks(&self) -> Vec<f64> {
        let powers = self.low.log10().floor() as i32..=self.high.log10().ceil() as i32;
        let steps: &[f64] = match self.high / self.low {
            range if range > 2000.0 => &[1.0],
            range if range > 12.0 => &[1.0, 2.0, 5.0],
            _ => &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0],
        };
        let all = powers.flat_map(|p| steps.iter().map(move |s| s * 10f64.powi(p)));
        all.filter(|t| (self.low..=self.high).contains(t)).collect()
    }

    pub(crate) fn coordinate(&self) -> WithKeyPoints<LogCoord<f64>> {
        self.coordinate_at(self.ticks())
    }

    /// With ticks at these values, in rising order.
    pub(crate) fn coordinate_at(&self, values: Vec<f64>) -> WithKeyPoints<LogCoord<f64>> {
        (self.low..self.high).log_scale().with_key_points(values)
    }
}

/// A tick's label: `0.02`, `1.5`, `50`, or `5e−6`.
pub(crate) fn tick(value: f64) -> String {
    if (0.000_9..=100_000.0).contains(&value) {
        format!("{}", (value * 1e6).round() / 1e6)
    } else {
        format!("{value:.1e}").replace(".0e", "e").replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(figures: &[(f64, f64)]) -> Vec<Point> {
        let measured: Vec<[Measured; 2]> = figures
            .iter()
            .map(|(cost, error)| {
                [Measured::new(*cost, cost * 0.9, cost * 1.2), Measured::new(*error, error * 0.9, error * 1.1)]
                    .map(Option::unwrap)
            })
            .collect();
        let standings = halflight_metrics::standings(&measured);
        let point = |(i, [cost, error]): (usize, &[Measured; 2])| Point {
            number: i + 1,
            colour: [0, 114, 178],
            cost: *cost,
            error: *error,
            resolved: true,
            standing: standings[i],
        };
        measured.iter().enumerate().map(point).collect()
    }

    fn axes(noise: f64) -> Axes {
        Axes { cost: "shade time, ms".into(), unit: 1e6, error: "RMSE".into(), noise: Some((noise, "truth".into())) }
    }

    #[test]
    fn every_point_the_front_and_the_noise_are_drawn() {
        let points = points(&[(1e6, 0.1), (5e7, 0.01), (1e8, 0.002), (1e9, 0.5)]);
        let svg = pareto(&points, &axes(1e-3)).unwrap().unwrap();
        let circles: Vec<&str> = svg.split("<circle").skip(1).collect();
        assert_eq!(circles.iter().filter(|c| c.contains("r=\"6\"")).count(), 3);
        // What is dominated is small and faint.
        assert_eq!(circles.iter().filter(|c| c.contains("r=\"4\"") && c.contains("opacity=\"0.4\"")).count(), 1);
        assert!(svg.contains("standard error of truth") && svg.contains("shade time, ms"));
        assert!(!pareto(&points, &axes(0.0)).unwrap().unwrap().contains("standard error"));
    }

    #[test]
    fn numbers_stand_apart() {
        let mut taken = vec![Pixels::around((100, 100), 5)];
        while let Some(place) = Pixels::beside((100, 100), 2, &taken) {
            assert!(taken.iter().all(|other| !place.meets(other)));
            taken.push(place);
        }
        assert!((5..=13).contains(&taken.len()), "{}", taken.len());
        // Where no room is left, none is taken.
        assert!(Pixels::beside((100, 100), 2, &[Pixels::around((100, 100), 99)]).is_none());
    }

    #[test]
    fn stairs_go_down_and_pass_through_the_front() {
        let points = points(&[(3.0, 0.2), (1.0, 0.9), (2.0, 0.5), (4.0, 0.7)]);
        let (x, y) = (Axis { low: 0.5, high: 9.0 }, Axis { low: 0.01, high: 2.0 });
        let stairs = stairs(&points.iter().collect::<Vec<_>>(), 1.0, &x, &y);
        let expected = [(1.0, 2.0), (1.0, 0.9), (2.0, 0.9), (2.0, 0.5), (3.0, 0.5), (3.0, 0.2), (9.0, 0.2)];
        assert_eq!(stairs, expected);
    }

    #[test]
    fn what_has_no_logarithm_is_left_out() {
        assert!(pareto(&points(&[(1e6, 0.0), (0.0, 1.0)]), &axes(0.0)).unwrap().is_none());
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
