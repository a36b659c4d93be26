//! Which cells say most: the order in which a run under a budget takes them.
//!
//! First every method on every scene at the planned setting that is nearest its defaults. Then, in turns over methods and
//! scenes, the setting that is farthest from those that are done: a sweep's ends first, then its middle, then the quarters.

use crate::plan::{Group, Plan, State};
use halflight_contract::{Params, Value};
use halflight_results::Store;
use std::collections::HashMap;

/// The plan's groups, those with nothing to run first and the others as they are to be run.
pub(crate) fn order<'p>(plan: &'p Plan, store: &Store) -> Vec<&'p Group> {
    let done = |group: &Group| group.cells.iter().all(|cell| group.state(cell, store) != State::Run);
    let mut families: Vec<Vec<&Group>> = Vec::new();
    let mut known = HashMap::new();
    for group in &plan.groups {
        let family = (group.scene, group.method.info().id, group.quantity.to_string(), group.backend.to_string());
        let place = *known.entry(family).or_insert(families.len());
        match families.get_mut(place) {
            Some(family) => family.push(group),
            None => families.push(vec![group]),
        }
    }
    let mut ordered: Vec<&Group> = plan.groups.iter().filter(|group| done(group)).collect();
    let turns: Vec<Vec<&Group>> = families.iter().map(|family| by_distance(family, done)).collect();
    for turn in 0..turns.iter().map(Vec::len).max().unwrap_or(0) {
        ordered.extend(turns.iter().filter_map(|family| family.get(turn)));
    }
    ordered
}

/// What is to be run of one method on one scene, farthest from what is done first.
fn by_distance<'p>(family: &[&'p Group], done: impl Fn(&Group) -> bool) -> Vec<&'p Group> {
    let scales = scales(family);
    let apart = |i: usize, j: usize| apart(&family[i].params, &family[j].params, &scales);
    let unusual = |i: usize| {
        let defaults = Params::defaults(family[i].method.info().params);
        family[i].params.iter().zip(defaults.iter()).filter(|(value, usual)| value != usual).count()
    };
    let (mut told, mut open): (Vec<usize>, Vec<usize>) = (0..family.len()).partition(|i| done(family[*i]));
    let mut ordered = Vec::new();
    while !open.is_empty() {
        let distance = |i: usize| told.iter().map(|j| apart(i, *j)).fold(f64::INFINITY, f64::min);
        // Of equals the first as planned.
        let next = if told.is_empty() {
            (0..open.len()).min_by_key(|n| unusual(open[*n]))
        } else {
            (0..open.len()).rev().max_by(|a, b| distance(open[*a]).total_cmp(&distance(open[*b])))
        };
        let Some(next) = next else { break };
        let chosen = open.remove(next);
        told.push(chosen);
        ordered.push(family[chosen]);
    }
    ordered
}

/// The planned values of every parameter that is a number, sorted.
type Scales = HashMap<&'static str, Vec<f64>>;

fn scales(family: &[&Group]) -> Scales {
    let mut scales = Scales::new();
    for (name, value) in family.iter().flat_map(|group| group.params.iter()) {
        scales.entry(name).or_default().extend(number(value));
    }
    for values in scales.values_mut() {
        values.sort_by(f64::total_cmp);
        values.dedup();
    }
    scales
}

/// The sum over parameters: for a number the share of the planned values that lie between the two, for a word or switch 1
/// if they differ.
fn apart(a: &Params, b: &Params, scales: &Scales) -> f64 {
    let one = |((name, a), (_, b)): ((&str, Value), (&str, Value))| match (number(a), number(b), scales.get(name)) {
        (Some(a), Some(b), Some(scale)) => {
            let between = scale.iter().filter(|v| a.min(b) < **v && **v <= a.max(b)).count();
            between as f64 / (scale.len() - 1).max(1) as f64
        }
        _ => f64::from(u8::from(a != b)),
    };
    a.iter().zip(b.iter()).map(one).sum()
}

fn number(value: Value) -> Option<f64> {
    match value {
        Value::Int(v) => Some(v as f64),
        Value::Float(v) => Some(v),
        Value::Choice(_) | Value::Flag(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Terms;
    use crate::select::Selection;
    use halflight_results::{Record, Run};

    /// The methods and settings to run in this order, of a plan whose first group is done where said so.
    fn ordered(methods: &[&str], set: &[&str], first_is_done: bool) -> Vec<String> {
        let selection = Selection {
            scenes: vec!["sphere-plane".into()],
            methods: methods.iter().map(|m| (*m).to_owned()).collect(),
            set: set.iter().map(|s| s.parse().unwrap()).collect(),
            references: vec!["truth".into()],
            ..Selection::default()
        };
        let plan = Plan::new(&selection.entries().unwrap(), &Terms { seed: 1, timed_on: String::new() }).unwrap();
        let dir = tempfile::tempdir().unwrap();
        let mut store = Store::open(dir.path()).unwrap();
        if first_is_done {
            let run = Run { cell: plan.groups[0].cells[0].clone(), ..Run::default() };
            store.append(Record::Run(Box::new(run))).unwrap();
        }
        let label = |group: &&Group| group.label(&plan).split_once(" · ").unwrap().1.to_owned();
        order(&plan, &store).iter().map(label).collect()
    }

    #[test]
    fn defaults_first_then_the_farthest() {
        let orders = ordered(&["shexp/hyb"], &["order=2..6"], false);
        assert_eq!(orders, [4, 2, 6, 3, 5].map(|order| format!("shexp/hyb order={order}")));
    }

    #[test]
    fn methods_take_turns() {
        let turns = ordered(&["shexp/hyb", "sh-product/ordered"], &["order=2,4,6"], false);
        let methods: Vec<_> = turns.iter().map(|t| t.split(' ').next().unwrap()).collect();
        assert_eq!(methods, ["shexp/hyb", "sh-product/ordered"].repeat(3));
        assert!(turns[..2].iter().all(|t| t.ends_with("order=4")), "{turns:?}");
    }

    #[test]
    fn what_is_done_comes_first_and_counts() {
        let orders = ordered(&["shexp/hyb"], &["order=2..6"], true);
        assert_eq!(orders, [2, 6, 4, 3, 5].map(|order| format!("shexp/hyb order={order}")));
    }
}
