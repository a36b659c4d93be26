//! Fig. 6: cuts that adapt to clusters of receivers, and seams between them.

use super::seams::square;
use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::ledger::{Bench, Seams, Setting};
use glam::Vec3;
use halflight_blockers::clusters;
use halflight_reports::{Sheet, Shown};

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/fig6",
    place: "Ren et al. 2006, Fig. 6",
    shows: "spheres in the cut of each receiver cluster; the ground without and with ratio vectors",
    look: "Clusters near the blockers' feet take more spheres, far ones few. Without ratio vectors the shadow breaks at the borders of \
           clusters, with them it goes on; `shexp/seams` shows how much is left.",
    make,
};

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let seams = Seams::shade(bench)?;
    let counts = cut_sizes(bench, &seams)?;
    let most = counts.iter().fold(0.0f32, |most, count| most.max(*count));
    let counts = square(counts.iter().map(|count| Vec3::splat(*count)).collect());
    let [exact, without, with] = [&seams.exact, &seams.without, &seams.with].map(|picture| square(picture.clone()));
    let shown = |name: &str, picture, against| Shown { name: name.into(), caption: String::new(), picture, against };
    sheet.maps([0.0, f64::from(most)], &[shown("(a) spheres in the cluster's cut", &counts, None)])?;
    sheet.pictures(&[
        shown("every sphere", &exact, None),
        shown("(b) cuts without ratio vectors", &without, Some(&exact)),
        shown("(c) cuts with ratio vectors", &with, Some(&exact)),
    ])?;
    claim(bench, sheet, "S9")?;
    claim(bench, sheet, "S10")
}

/// How many spheres are in the cut of every receiver's cluster: each cluster is shaded by itself.
fn cut_sizes(bench: &Bench, seams: &Seams) -> Result<Vec<f32>, Error> {
    let setting = Setting::new("shexp/hyb", &Seams::SETTINGS)?;
    let receivers = &seams.ground.frame.receivers;
    let mut counts = vec![0.0; receivers.len()];
    for members in clusters(receivers, setting.params.int("cluster")) {
        let point = |&i: &usize| (receivers.position[i], receivers.normal[i]);
        let scene = seams.ground.scene.with_receivers(&members.iter().map(point).collect::<Vec<_>>());
        let counters = bench.shaded(&scene, &scene.frame(0), &setting)?.recorded.counters;
        let count = counters.get("spheres in cuts").copied().unwrap_or(0) as f32;
        members.iter().for_each(|&member| counts[member] = count);
    }
    Ok(counts)
}
