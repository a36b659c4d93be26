//! Fig. 4: sphere sets and their competitors.

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::figures::seeing::direct;
use crate::ledger::{Bench, number};
use glam::Vec3;
use halflight_proxies::Maker;
use halflight_reports::{Sheet, Shown};
use halflight_results::Picture;
use halflight_scenes::{Camera, Object, Placement, Scene, Shape};
use std::sync::Arc;

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig4",
    place: "Ren et al. 2006, Fig. 4",
    shows: "a mesh and its sphere sets by octree, medial axis and the variational method",
    look: "With as many spheres the octree's stand far off the mesh, the medial set's and ours follow it; E is the volume outside the mesh over \
           the mesh's (printed: 4.1 with 575 spheres, 0.52 and 0.35 with 64).",
    make,
};

const COUNT: usize = 64;

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let scene = halflight_scenes::find("bunny-studio")?;
    let bunny = scene.objects.iter().find(|object| object.name == "bunny").cloned();
    let Some((bunny, Shape::Mesh(mesh))) = bunny.as_ref().map(|bunny| (bunny, &*bunny.shape)) else {
        return Err(Error::Other("bunny-studio: expected a mesh bunny".into()));
    };
    let about = middle(&mesh.positions);
    let mut pictures = vec![("original".to_owned(), String::new(), headlight(bench, &scene, bunny, about)?)];
    for maker in [Maker::Octree, Maker::Medial, Maker::Variational] {
        let set = maker.make(mesh, COUNT, &mut |_, _| true);
        let set = set.ok_or_else(|| Error::Other(format!("no set by {}", maker.name())))?;
        let caption = format!("{} spheres, E = {}", set.spheres.len(), number(f64::from(set.outside_volume)));
        let shape = Shape::Spheres(set.spheres);
        let spheres = Object { content: shape.content(), shape: Arc::new(shape), texture: None, ..bunny.clone() };
        pictures.push((maker.name().to_owned(), caption, headlight(bench, &scene, &spheres, about)?));
    }
    let shown = pictures.iter().map(|(name, caption, picture)| Shown {
        name: name.clone(),
        caption: caption.clone(),
        picture,
        against: None,
    });
    sheet.pictures(&shown.collect::<Vec<_>>())?;
    claim(bench, sheet, "S6")
}

/// An object by itself, lit from where it is looked at.
fn headlight(bench: &Bench, scene: &Scene, object: &Object, about: Vec3) -> Result<Picture, Error> {
    let camera = scene.camera.ok_or_else(|| Error::Other(format!("{}: expected a camera", scene.name)))?;
    let camera = Camera { width: 280, height: 280, target: about, ..camera };
    let (objects, placement) = (vec![object.clone()], Placement::Camera);
    let scene = Scene { objects, camera: Some(camera), placement, ..scene.clone() }.as_changed();
    let question = direct(&scene, 0);
    let asked = bench.ask(&question)?;
    let receivers = &asked.frame.receivers;
    let light = |(normal, position): (&Vec3, &Vec3)| {
        Vec3::splat(0.15 + 0.85 * normal.dot((camera.eye - *position).normalize_or_zero()).max(0.0))
    };
    Ok(asked.picture(receivers.normal.iter().zip(&receivers.position).map(light).collect()))
}

fn middle(positions: &[Vec3]) -> Vec3 {
    let ends = positions.iter().fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
    0.5 * (ends.0 + ends.1)
}
