//! By how much characters leave the spheres that stand for them.

use super::{FRAMES, SPHERES};
use crate::Error;
use crate::ledger::{Bench, number};
use halflight_contract::{Backend, Job, NoMeter, Params};
use halflight_proxies::{Excess, proxies};
use halflight_reports::Sheet;

const SCENES: [&str; 2] = ["walker", "boxers"];

/// A row for each body: spheres hold all vertices at rest, and are carried along.
pub(super) fn excess(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    sheet.heading("Vertices outside their spheres");
    let params = Params::default();
    let mut rows = Vec::new();
    for name in SCENES {
        let scene = halflight_scenes::find(name)?;
        let job = Job::new(&scene, &params, 1, Backend::Cpu, &bench.cache);
        let proxies = proxies(&job, SPHERES, &mut NoMeter).map_err(|error| Error::Other(format!("{name}: {error}")))?;
        let frames: Vec<_> = (0..FRAMES.min(scene.frame_count)).map(|index| scene.frame(index)).collect();
        for (i, object) in scene.objects.iter().enumerate().filter(|(_, object)| object.deformation.is_some()) {
            let Some(proxy) = &proxies[i] else { continue };
            let found: Vec<Excess> =
                frames.iter().map(|frame| proxy.excess(object, &frame.objects[i], frame.time)).collect();
            let most = |of: fn(&Excess) -> f32| f64::from(found.iter().map(of).fold(0.0, f32::max));
            let mean = f64::from(found.iter().map(|excess| excess.outside).sum::<f32>()) / found.len() as f64;
            rows.push(vec![
                format!("{name}, {}", object.name),
                format!("{}%", number(100.0 * mean)),
                format!("{}%", number(100.0 * most(|excess| excess.outside))),
                format!("{} mm", number(1e3 * most(|excess| excess.farthest))),
                format!("{}%", number(100.0 * most(|excess| excess.relative))),
            ]);
        }
    }
    let columns = ["", "outside, mean", "outside, largest of a frame", "farthest", "of the body's size"];
    sheet.table(&columns, &rows);
    sheet.note(&format!("{SPHERES} spheres a body, {FRAMES} frames as shipped. Spheres hold every vertex at rest."));
    Ok(())
}
