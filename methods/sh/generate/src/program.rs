//! Straight-line programs over lanes: built without repetition, counted, run, and printed as Rust.

use std::collections::HashMap;
use std::fmt::Write;

/// The number of a value in a program.
pub type Id = usize;

/// A constant factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Factor {
    /// Printed as a number.
    Literal(f64),
    /// Printed as an entry of the table `k`, so that one text serves several tables.
    Slot(usize),
}

impl Factor {
    fn key(self) -> (u8, u64) {
        match self {
            Self::Literal(value) => (0, value.to_bits()),
            Self::Slot(slot) => (1, slot as u64),
        }
    }
}

/// One step. Every step but [`Op::Input`] and [`Op::Constant`] is one instruction of a machine with fused multiply-add.
#[derive(Clone, Copy, Debug)]
pub enum Op {
    /// Coefficient `index` of input `vector`.
    Input(usize, usize),
    /// `constant·x`.
    Scale(Factor, Id),
    /// `x·y`.
    Mul(Id, Id),
    /// `x + y`.
    Add(Id, Id),
    /// `x - y`.
    Sub(Id, Id),
    /// `constant·x + z`.
    ScaleAdd(Factor, Id, Id),
    /// `x·y + z`.
    MulAdd(Id, Id, Id),
    /// `z - x·y`.
    NegMulAdd(Id, Id, Id),
    /// A number, in a register or memory: no instruction.
    Constant(f64),
    /// `slope·x + offset`.
    Affine(f64, Id, f64),
    /// `x·y + offset`.
    MulOffset(Id, Id, f64),
}

/// A program and the values that it writes.
#[derive(Clone, Debug, Default)]
pub struct Program {
    ops: Vec<Op>,
    known: HashMap<(u8, (u8, u64), Id, Id), Id>,
    outputs: Vec<(usize, Id)>,
    slots: Vec<f64>,
    verbatim: bool,
}

impl Program {
    /// A program that computes what it is told as often as it is told.
    pub fn verbatim() -> Self {
        Self { verbatim: true, ..Self::default() }
    }

    /// The value of a step; one that is already there is not computed again.
    pub fn push(&mut self, op: Op) -> Id {
        let key = match op {
            Op::Input(vector, index) => (0, (0, 0), vector, index),
            Op::Scale(k, x) => (1, k.key(), x, 0),
            Op::Mul(x, y) => (2, (0, 0), x.min(y), x.max(y)),
            Op::Add(x, y) => (3, (0, 0), x.min(y), x.max(y)),
            Op::Sub(x, y) => (4, (0, 0), x, y),
            Op::ScaleAdd(k, x, z) => (5, k.key(), x, z),
            Op::MulAdd(x, y, z) => (6, (0, z as u64), x.min(y), x.max(y)),
            Op::NegMulAdd(x, y, z) => (7, (0, z as u64), x.min(y), x.max(y)),
            Op::Constant(k) => (8, (0, k.to_bits()), 0, 0),
            Op::Affine(k, x, offset) => (9, (0, k.to_bits()), x, offset.to_bits() as usize),
            Op::MulOffset(x, y, offset) => (10, (0, offset.to_bits()), x.min(y), x.max(y)),
        };
        let Self { ops, known, .. } = self;
        if self.verbatim && !matches!(op, Op::Input(..)) {
            ops.push(op);
            return ops.len() - 1;
        }
        *known.entry(key).or_insert_with(|| {
            ops.push(op);
            ops.len() - 1
        })
    }

    /// Coefficient `index` of input `vector`.
    pub fn input(&mut self, vector: usize, index: usize) -> Id {
        self.push(Op::Input(vector, index))
    }

    /// A constant of the table.
    pub fn slot(&mut self, value: f64) -> Factor {
        self.slots.push(value);
        Factor::Slot(self.slots.len() - 1)
    }

    /// The table of constants.
    pub fn slots(&self) -> &[f64] {
        &self.slots
    }

    /// Writes a value to output `index`.
    pub fn output(&mut self, index: usize, value: Id) {
        self.outputs.push((index, value));
    }

    /// The indices of the outputs, ascending.
    pub fn outputs(&self) -> impl Iterator<Item = usize> {
        let mut outputs: Vec<usize> = self.outputs.iter().map(|output| output.0).collect();
        outputs.sort_unstable();
        outputs.into_iter()
    }

