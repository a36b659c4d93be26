//! S5: where the optimal linear exponential holds.

use super::super::bench::{Bench, Figure};
use super::super::ground::Ground;
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use halflight_metrics::percentile;
use halflight_sh::{ExpWorkspace, circle_log};

const ORDER: usize = 4;
const LIMIT: f64 = 4.8;

const RADIUS: &str = "radius of the circle with ‖f̂‖ = 4.8";
const SHARE: &str = "least share of shadowed receivers with ‖f̂‖ < 4.8";
const INSIDE: &str = "largest 95th percentile of OL's relative error, ‖f̂‖ < 4.8";
const OUTSIDE: &str = "largest 95th percentile of OL's relative error, ‖f̂‖ > 4.8";
const TWO_TERMS: &str = "largest 95th percentile of the two-term series' relative error, ‖f̂‖ < 4.8";

pub(crate) const S5: Row = Row {
    id: "S5",
    place: "§4.2 and Fig. 3",
    claim: "At order 4 models agree on OL's coefficients for ‖f̂‖ < 4.8, a blocker of less than 50°, and OL is much more accurate there than 1 + f",
    paper: &[(RADIUS, "< 50°")],
    needs: "",
    measure,
    judge,
};

/// Scene, width of the ground that is looked at, what to call it.
const MODELS: [(&str, f32, &str); 4] = [
    ("bunny-studio", 3.0, "bunny"),
    ("dino-elephant-courtyard", 4.0, "dino and elephant"),
    ("teapot-sunset", 3.0, "teapot"),
    ("spheres-60", 6.4, "60 spheres"),
];

fn measure(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let mut figures = vec![Figure::exact(RADIUS, "°", radius().to_degrees(), 1)];
    let mut all: Vec<[f64; 4]> = Vec::new();
    let mut receivers = 0;
    for (scene, size, model) in MODELS {
        let logs = Ground::new(bench, scene, size, 64, 64)?.logs(ORDER);
        let errors: Vec<[f64; 3]> = logs.iter().map(|log| errors(log)).collect();
        let inside = |e: &&[f64; 3]| e[0] < LIMIT;
        let share = 100.0 * errors.iter().filter(inside).count() as f64 / errors.len() as f64;
        let upper = |which: usize, within: bool| {
            let chosen = errors.iter().filter(|e| inside(e) == within);
            let mut values: Vec<f64> = chosen.map(|e| 100.0 * e[which]).collect();
            values.sort_by(f64::total_cmp);
            percentile(&values, 95.0).unwrap_or(0.0)
        };
        let found = [share, upper(1, true), upper(1, false), upper(2, true)];
        let names =
            ["receivers with ‖f̂‖ < 4.8", "OL's error, ‖f̂‖ < 4.8", "OL's error, ‖f̂‖ > 4.8", "1 + f's error, ‖f̂‖ < 4.8"];
        figures.extend(
            names
                .iter()
                .zip(found)
                .map(|(name, value)| Figure::exact(format!("{model}: {name}"), "%", value, logs.len())),
        );
        receivers += logs.len();
        all.push(found);
    }
    let worst = |which: usize| all.iter().map(|found| found[which]).fold(0.0, f64::max);
    let least = all.iter().map(|found| found[0]).fold(100.0, f64::min);
    figures.extend([
        Figure::exact(SHARE, "%", least, receivers),
        Figure::exact(INSIDE, "%", worst(1), receivers),
        Figure::exact(OUTSIDE, "%", worst(2), receivers),
        Figure::exact(TWO_TERMS, "%", worst(3), receivers),
    ]);
    Ok(figures)
}

/// The angular radius at which a circle's log, without its mean, has the norm.
fn radius() -> f64 {
    let norm = |angle: f64| {
        let mut zonal = [0.0; ORDER];
        circle_log(ORDER, angle.cos(), &mut zonal);
        zonal[1..].iter().map(|value| value * value).sum::<f64>().sqrt()
    };
    let (mut low, mut high) = (0.1f64, 1.0f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *if norm(middle) < LIMIT { &mut low } else { &mut high } = middle;
    }
    low
}

/// `‖f̂‖`, the relative error of OL and that of `1 + f̂` without its mean, both against the eigen-exponential.
fn errors(log: &[f32]) -> [f64; 3] {
    let mut exp = ExpWorkspace::<f64>::new(ORDER);
    let log: Vec<f64> = log.iter().map(|value| f64::from(*value)).collect();
    let (mut exact, mut linear, mut two) = (log.clone(), log.clone(), log.clone());
    exp.eigen(&log, &mut exact);
    exp.optimal_linear(&log, &mut linear);
    exp.product_series(1, &log, &mut two);
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let apart = |v: &[f64]| v.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt() / norm(&exact);
    [norm(&log[1..]), apart(&linear), apart(&two)]
}

fn judge(figures: &Figures<'_>) -> Option<Judgement> {
    let [radius, share, inside, outside, two] = figures.values([RADIUS, SHARE, INSIDE, OUTSIDE, TWO_TERMS])?;
    // "Agree" is a matter of degree: a twentieth of the visibility's norm is less than what the log's clip costs a circle.
    let parts = [(48.0..52.0).contains(&radius), inside < 5.0, outside > inside, two > 4.0 * inside];
    let why = format!(
        "The circle of that norm has {}°. Over four models OL's error stays within {}% of the visibility's norm for 95% of receivers \
         below the limit, where 1 + f's reaches {}%, and grows to {}% above it; {}% of shadowed receivers or more lie below.",
        number(radius),
        number(inside),
        number(two),
        number(outside),
        number(share)
    );
    Some(Judgement { verdict: Verdict::of(&parts), why })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_a_circle_of_fifty_degrees() {
        // Ren 2006 §4.2; from 49.0° on the log is clipped, at 50° the norm is 4.90.
        assert!((48.0..50.0).contains(&radius().to_degrees()), "{}", radius().to_degrees());
    }
}
