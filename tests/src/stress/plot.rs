//! The plots.

use std::error::Error;

use plotters::prelude::*;

use super::{COUNTS, ORDERS, Stress, TRUTH};

const COLOURS: [RGBColor; 8] = [
    RGBColor(200, 60, 40),
    RGBColor(40, 110, 200),
    RGBColor(40, 150, 70),
    RGBColor(150, 80, 180),
    RGBColor(220, 150, 30),
    RGBColor(30, 160, 170),
    RGBColor(110, 80, 60),
    RGBColor(90, 90, 90),
];

const SIZE: (u32, u32) = (760, 420);

/// A curve with its name.
type Curve = (&'static str, Vec<(f64, f64)>);

/// The first N at which each method diverges, without the guard, against order, as SVG.
///
/// # Errors
/// If the plot cannot be drawn.
pub fn onsets(stress: &Stress) -> Result<String, Box<dyn Error>> {
    let beyond = 2.0 * *COUNTS.last().expect("some") as f64;
    let curves = curves(stress, |points, overlap| {
        points.push((overlap.order as f64, overlap.onset(false).map_or(beyond, |count| count as f64)));
    });
    let [first, last] = [*ORDERS.start() as f64, *ORDERS.end() as f64];
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(
                "Coincident circles of 15° at which irradiance leaves [0, 1] (top: at none up to 1000)",
                ("sans-serif", 16),
            )
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(56)
            .build_cartesian_2d(first - 0.3..last + 2.2, (0.8..1.3 * beyond).log_scale())?;
        let mut mesh = chart.configure_mesh();
        mesh.x_desc("order").y_desc("N").x_labels(12).x_label_formatter(&|x| format!("{x:.0}"));
        mesh.y_label_formatter(&|y| format!("{y:.0}")).light_line_style(WHITE).draw()?;
        draw(&mut chart, curves)?;
        area.present()?;
    }
    Ok(svg)
}

/// Irradiance against N at order 4 without the guard, bounded by 10, as SVG.
///
/// # Errors
/// If the plot cannot be drawn.
pub fn irradiance(stress: &Stress) -> Result<String, Box<dyn Error>> {
    let mut curves = curves(stress, |points, overlap| {
        let values = overlap.irradiance[0].iter().map(|value| value.clamp(-2.0, 10.0));
        points.extend(COUNTS.iter().map(|count| *count as f64).zip(values).filter(|_| overlap.order == 4));
    });
    curves.push(("truth", COUNTS.iter().map(|count| (*count as f64, TRUTH)).collect()));
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(
                "Irradiance under N coincident circles of 15°, order 4, guard off, cut off at −2 and 10",
                ("sans-serif", 16),
            )
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(56)
            .build_cartesian_2d((0.9..9000.0).log_scale(), -2.2..10.4)?;
        let mut mesh = chart.configure_mesh();
        mesh.x_desc("N").y_desc("irradiance, open sky 1").x_label_formatter(&|x| format!("{x:.0}"));
        mesh.light_line_style(WHITE).draw()?;
        draw(&mut chart, curves)?;
        area.present()?;
    }
    Ok(svg)
}

fn curves(stress: &Stress, add: impl Fn(&mut Vec<(f64, f64)>, &super::Overlap)) -> Vec<Curve> {
    let rows = stress.overlaps.chunks(ORDERS.count());
    rows.map(|row| {
        let mut points = Vec::new();
        row.iter().for_each(|overlap| add(&mut points, overlap));
        (row[0].method, points)
    })
    .collect()
}

fn draw<'a, X, Y>(
    chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
    curves: Vec<Curve>,
) -> Result<(), Box<dyn Error>>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    for (i, (name, points)) in curves.into_iter().enumerate() {
        let colour = COLOURS.get(i).copied().unwrap_or(BLACK);
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(2)).point_size(3))
            .map_err(|error| error.to_string())?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
    }
    let mut labels = chart.configure_series_labels();
    labels.position(SeriesLabelPosition::UpperRight).background_style(WHITE.mix(0.8)).border_style(BLACK.mix(0.3));
    labels.draw().map_err(|error| error.to_string().into())
}