    /// The values that are written, by the index of their output.
    pub(crate) fn written(&self) -> impl Iterator<Item = (usize, Id)> {
        self.outputs.iter().copied()
    }

    /// The step that makes a value.
    pub(crate) fn step(&self, id: Id) -> Op {
        self.ops[id]
    }

    /// The steps that outputs depend on.
    pub(crate) fn live_steps(&self) -> impl Iterator<Item = (Id, Op)> {
        self.ops.iter().copied().enumerate().zip(self.live()).filter(|(_, live)| *live).map(|(step, _)| step)
    }

    /// Which steps the outputs depend on.
    fn live(&self) -> Vec<bool> {
        let mut live = vec![false; self.ops.len()];
        self.outputs.iter().for_each(|output| live[output.1] = true);
        for (id, &op) in self.ops.iter().enumerate().rev() {
            if live[id] {
                operands(op).into_iter().flatten().for_each(|operand| live[operand] = true);
            }
        }
        live
    }

    /// Instructions: sums, products and fused multiply-adds.
    pub fn count(&self) -> usize {
        let free = |op: &Op| matches!(op, Op::Input(..) | Op::Constant(_));
        self.ops.iter().zip(self.live()).filter(|(op, live)| *live && !free(op)).count()
    }

    /// Those among them that multiply: on some machines sums go to other units, at the same time.
    pub fn count_multiplications(&self) -> usize {
        let multiplies = |op: &Op| !matches!(op, Op::Input(..) | Op::Constant(_) | Op::Add(..) | Op::Sub(..));
        self.ops.iter().zip(self.live()).filter(|(op, live)| *live && multiplies(op)).count()
    }

    /// Writes the outputs for given inputs.
    pub fn run(&self, inputs: &[&[f64]], out: &mut [f64]) {
        let factor = |k: Factor| match k {
            Factor::Literal(value) => value,
            Factor::Slot(slot) => self.slots[slot],
        };
        let mut values: Vec<f64> = Vec::with_capacity(self.ops.len());
        for &op in &self.ops {
            let v = |id: Id| values[id];
            values.push(match op {
                Op::Input(vector, index) => inputs[vector][index],
                Op::Scale(k, x) => factor(k) * v(x),
                Op::Mul(x, y) => v(x) * v(y),
                Op::Add(x, y) => v(x) + v(y),
                Op::Sub(x, y) => v(x) - v(y),
                Op::ScaleAdd(k, x, z) => factor(k) * v(x) + v(z),
                Op::MulAdd(x, y, z) => v(x) * v(y) + v(z),
                Op::NegMulAdd(x, y, z) => v(z) - v(x) * v(y),
                Op::Constant(k) => k,
                Op::Affine(k, x, offset) => k * v(x) + offset,
                Op::MulOffset(x, y, offset) => v(x) * v(y) + offset,
            });
        }
        self.outputs.iter().for_each(|&(index, id)| out[index] = values[id]);
    }

    /// The body of a function over lanes `V` that reads `names[vector].get(index)` and calls `out.set(index, value)` as soon as a value
    /// is there.
    pub fn body(&self, names: &[&str]) -> String {
        self.print(names, usize::MAX)
    }

    /// The body of a loop: as [`Program::body`], but the input of the name `kept` is read from variables of that name and an index, to which
    /// outputs of this index go.
    pub fn loop_body(&self, names: &[&str], kept: usize) -> String {
        self.print(names, kept)
    }

