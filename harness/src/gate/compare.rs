//! Holding what was measured against baselines.

use super::chance::{Chance, Estimated, LEVEL};
use super::{Baselines, CellBaseline, MORE, Observed, PACE, ReferenceBaseline, ScoreBaseline};
use halflight_metrics::{COLUMNS, ROWS};
use std::collections::BTreeMap;

/// How far a mean may be off by rounding, relative to the root mean square of its picture; and a counter, relative to itself,
/// on another processor.
pub const ROUNDING: f64 = 1e-4;

/// How much of the time that it took before, relative to [`PACE`], shading may take.
pub const SLOWER: f64 = 3.0;

/// What a finding means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It must not pass.
    Fails,
    /// It is better than it was: told, and failed only where any change is.
    Improves,
}

/// A difference from the baselines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What it means.
    pub verdict: Verdict,
    /// The cell or reference that differs, or the method whose time does.
    pub subject: String,
    /// What was expected, and what was found.
    pub told: String,
}

/// What a comparison finds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// All differences.
    pub findings: Vec<Finding>,
    /// Checks made.
    pub checks: usize,
    /// Those of them that are statistical, because a reference was estimated anew.
    pub statistical: usize,
}

impl Comparison {
    /// Whether something was checked and nothing fails; `strict` fails on any difference.
    pub fn passes(&self, strict: bool) -> bool {
        self.checks > 0 && !self.findings.iter().any(|finding| strict || finding.verdict == Verdict::Fails)
    }
}

/// Compares. `partial` is for a part of what the baselines know: what was not measured is not missed.
pub fn compare(expected: &Baselines, found: &Observed, partial: bool) -> Comparison {
    let comparison = Comparison::default();
    let mut comparing = Comparing { expected, found, partial, chance: Vec::new(), comparison };
    for (subject, why) in &found.faults {
        comparing.fails(subject, why.clone());
    }
    comparing.pairs(&expected.cells, &found.measured.cells, Comparing::cell);
    comparing.pairs(&expected.references, &found.measured.references, Comparing::reference);
    comparing.times();
    comparing.instructions();
    comparing.judge_chance();
    if comparing.comparison.checks == 0 {
        comparing.fails("the gate", "expected at least one check, found nothing to compare".into());
    }
    comparing.comparison
}

struct Comparing<'c> {
    expected: &'c Baselines,
    found: &'c Observed,
    partial: bool,
    chance: Vec<Chance>,
    comparison: Comparison,
}

/// Where a value stands to what is right.
enum Side {
    Equal,
    Better,
    Worse,
}

impl<'c> Comparing<'c> {
    fn tell(&mut self, verdict: Verdict, subject: &str, told: String) {
        self.comparison.findings.push(Finding { verdict, subject: subject.to_owned(), told });
    }

    fn fails(&mut self, subject: &str, told: String) {
        self.tell(Verdict::Fails, subject, told);
    }

    fn sided(&mut self, side: Side, subject: &str, told: String) {
        match side {
            Side::Equal => {}
            Side::Better => self.tell(Verdict::Improves, subject, told),
            Side::Worse => self.fails(subject, told),
        }
    }

    /// What both have is compared; what is gone fails, and what is new: nobody has blessed it.
    fn pairs<T>(
        &mut self,
        expected: &'c BTreeMap<String, T>,
        found: &'c BTreeMap<String, T>,
        compare: impl Fn(&mut Self, &str, &T, &T),
    ) {
        for (subject, old) in expected {
            match found.get(subject) {
                Some(new) => compare(self, subject, old, new),
                None => self.gone(subject),
            }
        }
        for subject in found.keys().filter(|subject| !expected.contains_key(*subject)) {
            self.fails(subject, "no baseline; if it is right, `halflight bless`".into());
        }
    }

    fn gone(&mut self, subject: &str) {
        let told_already = self.found.faults.iter().any(|(faulty, _)| faulty == subject);
        match self.found.skipped.get(subject) {
            Some(why) => self.fails(subject, format!("expected by the baselines, found a skip: {why}")),
            None if self.partial || told_already => {}
            None => {
                self.fails(subject, "expected by the baselines, not found; if it is meant, `halflight bless`".into())
            }
        }
    }

