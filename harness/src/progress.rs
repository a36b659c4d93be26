//! Progress: bars on a terminal; otherwise plain lines, one a finished step and one now and then within a long step. It goes to
//! standard error.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Between two plain lines within a step.
const PATIENCE: Duration = Duration::from_secs(10);

/// The progress of a run of so many steps.
pub(crate) struct Progress {
    total: usize,
    finished: usize,
    started: Instant,
    pace: Option<Pace>,
    told: Instant,
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Progress {
    /// Progress over `total` steps, on standard error.
    pub(crate) fn new(total: usize) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = "{bar:30} {pos}/{len} {elapsed} {wide_msg}";
            let style = ProgressStyle::with_template(style).expect("the template names known keys");
            let bar = ProgressBar::new(total as u64).with_style(style);
            bar.enable_steady_tick(Duration::from_millis(100));
            bar
        });
        let now = Instant::now();
        Self { total, finished: 0, started: now, pace: None, told: now, bar, quiet: false }
    }

    /// Progress that nobody sees.
    pub(crate) fn silent() -> Self {
        let now = Instant::now();
        Self { total: 0, finished: 0, started: now, pace: None, told: now, bar: None, quiet: true }
    }

    /// A step begins.
    pub(crate) fn begin(&mut self, label: &str) {
        self.started = Instant::now();
        (self.pace, self.told) = (None, self.started);
        if let Some(bar) = &self.bar {
            bar.set_message(label.to_owned());
        }
    }

    /// Tells something beside the steps.
    pub(crate) fn note(&self, line: &str) {
        match &self.bar {
            Some(bar) => bar.println(line),
            None if self.quiet => {}
            None => eprintln!("{line}"),
        }
    }

    /// The present step turned out to be no work.
    pub(crate) fn pass(&mut self) {
        self.finished += 1;
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }

    /// How far the present step is.
    pub(crate) fn within(&mut self, label: &str, what: &str, done: u64, total: u64) {
        let now = Instant::now();
        if self.pace.as_ref().is_none_or(|pace| pace.what != what) {
            self.pace = Some(Pace { what: what.to_owned(), since: now, from: done });
        }
        let left = self.pace.as_ref().and_then(|pace| pace.left(done, total, now));
        let left = left.map_or(String::new(), |left| format!(", {} left", duration(left)));
        match &self.bar {
            Some(bar) => bar.set_message(format!("{label} · {what} {done}/{total}{left}")),
            None if !self.quiet && now - self.told >= PATIENCE => {
                self.told = now;
                eprintln!("[{}/{}] {label} · {what} {done}/{total}{left}", self.finished + 1, self.total);
            }
            None => {}
        }
    }

    /// The present step has ended.
    pub(crate) fn end(&mut self, label: &str, outcome: &str) {
        self.end_of(1, label, outcome);
    }

    /// So many steps, done together, have ended.
    pub(crate) fn end_of(&mut self, steps: usize, label: &str, outcome: &str) {
        self.finished += steps;
        let line = format!(
            "[{}/{}] {label} … {outcome}, {:.2} s",
            self.finished,
            self.total,
            self.started.elapsed().as_secs_f64()
        );
        match &self.bar {
            Some(bar) => {
                bar.println(line);
                bar.inc(steps as u64);
            }
            None if self.quiet => {}
            None => eprintln!("{line}"),
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// The rate of a piece of work, from when it was first heard of: it may have been half done then.
struct Pace {
    what: String,
    since: Instant,
    from: u64,
}

impl Pace {
    /// What is left if the rest goes as what was done so far; `None` while nothing was done.
    fn left(&self, done: u64, total: u64, now: Instant) -> Option<Duration> {
        let did = done.checked_sub(self.from).filter(|did| *did > 0)?;
        let share = total.saturating_sub(done) as f64 / did as f64;
        Duration::try_from_secs_f64((now - self.since).as_secs_f64() * share).ok()
    }
}

/// A time for people: `8 s`, `3 min 20 s`, `2 h 05 min`.
fn duration(time: Duration) -> String {
    match time.as_secs_f64().ceil() as u64 {
        s @ 0..60 => format!("{s} s"),
        s @ 60..3600 => format!("{} min {:02} s", s / 60, s % 60),
        s => format!("{} h {:02} min", s / 3600, s % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_that_of_the_rate_since_the_beginning() {
        let since = Instant::now();
        let pace = Pace { what: "reference".into(), since, from: 600 };
        let after = |seconds| since + Duration::from_secs(seconds);
        assert_eq!(pace.left(600, 1000, after(5)), None, "nothing was done");
        // 100 in 5 s, 300 to go: what was there before does not count as done in this time.
        assert_eq!(pace.left(700, 1000, after(5)), Some(Duration::from_secs(15)));
        assert_eq!(pace.left(1000, 1000, after(20)), Some(Duration::ZERO));
        assert_eq!(pace.left(500, 1000, after(20)), None, "work that went backwards has no rate");
    }

    #[test]
    fn times_are_read_by_people() {
        for (seconds, text) in [(0.0, "0 s"), (7.2, "8 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 05 min")] {
            assert_eq!(duration(Duration::from_secs_f64(seconds)), text);
        }
    }
}
