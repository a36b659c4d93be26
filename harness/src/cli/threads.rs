//! `--threads`: how many, or several numbers to time the same work on.

use anyhow::ensure;
use std::str::FromStr;

/// A number of threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Threads(pub(super) usize);

impl FromStr for Threads {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let count = match text {
            "all" => std::thread::available_parallelism().map_or(1, usize::from),
            text => text.parse().unwrap_or(0),
        };
        if (1..=1024).contains(&count) { Ok(Self(count)) } else { Err("expected 1 to 1024, or all".into()) }
    }
}

/// Has all work done on the threads that were asked for. Several numbers, where the command knows what to do with them, are
/// returned, each once; the work that they do not time is done on all cores.
pub(super) fn settle(asked: &[Threads], may_be_several: bool) -> anyhow::Result<Vec<usize>> {
    let mut counts: Vec<usize> = Vec::new();
    for &Threads(count) in asked {
        if !counts.contains(&count) {
            counts.push(count);
        }
    }
    if asked.len() > 1 {
        ensure!(may_be_several, "--threads: expected one number; several are for `run` and `plan`");
        return Ok(counts);
    }
    if let Some(&threads) = counts.first() {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global()?;
    }
    Ok(Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_all_are_threads() {
        assert_eq!("3".parse(), Ok(Threads(3)));
        assert!("all".parse::<Threads>().unwrap().0 >= 1);
        for bad in ["0", "1025", "-1", "", "some"] {
            assert!(bad.parse::<Threads>().is_err(), "{bad}");
        }
        assert_eq!(settle(&[Threads(1), Threads(2), Threads(1)], true).unwrap(), [1, 2]);
        assert!(settle(&[Threads(1), Threads(2)], false).is_err());
    }
}
