//! Where errors are collected.

use crate::inputs::Class;
use crate::operation::Operation;

/// The errors of one operation by one piece of code on one class of inputs.
#[derive(Clone, Debug)]
pub struct Row {
    /// What was computed.
    pub operation: &'static Operation,
    /// The order.
    pub order: usize,
    /// `f32` or `f64`.
    pub precision: &'static str,
    /// `one` vector at a time, the instruction set of a batch, or `table`.
    pub code: String,
    /// What it was tried with.
    pub inputs: &'static str,
    /// Results that were compared.
    pub count: usize,
    /// The largest error.
    pub max: f64,
    /// The root of the mean squared error.
    pub rms: f64,
}

impl Row {
    /// Whether the largest error is at most what is stated; not if it is NaN.
    pub fn keeps_its_bound(&self) -> bool {
        self.max <= self.operation.stated(self.order, self.precision)
    }
}

/// The rows of one order.
pub(crate) struct Tally {
    pub(crate) order: usize,
    pub(crate) rows: Vec<Row>,
}

impl Tally {
    pub(crate) fn new(order: usize) -> Self {
        Self { order, rows: Vec::new() }
    }

    /// Adds a row.
    pub(crate) fn add<T>(&mut self, operation: &'static Operation, code: &str, inputs: Class, errors: &[f64]) {
        let largest = errors.iter().fold(0.0f64, |m, &e| if e.is_nan() || m.is_nan() { f64::NAN } else { m.max(e) });
        let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        let precision = if size_of::<T>() == 4 { "f32" } else { "f64" };
        self.rows.push(Row {
            operation,
            order: self.order,
            precision,
            code: code.into(),
            inputs: inputs.name(),
            count: errors.len(),
            max: largest,
            rms: mean.sqrt(),
        });
    }
}
