//! S11: ambient occlusion against directional shadows.

use super::super::asking::direct;
use super::super::bench::{Bench, Figure, Setting};
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use glam::Vec3;
use halflight_scenes::{Light, Rgb, Scene};

const FAMILY: &str = "ambient-occlusion";
const AMBIENT: &str = "share of the change between opposite lights, ambient occlusion";
/// Without any shadow there would be none to lose.
const DARK: &str = "light that ambient occlusion takes away, mean";
const EXP: &str = "share of the change between opposite lights, SHEXP";
const AMBIENT_ERROR: &str = "RMS error of shadows over RMS shadow, ambient occlusion";
const EXP_ERROR: &str = "RMS error of shadows over RMS shadow, SHEXP";

pub(crate) const S11: Row = Row {
    id: "S11",
    place: "Fig. 1 and §2",
    claim: "Ambient occlusion loses shadows that trail behind bright lighting directions, which SHEXP keeps",
    paper: &[],
    needs: "",
    measure,
    judge,
};

/// A shadow is the part of unblocked light that is missing. Of what the key light's coming from the other side changes in the
/// truth's shadows, a method has the share that regression of its change on the truth's finds.
fn measure(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let ambient = halflight_registry::methods().into_iter().find(|method| method.info().family() == FAMILY);
    let ambient =
        ambient.ok_or_else(|| Error::Other(format!("row S11 needs a method of the family {FAMILY}")))?.info().id;
    let scenes = [1.0, -1.0].map(scene);
    let [first, second] = scenes.each_ref().map(|scene| scene.as_ref());
    let (Ok(first), Ok(second)) = (first, second) else {
        return Err(Error::Other("spheres-60 cannot be loaded".into()));
    };
    let shadows =
        |of: &dyn Fn(&Scene) -> Result<Vec<Rgb>, Error>| Ok::<_, Error>([shadow(of, first)?, shadow(of, second)?]);
    let truth = shadows(&|scene| traced(bench, scene))?;
    let mut figures = Vec::new();
    for (method, share, error) in [
        (ambient, AMBIENT, AMBIENT_ERROR),
        (
            "sh-product/ordered",
            "share of the change between opposite lights, SH product",
            "RMS error of shadows over RMS shadow, SH product",
        ),
        ("shexp/hyb", EXP, EXP_ERROR),
    ] {
        let setting = Setting::new(method, &[])?;
        let own = shadows(&|scene| Ok(bench.shaded(scene, &scene.frame(0), &setting)?.radiance))?;
        if method == ambient {
            let mean = own[0].iter().sum::<f64>() / own[0].len() as f64;
            figures.push(Figure::exact(DARK, "%", 100.0 * mean, own[0].len()));
        }
        let (changed, known) = (change(&own), change(&truth));
        figures.push(Figure::exact(share, "", dot(&changed, &known) / dot(&known, &known), known.len()));
        let missed: Vec<f64> = own[0].iter().zip(&truth[0]).map(|(own, truth)| own - truth).collect();
        let relative = (dot(&missed, &missed) / dot(&truth[0], &truth[0])).sqrt();
        figures.push(Figure::exact(error, "", relative, missed.len()));
    }
    Ok(figures)
}

fn change([first, second]: &[Vec<f64>; 2]) -> Vec<f64> {
    first.iter().zip(second).map(|(first, second)| first - second).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The spheres over the ground, the key light's direction mirrored about the vertical where `side` is -1.
fn scene(side: f32) -> Result<Scene, Error> {
    let mut scene = halflight_scenes::find("spheres-60@0.5")?;
    for light in &mut scene.lights {
        if let Light::Key(key) = &mut light.rest {
            key.direction *= Vec3::new(side, side, 1.0);
        }
    }
    Ok(on_ground(&scene))
}

/// The same with receivers as points, which makes its content anew.
fn on_ground(scene: &Scene) -> Scene {
    let receivers = scene.frame(0).receivers;
    let points: Vec<(Vec3, Vec3)> = receivers.position.iter().copied().zip(receivers.normal.iter().copied()).collect();
    scene.with_receivers(&points)
}

/// The missing part of light at every receiver.
fn shadow(of: &dyn Fn(&Scene) -> Result<Vec<Rgb>, Error>, scene: &Scene) -> Result<Vec<f64>, Error> {
    let mut open = scene.clone();
    open.objects.iter_mut().for_each(|object| object.casts = false);
    let (lit, open) = (of(scene)?, of(&on_ground(&open))?);
    let missing = |(lit, open): (&Rgb, &Rgb)| 1.0 - f64::from(lit.element_sum()) / f64::from(open.element_sum());
    Ok(lit.iter().zip(&open).map(missing).collect())
}

/// Ray traced under light in SH of order 4.
fn traced(bench: &Bench, scene: &Scene) -> Result<Vec<Rgb>, Error> {
    Ok(bench.ask(&direct(scene, 0))?.traced("sh-light:4")?.picture.radiance)
}

fn judge(figures: &Figures<'_>) -> Option<Judgement> {
    let [ambient, exp, dark] = figures.values([AMBIENT, EXP, DARK])?;
    let [lost, kept] = figures.values([AMBIENT_ERROR, EXP_ERROR])?;
    let why = format!(
        "Of the truth's shadows ambient occlusion misses {}, SHEXP {} (RMS). As the key light comes from the other side, shadows of ambient \
         occlusion, which takes {}% of the light away, change by {} of what the truth's do, as they must, since it asks no light where it \
         comes from; SHEXP's by {}. More than 1/2 and less than 1/4 count as lost, less than 1/2 and more than 3/4 as kept.",
        number(lost),
        number(kept),
        number(dark),
        number(ambient),
        number(exp)
    );
    Some(Judgement {
        verdict: Verdict::of(&[dark > 1.0 && ambient < 0.25 && lost > 0.5, exp > 0.75 && kept < 0.5]),
        why,
    })
}
