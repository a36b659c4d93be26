//! S3 and S4: speed of sums of logs against products, and operations of exponentials.

use super::super::bench::{Bench, Figure, Setting, Work, ratios};
use super::super::ground::Ground;
use super::super::plain::{How, render};
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use std::hint::black_box;

pub(crate) const S3: Row = Row {
    id: "S3",
    place: "Fig. 8",
    claim: "On a CPU, 200×200 vertices, 60 spheres, PS*-2 renders 1.9, 3.4, 6.5, 11.0 times as fast as SH products at orders 3 to 6",
    paper: &[
        ("plain product over our PS*-2, order 3", "1.9×"),
        ("plain product over our PS*-2, order 4", "3.4×"),
        ("plain product over our PS*-2, order 5", "6.5×"),
        ("plain product over our PS*-2, order 6", "11.0×"),
        ("our PS*-2, order 3", "7.1 Hz"),
        ("our PS*-2, order 4", "5.5 Hz"),
        ("our PS*-2, order 5", "4.3 Hz"),
        ("our PS*-2, order 6", "3.3 Hz"),
        ("plain product, order 6", "0.3 Hz"),
    ],
    needs: "",
    measure: measure_orders,
    judge: judge_orders,
};

const ORDERS: std::ops::RangeInclusive<usize> = 3..=6;
const PRINTED: [f64; 4] = [1.9, 3.4, 6.5, 11.0];

fn of(what: &str, order: usize) -> String {
    format!("{what}, order {order}")
}

const OURS: &str = "plain product over our PS*-2";
const ALIKE: &str = "plain product over plain PS*-2";
const FAST: &str = "our product over our PS*-2";

fn measure_orders(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let ground = Ground::new(bench, "spheres-60", 6.4, 200, 64)?;
    let mut figures = Vec::new();
    for order in ORDERS {
        let transfer = &ground.transfer(bench, order)?[0];
        let text = order.to_string();
        let [product, exp] = [
            Setting::new("sh-product/ordered", &[("order", &text)])?,
            Setting::new("shexp/ps-star", &[("order", &text), ("p", "2")])?,
        ];
        let hows = [How::Product, How::PsStar2, How::Circles, How::Sum];
        let mut works: Vec<Work<'_>> = hows.iter().map(|how| plain(&ground, order, transfer, *how)).collect();
        for setting in [&product, &exp] {
            works.push(bench.shading(&ground.scene, &ground.frame, setting)?);
        }
        let times = bench.interleaved(&mut works)?;
        let [plain_product, plain_exp, circles, sum, fast_product, fast_exp] = &times[..] else { unreachable!() };
        figures.extend([
            Figure::median(of(OURS, order), "×", &ratios(plain_product, fast_exp)),
            Figure::median(of(ALIKE, order), "×", &ratios(plain_product, plain_exp)),
            Figure::median(of(FAST, order), "×", &ratios(fast_product, fast_exp)),
            Figure::median(of("our PS*-2", order), "Hz", &rates(fast_exp)),
            Figure::median(of("our product", order), "Hz", &rates(fast_product)),
            Figure::median(of("plain PS*-2", order), "Hz", &rates(plain_exp)),
            Figure::median(of("plain product", order), "Hz", &rates(plain_product)),
            Figure::median(of("plain: finding and rotating circles, of PS*-2", order), "%", &share(circles, plain_exp)),
            Figure::median(of("plain: exponentials, of PS*-2", order), "%", &rest(sum, plain_exp)),
            Figure::median(of("plain: products, of the product", order), "%", &rest(circles, plain_product)),
        ]);
    }
    Ok(figures)
}

fn plain<'a>(ground: &'a Ground, order: usize, transfer: &'a [f32], how: How) -> Work<'a> {
    Box::new(move || {
        black_box(render(ground, order, transfer, how));
        Ok(())
    })
}

fn rates(nanoseconds: &[f64]) -> Vec<f64> {
    nanoseconds.iter().map(|time| 1e9 / time).collect()
}

/// Percent that a part is of a whole, round by round.
fn share(part: &[f64], whole: &[f64]) -> Vec<f64> {
    ratios(part, whole).iter().map(|ratio| 100.0 * ratio).collect()
}

