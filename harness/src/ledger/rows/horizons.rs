//! H4 and H5: errors of the pyramid's horizons.

use super::super::bench::{Bench, Figure};
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use halflight_horizons::{
    Azimuth, Border, Horizons, March, Plane, Points, Purpose, Pyramid, Reconstruction, Scale, Settings, Sweep,
};
use halflight_references::horizon;
use halflight_scenes::{HeightField, Shape};
use rayon::prelude::*;

const AZIMUTHS: usize = 16;
/// Of the vertices along each side, so many apart are compared.
const STRIDE: usize = 3;
const STEPS: [(usize, u8); 4] = [(1, 1), (2, 2), (4, 4), (8, 8)];

fn azimuths() -> Vec<Azimuth> {
    let angle = |i: usize| (i as f32 + 0.5) * std::f32::consts::TAU / AZIMUTHS as f32;
    (0..AZIMUTHS).map(|i| Azimuth { angle: angle(i), purpose: Purpose::Key }).collect()
}

fn field(name: &str) -> Result<HeightField, Error> {
    let scene = halflight_scenes::find(name)?;
    let fields = scene.objects.iter().filter_map(|object| match &*object.shape {
        Shape::Heights(field) => Some(field.clone()),
        _ => None,
    });
    fields.into_iter().next().ok_or_else(|| Error::Other(format!("{name} has no height field")))
}

/// Elevations at all vertices, azimuth after azimuth.
fn map(horizons: &mut dyn Horizons, field: &HeightField) -> Vec<f32> {
    let azimuths = azimuths();
    horizons.update(field, &azimuths);
    let vertices = 0..field.heights().len();
    let x: Vec<f32> = vertices.clone().map(|vertex| (vertex % field.columns()) as f32).collect();
    let y: Vec<f32> = vertices.map(|vertex| (vertex / field.columns()) as f32).collect();
    let mut out = vec![0.0; x.len() * azimuths.len()];
    horizons.elevations(Points { x: &x, y: &y }, 0..azimuths.len(), &mut out);
    out
}

/// Exact elevations at every third vertex, by number.
fn exact(field: &HeightField) -> Vec<(usize, Vec<f64>)> {
    let found = horizon::Horizons::new(field);
    let azimuths: Vec<f64> = azimuths().iter().map(|azimuth| f64::from(azimuth.angle)).collect();
    let columns = field.columns();
    let chosen =
        |vertex: &usize| (vertex % columns).is_multiple_of(STRIDE) && (vertex / columns).is_multiple_of(STRIDE);
    let at = |vertex: usize| {
        azimuths.iter().map(|azimuth| found.at_vertex([vertex % columns, vertex / columns], *azimuth)).collect()
    };
    (0..field.heights().len()).into_par_iter().filter(chosen).map(|vertex| (vertex, at(vertex))).collect()
}

/// RMS in degrees.
fn error(map: &[f32], exact: &[(usize, Vec<f64>)]) -> f64 {
    let vertices = map.len() / AZIMUTHS;
    let square = |(vertex, elevations): &(usize, Vec<f64>)| {
        let apart = elevations.iter().enumerate().map(|(i, want)| f64::from(map[i * vertices + vertex]) - want);
        apart.map(|apart| apart * apart).sum::<f64>()
    };
    (exact.iter().map(square).sum::<f64>() / (exact.len() * AZIMUTHS) as f64).sqrt().to_degrees()
}

fn pyramid((levels, offset): (usize, u8), scale: Scale, plane: Plane) -> Pyramid {
    let reconstruction = Reconstruction { scale, plane };
    let settings = Settings { levels_per_octave: levels, offset: offset.into(), reconstruction, ..Settings::default() };
    Pyramid::new(settings).with_border(Border::Open)
}

pub(crate) const H4: Row = Row {
    id: "H4",
    place: "Fig. 10",
    claim: "As k and o grow together, the pyramid's result becomes that of the ground truth",
    paper: &[],
    needs: "",
    measure: measure_steps,
    judge: judge_steps,
};

fn step((levels, offset): (usize, u8), plane: &str) -> String {
    format!("RMS error of horizons, (k, o) = ({levels}, {offset}), {plane}")
}

const SPLINE: &str = "B-spline in the plane";
const BILINEAR: &str = "bilinear";
const MARCH: &str = "RMS error of horizons, march of 145 samples";
const SWEEP: &str = "RMS error of horizons, sweep";