    fn cell(&mut self, subject: &str, old: &CellBaseline, new: &CellBaseline) {
        self.receivers(subject, old.receivers, new.receivers);
        self.blocks(subject, "picture", old.level, &old.blocks, &new.blocks);
        for (reference, old) in &old.errors {
            match new.errors.get(reference) {
                Some(new) => self.errors(subject, reference, old, new),
                None => self.gone(reference),
            }
        }
        for reference in new.errors.keys().filter(|reference| !old.errors.contains_key(*reference)) {
            self.fails(
                subject,
                format!("no baseline of its error against {reference}; if it is right, `halflight bless`"),
            );
        }
        self.memory(subject, &old.memory, &new.memory);
        self.work(subject, &old.work, &new.work);
    }

    fn reference(&mut self, subject: &str, old: &ReferenceBaseline, new: &ReferenceBaseline) {
        self.receivers(subject, old.receivers, new.receivers);
        if old.key == new.key {
            let means = |reference: &ReferenceBaseline| -> Vec<Option<[f64; 3]>> {
                reference.blocks.iter().map(|block| block.map(|(mean, ..)| mean)).collect()
            };
            return self.blocks(subject, "reference of the same key", old.level, &means(old), &means(new));
        }
        for (i, pair) in old.blocks.iter().zip(&new.blocks).enumerate() {
            match pair {
                (Some(old_block), Some(new_block)) => (0..3).for_each(|c| {
                    let of =
                        |block: &super::Noisy| Estimated { value: block.0[c], error: block.1[c], effective: block.2 };
                    let (what, slack) = (format!("reference, {}", place(i, c)), ROUNDING * old.level);
                    self.maybe(subject, what, of(old_block), of(new_block), slack, false);
                }),
                (None, None) => {}
                _ => self.fails(subject, format!("{}: receivers in one of baseline and reference only", place(i, 0))),
            }
        }
    }

    fn receivers(&mut self, subject: &str, old: usize, new: usize) {
        self.comparison.checks += 1;
        if old != new {
            self.fails(subject, format!("valid receivers: expected {old}, found {new}"));
        }
    }

    /// Compares block means that have no noise, or the same; tells of the one that is farthest off.
    fn blocks(&mut self, subject: &str, what: &str, level: f64, old: &[Option<[f64; 3]>], new: &[Option<[f64; 3]>]) {
        self.comparison.checks += 1;
        let masks = |blocks: &[Option<[f64; 3]>]| blocks.iter().map(Option::is_some).collect::<Vec<_>>();
        if masks(old) != masks(new) {
            return self.fails(subject, format!("{what}: receivers lie in other blocks than expected"));
        }
        let off = |old: f64, new: f64| (new - old).abs() / level;
        let pairs = old.iter().zip(new).enumerate().filter_map(|(i, (old, new))| Some((i, (*old)?, (*new)?)));
        let all = pairs.flat_map(|(i, old, new)| [0, 1, 2].map(|c| (i, c, old[c], new[c])));
        // What is not within is off, a NaN too.
        let within = |old, new| off(old, new) <= ROUNDING;
        let wrong: Vec<_> = all.filter(|(.., old, new)| !within(*old, *new)).collect();
        let farthest = wrong.iter().max_by(|a, b| off(a.2, a.3).total_cmp(&off(b.2, b.3)));
        let Some((i, c, old, new)) = farthest else { return };
        let (share, place) = (100.0 * (new - old) / old, place(*i, *c));
        let told =
            format!("{what}, {place}: expected {old:.6}, found {new:.6} ({share:+.3}%); {} means are off", wrong.len());
        self.fails(subject, told);
    }

    fn errors(&mut self, subject: &str, reference: &str, old: &ScoreBaseline, new: &ScoreBaseline) {
        let known = |baselines: &'c Baselines| baselines.references.get(reference);
        let (Some(before), Some(now)) = (known(self.expected), known(&self.found.measured)) else {
            return self.fails(reference, "the reference is missing".into());
        };
        let slack = ROUNDING * before.level;
        for (what, old, new) in [
            ("RMSE", (old.rmse, old.rmse_error, old.effective), (new.rmse, new.rmse_error, new.effective)),
            ("bias", (old.bias, old.bias_error, old.effective), (new.bias, new.bias_error, new.effective)),
        ] {
            let what = format!("{what} against {reference}");
            if before.key != now.key {
                let of = |(value, error, effective)| Estimated { value, error, effective };
                self.maybe(subject, what, of(old), of(new), slack, true);
                continue;
            }
            self.comparison.checks += 1;
            // The noise is common to both.
            let side = if (new.0 - old.0).abs() <= slack { Side::Equal } else { nearer_to_zero(old.0, new.0) };
            self.sided(side, subject, format!("{what}: expected {:.4e}, found {:.4e}", old.0, new.0));
        }
    }

