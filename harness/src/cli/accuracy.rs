//! `halflight accuracy`.

use super::{Ending, say};
use anyhow::Context;
use clap::{Args, Subcommand};
use halflight_sh_accuracy::{measure, violations};
use std::ops::RangeInclusive;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Accuracy {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// The spherical harmonics algebra, every operation in every form against f64 quadrature, and the domains of exponentials
    Sh(Sh),
}

#[derive(Args)]
struct Sh {
    /// An order, or a range such as 2..6
    #[arg(long, value_name = "ORDERS", default_value = "1..8", value_parser = orders)]
    order: RangeInclusive<usize>,
    /// Write accuracy.md, errors.csv and domains.csv there rather than print the tables
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Exit with 1 if anything is worse than what is stated of it
    #[arg(long)]
    check: bool,
}

impl Accuracy {
    pub(super) fn act(&self) -> anyhow::Result<Ending> {
        let What::Sh(sh) = &self.what;
        sh.act()
    }
}

impl Sh {
    fn act(&self) -> anyhow::Result<Ending> {
        let report = measure(self.order.clone());
        let Some(dir) = &self.out else {
            say(report.markdown().trim_end());
            return Ok(self.judge(&violations(&report)));
        };
        std::fs::create_dir_all(dir).with_context(|| dir.display().to_string())?;
        let files = [
            ("accuracy.md", report.markdown()),
            ("errors.csv", report.errors_csv()),
            ("domains.csv", report.domains_csv()),
        ];
        for (name, text) in files {
            let path = dir.join(name);
            std::fs::write(&path, text).with_context(|| path.display().to_string())?;
            say(&path.display().to_string());
        }
        Ok(self.judge(&violations(&report)))
    }

    fn judge(&self, violations: &[String]) -> Ending {
        if !self.check {
            return Ending::Well;
        }
        violations.iter().for_each(|line| say(line));
        if violations.is_empty() { Ending::Well } else { Ending::Differs }
    }
}

/// `4`, or `2..6` with both ends, within 1 to 8.
fn orders(text: &str) -> Result<RangeInclusive<usize>, String> {
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    let parse = |end: &str| end.trim_start_matches('=').parse().ok().filter(|order| (1..=8).contains(order));
    match (parse(first), parse(last)) {
        (Some(first), Some(last)) if first <= last => Ok(first..=last),
        _ => Err("expected an order from 1 to 8, or a range such as 2..6".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_one_or_a_range() {
        assert_eq!(orders("4"), Ok(4..=4));
        assert_eq!(orders("2..6"), Ok(2..=6));
        assert_eq!(orders("1..=8"), Ok(1..=8));
        for wrong in ["", "0", "9", "6..2", "1..9", "a..b", "1..2..3"] {
            assert!(orders(wrong).is_err(), "{wrong}");
        }
    }
}
