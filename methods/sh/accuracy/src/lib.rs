//! How accurate the spherical harmonics algebra is: every operation of `halflight-sh` in every form against quadrature in
//! `f64`, over random, structured and adversarial inputs, and where each exponential leaves its domain.
//!
//! The program prints it: `halflight accuracy sh`. What is stated of each operation is in [`OPERATIONS`]; [`violations`]
//! tells what is broken, and the crate's page carries the same tables.
//!
//! ```
//! let report = halflight_sh_accuracy::measure(2..=2);
//! assert!(halflight_sh_accuracy::violations(&report).is_empty());
//! ```

mod batches;
mod domain;
mod inputs;
mod measure;
mod operation;
mod oracle;
mod render;
mod tally;
mod vector;

pub use domain::{Domain, Family, STATED_DOMAINS, Step};
pub use inputs::Class;
pub use operation::{OPERATIONS, Operation};
pub use render::stated_markdown;
pub use tally::Row;

use std::ops::RangeInclusive;

use rayon::prelude::*;

use measure::{basis, circles, exponentials, products, rotations};
use oracle::Oracle;
use tally::Tally;

/// What was measured.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Errors, by order.
    pub rows: Vec<Row>,
    /// Exponentials at growing lengths, by order, family and variant.
    pub steps: Vec<Step>,
    /// Where exponentials end, in the same order.
    pub domains: Vec<Domain>,
}

/// Measures everything at some orders, within 1 to 8.
///
/// # Panics
/// If an order is outside 1 to 8.
pub fn measure(orders: RangeInclusive<usize>) -> Report {
    type Part = fn(&Oracle, &mut Tally);
    let parts: &[Part] = &[
        products::measure::<f32>,
        products::measure::<f64>,
        basis::measure::<f32>,
        basis::measure::<f64>,
        rotations::measure::<f32>,
        rotations::measure::<f64>,
        |_, tally| circles::tables::<f32>(tally),
        |_, tally| circles::tables::<f64>(tally),
        circles::logs,
        exponentials::measure::<f32>,
        exponentials::measure::<f64>,
    ];
    // The highest orders take longest and begin first.
    let jobs: Vec<(usize, &Part)> =
        orders.clone().rev().flat_map(|order| parts.iter().map(move |p| (order, p))).collect();
    let rays: Vec<(usize, Family)> =
        orders.clone().flat_map(|order| Family::ALL.map(|family| (order, family))).collect();
    let rows = jobs.par_iter().map(|&(order, part)| {
        let mut tally = Tally::new(order);
        part(&Oracle::new(order), &mut tally);
        tally.rows
    });
    let mut rows: Vec<Row> = rows.collect::<Vec<_>>().concat();
    rows.sort_by_key(|row| row.order);
    let steps: Vec<Step> =
        rays.par_iter().map(|&(order, family)| domain::steps(order, family)).collect::<Vec<_>>().concat();
    let domains = domain::domains(&steps);
    Report { rows, steps, domains }
}

/// Whatever does not keep what is stated of it.
pub fn violations(report: &Report) -> Vec<String> {
    let rows = report.rows.iter().filter(|row| !row.keeps_its_bound()).map(|row| {
        let stated = row.operation.stated(row.order, row.precision);
        format!(
            "{} ({}, {}, {} inputs), order {}: error {:.2e}, at most {stated:.1e} stated",
            row.operation.name, row.precision, row.code, row.inputs, row.order, row.max
        )
    });
    let domains = report.domains.iter().filter(|domain| domain.every < domain.stated()).map(|domain| {
        let Domain { order, variant, every, .. } = domain;
        format!("{variant}, order {order}: 10% is kept up to ‖f̂‖ = {every:.2}, {:.1} stated", domain.stated())
    });
    let not_finite = report.steps.iter().filter(|step| step.not_finite > 0).map(|step| {
        format!(
            "{}, order {}, ‖f̂‖ = {:.1}: {} results are not finite",
            step.variant, step.order, step.length, step.not_finite
        )
    });
    // Both lie in the ball of all visibilities, so that they are at most its diameter apart, which is the open sky's length.
    let unguarded =
        report.steps.iter().filter(|step| step.guarding[1].is_nan() || step.guarding[1] > 1.0 + 1e-5).map(|step| {
            let [_, off] = step.guarding;
            format!("{}, order {}, ‖f̂‖ = {:.1}: {off} after the guard", step.variant, step.order, step.length)
        });
    rows.chain(domains).chain(not_finite).chain(unguarded).collect()
}
