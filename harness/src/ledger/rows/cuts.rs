//! S9 and S10: cuts through sphere hierarchies, and ratio vectors.

use super::super::asking::direct;
use super::super::bench::{Bench, Figure, Setting};
use super::super::ground::Ground;
use super::super::row::{Figures, Judgement, Row, Verdict, number};
use crate::Error;
use crate::budget::apart;
use halflight_blockers::clusters;
use halflight_scenes::Rgb;

/// Name, scene, spheres an object; as many receivers as the paper's scenes have.
const SCENES: [(&str, &str, &str); 2] = [("battle size", "battle", "61"), ("dino size", "herd", "32")];
const CUT: &str = "25";
const ADDED: &str = "10 000 × 500: RMSE that cuts add over RMSE without";

pub(crate) const S9: Row = Row {
    id: "S9",
    place: "§9 and Fig. 10",
    claim: "Cuts are far smaller than sets: a mean of 47 and at most 117 of 244 leaf spheres, 42 and 160 of 500",
    paper: &[
        ("battle size: leaf spheres", "244"),
        ("battle size: accumulated a receiver, mean", "47"),
        ("battle size: largest cut", "117"),
        ("dino size: leaf spheres", "500"),
        ("dino size: accumulated a receiver, mean", "42"),
        ("dino size: largest cut", "160"),
    ],
    needs: "",
    measure: measure_cuts,
    judge: judge_cuts,
};

fn measure_cuts(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let mut figures = Vec::new();
    for (name, scene, spheres) in SCENES {
        let scene = halflight_scenes::find(scene)?;
        let frame = scene.frame(0);
        let counters = |cut: &str| {
            let setting = Setting::new("shexp/hyb", &[("spheres", spheres), ("cut", cut)])?;
            Ok::<_, Error>(bench.shaded(&scene, &frame, &setting)?.recorded.counters)
        };
        let (without, with) = (counters("0")?, counters(CUT)?);
        let amount =
            |of: &std::collections::BTreeMap<String, u64>, name: &str| of.get(name).copied().unwrap_or(0) as f64;
        let receivers = amount(&with, "receivers");
        let seen = |of| {
            let names =
                ["blockers accumulated", "blockers removed by self-shadow rules", "blockers below the smallest angle"];
            names.iter().map(|name| amount(of, name)).sum::<f64>() / receivers
        };
        let count = receivers as usize;
        let clusters = amount(&with, "receiver clusters");
        figures.extend([
            Figure::exact(format!("{name}: leaf spheres"), "", seen(&without), count),
            Figure::exact(
                format!("{name}: accumulated a receiver, mean, without cuts"),
                "",
                amount(&without, "blockers accumulated") / receivers,
                count,
            ),
            Figure::exact(
                format!("{name}: accumulated a receiver, mean"),
                "",
                amount(&with, "blockers accumulated") / receivers,
                count,
            ),
            Figure::exact(
                format!("{name}: cut, mean over clusters"),
                "",
                amount(&with, "spheres in cuts") / clusters,
                clusters as usize,
            ),
            Figure::exact(format!("{name}: largest cut"), "", amount(&with, "largest cut"), clusters as usize),
        ]);
    }
    figures.extend(ten_thousand(bench)?);
    Ok(figures)
}

