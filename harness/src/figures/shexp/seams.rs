//! Seams between clusters with and without ratio vectors.

use crate::Error;
use crate::figures::Figure;
use crate::figures::claims::claim;
use crate::ledger::{Bench, Seams, number};
use glam::Vec3;
use halflight_reports::{Axis, Mark, Plot, Series, Sheet, Shown};
use halflight_results::{Layout, Picture};

pub(super) const FIGURE: Figure = Figure {
    id: "shexp/seams",
    place: "Ren et al. 2006, §6.3 and Fig. 6",
    shows: "what cuts change, with and without ratio vectors, and how rough pictures are across the borders of clusters",
    look: "The maps show the tiling of clusters, strongly without ratio vectors, faintly with them. So does the profile: what cuts change is \
           smooth within clusters and breaks at their borders; the peak with ratio vectors is what is left of the seams.",
    make,
};

const SIDE: usize = Seams::SIDE;
/// Receivers on either side of a border; borders nearer to another one are left out.
const REACH: isize = 5;

fn make(bench: &Bench, sheet: &mut Sheet) -> Result<(), Error> {
    let seams = Seams::shade(bench)?;
    let named = [
        ("every sphere", &seams.exact),
        ("without ratio vectors", &seams.without),
        ("with ratio vectors", &seams.with),
    ];
    let pictures = named.map(|(_, picture)| square(picture.clone()));
    let shown = named.iter().zip(&pictures).enumerate().map(|(i, ((name, _), picture))| Shown {
        name: (*name).to_owned(),
        caption: String::new(),
        picture,
        against: (i > 0).then_some(&pictures[0]),
    });
    sheet.pictures(&shown.collect::<Vec<_>>())?;
    let exact = seams.levels(&seams.exact);
    let profiles = [named[1], named[2]].map(|(name, picture)| {
        let error: Vec<f64> = seams.levels(picture).iter().zip(&exact).map(|(a, b)| a - b).collect();
        (name, profile(&error, &seams.cluster))
    });
    let points =
        |profile: &[f64]| (1 - REACH..=REACH).zip(profile).map(|(k, v)| (k as f64 - 0.5, *v)).collect::<Vec<_>>();
    sheet.plot(&Plot {
        title: "Second difference across borders of what cuts change: root mean square, of the mean radiance".into(),
        across: Axis::linear("receivers from the border; −0.5 and 0.5 straddle it"),
        upwards: Axis::linear("second difference"),
        series: profiles.iter().map(|(name, profile)| Series::new(*name, Mark::Line, points(profile))).collect(),
    })?;
    let rows = profiles.iter().map(|(name, profile)| {
        let [at, away] = peak(profile);
        [vec![(*name).to_owned()], [at, away, at / away].map(number).to_vec()].concat()
    });
    sheet.table(&["second difference", "at the border", "away from it", "ratio"], &rows.collect::<Vec<_>>());
    claim(bench, sheet, "S10")
}

/// A picture of the ground.
pub(super) fn square(radiance: Vec<Vec3>) -> Picture {
    let valid = vec![true; radiance.len()];
    Picture { layout: Layout::Image { width: SIDE, height: SIDE }, radiance, valid }
}

/// Root mean square of the second difference of values along rows and columns, by the place relative to a border that the line
/// crosses: entry `i` is at the receiver `i + 1 − REACH` from the last before the border.
fn profile(values: &[f64], cluster: &[usize]) -> Vec<f64> {
    let (mut sums, mut count) = (vec![0.0; 2 * REACH as usize], 0usize);
    for [start, step] in (0..SIDE).flat_map(|line| [[line * SIDE, 1], [line, SIDE]]) {
        let at = |place: isize| start + place as usize * step;
        for border in REACH..SIDE as isize - REACH - 1 {
            // Between `border` and the next, and no other one near.
            let crosses = |place: isize| cluster[at(place)] != cluster[at(place + 1)];
            if (border - REACH..=border + REACH).any(|place| crosses(place) != (place == border)) {
                continue;
            }
            count += 1;
            for (sum, place) in sums.iter_mut().zip(border + 1 - REACH..) {
                let second = values[at(place - 1)] - 2.0 * values[at(place)] + values[at(place + 1)];
                *sum += second * second;
            }
        }
    }
    sums.iter().map(|sum| (sum / count.max(1) as f64).sqrt()).collect()
}

/// The larger of a profile at the border, and its mean farther off.
fn peak(profile: &[f64]) -> [f64; 2] {
    let middle = REACH as usize - 1;
    let away: Vec<f64> =
        (0..profile.len()).filter(|i| !(middle - 1..=middle + 2).contains(i)).map(|i| profile[i]).collect();
    [profile[middle].max(profile[middle + 1]), away.iter().sum::<f64>() / away.len() as f64]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_peaks_at_its_border_and_a_slope_nowhere() {
        let cluster: Vec<usize> = (0..SIDE * SIDE).map(|i| i % SIDE / 16).collect();
        let step: Vec<f64> = cluster.iter().map(|c| (c % 2) as f64).collect();
        let found = profile(&step, &cluster);
        let middle = REACH as usize - 1;
        assert!(found.iter().enumerate().all(|(i, v)| (*v == 1.0) == (i == middle || i == middle + 1)), "{found:?}");
        assert_eq!(peak(&found), [1.0, 0.0]);
        let slope: Vec<f64> = (0..SIDE * SIDE).map(|i| (i % SIDE) as f64).collect();
        assert!(profile(&slope, &cluster).iter().all(|v| *v == 0.0));
    }
}
