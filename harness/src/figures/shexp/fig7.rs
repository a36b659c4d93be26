//! Fig. 7: where the error comes from.

use crate::Error;
use crate::budget::chain::walk;
use crate::budget::{Seen, apart};
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::figures::seeing::direct;
use crate::ledger::{Bench, SHADOW, Setting, in_shadow, mean_change, silent};
use halflight_contract::Quantity;
use halflight_reports::{Sheet, Shown, plus_minus};
use halflight_scenes::Scene;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig7",
    place: "Ren et al. 2006, Fig. 7",
    shows: "error budget: light, spheres for meshes, truncation, log space, exponential, higher order",
    look: "Each step adds one approximation, and the map under it shows what that changed. The paper says: truncating each product \
           (sh-product) errs most and darkens, spheres for meshes enlarge shadows a little, log space all but changes nothing, and order 6 \
           truncated to 4 wins much of the truncation back.",
    make,
};

const SCENES: [&str; 2] = ["bunny-studio@0.5", "dino-elephant-courtyard@0.5"];
const METHOD: (&str, &[(&str, &str)]) = ("shexp/ps-star", &[("p", "2")]);
const HIGHER: (&str, &[(&str, &str)]) = ("shexp/ps-star", &[("p", "2"), ("extra-bands", "2")]);
/// Mean changes below this are not worth a word; radiance.
const NOTHING: f64 = 3e-4;

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    SCENES.iter().try_for_each(|scene| scene_budget(bench, sheet, &halflight_scenes::find(scene)?))?;
    claim(bench, sheet, "S7")
}

fn scene_budget(bench: &Bench, sheet: &mut Sheet, scene: &Scene) -> Result<(), Error> {
    let question = direct(scene, 0);
    let asked = bench.ask(&question)?;
    let setting = Setting::new(METHOD.0, METHOD.1)?;
    let steps = walk(scene, Quantity::Direct, setting.method, &setting.params).steps;
    let mut seen = steps.iter().map(|step| asked.see(&step.what, &mut silent)).collect::<Result<Vec<_>, _>>()?;
    let mut names: Vec<String> = steps.into_iter().map(|step| step.name).collect();
    seen.push(asked.shaded(HIGHER.0, HIGHER.1)?);
    names.push("order 6 truncated to 4".into());
    let shadow = in_shadow(bench, scene, &asked)?;

    let dark = shadow.iter().filter(|dark| **dark).count();
    sheet.heading(&scene.name);
    sheet.note(&format!(
        "Mean signed changes are of radiance; in shadow: the {dark} receivers of {} that lack {SHADOW} or more of the light of the traced \
         picture; ± one standard error by the references' noise.",
        shadow.len()
    ));
    let mut rows = vec![vec![names[0].clone()]];
    for (pair, name) in seen.windows(2).zip(&names[1..]) {
        rows.push(row(name, [&pair[0], &pair[1]], [&seen[0], &seen[1]], &shadow)?);
    }
    let columns = [
        "step",
        "RMSE from truth",
        "from traced, SH light",
        "RMSE of the step",
        "bias of the step",
        "in shadow",
        "outside",
        "shadows are made",
    ];
    sheet.table(&columns, &rows);
    let caption = |i: usize| rows[i].get(4).map_or(String::new(), |bias| format!("bias of the step {bias}"));
    let before = |i: usize| i.checked_sub(1).map(|i| &seen[i].picture);
    let shown = (0..seen.len()).map(|i| Shown {
        name: names[i].clone(),
        caption: caption(i),
        picture: &seen[i].picture,
        against: before(i),
    });
    Ok(sheet.pictures(&shown.collect::<Vec<_>>())?)
}

fn row(name: &str, [before, this]: [&Seen; 2], traced: [&Seen; 2], shadow: &[bool]) -> Result<Vec<String>, Error> {
    let (truth, step) = (apart(this, traced[0])?, apart(this, before)?);
    // The step that is this picture itself has none.
    let same_light = if std::ptr::eq(this, traced[1]) { None } else { Some(apart(this, traced[1])?) };
    let [inside, outside] = [true, false].map(|dark| mean_change(this, before, shadow, dark));
    let values = [
        (truth.rmse, truth.rmse_error),
        same_light.map_or((0.0, 0.0), |d| (d.rmse, d.rmse_error)),
        (step.rmse, step.rmse_error),
        (step.bias, step.bias_error),
        inside,
        outside,
    ];
    let told = [sign(inside, ["darker", "lighter"]), sign(outside, ["larger", "smaller"])].concat().join(", ");
    let values = values.iter().map(|(value, error)| plus_minus(*value, *error));
    Ok([name.to_owned()].into_iter().chain(values).chain([told]).collect())
}

/// What a change makes of shadows, where it is surely one.
fn sign((change, error): (f64, f64), [below, above]: [&'static str; 2]) -> Vec<&'static str> {
    match change {
        _ if change.abs() <= 3.0 * error || change.abs() < NOTHING => Vec::new(),
        ..0.0 => vec![below],
        _ => vec![above],
    }
}
