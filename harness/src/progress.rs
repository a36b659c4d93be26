//! Progress: bars on a terminal, one plain line a finished step otherwise. It goes to standard error.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Instant;

/// The progress of a run of so many steps.
pub(crate) struct Progress {
    total: usize,
    finished: usize,
    started: Instant,
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
            bar.enable_steady_tick(std::time::Duration::from_millis(100));
            bar
        });
        Self { total, finished: 0, started: Instant::now(), bar, quiet: false }
    }

    /// Progress that nobody sees.
    pub(crate) fn silent() -> Self {
        Self { total: 0, finished: 0, started: Instant::now(), bar: None, quiet: true }
    }

    /// A step begins.
    pub(crate) fn begin(&mut self, label: &str) {
        self.started = Instant::now();
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
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{label} · {what} {done}/{total}"));
        }
    }

    /// The present step has ended.
    pub(crate) fn end(&mut self, label: &str, outcome: &str) {
        self.finished += 1;
        let line = format!(
            "[{}/{}] {label} … {outcome}, {:.2} s",
            self.finished,
            self.total,
            self.started.elapsed().as_secs_f64()
        );
        match &self.bar {
            Some(bar) => {
                bar.println(line);
                bar.inc(1);
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