    fn maybe(
        &mut self,
        subject: &str,
        what: String,
        expected: Estimated,
        found: Estimated,
        slack: f64,
        error_measure: bool,
    ) {
        self.comparison.checks += 1;
        self.comparison.statistical += 1;
        self.chance.push(Chance { subject: subject.to_owned(), what, expected, found, slack, error_measure });
    }

    /// Judges what may be chance, once it is known how many there are.
    fn judge_chance(&mut self) {
        let share = LEVEL / self.chance.len().max(1) as f64;
        for chance in std::mem::take(&mut self.chance) {
            if chance.p() >= share {
                continue;
            }
            let (old, new) = (chance.expected.value, chance.found.value);
            let side = if chance.error_measure { nearer_to_zero(old, new) } else { Side::Worse };
            self.sided(side, &chance.subject, format!("{}: more than chance", chance.told()));
        }
    }

    fn memory(&mut self, subject: &str, old: &BTreeMap<String, u64>, new: &BTreeMap<String, u64>) {
        for (purpose, old, new) in both(old, new) {
            self.comparison.checks += 1;
            let side = match new.cmp(&old) {
                std::cmp::Ordering::Equal => Side::Equal,
                std::cmp::Ordering::Less => Side::Better,
                std::cmp::Ordering::Greater => Side::Worse,
            };
            self.sided(side, subject, format!("memory, {purpose}: expected {old} bytes, found {new}"));
        }
    }

    fn work(&mut self, subject: &str, old: &BTreeMap<String, u64>, new: &BTreeMap<String, u64>) {
        let same_kernels = self.expected.kernels == self.found.measured.kernels;
        for (counter, old, new) in both(old, new) {
            self.comparison.checks += 1;
            let slack = if same_kernels { 0 } else { (ROUNDING * old as f64).ceil() as u64 };
            if old.abs_diff(new) > slack {
                self.fails(subject, format!("work, {counter}: expected {old}, found {new}"));
            }
        }
    }

    /// Counts that were taken with the same compiler.
    fn instructions(&mut self) {
        let (old, new) = (&self.expected.instructions, &self.found.measured.instructions);
        if old.with != new.with || new.counts.is_empty() {
            return;
        }
        for (method, new) in &new.counts {
            let subject = format!("instructions of {method}");
            self.comparison.checks += 1;
            match old.counts.get(method) {
                Some(old) => {
                    let share = *new as f64 / *old as f64 - 1.0;
                    let side = match share {
                        share if share > MORE => Side::Worse,
                        share if share < -MORE => Side::Better,
                        _ => Side::Equal,
                    };
                    self.sided(side, &subject, format!("expected {old}, found {new} ({:+.2}%)", 100.0 * share));
                }
                None => self.fails(&subject, "no baseline; if it is right, `halflight bless --instructions`".into()),
            }
        }
        for method in old.counts.keys().filter(|method| !new.counts.contains_key(*method)) {
            self.fails(&format!("instructions of {method}"), "expected by the baselines, not found".into());
        }
    }

    fn times(&mut self) {
        for (method, old) in &self.expected.paces {
            let Some(new) = self.found.ratios.get(method) else { continue };
            self.comparison.checks += 1;
            let side = match (new.low > SLOWER * old, new.high < old / SLOWER) {
                (true, _) => Side::Worse,
                (_, true) => Side::Better,
                _ => Side::Equal,
            };
            let (ratio, low, high) = (new.ratio, new.low, new.high);
            let told =
                format!("shading time over {PACE}'s: expected {old:.2}, found {ratio:.2} ({low:.2} to {high:.2})");
            self.sided(side, method, told);
        }
    }
}

/// An error measure that has changed: nearer to zero is better.
fn nearer_to_zero(old: f64, new: f64) -> Side {
    if new.abs() < old.abs() { Side::Better } else { Side::Worse }
}

/// The values of both maps by name, 0 where there is none.
fn both<'a>(
    old: &'a BTreeMap<String, u64>,
    new: &'a BTreeMap<String, u64>,
) -> impl Iterator<Item = (&'a str, u64, u64)> {
    let of = |map: &BTreeMap<String, u64>, name: &str| map.get(name).copied().unwrap_or(0);
    let names = old.keys().chain(new.keys().filter(|name| !old.contains_key(*name)));
    names.map(move |name| (name.as_str(), of(old, name), of(new, name)))
}

/// A block and channel in words.
fn place(block: usize, channel: usize) -> String {
    let (row, column) = (block / COLUMNS + 1, block % COLUMNS + 1);
    format!("block {column} of {COLUMNS} in row {row} of {ROWS}, {}", ["red", "green", "blue"][channel])
}