/// Percent of a whole that is left beside a part, round by round.
fn rest(part: &[f64], whole: &[f64]) -> Vec<f64> {
    ratios(part, whole).iter().map(|ratio| 100.0 * (1.0 - ratio)).collect()
}

fn judge_orders(figures: &Figures<'_>) -> Option<Judgement> {
    let (mut ours, mut alike, mut fast) = (Vec::new(), Vec::new(), Vec::new());
    let mut reached = [0, 0];
    for (order, printed) in ORDERS.zip(PRINTED) {
        for (reached, name) in reached.iter_mut().zip([OURS, ALIKE]) {
            *reached += usize::from(figures.interval(&of(name, order))?[0] >= printed);
        }
        ours.push(figures.value(&of(OURS, order))?);
        alike.push(figures.value(&of(ALIKE, order))?);
        fast.push(figures.value(&of(FAST, order))?);
    }
    let why = format!(
        "Against the plain sparse product our PS*-2 is {} times as fast at orders 3 to 6, surely the printed factor or more at {} of 4. \
         With circles found alike and both accumulated one vertex at a time in plain code the factors are {}, surely as printed or more \
         at {} of 4; with both in lanes they are {}, since our product gains more by lanes than the rest does.",
        list(&ours),
        reached[0],
        list(&alike),
        reached[1],
        list(&fast),
    );
    // Both ways to read the claim, at all orders.
    let verdict = match reached {
        [4, 4] => Verdict::Confirmed,
        [0, 0] => Verdict::NotConfirmed,
        _ => Verdict::Partly,
    };
    Some(Judgement { verdict, why })
}

fn list(values: &[f64]) -> String {
    values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(", ")
}

pub(crate) const S4: Row = Row {
    id: "S4",
    place: "Fig. 9",
    claim: "At order 4 PS*-2 is faster than PS-21, which is faster than the product; HYB needs squares alone, one fewer a vertex than PS*-2",
    paper: &[
        (PRODUCTS_A, "30.2"),
        (PRODUCTS_B, "20"),
        (SQUARES_HYB, "1.88"),
        (SQUARES_STAR, "2.78"),
        ("plain product", "2.47 Hz"),
        ("plain PS-21", "3.27 Hz"),
        ("plain PS*-2", "7.53 Hz"),
        (PLAIN_A, "1.32×"),
        (PLAIN_B, "2.30×"),
    ],
    needs: "",
    measure: measure_exponentials,
    judge: judge_exponentials,
};

const PRODUCTS_A: &str = "products a vertex, product";
const PRODUCTS_B: &str = "products and squares a vertex, PS-21";
const SQUARES_HYB: &str = "squares a vertex, HYB";
const SQUARES_STAR: &str = "squares a vertex, PS*-2";
const PLAIN_A: &str = "plain product over plain PS-21";
const PLAIN_B: &str = "plain PS-21 over plain PS*-2";
const LANES_A: &str = "our product over our PS-21";
const LANES_B: &str = "our PS-21 over our PS*-2";

