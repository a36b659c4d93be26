//! Fig. 5: what self-shadow rules make of spheres about a receiver's plane.

use crate::Error;
use crate::figures::Figure;
use crate::figures::seeing::{alone, beside, direct};
use crate::ledger::Bench;
use glam::{Vec2, Vec3};
use halflight_proxies::SelfShadow;
use halflight_reports::Sheet;
use halflight_scenes::{Grid, Placement, Scene, Shape, Sphere};
use std::sync::Arc;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig5",
    place: "Ren et al. 2006, Fig. 5",
    shows: "a plane under a uniform sky with spheres that poke through it, by self-shadow rule",
    look: "From left to right the centres lie at −0.5, 0, 0.5 and 0.9 radii over the plane. Traced, every disc within a sphere is black: the \
           self-shadow of a bounding set. Without rules a sphere that holds the receiver blocks half the directions, and discs stay, which is \
           the banding that the paper speaks of. The printed rules leave nothing of spheres whose centres are not above, and a bright ring \
           about the two others, where what is blocked drops at the rim; the continuous rule has no ring.",
    make,
};

const HEIGHTS: [f32; 4] = [-0.5, 0.0, 0.5, 0.9];

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let scene = row_of_spheres()?;
    let question = direct(&scene, 0);
    let asked = bench.ask(&question)?;
    let traced = asked.traced("truth")?;
    let rules = [SelfShadow::Off, SelfShadow::Paper, SelfShadow::Continuous].map(SelfShadow::name);
    let seen = rules.map(|rule| asked.shaded("sh-product/ordered", &[("order", "6"), ("self-shadow", rule)]));
    let mut shown = vec![alone("ray traced", &traced)];
    let seen = seen.into_iter().collect::<Result<Vec<_>, _>>()?;
    for (rule, seen) in rules.iter().zip(&seen) {
        shown.push(beside(format!("rule: {rule}"), seen, &traced)?);
    }
    Ok(sheet.pictures(&shown)?)
}

fn row_of_spheres() -> Result<Scene, Error> {
    let mut scene = halflight_scenes::find("sphere-plane")?;
    let sphere = |(i, c): (usize, &f32)| Sphere { center: Vec3::new(3.0 * (i as f32 - 1.5), 0.0, *c), radius: 1.0 };
    let shape = Shape::Spheres(HEIGHTS.iter().enumerate().map(sphere).collect());
    scene.objects[0].content = shape.content();
    scene.objects[0].shape = Arc::new(shape);
    let (center, normal) = (Vec3::ZERO, Vec3::Z);
    let grid = Grid { center, size: Vec2::new(12.0, 4.0), resolution: [240, 80], normal, object: None };
    Ok(Scene { placement: Placement::Grid(grid), ..scene }.as_changed())
}
