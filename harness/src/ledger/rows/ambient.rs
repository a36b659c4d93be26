//! S11: ambient occlusion against directional shadows.

use super::super::bench::{Bench, Figure, Setting, silent};
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use crate::budget::Asked;
use crate::budget::chain::walk;
use crate::probe::Question;
use glam::Vec3;
use halflight_contract::Quantity;
use halflight_scenes::{Light, Rgb, Scene};

const FAMILY: &str = "ambient-occlusion";
const AMBIENT: &str = "share of the change between opposite lights, ambient occlusion";
const EXP: &str = "share of the change between opposite lights, SHEXP";

pub(crate) const S11: Row = Row {
    id: "S11",
    place: "Fig. 1 and §2",
    claim: "Ambient occlusion loses shadows that trail behind bright lighting directions, which SHEXP keeps",
    paper: &[],
    needs: "a method of the family `ambient-occlusion`, which is not registered yet",
    measure,
    judge,
};

/// A shadow is the part of unblocked light that is missing. Of what the key light's coming from the other side changes in the
/// truth's shadows, a method has the share that regression of its change on the truth's finds.
fn measure(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let ambient = halflight_registry::methods().into_iter().find(|method| method.info().family() == FAMILY);
    let ambient = ambient.ok_or_else(|| Error::Other(format!("row S11 needs {}", S11.needs)))?.info().id;
    let scenes = [1.0, -1.0].map(scene);
    let [first, second] = scenes.each_ref().map(|scene| scene.as_ref());
    let (Ok(first), Ok(second)) = (first, second) else {
        return Err(Error::Other("spheres-60 cannot be loaded".into()));
    };
    let change = |of: &dyn Fn(&Scene) -> Result<Vec<Rgb>, Error>| {
        let [first, second] = [shadow(of, first)?, shadow(of, second)?];
        Ok::<Vec<f64>, Error>(first.iter().zip(&second).map(|(a, b)| a - b).collect())
    };
    let truth = change(&|scene| traced(bench, scene))?;
    let mut figures = Vec::new();
    for (name, method) in [
        (AMBIENT, ambient),
        ("share of the change between opposite lights, SH product", "sh-product/ordered"),
        (EXP, "shexp/hyb"),
    ] {
        let setting = Setting::new(method, &[])?;
        let own = change(&|scene| Ok(bench.shaded(scene, &scene.frame(0), &setting)?.radiance))?;
        let along: f64 = own.iter().zip(&truth).map(|(own, truth)| own * truth).sum();
        let whole: f64 = truth.iter().map(|truth| truth * truth).sum();
        figures.push(Figure::exact(name, "", along / whole, truth.len()));
    }
    Ok(figures)
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
    let question = Question { scene, frame: 0, quantity: Quantity::Direct, seed: 1 };
    let asked = Asked::new(&question, &bench.terms.quality, &bench.terms.cache)?;
    let setting = Setting::new("shexp/hyb", &[])?;
    let steps = walk(scene, Quantity::Direct, setting.method, &setting.params).steps;
    let step = steps.iter().find(|step| step.name.starts_with("+ sh-light")).expect("there is distant light");
    Ok(asked.see(&step.what, &mut silent)?.picture.radiance)
}

fn judge(figures: &Figures<'_>) -> Option<Judgement> {
    let [ambient, exp] = figures.values([AMBIENT, EXP])?;
    let why = format!(
        "As the key light comes from the other side, ambient occlusion changes by {} of what the truth changes by along with it, \
         SHEXP by {}; less than 1/4 counts as lost, more than 3/4 as kept.",
        number(ambient),
        number(exp)
    );
    Some(Judgement { verdict: Verdict::of(&[ambient < 0.25, exp > 0.75]), why })
}