    fn print(&self, names: &[&str], kept: usize) -> String {
        let mut text = String::new();
        let name = |id: Id| match self.ops[id] {
            Op::Input(vector, index) => format!("{}{index}", names[vector]),
            _ => format!("t{id}"),
        };
        let factor = |k: Factor| match k {
            Factor::Literal(value) => format!("V::constant({value:?})"),
            Factor::Slot(slot) => format!("V::splat(k[{slot}])"),
        };
        let live = self.live();
        for (id, &op) in self.ops.iter().enumerate().filter(|(id, _)| live[*id]) {
            if matches!(op, Op::Input(vector, _) if vector == kept) {
                continue;
            }
            let expression = match op {
                Op::Input(vector, index) => format!("{}.get({index})", names[vector]),
                Op::Scale(k, x) => format!("{}.mul({})", factor(k), name(x)),
                Op::Mul(x, y) => format!("{}.mul({})", name(x), name(y)),
                Op::Add(x, y) => format!("{}.add({})", name(x), name(y)),
                Op::Sub(x, y) => format!("{}.sub({})", name(x), name(y)),
                Op::ScaleAdd(k, x, z) => format!("{}.mul_add({}, {})", factor(k), name(x), name(z)),
                Op::MulAdd(x, y, z) => format!("{}.mul_add({}, {})", name(x), name(y), name(z)),
                Op::NegMulAdd(x, y, z) => format!("{}.neg_mul_add({}, {})", name(x), name(y), name(z)),
                Op::Constant(k) => format!("V::constant({k:?})"),
                Op::Affine(k, x, offset) => {
                    format!("V::constant({k:?}).mul_add({}, V::constant({offset:?}))", name(x))
                }
                Op::MulOffset(x, y, offset) => format!("{}.mul_add({}, V::constant({offset:?}))", name(x), name(y)),
            };
            let kind = if names.get(kept).is_some() && matches!(op, Op::Input(..)) { ": V" } else { "" };
            writeln!(text, "    let {}{kind} = {expression};", name(id)).expect("a string");
            for (index, _) in self.outputs.iter().filter(|output| output.1 == id) {
                match names.get(kept) {
                    Some(kept) => writeln!(text, "    {kept}{index} = {};", name(id)),
                    None => writeln!(text, "    out.set({index}, {});", name(id)),
                }
                .expect("a string");
            }
        }
        text
    }
}

fn operands(op: Op) -> [Option<Id>; 3] {
    match op {
        Op::Input(..) | Op::Constant(_) => [None; 3],
        Op::Scale(_, x) | Op::Affine(_, x, _) => [Some(x), None, None],
        Op::Mul(x, y) | Op::Add(x, y) | Op::Sub(x, y) | Op::ScaleAdd(_, x, y) | Op::MulOffset(x, y, _) => {
            [Some(x), Some(y), None]
        }
        Op::MulAdd(x, y, z) | Op::NegMulAdd(x, y, z) => [Some(x), Some(y), Some(z)],
    }
}

/// A sum of products in the making. Negative terms wait for a positive one, so that no sign costs an instruction.
#[derive(Clone, Debug, Default)]
pub struct Sum {
    value: Option<Id>,
    waiting: Vec<(Id, Id)>,
}

impl Sum {
    /// A sum that goes on from a value.
    pub fn from(value: Id) -> Self {
        Self { value: Some(value), waiting: Vec::new() }
    }

    /// Adds `factor·x`.
    pub fn scaled(&mut self, program: &mut Program, factor: Factor, x: Id) {
        let op = match (self.value, factor) {
            (None, Factor::Literal(1.0)) => return self.start(program, x),
            (None, _) => Op::Scale(factor, x),
            (Some(z), Factor::Literal(1.0)) => Op::Add(z, x),
            (Some(z), Factor::Literal(-1.0)) => Op::Sub(z, x),
            (Some(z), _) => Op::ScaleAdd(factor, x, z),
        };
        let value = program.push(op);
        self.start(program, value);
    }

    /// Adds `x·y`.
    pub fn product(&mut self, program: &mut Program, x: Id, y: Id) {
        let value = program.push(self.value.map_or(Op::Mul(x, y), |z| Op::MulAdd(x, y, z)));
        self.start(program, value);
    }

    /// Subtracts `x·y`.
    pub fn minus_product(&mut self, program: &mut Program, x: Id, y: Id) {
        match self.value {
            None => self.waiting.push((x, y)),
            Some(z) => self.value = Some(program.push(Op::NegMulAdd(x, y, z))),
        }
    }

    fn start(&mut self, program: &mut Program, value: Id) {
        let value = self.waiting.drain(..).fold(value, |z, (x, y)| program.push(Op::NegMulAdd(x, y, z)));
        self.value = Some(value);
    }

    /// The sum; none if nothing was added.
    ///
    /// # Panics
    /// If there were only negative products.
    pub fn value(&self) -> Option<Id> {
        assert!(self.waiting.is_empty(), "a sum needs a positive term");
        self.value
    }
}
