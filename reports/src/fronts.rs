//! Pareto fronts: which settings nobody beats, of error against time and of error against memory.

use crate::{Report, Row};
use halflight_metrics::{Measured, Standing, geometric_mean, standings};
use std::collections::{BTreeMap, BTreeSet};

/// What errors are weighed against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Against {
    /// Shading time: the median of its repeats with its 95% interval, nanoseconds.
    Time,
    /// Bytes held after shading, host and device together, as the method counts them; exact.
    Memory,
}

impl Against {
    /// Both.
    pub const ALL: [Against; 2] = [Against::Time, Against::Memory];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Against::Time => "shade time",
            Against::Memory => "memory held",
        }
    }

    fn of(self, row: &Row) -> Option<Measured> {
        match self {
            Against::Time => {
                let time = row.shade_time()?;
                match time.count {
                    // One repeat says nothing of the scatter.
                    1 => Measured::new(time.median, time.median / ONE_REPEAT, time.median * ONE_REPEAT),
                    _ => Measured::new(time.median, time.low, time.high),
                }
            }
            Against::Memory => {
                let held = row.run.footprint.iter().map(|held| held.host_bytes + held.device_bytes);
                Measured::exact(held.clone().sum::<u64>() as f64).filter(|_| held.len() > 0)
            }
        }
    }
}

/// A time that was taken once is held to be known to this factor.
const ONE_REPEAT: f64 = 2.0;

/// Settings that are comparable, with their standing.
#[derive(Clone, Debug)]
pub struct Front {
    /// The scene's section name; none for a front over several scenes.
    pub scene: Option<String>,
    /// What was computed.
    pub quantity: String,
    /// Where times were taken.
    pub machine: String,
    /// The reference that errors are against.
    pub reference: String,
    /// What errors are weighed against.
    pub against: Against,
    /// Over several scenes, what all figures are relative to.
    pub relative: Option<Relative>,
    /// The settings, the cheapest first.
    pub entries: Vec<Entry>,
}

/// What the figures of a front over scenes mean: geometric means of ratios to a base setting.
#[derive(Clone, Debug)]
pub struct Relative {
    /// The base setting's place in [`Report::labels`].
    pub base: usize,
    /// The scenes.
    pub scenes: Vec<String>,
    /// How many settings are left out since they lack one of the scenes.
    pub left_out: usize,
}

/// One setting.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Place in [`Report::labels`].
    pub label: usize,
    /// What it costs.
    pub cost: Measured,
    /// RMSE, with twice its standard error by the reference's noise to either side. Methods have no noise of their own.
    pub error: Measured,
    /// Whether the error stands out of the reference's noise; where not, its lower end is 0.
    pub resolved: bool,
    /// Its standing; `by` is a place among the entries.
    pub standing: Standing,
}

impl Entry {
    fn new(label: usize, cost: Measured, error: Measured, resolved: bool) -> Self {
        Self { label, cost, error, resolved, standing: Standing::Front }
    }
}

/// Settings of one machine and quantity.
type Kind = (String, String);

fn kind(row: &Row) -> Kind {
    let cell = &row.run.cell;
    // Of what was not timed, all that is known is where it ran.
    (cell.quantity.clone(), cell.timed_on.as_ref().unwrap_or(&cell.backend).clone())
}

impl Report {
    /// The front of every scene, quantity and machine that has settings to compare.
    pub fn fronts(&self, against: Against) -> Vec<Front> {
        let mut fronts = Vec::new();
        for scene in &self.scenes {
            let Some(reference) = scene.main_reference() else { continue };
            let mut kinds: BTreeMap<Kind, Vec<Entry>> = BTreeMap::new();
            for row in &scene.rows {
                if let Some(entry) = entry(row, reference, against) {
                    kinds.entry(kind(row)).or_default().push(entry);
                }
            }
            fronts.extend(kinds.into_iter().map(|((quantity, machine), entries)| Front {
                scene: Some(scene.name.clone()),
                quantity,
                machine,
                reference: reference.to_owned(),
                against,
                relative: None,
                entries: stand(entries),
            }));
        }
        fronts
    }

    /// The front over all scenes of a base setting, for every quantity and machine that has two such scenes. The base is the
    /// setting of this label, or else the one that was measured on most scenes, of equals the first.
    ///
    /// Figures are geometric means over scenes of the ratio to the base on the same scene: a ratio weighs every scene alike
    /// however bright or large it is, and the geometric mean of ratios is the one mean for which the choice of the base changes
    /// no order (Fleming and Wallace 1986). The base's own uncertainty, common to all, is left out.
    pub fn fronts_over_scenes(&self, against: Against, base: Option<&str>) -> Vec<Front> {
        let mut kinds: BTreeMap<Kind, Vec<(usize, Entry)>> = BTreeMap::new();
        for (section, scene) in self.scenes.iter().enumerate() {
            let Some(reference) = scene.main_reference() else { continue };
            for row in &scene.rows {
                let positive = |entry: &Entry| entry.error.value() > 0.0 && entry.cost.value() > 0.0;
                if let Some(entry) = entry(row, reference, against).filter(positive) {
                    kinds.entry(kind(row)).or_default().push((section, entry));
                }
            }
        }
        kinds.into_iter().filter_map(|(kind, entries)| self.over_scenes(against, base, kind, &entries)).collect()
    }

