//! The times of cells, once there are their pictures: which are timed side by side, and on which threads.

use super::Running;
use crate::Error;
use crate::plan::{Group, Plan, State};
use crate::rounds::{Entrant, Timed, side_by_side};
use crate::sway::{self, Motion};
use crate::todo::{Planned, Todo};
use halflight_contract::Cache;
use halflight_results::{Cell, Record, StoreError, Times};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::{BTreeMap, BTreeSet};
use std::time::SystemTime;

/// Most methods that are held ready at once.
const MOST: usize = 8;

/// Most bytes that these may hold together, as far as their runs tell; a single one may hold more.
const MOST_BYTES: u64 = 1 << 30;

/// Cells of one scene, those of a group in a row, in bunches of several groups each; `bytes` tells what a cell's method holds.
pub(crate) fn bunches<'b, 'p>(cells: &'b [Planned<'p>], bytes: impl Fn(&Cell) -> u64) -> Vec<&'b [Planned<'p>]> {
    let mut bunches = Vec::new();
    let (mut start, mut end, mut count, mut held) = (0, 0, 0, 0);
    for group in cells.chunk_by(|(a, _), (b, _)| std::ptr::eq(*a, *b)) {
        let holds = group.iter().map(|(_, cell)| bytes(cell)).max().unwrap_or(0);
        if count > 0 && (count == MOST || held + holds > MOST_BYTES) {
            bunches.push(&cells[start..end]);
            (start, count, held) = (end, 0, 0);
        }
        (end, count, held) = (end + group.len(), count + 1, held + holds);
    }
    if end > start {
        bunches.push(&cells[start..end]);
    }
    bunches
}

/// Pools of threads by their number, for all groups that ask for one.
pub(crate) fn pools(plan: &Plan) -> Result<BTreeMap<usize, ThreadPool>, Error> {
    let counts: BTreeSet<usize> = plan.groups.iter().filter_map(|group| group.threads).collect();
    let pool = |threads| match ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => Ok((threads, pool)),
        Err(error) => Err(Error::Other(format!("{threads} threads: {error}"))),
    };
    counts.into_iter().map(pool).collect()
}

impl Running<'_> {
    /// Takes the times of a scene's cells, bunch by bunch.
    pub(super) fn times(&mut self, todo: &Todo<'_>, cache: &Cache) -> Result<(), StoreError> {
        let bytes = |cell: &Cell| {
            let held = self.store.run(&cell.key()).map_or(&[][..], |run| &run.footprint);
            held.iter().map(|storage| storage.host_bytes).sum()
        };
        let mut elsewhere = Vec::new();
        for bunch in bunches(&todo.untimed, bytes) {
            elsewhere.extend(self.bunch(todo, bunch, cache, false)?);
        }
        // One at a time: who waits for a claim must hold no other.
        for planned in elsewhere {
            self.bunch(todo, &[planned], cache, true)?;
        }
        Ok(())
    }

    /// Times cells side by side, and returns those that another process has claimed unless `waiting` for it.
    fn bunch<'p>(
        &mut self,
        todo: &Todo<'_>,
        cells: &[Planned<'p>],
        cache: &Cache,
        waiting: bool,
    ) -> Result<Vec<Planned<'p>>, StoreError> {
        let (mut elsewhere, mut mine, mut claims) = (Vec::new(), Vec::new(), Vec::new());
        for &(group, cell) in cells {
            let key = cell.key();
            match if waiting { Some(self.store.claim(&key)?) } else { self.store.try_claim(&key)? } {
                Some(claim) => {
                    claims.push(claim);
                    mine.push((group, cell));
                }
                None => elsewhere.push((group, cell)),
            }
        }
        self.store.refresh()?;
        mine.retain(|(group, cell)| group.state(cell, self.store) == State::Time);
        (elsewhere.len() + mine.len()..cells.len()).for_each(|_| self.progress.pass());

        let mut entrants: Vec<(&Group, Entrant<'_>)> = Vec::new();
        for (group, _) in &mine {
            if entrants.last().is_none_or(|(last, _)| !std::ptr::eq(*last, *group)) {
                let pool = group.threads.and_then(|threads| self.pools.get(&threads));
                entrants.push((group, Entrant::new(self.task(todo, group, cache), pool)));
            }
        }
        for frame in mine.iter().map(|(_, cell)| cell.frame).collect::<BTreeSet<_>>() {
            let here: Vec<_> = mine.iter().filter(|(_, cell)| cell.frame == frame).collect();
            let label = format!("{} · times of {} cells side by side", todo.scene.name, here.len());
            self.progress.begin(&label);
            let takes_part = |group: &Group| here.iter().any(|(other, _)| std::ptr::eq(*other, group));
            let taking_part = entrants.iter_mut().filter(|(group, _)| takes_part(group)).map(|(_, entrant)| entrant);
            let from = sway::other(todo.frames, frame as usize);
            let motion = Motion { from: from.as_ref(), to: &todo.frames[frame as usize] };
            let times = side_by_side(taking_part.collect(), motion, self.options.repeats, self.calibrator);
            for ((_, cell), times) in here.iter().zip(times) {
                self.finish_times(cell, here.len(), times)?;
            }
            self.progress.end_of(here.len(), &label, "taken");
        }
        Ok(elsewhere)
    }

    fn finish_times(&mut self, cell: &Cell, beside: usize, timed: Result<Timed, String>) -> Result<(), StoreError> {
        self.left.done(cell);
        match timed {
            Ok(Timed { phases, calibration }) => {
                self.summary.timed += 1;
                let taken = SystemTime::UNIX_EPOCH.elapsed().map_or(0, |since| since.as_secs());
                let times = Times { run: cell.key(), taken, beside, phases, calibration };
                self.append(Record::Times(Box::new(times)))
            }
            // Its picture stands: a device that was lost takes no finished cell with it. The next run takes the times again.
            Err(error) => {
                self.summary.failed += 1;
                self.progress.note(&format!("{} · {}: FAILED when it was timed: {error}", cell.scene, cell.method));
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Selection, Terms};

    #[test]
    fn bunches_are_bounded_and_keep_groups_whole() {
        let selection = Selection {
            scenes: vec!["sphere-plane".into()],
            set: vec!["order=2..6".parse().unwrap()],
            ..Selection::default()
        };
        let plan = Plan::new(&selection.entries().unwrap(), &Terms { seed: 1, timed_on: String::new() }).unwrap();
        let cells: Vec<Planned<'_>> = plan.cells().flat_map(|(group, cell)| [(group, cell), (group, cell)]).collect();
        assert!(cells.len() >= 40);
        let lengths = |bytes: u64| {
            let bunches = bunches(&cells, |_| bytes);
            assert_eq!(bunches.concat().len(), cells.len());
            bunches.iter().map(|bunch| bunch.len()).collect::<Vec<_>>()
        };
        assert!(lengths(0).iter().all(|length| *length <= 2 * MOST) && lengths(0)[0] == 2 * MOST);
        assert_eq!(lengths(MOST_BYTES / 3)[0], 2 * 3);
        assert!(lengths(2 * MOST_BYTES).iter().all(|length| *length == 2));
        assert!(bunches(&[], |_| 0).is_empty());
    }
}
