//! Time and error against order as SVG.

use std::error::Error;
use std::path::Path;

use plotters::prelude::*;

use crate::Point;

const COLORS: [RGBColor; 5] = [
    RGBColor(200, 60, 40),
    RGBColor(40, 110, 200),
    RGBColor(40, 150, 70),
    RGBColor(150, 80, 180),
    RGBColor(90, 90, 90),
];

/// Writes `time.svg` and `error.svg`.
pub(crate) fn draw(folder: &Path, names: &[&str], points: &[Point]) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    chart(&folder.join("time.svg"), "Nanoseconds a product, f32", names, points, |point| point.nanoseconds)?;
    chart(&folder.join("error.svg"), "Largest error of a product, f32, relative to |a||b|", names, points, |p| p.error)
}

fn chart(
    path: &Path,
    title: &str,
    names: &[&str],
    points: &[Point],
    value: fn(&Point) -> f64,
) -> Result<(), Box<dyn Error>> {
    let values = points.iter().map(value);
    let (low, high) = values.fold((f64::MAX, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
    let last = points.iter().map(|point| point.order).max().unwrap_or(2) as f64;
    let area = SVGBackend::new(path, (640, 400)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 16))
        .margin(10)
        .x_label_area_size(36)
        .y_label_area_size(64)
        .build_cartesian_2d(1.5..last + 0.5, (0.7 * low..1.5 * high).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("order")
        .x_labels(16)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_labels(6)
        .y_label_formatter(&|y| if *y < 0.01 { format!("{y:.0e}") } else { format!("{y}") })
        .light_line_style(WHITE)
        .draw()?;
    for (&name, color) in names.iter().zip(COLORS) {
        let line: Vec<(f64, f64)> =
            points.iter().filter(|point| point.name == name).map(|point| (point.order as f64, value(point))).collect();
        chart
            .draw_series(LineSeries::new(line.clone(), color.stroke_width(2)).point_size(3))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    area.present()?;
    Ok(())
}