    fn over_scenes(
        &self,
        against: Against,
        base: Option<&str>,
        (quantity, machine): Kind,
        entries: &[(usize, Entry)],
    ) -> Option<Front> {
        let mut settings: BTreeMap<usize, BTreeMap<usize, Entry>> = BTreeMap::new();
        for (section, entry) in entries {
            settings.entry(entry.label).or_default().insert(*section, *entry);
        }
        let named = |label: &&usize| base.is_none_or(|base| self.labels[**label] == base);
        // Of equals `max_by_key` takes the last.
        let base = *settings.keys().rev().filter(named).max_by_key(|label| settings[label].len())?;
        let sections: BTreeSet<usize> = settings[&base].keys().copied().collect();
        if sections.len() < 2 {
            return None;
        }
        let mean = |entries: &BTreeMap<usize, Entry>, figure: &dyn Fn(&Entry) -> Measured| {
            let figures: Option<Vec<Measured>> = sections.iter().map(|s| entries.get(s).map(figure)).collect();
            geometric_mean(&figures?)
        };
        let (base_cost, base_error) = (mean(&settings[&base], &|e| e.cost)?, mean(&settings[&base], &|e| e.error)?);
        let means = settings.iter().filter_map(|(label, entries)| {
            let cost = relative(mean(entries, &|e| e.cost)?, base_cost)?;
            let error = relative(mean(entries, &|e| e.error)?, base_error)?;
            let resolved = sections.iter().all(|section| entries[section].resolved);
            Some(Entry::new(*label, cost, error, resolved))
        });
        let means: Vec<Entry> = means.collect();
        let scene = |section: &usize| self.scenes[*section].name.clone();
        let left_out = settings.len() - means.len();
        let references: BTreeSet<&str> = sections.iter().filter_map(|s| self.scenes[*s].main_reference()).collect();
        Some(Front {
            scene: None,
            quantity,
            machine,
            reference: references.into_iter().collect::<Vec<_>>().join(" or "),
            against,
            relative: Some(Relative { base, scenes: sections.iter().map(scene).collect(), left_out }),
            entries: stand(means),
        })
    }
}

fn relative(figure: Measured, base: Measured) -> Option<Measured> {
    let base = base.value();
    Measured::new(figure.value() / base, figure.low() / base, figure.high() / base)
}

fn entry(row: &Row, reference: &str, against: Against) -> Option<Entry> {
    let score = row.score(reference)?;
    let measure = |name: &str| score.measures.get(name).copied();
    let rmse = measure("rmse")?;
    // Scores of older measures do not have it; what the reference's noise could do at most stands for it.
    let spread = 2.0 * measure("rmse_standard_error").or(measure("reference_standard_error"))?;
    let low = if score.resolved { (rmse - spread).max(0.0) } else { 0.0 };
    Some(Entry::new(row.label, against.of(row)?, Measured::new(rmse, low, rmse + spread)?, score.resolved))
}

