//! PyPI's `sphericart` in a Python of its own, which times itself when asked to.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// A running Python.
pub(crate) struct Sphericart {
    child: Child,
    ask: ChildStdin,
    answer: BufReader<ChildStdout>,
}

impl Sphericart {
    /// Starts it with the directions; also returns the basis functions at every 37th. `None`, with a word on standard
    /// error, where there is no such package.
    pub(crate) fn start(order: usize, precision: &str, directions: &[[f64; 3]]) -> Option<(Self, Vec<Vec<f64>>)> {
        let python = std::env::var("HALFLIGHT_PYTHON").unwrap_or_else(|_| "python3".into());
        let child = Command::new(&python)
            .args(["-c", include_str!("sphericart.py"), &order.to_string(), precision])
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let started = child.ok().and_then(|mut child| {
            let (ask, answer) = (child.stdin.take()?, BufReader::new(child.stdout.take()?));
            let mut this = Self { child, ask, answer };
            let text: String = directions.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
            this.ask.write_all(format!("{}\n{text}", directions.len()).as_bytes()).ok()?;
            this.ask.flush().ok()?;
            let lines = directions.len().div_ceil(37);
            let numbers = |line: String| line.split_whitespace().map(|x| x.parse().ok()).collect::<Option<Vec<f64>>>();
            let values = (0..lines).map(|_| numbers(this.line()?)).collect::<Option<Vec<_>>>()?;
            Some((this, values))
        });
        if started.is_none() {
            eprintln!("{python} has no sphericart with numpy: skipped");
        }
        started
    }

    fn line(&mut self) -> Option<String> {
        let mut line = String::new();
        (self.answer.read_line(&mut line).ok()? > 0).then_some(line)
    }

    /// Seconds that all directions take.
    ///
    /// # Panics
    /// If the Python is gone.
    pub(crate) fn time(&mut self) -> f64 {
        writeln!(self.ask, "time").and_then(|()| self.ask.flush()).expect("a running Python");
        self.line().and_then(|line| line.trim().parse().ok()).expect("seconds")
    }
}

impl Drop for Sphericart {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
