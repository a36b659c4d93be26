//! `halflight refs list`.

use super::super::{CacheDir, Ending, say};
use clap::Args;
use halflight_references::{Entry, Provenance, REVISION, State};
use serde::Serialize;
use std::time::{SystemTime, UNIX_EPOCH};

#[derive(Args)]
pub(super) struct List {
    #[command(flatten)]
    cache: CacheDir,
    /// Print a JSON array
    #[arg(long)]
    json: bool,
}

/// A file and what it tells of itself.
#[derive(Serialize)]
struct Row<'a> {
    file: String,
    state: &'static str,
    bytes: u64,
    /// Seconds since 1970, UTC.
    modified: u64,
    /// Whether this program uses it: made by its revision, and whole or begun.
    current: bool,
    /// Receivers that are done.
    done: Option<usize>,
    provenance: Option<&'a Provenance>,
}

impl List {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let entries = crate::refs::store(&self.cache.path()?).entries()?;
        let rows: Vec<Row<'_>> = entries.iter().map(Row::of).collect();
        if self.json {
            say(&serde_json::to_string_pretty(&rows)?);
            return Ok(Ending::Well);
        }
        rows.iter().for_each(|row| say(&row.line()));
        let bytes: u64 = rows.iter().map(|row| row.bytes).sum();
        say(&format!("{} files, {}", rows.len(), super::prune::size(bytes)));
        Ok(Ending::Well)
    }
}

impl<'a> Row<'a> {
    fn of(entry: &'a Entry) -> Self {
        let (state, provenance, done) = match &entry.state {
            State::Whole(provenance) => ("whole", Some(provenance), None),
            State::Begun { provenance, done, in_use: true } => ("being made", Some(provenance), Some(*done)),
            State::Begun { provenance, done, in_use: false } => ("begun", Some(provenance), Some(*done)),
            State::Damaged => ("damaged", None, None),
            State::Unplaced => ("unplaced", None, None),
        };
        Row {
            file: entry.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            state,
            bytes: entry.bytes,
            modified: seconds(entry.modified),
            current: provenance.is_some_and(|provenance| provenance.revision == REVISION),
            done,
            provenance,
        }
    }

    fn line(&self) -> String {
        let head = format!("{}  {:>10}  {:.12}", date(self.modified), super::prune::size(self.bytes), self.file);
        let Some(p) = self.provenance else { return format!("{head}  {}", self.state) };
        let mut line =
            format!("{head}  {} · {} · {} · frame {}, seed {}", p.scene, p.reference, p.quantity, p.frame, p.seed);
        match (&p.achieved, self.done) {
            (Some(a), _) => {
                line += &format!(", {} samples, standard error {:.2} %", a.samples, 100.0 * a.standard_error);
            }
            (None, Some(done)) => line += &format!(", {}: {done} of {} receivers", self.state, p.receivers),
            (None, None) => {}
        }
        if !self.current {
            line += ", by another revision";
        }
        line
    }
}

fn seconds(time: SystemTime) -> u64 {
    time.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs()
}

/// `2026-11-22 05:43` of seconds since 1970, UTC: days to a civil date by eras of 400 years that begin in March.
fn date(seconds: u64) -> String {
    let days = seconds / 86_400 + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let (day, month) = (day - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    let year = 400 * era + year + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}", seconds / 3600 % 24, seconds / 60 % 60)
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn dates_are_those_of_date_u() {
        for (seconds, text) in [
            (0, "1970-01-01 00:00"),
            (951_782_399, "2000-02-28 23:59"),
            (951_782_400, "2000-02-29 00:00"),
            (4_107_542_400, "2100-03-01 00:00"),
            (1_735_689_599, "2024-12-31 23:59"),
        ] {
            assert_eq!(date(seconds), text);
        }
    }
}
