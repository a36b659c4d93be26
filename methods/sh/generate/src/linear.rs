//! Several linear forms of one vector, with the subexpressions that they share computed once.

use std::collections::HashMap;

use crate::program::{Factor, Id, Op, Program, Sum};

/// Ratios closer than this are the same.
const SAME: f64 = 1e-9;

/// `u = x_first + ratio·x_second`, where the columns below the input's size are its coefficients and the others temporaries.
#[derive(Clone, Copy, Debug)]
struct Shared {
    first: usize,
    second: usize,
    ratio: f64,
}

/// Rows of a sparse matrix over the coefficients of a vector and shared temporaries.
#[derive(Clone, Debug)]
pub struct Forms {
    size: usize,
    rows: Vec<Vec<(usize, f64)>>,
    shared: Vec<Shared>,
    grouped: bool,
}

impl Forms {
    /// The forms `Σ value·x_column`, nothing shared yet.
    pub fn new(size: usize, rows: Vec<Vec<(usize, f64)>>) -> Self {
        Self { size, rows, shared: Vec::new(), grouped: true }
    }

    /// The same with no factor of the transposed map taken out of a sum.
    pub fn ungrouped(mut self) -> Self {
        self.grouped = false;
        self
    }

    /// Computes two-term parts that at least `uses` rows hold up to a factor once, the most frequent first (Paar's greedy).
    pub fn share(&mut self, uses: usize) {
        while let Some(best) = self.most_frequent(uses) {
            let column = self.size + self.shared.len();
            self.shared.push(best);
            for row in &mut self.rows {
                let find = |row: &[(usize, f64)], column| row.iter().position(|entry| entry.0 == column);
                let (Some(p), Some(q)) = (find(row, best.first), find(row, best.second)) else { continue };
                let scale = row[p].1;
                if (row[q].1 / scale - best.ratio).abs() < SAME {
                    row.remove(p.max(q));
                    row.remove(p.min(q));
                    row.push((column, scale));
                }
            }
        }
    }

    fn most_frequent(&self, least: usize) -> Option<Shared> {
        let mut found: HashMap<(usize, usize, i64), (usize, f64)> = HashMap::new();
        for row in &self.rows {
            for (at, p) in row.iter().enumerate() {
                for q in &row[at + 1..] {
                    let (p, q) = if p.0 < q.0 { (p, q) } else { (q, p) };
                    let ratio = q.1 / p.1;
                    found.entry((p.0, q.0, (ratio / SAME / 10.0).round() as i64)).or_insert((0, ratio)).0 += 1;
                }
            }
        }
        let best = found.into_iter().filter(|(_, (uses, _))| *uses >= least);
        let best = best.max_by_key(|&((first, second, key), (uses, _))| (uses, usize::MAX - first, second, key));
        best.map(|((first, second, _), (_, ratio))| Shared { first, second, ratio })
    }

    /// The forms of one input, each computed when it is first asked for.
    pub fn of(&self, vector: usize) -> Forward<'_> {
        Forward { forms: self, vector, columns: vec![None; self.size + self.shared.len()] }
    }

    /// The transposed map: sums over rows into coefficients.
    pub fn transposed(&self) -> Transposed<'_> {
        Transposed { forms: self, columns: vec![Sum::default(); self.size + self.shared.len()], groups: Vec::new() }
    }
}

/// The forms of one input vector.
pub struct Forward<'a> {
    forms: &'a Forms,
    vector: usize,
    columns: Vec<Option<Id>>,
}

impl Forward<'_> {
    /// The value of a row; none if the row is empty.
    pub fn row(&mut self, program: &mut Program, row: usize) -> Option<Id> {
        let mut sum = Sum::default();
        for &(column, value) in &self.forms.rows[row] {
            let x = self.column(program, column);
            sum.scaled(program, Factor::Literal(value), x);
        }
        sum.value()
    }

    fn column(&mut self, program: &mut Program, column: usize) -> Id {
        if let Some(known) = self.columns[column] {
            return known;
        }
        let value = if column < self.forms.size {
            program.input(self.vector, column)
        } else {
            let Shared { first, second, ratio } = self.forms.shared[column - self.forms.size];
            let (x, y) = (self.column(program, first), self.column(program, second));
            program.push(if ratio == 1.0 { Op::Add(x, y) } else { Op::ScaleAdd(Factor::Literal(ratio), y, x) })
        };
        self.columns[column] = Some(value);
        value
    }
}

/// The sums of a transposed map in the making.
pub struct Transposed<'a> {
    forms: &'a Forms,
    columns: Vec<Sum>,
    groups: Vec<Group>,
}

/// What reaches one column by one factor is summed first and multiplied once.
struct Group {
    column: usize,
    factor: f64,
    sum: Sum,
}

impl Transposed<'_> {
    /// Adds `factor·Σ x·y` over the products, times a row, to the columns.
    pub fn add(&mut self, program: &mut Program, row: usize, factor: f64, products: &[(Id, Id)]) {
        if let (&[(column, value)], true) = (self.forms.rows[row].as_slice(), self.forms.grouped) {
            return self.add_to_group(program, column, factor * value, products);
        }
        if self.forms.rows[row].is_empty() {
            return;
        }
        let mut sum = Sum::default();
        products.iter().for_each(|&(x, y)| sum.product(program, x, y));
        let x = sum.value().expect("at least one product");
        for &(column, value) in &self.forms.rows[row] {
            self.columns[column].scaled(program, Factor::Literal(factor * value), x);
        }
    }

    /// Adds `factor·Σ x·y` to one column.
    pub fn add_to_group(&mut self, program: &mut Program, column: usize, factor: f64, products: &[(Id, Id)]) {
        let same = |group: &Group| group.column == column && (group.factor.abs() - factor.abs()).abs() < SAME;
        let at = self.groups.iter().position(same).unwrap_or_else(|| {
            self.groups.push(Group { column, factor, sum: Sum::default() });
            self.groups.len() - 1
        });
        let Group { factor: known, sum, .. } = &mut self.groups[at];
        for &(x, y) in products {
            if known.signum() == factor.signum() {
                sum.product(program, x, y);
            } else {
                sum.minus_product(program, x, y);
            }
        }
    }

    /// The sum of a coefficient, to which more may be added.
    pub fn sum(&mut self, column: usize) -> &mut Sum {
        &mut self.columns[column]
    }

    /// The finished sums of the coefficients.
    pub fn finish(mut self, program: &mut Program) -> Vec<Id> {
        for Group { column, factor, sum } in &self.groups {
            let value = sum.value().expect("groups begin with a positive product");
            self.columns[*column].scaled(program, Factor::Literal(*factor), value);
        }
        for (at, &Shared { first, second, ratio }) in self.forms.shared.iter().enumerate().rev() {
            let dual = self.columns[self.forms.size + at].value().expect("shared parts are used");
            self.columns[first].scaled(program, Factor::Literal(1.0), dual);
            self.columns[second].scaled(program, Factor::Literal(ratio), dual);
        }
        self.columns[..self.forms.size].iter().map(|sum| sum.value().expect("every coefficient is reached")).collect()
    }
}