/// Sorts entries by cost and finds their standing.
fn stand(mut entries: Vec<Entry>) -> Vec<Entry> {
    entries.sort_by(|a, b| a.cost.value().total_cmp(&b.cost.value()).then(a.error.value().total_cmp(&b.error.value())));
    let points: Vec<[Measured; 2]> = entries.iter().map(|entry| [entry.cost, entry.error]).collect();
    for (entry, standing) in entries.iter_mut().zip(standings(&points)) {
        entry.standing = standing;
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use halflight_results::{Calibration, Cell, Key, Phase, Run, Score, Storage, Times, Timing};

    /// A row of a setting with this shade time, memory and error; the reference's noise is 0.01.
    fn row(label: usize, time: f64, bytes: u64, rmse: f64) -> Row {
        let cell = Cell { quantity: "direct".into(), ..Cell::default() };
        let timing = Timing { phase: Phase::Shade, nanoseconds: vec![time * 0.9, time, time, time, time * 1.1] };
        let footprint = vec![Storage { purpose: "x".into(), host_bytes: bytes, device_bytes: 0 }];
        let key = Key::of_bytes(b"");
        let score = Score {
            run: key.clone(),
            image: key.clone(),
            reference: "truth".into(),
            reference_key: key.clone(),
            reference_image: key,
            metrics: 2,
            receivers: 1,
            resolved: rmse > 0.02,
            measures: [("rmse".into(), rmse), ("rmse_standard_error".into(), 0.001)].into(),
        };
        let times = Times {
            run: cell.key(),
            taken: 0,
            beside: 1,
            phases: [("shade".into(), timing)].into(),
            calibration: Calibration::default(),
        };
        let run = Run { cell, footprint, ..Run::default() };
        Row { label, run, picture: None, times: Some(times), scores: vec![score] }
    }

    fn report(scenes: Vec<Vec<Row>>) -> Report {
        let settings = scenes.iter().flatten().map(|row| row.label + 1).max().unwrap_or(0);
        let scene = |(i, rows): (usize, Vec<Row>)| Scene {
            name: format!("scene {i}"),
            references: vec![crate::Reference { id: "truth".into(), picture: None }],
            rows,
        };
        Report {
            labels: (0..settings).map(|i| format!("setting {i}")).collect(),
            methods: vec!["m".into(); settings],
            scenes: scenes.into_iter().enumerate().map(scene).collect(),
            ..Report::empty("")
        }
    }

    fn standing(front: &Front, label: usize) -> Standing {
        front.entries.iter().find(|entry| entry.label == label).unwrap().standing
    }

    #[test]
    fn dominated_is_only_what_is_worse_by_more_than_the_uncertainty() {
        let rows =
            vec![row(0, 100.0, 10, 0.1), row(1, 200.0, 9, 0.2), row(2, 105.0, 10, 0.2), row(3, 200.0, 12, 0.1015)];
        let report = report(vec![rows]);
        let [time, memory] = Against::ALL.map(|against| report.fronts(against).remove(0));
        assert_eq!(standing(&time, 0), Standing::Front);
        assert_eq!(standing(&time, 1), Standing::Dominated { by: 0 });
        // 5% slower lies within the interval; 1.5% more error within twice the standard error.
        assert_eq!(standing(&time, 2), Standing::Undecided);
        assert_eq!(standing(&time, 3), Standing::Undecided);
        // Memory is exact.
        assert_eq!(standing(&memory, 1), Standing::Front);
        assert_eq!(standing(&memory, 2), Standing::Dominated { by: 1 });
        assert_eq!(standing(&memory, 3), Standing::Undecided);
    }

    #[test]
    fn what_is_not_resolved_is_never_beaten_by_its_error() {
        let report = report(vec![vec![row(0, 100.0, 1, 0.011), row(1, 100.0, 2, 0.018), row(2, 100.0, 3, 0.03)]]);
        let memory = report.fronts(Against::Memory).remove(0);
        assert_eq!(standing(&memory, 1), Standing::Undecided);
        assert_eq!(standing(&memory, 2), Standing::Dominated { by: 0 });
    }

    #[test]
    fn kinds_that_cannot_be_compared_stay_apart() {
        let mut rows = vec![row(0, 100.0, 1, 0.1), row(1, 200.0, 2, 0.2), row(2, 300.0, 3, 0.3)];
        rows[1].run.cell.quantity = "total".into();
        rows[2].run.cell.timed_on = Some("another".into());
        let fronts = report(vec![rows]).fronts(Against::Time);
        assert_eq!(fronts.len(), 3);
        assert!(fronts.iter().all(|front| front.entries.len() == 1 && front.entries[0].standing == Standing::Front));
    }

    #[test]
    fn scenes_count_alike_and_the_base_changes_no_order() {
        // A bright and a dim scene; setting 3 lacks one, setting 4 has an error that is not resolved.
        let one = vec![
            row(0, 100.0, 1, 0.4),
            row(1, 200.0, 1, 0.2),
            row(2, 400.0, 1, 0.4),
            row(3, 1.0, 1, 0.1),
            row(4, 800.0, 1, 0.015),
        ];
        let two = vec![row(0, 1e4, 1, 40.0), row(1, 2e4, 1, 80.0), row(2, 1e4, 1, 5.0), row(4, 8e4, 1, 40.0)];
        let report = report(vec![one, two]);
        let front = report.fronts_over_scenes(Against::Time, None).remove(0);
        let relative = front.relative.as_ref().unwrap();
        assert_eq!((relative.base, relative.scenes.len(), relative.left_out), (0, 2, 1));
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-12;
        let expected = [(0, 1.0, 1.0), (2, 2.0, 0.125f64.sqrt()), (1, 2.0, 1.0), (4, 8.0, (0.015f64 / 0.4).sqrt())];
        assert_eq!(front.entries.len(), expected.len());
        for (entry, (label, cost, error)) in front.entries.iter().zip(expected) {
            assert!(
                entry.label == label && near(entry.cost.value(), cost) && near(entry.error.value(), error),
                "{entry:?}"
            );
        }
        assert!(!front.entries.iter().find(|e| e.label == 4).unwrap().resolved);
        let other = report.fronts_over_scenes(Against::Time, Some("setting 2")).remove(0);
        let kinds =
            |front: &Front| -> Vec<(usize, Standing)> { front.entries.iter().map(|e| (e.label, e.standing)).collect() };
        assert_eq!(kinds(&front), kinds(&other));
        assert!(report.fronts_over_scenes(Against::Time, Some("setting 3")).is_empty(), "one scene alone");
        assert!(report.fronts_over_scenes(Against::Time, Some("nobody")).is_empty());
    }
}