fn measure_steps(_: &Bench) -> Result<Vec<Figure>, Error> {
    let field = field("fractal-512")?;
    let exact = exact(&field);
    let of = |name: String, horizons: &mut dyn Horizons| {
        Figure::exact(name, "°", error(&map(horizons, &field), &exact), exact.len() * AZIMUTHS)
    };
    let mut figures = Vec::new();
    for (name, plane) in [(SPLINE, Plane::BSpline), (BILINEAR, Plane::Bilinear)] {
        figures.extend(STEPS.map(|at| of(step(at, name), &mut pyramid(at, Scale::BSpline, plane))));
    }
    figures.push(of(MARCH.into(), &mut March::default().with_border(Border::Open)));
    figures.push(of(SWEEP.into(), &mut Sweep::new()));
    Ok(figures)
}

fn judge_steps(figures: &Figures<'_>) -> Option<Judgement> {
    let errors = |plane: &str| figures.values(STEPS.map(|at| step(at, plane)).each_ref().map(String::as_str));
    let (spline, bilinear) = (errors(SPLINE)?, errors(BILINEAR)?);
    let [march, sweep] = figures.values([MARCH, SWEEP])?;
    let falls = |errors: &[f64]| errors.windows(2).all(|pair| pair[1] < pair[0]);
    // The paper's ground truth is the march.
    let arrives = |errors: &[f64]| errors.last().is_some_and(|last| *last <= march);
    let list = |errors: &[f64]| errors.iter().map(|error| number(*error)).collect::<Vec<_>>().join("°, ");
    let why = format!(
        "Against the exact horizon of the terrain's triangles, all ending at its border, errors are {}° with B-splines in the plane, which smooth the finest level \
         too, and {}° bilinearly; the paper's own ground truth, 145 samples, is {}° off, the sweep {}°.",
        list(&spline),
        list(&bilinear),
        number(march),
        number(sweep)
    );
    Some(Judgement {
        verdict: Verdict::of(&[falls(&spline) && arrives(&spline), falls(&bilinear) && arrives(&bilinear)]),
        why,
    })
}

pub(crate) const H5: Row = Row {
    id: "H5",
    place: "Fig. 9",
    claim: "B-splines in scale and in the plane give the smoothest shadow",
    paper: &[],
    needs: "",
    measure: measure_variants,
    judge: judge_variants,
};

const VARIANTS: [(&str, Scale, Plane); 4] = [
    ("linear, bilinear", Scale::Linear, Plane::Bilinear),
    ("B-spline, bilinear", Scale::BSpline, Plane::Bilinear),
    ("linear, B-spline", Scale::Linear, Plane::BSpline),
    ("B-spline, B-spline", Scale::BSpline, Plane::BSpline),
];

fn rough(variant: &str) -> String {
    format!("RMS second difference of horizons, {variant}")
}

fn wrong(variant: &str) -> String {
    format!("RMS error of horizons, {variant}")
}

fn measure_variants(_: &Bench) -> Result<Vec<Figure>, Error> {
    let field = field("fractal-256")?;
    let exact = exact(&field);
    let mut figures = Vec::new();
    for (name, scale, plane) in VARIANTS {
        let map = map(&mut pyramid((4, 2), scale, plane), &field);
        figures.push(Figure::exact(rough(name), "°", bending(&map, field.columns()), map.len()));
        figures.push(Figure::exact(wrong(name), "°", error(&map, &exact), exact.len() * AZIMUTHS));
    }
    Ok(figures)
}

/// RMS in degrees of the second differences along rows.
fn bending(map: &[f32], columns: usize) -> f64 {
    let rows = map.chunks_exact(columns).flat_map(|row| row.windows(3));
    let bends: Vec<f64> = rows.map(|w| f64::from(w[0]) - 2.0 * f64::from(w[1]) + f64::from(w[2])).collect();
    (bends.iter().map(|bend| bend * bend).sum::<f64>() / bends.len() as f64).sqrt().to_degrees()
}

fn judge_variants(figures: &Figures<'_>) -> Option<Judgement> {
    let names = VARIANTS.map(|(name, ..)| name);
    let bends = figures.values(names.map(rough).each_ref().map(String::as_str))?;
    let errors = figures.values(names.map(wrong).each_ref().map(String::as_str))?;
    let [neither, scale, plane, both] = bends;
    let (in_plane, between_scales) = (plane < neither && both < scale, scale < neither && both < plane);
    let told: Vec<String> = names
        .iter()
        .zip(bends.iter().zip(&errors))
        .map(|(name, (bend, error))| format!("{name} {}° (error {}°)", number(*bend), number(*error)))
        .collect();
    let why = format!(
        "B-splines in the plane {}; between scales they {}. Second differences at (k, o) = (4, 2), between scales and in the plane: {}.",
        if in_plane { "smooth" } else { "do not smooth" },
        if between_scales { "smooth too, if little" } else { "do not where those in the plane have smoothed already" },
        told.join("; ")
    );
    Some(Judgement { verdict: Verdict::of(&[in_plane, between_scales]), why })
}
