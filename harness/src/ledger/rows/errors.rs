//! S7: sizes and signs of the sources of error.

use super::super::asking::direct;
use super::super::bench::{Bench, Figure, Setting, silent};
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use super::super::shadows::{in_shadow, mean_change};
use crate::Error;
use crate::budget::apart;
use crate::budget::chain::walk;
use halflight_contract::Quantity;
use halflight_metrics::Difference;

const SCENES: [(&str, &str); 2] = [("bunny-studio@0.5", "bunny"), ("dino-elephant-courtyard@0.5", "dino and elephant")];
const SPHERES: &str = "spheres for meshes";
const TRUNCATION: &str = "truncation after each product";
const LOG: &str = "log space";
const OUTSIDE: &str = "spheres for meshes, outside shadows";

pub(crate) const S7: Row = Row {
    id: "S7",
    place: "Fig. 7 and §9",
    claim: "Truncation after each SH product errs most and darkens, sphere sets err less and enlarge shadows, log space errs least; \
            summing at order 6 and truncating to 4 is more accurate than order 4",
    paper: &[],
    needs: "",
    measure,
    judge,
};

fn rmse(model: &str, what: &str) -> String {
    format!("{model}: RMSE, {what}")
}

fn bias(model: &str, what: &str) -> String {
    format!("{model}: bias, {what}")
}

fn measure(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let figures = SCENES.iter().map(|(scene, model)| scene_figures(bench, scene, model));
    Ok(figures.collect::<Result<Vec<_>, _>>()?.concat())
}

fn scene_figures(bench: &Bench, name: &str, model: &str) -> Result<Vec<Figure>, Error> {
    let scene = halflight_scenes::find(name)?;
    let question = direct(&scene, 0);
    let asked = bench.ask(&question)?;
    let setting = Setting::new("shexp/ps-star", &[("p", "2")])?;
    let steps = walk(&scene, Quantity::Direct, setting.method, &setting.params).steps;
    let see = |name: &str| {
        let step = steps.iter().find(|step| step.name.starts_with(name));
        asked.see(&step.expect("a step of the walk").what, &mut silent)
    };
    // (a) to (e) of Fig. 7, all under light of order 4.
    let (traced, spheres) = (see("+ sh-light")?, see("+ sphere-proxies")?);
    let (product, exp) = (see("sh-product/ordered")?, see("shexp/ps-star")?);
    let higher = asked.shaded("shexp/ps-star", &[("p", "2"), ("extra-bands", "2")])?;
    let shadow = in_shadow(bench, &scene, &asked)?;
    let outside = shadow.iter().filter(|dark| !**dark).count();
    let mut figures = Vec::new();
    for (what, this, before) in [(SPHERES, &spheres, &traced), (TRUNCATION, &product, &spheres), (LOG, &exp, &product)]
    {
        let Difference { rmse: r, rmse_error, bias: b, bias_error, receivers, .. } = apart(this, before)?;
        figures.push(Figure::estimate(rmse(model, what), r, rmse_error, receivers));
        figures.push(Figure::estimate(bias(model, what), b, bias_error, receivers));
    }
    let (change, error) = mean_change(&spheres, &traced, &shadow, false);
    figures.push(Figure::estimate(bias(model, OUTSIDE), change, error, outside));
    for (what, this) in [("order 4 in all", &exp), ("order 6 truncated to 4 in all", &higher)] {
        let found = apart(this, &traced)?;
        figures.push(Figure::estimate(rmse(model, what), found.rmse, found.rmse_error, found.receivers));
    }
    Ok(figures)
}

fn judge(figures: &Figures<'_>) -> Option<Judgement> {
    let (mut order, mut signs, mut higher, mut told) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (_, model) in SCENES {
        let [spheres, truncation, log] =
            figures.values([SPHERES, TRUNCATION, LOG].map(|w| rmse(model, w)).each_ref().map(String::as_str))?;
        let [of_spheres, of_truncation] =
            figures.values([OUTSIDE, TRUNCATION].map(|w| bias(model, w)).each_ref().map(String::as_str))?;
        let [four, six] = [
            figures.value(&rmse(model, "order 4 in all"))?,
            figures.value(&rmse(model, "order 6 truncated to 4 in all"))?,
        ];
        order.push(truncation > spheres && spheres > log);
        // Surely: the whole interval.
        let darkens = |what| Some(figures.interval(&bias(model, what))?[1] < 0.0);
        signs.push(darkens(TRUNCATION)? && darkens(OUTSIDE)?);
        let [[_, most], [least, _]] = [
            figures.interval(&rmse(model, "order 6 truncated to 4 in all"))?,
            figures.interval(&rmse(model, "order 4 in all"))?,
        ];
        higher.push(most < least);
        told.push(format!(
            "{model}: truncation {} (bias {}), spheres {} (outside shadows {}), log space {}; in all {} at order 4, {} at 6 truncated to 4",
            number(truncation),
            number(of_truncation),
            number(spheres),
            number(of_spheres),
            number(log),
            number(four),
            number(six)
        ));
    }
    let all = |parts: &[bool]| parts.iter().all(|holds| *holds);
    let parts = [all(&order), all(&signs), all(&higher)];
    let holds = |part: bool, text: &str| format!("{text} {}", if part { "holds" } else { "does not hold everywhere" });
    let why = format!(
        "{}, {}, {}. RMSE of {}.",
        holds(parts[0], "The order of sizes"),
        holds(parts[1], "that truncation darkens and spheres darken what lies outside shadows"),
        holds(parts[2], "that order 6 truncated to 4 is better"),
        told.join("; ")
    );
    Some(Judgement { verdict: Verdict::of(&parts), why })
}
