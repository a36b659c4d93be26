//! Fig. 3: the coefficients of the optimal linear exponential.

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::ledger::{Bench, Ground};
use halflight_reports::{Axis, Mark, Plot, Series, Sheet};
use halflight_sh::{ExpWorkspace, circle_log, circle_visibility, coefficients};
use std::f64::consts::{FRAC_PI_2, PI};

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig3",
    place: "Ren et al. 2006, Fig. 3",
    shows: "coefficients a and b of the optimal linear exponential over ‖f̂‖, order 4",
    look: "Below ‖f̂‖ = 4.8 receivers before compact bodies (bunny, teapot) lie along the curve of circles, from which the table is made; \
           beyond, the curve leaves them, as printed. Between the limbs of the dinosaur and the elephant b is larger than the curve well \
           below 4.8, which the print does not show.",
    make,
};

const ORDER: usize = 4;
/// Scene, metres of ground, name.
const MODELS: [(&str, f32, &str); 3] = [
    ("bunny-studio", 3.0, "bunny"),
    ("dino-elephant-courtyard", 4.0, "dino and elephant"),
    ("teapot-sunset", 3.0, "teapot"),
];
const SIDE: usize = 40;

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let circles = (1..=180).map(|half_degrees| circle(FRAC_PI_2 * f64::from(half_degrees) / 180.0));
    let mut all = vec![("circles".to_owned(), Mark::Line, circles.collect::<Vec<_>>())];
    for (scene, size, name) in MODELS {
        let logs = Ground::new(bench, scene, size, SIDE, 64)?.logs(ORDER);
        all.push((name.to_owned(), Mark::Dots, logs.iter().map(|log| receiver(log)).collect()));
    }
    for (which, name) in ["a", "b"].into_iter().enumerate() {
        let points = |fits: &[Fit]| fits.iter().map(|fit| (fit.norm, fit.ab[which])).collect::<Vec<_>>();
        sheet.plot(&Plot {
            title: format!("{name}, of exp*(f̂) ≈ a·1 + b·f̂"),
            across: Axis::linear("‖f̂‖").within(0.0, 12.0),
            upwards: Axis::linear(name).within(0.0, [8.0, 1.4][which]),
            series: all.iter().map(|(name, mark, fits)| Series::new(name.clone(), *mark, points(fits))).collect(),
        })?;
    }
    claim(bench, sheet, "S5")
}

/// The best a and b for one visibility (Ren 2006, eq. 24), and the norm that a table would look them up by.
struct Fit {
    norm: f64,
    ab: [f64; 2],
}

/// Of a circle of an angular radius.
fn circle(angle: f64) -> Fit {
    let (mut log, mut visibility) = ([0.0; ORDER], [0.0; ORDER]);
    circle_log(ORDER, angle.cos(), &mut log);
    circle_visibility(ORDER, angle.cos(), &mut visibility);
    fit(&log, &visibility)
}

/// Of the sum of logs at a receiver, by the eigen-exponential.
fn receiver(log: &[f32]) -> Fit {
    let log: Vec<f64> = log.iter().map(|value| f64::from(*value)).collect();
    let mut visibility = [0.0; coefficients(ORDER)];
    ExpWorkspace::<f64>::new(ORDER).eigen(&log, &mut visibility);
    fit(&log, &visibility)
}

fn fit(log: &[f64], visibility: &[f64]) -> Fit {
    let root = (4.0 * PI).sqrt();
    let scale = (-log[0] / root).exp();
    let (square, along) =
        log[1..].iter().zip(&visibility[1..]).fold((0.0, 0.0), |(s, a), (f, g)| (s + f * f, a + f * g));
    Fit { norm: square.sqrt(), ab: [scale * visibility[0] / root, scale * along / square] }
}