/// A vertex is one of all, as the paper's totals over 128×128 are divided.
fn measure_exponentials(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let ground = Ground::new(bench, "bunny-studio", 4.0, 128, 63)?;
    let spheres = ("spheres", "63");
    let settings = [
        Setting::new("sh-product/ordered", &[spheres])?,
        Setting::new("shexp/ps", &[spheres, ("p", "21")])?,
        Setting::new("shexp/ps-star", &[spheres, ("p", "2")])?,
        Setting::new("shexp/hyb", &[spheres])?,
        Setting::new("shexp/ol", &[spheres])?,
    ];
    let vertices = ground.frame.receivers.len();
    let mut counts = Vec::new();
    for setting in &settings {
        let counters = bench.shaded(&ground.scene, &ground.frame, setting)?.recorded.counters;
        let a_vertex = |name: &str| counters.get(name).copied().unwrap_or(0) as f64 / vertices as f64;
        counts.push((a_vertex("products"), a_vertex("squares")));
    }
    let exact = |name: &str, value| Figure::exact(name, "", value, vertices);
    let mut figures = vec![
        exact(PRODUCTS_A, counts[0].0),
        exact(PRODUCTS_B, counts[1].0 + counts[1].1),
        exact(SQUARES_STAR, counts[2].1),
        exact(SQUARES_HYB, counts[3].1),
        exact("products and squares a vertex, OL", counts[4].0 + counts[4].1),
    ];
    let transfer = &ground.transfer(bench, 4)?[0];
    let hows = [How::Product, How::Series(21), How::PsStar2];
    let mut works: Vec<Work<'_>> = hows.iter().map(|how| plain(&ground, 4, transfer, *how)).collect();
    for setting in &settings {
        works.push(bench.shading(&ground.scene, &ground.frame, setting)?);
    }
    let times = bench.interleaved(&mut works)?;
    figures.extend([
        Figure::median(PLAIN_A, "×", &ratios(&times[0], &times[1])),
        Figure::median(PLAIN_B, "×", &ratios(&times[1], &times[2])),
        Figure::median(LANES_A, "×", &ratios(&times[3], &times[4])),
        Figure::median(LANES_B, "×", &ratios(&times[4], &times[5])),
    ]);
    let names =
        ["plain product", "plain PS-21", "plain PS*-2", "our product", "our PS-21", "our PS*-2", "our HYB", "our OL"];
    figures.extend(names.iter().zip(&times).map(|(name, times)| Figure::median(*name, "Hz", &rates(times))));
    Ok(figures)
}

fn judge_exponentials(figures: &Figures<'_>) -> Option<Judgement> {
    let [[first, _], [second, _]] = [figures.interval(PLAIN_A)?, figures.interval(PLAIN_B)?];
    let [hyb, star] = figures.values([SQUARES_HYB, SQUARES_STAR])?;
    let [a, b, lanes_a, lanes_b] = figures.values([PLAIN_A, PLAIN_B, LANES_A, LANES_B])?;
    // One more a shadowed vertex: of all vertices, as many as are shadowed.
    let one_more = star - hyb;
    let verdict = Verdict::of(&[first > 1.0, second > 1.0, hyb < star && one_more <= 1.0]);
    let why = format!(
        "Accumulated one vertex at a time in plain code PS-21 is {} times as fast as the product, PS*-2 {} times as fast as PS-21; in \
         lanes {} and {}. HYB squares {} times a vertex, PS*-2 {}, no more than once more. Our scene is another than the print's: {} products a vertex.",
        number(a),
        number(b),
        number(lanes_a),
        number(lanes_b),
        number(hyb),
        number(star),
        number(figures.value(PRODUCTS_A)?)
    );
    Some(Judgement { verdict, why })
}

#[cfg(test)]
mod tests {
    use super::super::super::page::judgement;
    use super::*;
    use halflight_results::Measured;

    fn figure(quantity: String, [low, value, high]: [f64; 3]) -> Measured {
        Measured { quantity, value, interval: Some([low, high]), ..Measured::default() }
    }

    /// Factors whose intervals begin at these shares of the printed ones.
    fn verdict(shares: [f64; 4]) -> Verdict {
        let mut figures = Vec::new();
        for ((order, printed), share) in ORDERS.zip(PRINTED).zip(shares) {
            let around = [share * printed, 2.0 * printed, 3.0 * printed];
            figures.extend([OURS, ALIKE].map(|name| figure(of(name, order), around)));
            figures.push(figure(of(FAST, order), [1.0; 3]));
        }
        judgement(&S3, &figures.iter().collect::<Vec<_>>()).verdict
    }

    #[test]
    fn a_speed_up_counts_from_the_low_end_of_its_interval() {
        assert_eq!(verdict([1.0; 4]), Verdict::Confirmed);
        assert_eq!(verdict([1.0, 1.0, 1.0, 0.999]), Verdict::Partly);
        assert_eq!(verdict([0.999; 4]), Verdict::NotConfirmed);
    }

    #[test]
    fn a_row_without_all_of_its_figures_is_not_measured() {
        assert_eq!(judgement(&S3, &[]).verdict, Verdict::NotMeasured);
        let some = figure(of(OURS, 3), [9.0; 3]);
        assert_eq!(judgement(&S3, &[&some]).verdict, Verdict::NotMeasured);
    }
}