/// Ten thousand receivers before five hundred spheres: what a cut wins, and what it costs of the error that is there without it.
fn ten_thousand(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let (name, scene) = ("10 000 × 500", halflight_scenes::find("herd@0.32")?);
    let question = direct(&scene, 0);
    let asked = bench.ask(&question)?;
    let [without, with] = ["0", CUT].map(|cut| [("cut", cut)]);
    let truth = asked.traced("sh-light:4")?;
    let [exact, cut] = [asked.shaded("shexp/hyb", &without)?, asked.shaded("shexp/hyb", &with)?];
    let (own, added) = (apart(&exact, &truth)?, apart(&cut, &exact)?);
    let [without, with] = [Setting::new("shexp/hyb", &without)?, Setting::new("shexp/hyb", &with)?];
    let mut works = [bench.framing(&scene, &asked.frame, &without)?, bench.framing(&scene, &asked.frame, &with)?];
    let times = bench.interleaved(&mut works)?;
    let milliseconds = |times: &[f64]| times.iter().map(|time| 1e-6 * time).collect::<Vec<_>>();
    Ok(vec![
        Figure::median(format!("{name}: a frame without cuts"), "ms", &milliseconds(&times[0])),
        Figure::median(format!("{name}: a frame with cuts"), "ms", &milliseconds(&times[1])),
        Figure::estimate(format!("{name}: RMSE without cuts"), own.rmse, own.rmse_error, own.receivers),
        Figure::exact(format!("{name}: RMSE that cuts add"), "", added.rmse, added.receivers),
        Figure::exact(ADDED, "", added.rmse / own.rmse, added.receivers),
    ])
}

fn judge_cuts(figures: &Figures<'_>) -> Option<Judgement> {
    let (mut parts, mut told) = (Vec::new(), Vec::new());
    for (name, ..) in SCENES {
        let get = |what: &str| figures.value(&format!("{name}: {what}"));
        let (leaves, mean, largest) = (get("leaf spheres")?, get("accumulated a receiver, mean")?, get("largest cut")?);
        // "Far below": the mean under a quarter of the leaves, the largest under two thirds, both looser than any printed pair.
        parts.extend([mean < 0.25 * leaves, largest < leaves * 2.0 / 3.0]);
        told.push(format!("{name} a mean of {} and at most {} of {}", number(mean), number(largest), number(leaves)));
    }
    let why = format!(
        "With θmax = {CUT}°: {}; a quarter and two thirds of the leaves count as far below. They add {} of the error that is there \
                 without them.",
        told.join(", "),
        number(figures.value(ADDED)?)
    );
    Some(Judgement { verdict: Verdict::of(&parts), why })
}

const SIDE: usize = 128;
const WITH: &str = "jump of the error between neighbours of two clusters over that within one, with ratio vectors";
const WITHOUT: &str = "jump of the error between neighbours of two clusters over that within one, without";
const JUMP_WITH: &str = "jump between clusters, with ratio vectors, of mean radiance";
const JUMP_WITHOUT: &str = "jump between clusters, without ratio vectors, of mean radiance";

pub(crate) const S10: Row = Row {
    id: "S10",
    place: "Fig. 6 and §6.3",
    claim: "Ratio vectors eliminate the seams between receiver clusters that different cuts cause",
    paper: &[],
    needs: "",
    measure: measure_seams,
    judge: judge_seams,
};

/// A ground under two meshes, shaded sphere by sphere and by cuts with ratio vectors and without.
pub(crate) struct Seams {
    /// Every sphere by itself.
    pub(crate) exact: Vec<Rgb>,
    /// By cuts with ratio vectors.
    pub(crate) with: Vec<Rgb>,
    /// By cuts without.
    pub(crate) without: Vec<Rgb>,
    /// The cluster of every receiver; receivers are a square in rows.
    pub(crate) cluster: Vec<usize>,
    /// What was shaded.
    pub(crate) ground: Ground,
}

impl Seams {
    /// Receivers a side.
    pub(crate) const SIDE: usize = SIDE;

    pub(crate) fn shade(bench: &Bench) -> Result<Seams, Error> {
        let ground = Ground::new(bench, "dino-elephant-courtyard", 5.0, SIDE, 64)?;
        let shade = |settings: &[(&str, &str)]| {
            Ok::<_, Error>(bench.shaded(&ground.scene, &ground.frame, &Setting::new("shexp/hyb", settings)?)?.radiance)
        };
        let [exact, with] = [shade(&[])?, shade(&Seams::SETTINGS)?];
        let without = shade(&[("cut", CUT), ("ratio", "false")])?;
        let mut cluster = vec![usize::MAX; SIDE * SIDE];
        let most = Setting::new("shexp/hyb", &[])?.params.int("cluster");
        for (number, members) in clusters(&ground.frame.receivers, most).iter().enumerate() {
            members.iter().for_each(|&member| cluster[member] = number);
        }
        Ok(Seams { exact, with, without, cluster, ground })
    }

