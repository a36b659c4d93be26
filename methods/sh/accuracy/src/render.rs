//! Reports as tables: Markdown to read, CSV for other programs.

use std::fmt::Write;

use crate::domain::{Domain, Family};
use crate::operation::{OPERATIONS, Operation};
use crate::tally::Row;
use crate::{Report, STATED_DOMAINS};

/// One Markdown row.
fn line(cells: impl IntoIterator<Item = String>) -> String {
    let mut out = String::from("|");
    for cell in cells {
        let _ = write!(out, " {cell} |");
    }
    out + "\n"
}

fn header(first: &str, columns: impl Iterator<Item = String> + Clone) -> String {
    let rule = format!("|---|{}\n", "---|".repeat(columns.clone().count()));
    line(std::iter::once(first.to_owned()).chain(columns)) + &rule
}

/// Two digits, as short as they go.
fn short(value: f64) -> String {
    if value.is_nan() {
        "–".into()
    } else if value == 0.0 {
        "0".into()
    } else if (0.01..100.0).contains(&value) {
        format!("{}", format!("{value:.1e}").parse::<f64>().unwrap_or(value))
    } else {
        format!("{value:.1e}").replace(".0e", "e")
    }
}

/// A length on the grid.
fn length(value: f64) -> String {
    if value >= 1e4 {
        "∞".into()
    } else if value >= 10.0 {
        format!("{value:.0}")
    } else {
        format!("{value:.1}")
    }
}

impl Report {
    /// The orders that were measured, ascending.
    fn orders(&self) -> Vec<usize> {
        let mut orders: Vec<usize> = self.rows.iter().map(|row| row.order).collect();
        orders.dedup();
        orders
    }

    /// The tables of all that was measured, over all forms and inputs together.
    pub fn markdown(&self) -> String {
        let mut out = String::new();
        for precision in ["f32", "f64"] {
            let _ = writeln!(out, "Largest errors and, in brackets, root mean squares in `{precision}`, by order\n");
            let columns =
                std::iter::once("relative to".to_owned()).chain(self.orders().into_iter().map(|o| o.to_string()));
            out += &header("operation", columns);
            for operation in OPERATIONS {
                let rows: Vec<&Row> = self.rows.iter().filter(|row| row.is_of(operation, precision)).collect();
                if !rows.is_empty() {
                    let cells = self.orders().into_iter().map(|order| cell(&rows, order));
                    out +=
                        &line([operation.name.to_owned(), operation.relative_to.to_owned()].into_iter().chain(cells));
                }
            }
            out.push('\n');
        }
        for family in Family::ALL {
            let name = family.name();
            let _ = writeln!(
                out,
                "Exponentials of {name}, `f32`: the longest ‖f̂‖ up to which every input (half of them) errs by less than 10% of \
                 the whole series / the length from which half err by more than ten times it / up to which half err by less \
                 than 10% of the exact exponential\n"
            );
            out += &self.by_variant(family, ends);
            let _ = writeln!(
                out,
                "Exponentials of {name}, `f32`: percent of them that the guard changes at ‖f̂‖ = 1, 10, 100, 1000, 10000\n"
            );
            out += &self.by_variant(family, shares);
        }
        out
    }

    /// A table of the variants at all orders.
    fn by_variant(&self, family: Family, cell: fn(&Domain) -> String) -> String {
        let orders = self.orders().into_iter().filter(|&order| order > 1);
        let mut out = header("variant", orders.clone().map(|order| order.to_string()));
        let mut names: Vec<&str> = self.domains.iter().map(|domain| domain.variant).collect();
        names.sort_unstable();
        names.dedup();
        for name in names {
            let of = |order: usize| {
                let found = self.domains.iter().find(|d| (d.order, d.variant, d.family) == (order, name, family));
                found.map_or(String::new(), cell)
            };
            out += &line(std::iter::once(name.to_owned()).chain(orders.clone().map(of)));
        }
        out + "\n"
    }

    /// A line for each operation, order, precision, form and class of inputs.
    pub fn errors_csv(&self) -> String {
        let mut out = String::from("operation,relative_to,order,precision,code,inputs,count,max,rms,stated\n");
        for row in &self.rows {
            let Operation { name, relative_to, .. } = row.operation;
            let stated = row.operation.stated(row.order, row.precision);
            let _ = writeln!(
                out,
                "\"{name}\",\"{relative_to}\",{},{},\"{}\",{},{},{:e},{:e},{stated:e}",
                row.order, row.precision, row.code, row.inputs, row.count, row.max, row.rms
            );
        }
        out
    }

    /// A line for each exponential, order, family and length; what cannot be told is empty.
    pub fn domains_csv(&self) -> String {
        let mut out = String::from(
            "order,variant,inputs,length,series_median,series_worst,exact_median,visibility_unguarded,visibility_guarded,guarded,\
             not_finite\n",
        );
        for step in &self.steps {
            let number = |x: f64| if x.is_nan() { String::new() } else { format!("{x:e}") };
            let values = [step.series[0], step.series[1], step.exact, step.guarding[0], step.guarding[1]].map(number);
            let _ = writeln!(
                out,
                "{},{},{},{},{},{},{}",
                step.order,
                step.variant,
                step.family.name(),
                step.length,
                values.join(","),
                step.guarded,
                step.not_finite
            );
        }
        out
    }
}

impl Row {
    fn is_of(&self, operation: &Operation, precision: &str) -> bool {
        self.operation.name == operation.name && self.precision == precision
    }
}

/// The largest error and the root mean square of an order.
fn cell(rows: &[&Row], order: usize) -> String {
    let rows = rows.iter().filter(|row| row.order == order);
    let max = rows.clone().fold(0.0, |m: f64, row| if row.max.is_nan() { f64::NAN } else { m.max(row.max) });
    let (sum, count) =
        rows.fold((0.0, 0.0), |(sum, count), row| (sum + row.rms.powi(2) * row.count as f64, count + row.count as f64));
    format!("{} ({})", short(max), short((sum / count).sqrt()))
}

fn ends(domain: &Domain) -> String {
    let Domain { every, half, diverges, exact, .. } = domain;
    format!("{} ({}) / {} / {}", length(*every), length(*half), length(*diverges), length(*exact))
}

fn shares(domain: &Domain) -> String {
    domain.guarded.map(|share| format!("{:.0}", 100.0 * share)).join(" ")
}

/// What is stated of errors and domains, as the crate's page prints it.
pub fn stated_markdown() -> String {
    let orders = (1..=8).map(|order: usize| order.to_string());
    let mut out = header(
        "error at most, by order",
        ["relative to".to_owned()].into_iter().chain(orders.clone()).chain(["`f64`".to_owned()]),
    );
    for operation in OPERATIONS {
        let cells = operation.single.map(short);
        let names = [operation.name, operation.relative_to].map(str::to_owned);
        out += &line(names.into_iter().chain(cells).chain([short(operation.double)]));
    }
    out += "\n";
    out += &header("‖f̂‖ at least up to which every sum of blockers errs by less than 10%, by order", orders.skip(1));
    for (name, lengths) in STATED_DOMAINS {
        out += &line(std::iter::once((*name).to_owned()).chain(lengths.map(length)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 1.04e-7, 0.012, 0.37, 12.0, 250.0, f64::NAN].map(short);
        assert_eq!(texts, ["0", "1e-7", "0.012", "0.37", "12", "2.5e2", "–"]);
        assert_eq!([0.72, 22.627, f64::INFINITY].map(length), ["0.7", "23", "∞"]);
    }
}
