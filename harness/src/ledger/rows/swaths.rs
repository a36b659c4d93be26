//! H6 and H7: swaths and azimuths.

use super::super::bench::{Bench, Figure, Setting};
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use halflight_scenes::{Light, Rgb, Scene};

const SWATHS: [f64; 4] = [90.0, 45.0, 22.5, 11.25];

pub(crate) const H6: Row = Row {
    id: "H6",
    place: "Fig. 6",
    claim: "Narrower swaths sharpen shadows, which converge to a limit that depends on the light (k = 4, o = 2, nφ = 32)",
    paper: &[],
    needs: "",
    measure: measure_swaths,
    judge: judge_swaths,
};

fn width(swath: f64) -> String {
    format!("width of the penumbra across the light, ΔΦ = {swath}°")
}

/// Degrees about the cone's middle, on a circle of vertices behind it, over which the shadow's edge goes from a quarter to three
/// quarters of its depth.
fn measure_swaths(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let scene = halflight_scenes::find("cone")?;
    let open = level(&scene);
    let mut figures = Vec::new();
    for swath in SWATHS {
        let text = swath.to_string();
        let settings = [("swath", &*text), ("key-azimuths", "32"), ("key-level", "facing"), ("border", "extend")];
        let setting = Setting::new("horizon-wedges/partial", &settings)?;
        let shaded = |scene: &Scene| Ok::<_, Error>(bench.shaded(scene, &scene.frame(0), &setting)?.radiance);
        let (shadowed, lit) = (shaded(&scene)?, shaded(&open)?);
        let share: Vec<f64> = shadowed.iter().zip(&lit).map(|(a, b)| f64::from(a.y) / f64::from(b.y)).collect();
        figures.push(Figure::exact(width(swath), "°", penumbra(&share), 2));
    }
    Ok(figures)
}

/// The cone's plane without the cone, as far as receivers behind it see: flat heights.
fn level(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for object in &mut scene.objects {
        if let halflight_scenes::Shape::Heights(field) = &*object.shape {
            let heights = vec![0.0; field.heights().len()];
            let size = [field.columns(), field.rows()];
            let flat = halflight_scenes::HeightField::new(size, field.origin(), field.cell(), heights);
            object.shape = std::sync::Arc::new(halflight_scenes::Shape::Heights(flat));
            object.content = object.shape.content();
        }
    }
    scene
}

/// Degrees between a quarter and three quarters of the depth of the shadow that lies opposite to the light, on a circle of 0.75 m.
fn penumbra(share: &[f64]) -> f64 {
    const SIDE: usize = 256;
    const CELL: f64 = 0.02;
    let middle = (0.4f64).atan2(0.7);
    let at = |degrees: f64| {
        let (sin, cos) = (middle + degrees.to_radians()).sin_cos();
        let [x, y] = [cos, sin].map(|part| 0.75 * part / CELL + 0.5 * (SIDE - 1) as f64);
        // Rows of the picture run from +y down.
        let y = (SIDE - 1) as f64 - y;
        let (i, j) = (x as usize, y as usize);
        let (u, v) = (x - i as f64, y - j as f64);
        let value = |i: usize, j: usize| share[j * SIDE + i];
        (1.0 - v) * ((1.0 - u) * value(i, j) + u * value(i + 1, j))
            + v * ((1.0 - u) * value(i, j + 1) + u * value(i + 1, j + 1))
    };
    let (deep, open) = (at(0.0), at(150.0));
    let reached =
        |part: f64| (0..1500).map(|i| 0.1 * f64::from(i)).find(|degrees| at(*degrees) > deep + part * (open - deep));
    reached(0.75).unwrap_or(f64::NAN) - reached(0.25).unwrap_or(f64::NAN)
}

fn judge_swaths(figures: &Figures<'_>) -> Option<Judgement> {
    let widths = figures.values(SWATHS.map(width).each_ref().map(String::as_str))?;
    // By more than the step that widths are found with.
    let falls = widths[0] > widths[1] + 0.1 && widths.windows(2).all(|pair| pair[1] <= pair[0] + 0.1);
    let steps: Vec<f64> = widths.windows(2).map(|pair| pair[0] - pair[1]).collect();
    let converges = steps.windows(2).all(|pair| pair[1] <= pair[0]);
    let list: Vec<String> = widths.iter().map(|width| format!("{}°", number(*width))).collect();
    let why = format!(
        "From a quarter to three quarters of its depth the shadow's edge behind the cone takes {} at swaths of 90°, 45°, 22.5°, 11.25°.",
        list.join(", ")
    );
    Some(Judgement { verdict: Verdict::of(&[falls, converges]), why })
}

pub(crate) const H7: Row = Row {
    id: "H7",
    place: "§6",
    claim: "3 azimuths are enough for key lights, 16 to 32 for environments",
    paper: &[],
    needs: "",
    measure: measure_azimuths,
    judge: judge_azimuths,
};

/// Radiance is compared with that of so many azimuths.
const MANY: &str = "64";
const KEYS: [&str; 4] = ["1", "2", "3", "8"];
const AROUND: [&str; 4] = ["4", "8", "16", "32"];

fn key_error(azimuths: &str) -> String {
    format!("key light: RMSE over the level, {azimuths} azimuths for 64")
}

fn sky_error(azimuths: &str) -> String {
    format!("sky: RMSE over the level, {azimuths} azimuths for 64")
}

fn measure_azimuths(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let scene = halflight_scenes::find("fractal-256")?;
    let of = |keep: fn(&Light) -> bool| {
        let mut scene = scene.clone();
        scene.lights.retain(|light| keep(&light.rest));
        scene
    };
    let key = of(|light| matches!(light, Light::Key(_)));
    let sky = of(|light| matches!(light, Light::Sky(_)));
    let mut figures = sweep(bench, &key, "key-azimuths", KEYS, key_error)?;
    figures.extend(sweep(bench, &sky, "azimuths", AROUND, sky_error)?);
    Ok(figures)
}

fn sweep(
    bench: &Bench,
    scene: &Scene,
    parameter: &str,
    values: [&str; 4],
    name: fn(&str) -> String,
) -> Result<Vec<Figure>, Error> {
    let shaded = |value: &str| {
        let setting = Setting::new("horizon-wedges/partial", &[(parameter, value)])?;
        Ok::<Vec<Rgb>, Error>(bench.shaded(scene, &scene.frame(0), &setting)?.radiance)
    };
    let many = shaded(MANY)?;
    let level = many.iter().map(|rgb| f64::from(rgb.y)).sum::<f64>() / many.len() as f64;
    let figure = |value: &&str| {
        let apart = shaded(value)?.iter().zip(&many).map(|(a, b)| f64::from(a.y - b.y).powi(2)).sum::<f64>();
        Ok(Figure::exact(name(value), "%", 100.0 * (apart / many.len() as f64).sqrt() / level, many.len()))
    };
    values.iter().map(figure).collect()
}

fn judge_azimuths(figures: &Figures<'_>) -> Option<Judgement> {
    let [three, sixteen, more] = figures.values([&*key_error("3"), &*sky_error("16"), &*sky_error("32")])?;
    let why = format!(
        "Less than 2% of the level counts as enough: 3 azimuths change the key light by {}% against 64, 16 and 32 the sky by {}% and {}%.",
        number(three),
        number(sixteen),
        number(more)
    );
    Some(Judgement { verdict: Verdict::of(&[three < 2.0, sixteen < 2.0]), why })
}