    /// Cuts with ratio vectors.
    pub(crate) const SETTINGS: [(&'static str, &'static str); 1] = [("cut", CUT)];

    /// A picture's grey values over the mean of the exact picture's.
    pub(crate) fn levels(&self, picture: &[Rgb]) -> Vec<f64> {
        let level = f64::from(self.exact.iter().map(grey).sum::<f32>()) / self.exact.len() as f64;
        picture.iter().map(|rgb| f64::from(grey(rgb)) / level).collect()
    }
}

fn measure_seams(bench: &Bench) -> Result<Vec<Figure>, Error> {
    let seams = Seams::shade(bench)?;
    let exact = seams.levels(&seams.exact);
    let mut figures = Vec::new();
    for (picture, over, between) in [(&seams.with, WITH, JUMP_WITH), (&seams.without, WITHOUT, JUMP_WITHOUT)] {
        let error: Vec<f64> = seams.levels(picture).iter().zip(&exact).map(|(a, b)| a - b).collect();
        let ([apart, within], pairs) = jumps(&error, &seams.cluster);
        figures.push(Figure::exact(between, "%", 100.0 * apart, pairs));
        figures.push(Figure::exact(over, "×", apart / within, pairs));
    }
    Ok(figures)
}

fn grey(rgb: &Rgb) -> f32 {
    rgb.element_sum() / 3.0
}

/// Root mean square of what the error changes by between neighbours of two clusters and of one, and how many pairs of two there are.
fn jumps(error: &[f64], cluster: &[usize]) -> ([f64; 2], usize) {
    let mut sums = [(0.0, 0usize); 2];
    let places = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    for (x, y) in places {
        let a = y * SIDE + x;
        for b in [(x + 1 < SIDE).then_some(a + 1), (y + 1 < SIDE).then_some(a + SIDE)].into_iter().flatten() {
            let (sum, count) = &mut sums[usize::from(cluster[a] == cluster[b])];
            *sum += (error[a] - error[b]).powi(2);
            *count += 1;
        }
    }
    (sums.map(|(sum, count)| (sum / count.max(1) as f64).sqrt()), sums[0].1)
}

fn judge_seams(figures: &Figures<'_>) -> Option<Judgement> {
    let [with, without] = figures.values([JUMP_WITH, JUMP_WITHOUT])?;
    let [over_with, over_without] = figures.values([WITH, WITHOUT])?;
    // Gone: less than a quarter of the jump is left.
    let verdict = Verdict::of(&[with < without, with < 0.25 * without]);
    let why = format!(
        "Between clusters the error jumps by {}% of the mean radiance with ratio vectors and {}% without ({} and {} times as much as \
         within clusters): 1/{} is left, where less than 1/4 counts as gone.",
        number(with),
        number(without),
        number(over_with),
        number(over_without),
        number(without / with)
    );
    Some(Judgement { verdict, why })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_at_a_border_is_a_seam_and_a_slope_is_none() {
        let cluster: Vec<usize> = (0..SIDE * SIDE).map(|i| i % SIDE / (SIDE / 2)).collect();
        let step: Vec<f64> = cluster.iter().map(|c| *c as f64).collect();
        assert_eq!(jumps(&step, &cluster), ([1.0, 0.0], SIDE));
        let slope: Vec<f64> = (0..SIDE * SIDE).map(|i| (i / SIDE + i % SIDE) as f64).collect();
        assert_eq!(jumps(&slope, &cluster).0, [1.0, 1.0]);
    }
}
