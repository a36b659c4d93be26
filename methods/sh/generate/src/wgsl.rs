//! The same programs as WGSL, a function of values for each.

use std::fmt::Write;

use halflight_sh::{MAX_ORDER, clamped_cosine};

use crate::basis::{self, Output};
use crate::lobatto::Place;
use crate::program::{Factor, Id, Op, Program};
use crate::triples::Kind;
use crate::{Form, HEADER};

/// Every file, by its path from the folder of `halflight-sh`.
pub(crate) fn files() -> impl Iterator<Item = (String, String)> {
    (1..=MAX_ORDER).map(|order| (format!("src/wgsl/generated/order_{order}.wgsl"), order_file(order)))
}

fn order_file(order: usize) -> String {
    let (size, cosine) = (order * order, clamped_cosine(order));
    let mut text = format!(
        "{HEADER}\n// Order {order}: products, squares, zonal vectors turned to a direction.\n\nconst ORDER: u32 = {order}u;\nconst SIZE: u32 = {size}u;\nalias Zonal = array<f32, {order}>;\nalias Vector = array<f32, {size}>;\n\n/// The clamped cosine about z.\nconst CLAMPED_COSINE = Zonal({});\n\n",
        list(cosine.iter().copied())
    );
    for (kind, name, inputs) in [(Kind::Product, "product", &["a", "b"][..]), (Kind::Square, "square", &["a"])] {
        let form = Form::fastest(order, kind);
        let programs = form.build(order, kind);
        match form {
            Form::Triples => {
                function(&mut text, name, &vectors(inputs), inputs, &programs[0].1, size);
            }
            Form::Lobatto => rings(&mut text, name, inputs, &programs, size),
        }
    }
    let turn = basis::build(order, Output::Lobe);
    function(&mut text, "rotate_zonal", "zonal: Zonal, d: vec3f", &["d", "zonal"], &turn, size);
    text.truncate(text.trim_end().len());
    text + "\n"
}

fn vectors(inputs: &[&str]) -> String {
    inputs.iter().map(|input| format!("{input}: Vector")).collect::<Vec<_>>().join(", ")
}

/// A function for each kind of ring, and the one that runs them all.
fn rings(text: &mut String, name: &str, inputs: &[&str], programs: &[(Place, Program)], size: usize) {
    let (given, taken) = (inputs.join(", "), vectors(inputs));
    let names = [inputs, &["sum"]].concat();
    let mut body = String::new();
    for (at, (place, program)) in programs.iter().enumerate() {
        if programs[..at].iter().any(|(other, _)| other == place) {
            continue;
        }
        match place {
            Place::Poles | Place::Equator => {
                let own = format!("{name}_{}", if *place == Place::Poles { "at_poles" } else { "on_equator" });
                function(text, &own, &format!("{taken}, sum: Vector"), &names, program, size);
                writeln!(body, "    sum = {own}({given}, sum);")
            }
            Place::Pair => {
                let own = format!("{name}_on_pair");
                let pairs: Vec<_> = programs.iter().filter(|(place, _)| *place == Place::Pair).collect();
                let table = format!("{}_PAIRS", name.to_uppercase());
                let (count, slots) = (pairs.len(), program.slots().len());
                let rows: Vec<String> = pairs
                    .iter()
                    .map(|(_, program)| format!("    array<f32, {slots}>({})", list(program.slots().iter().copied())))
                    .collect();
                writeln!(
                    text,
                    "const {table} = array<array<f32, {slots}>, {count}>(\n{}\n);\n",
                    rows.join(",\n")
                )
                .expect("a string");
                let taken = format!("k: array<f32, {slots}>, {taken}, sum: Vector");
                function(text, &own, &taken, &names, program, size);
                writeln!(
                    body,
                    "    for (var pair = 0u; pair < {count}u; pair++) {{\n        sum = {own}({table}[pair], {given}, sum);\n    }}"
                )
            }
        }
        .expect("a string");
    }
    write!(text, "fn {name}({taken}) -> Vector {{\n    var sum = Vector();\n{body}    return sum;\n}}\n\n")
        .expect("a string");
}

/// A function of one program; outputs that it does not write are those of its last input.
fn function(text: &mut String, name: &str, taken: &str, names: &[&str], program: &Program, size: usize) {
    let printed = Printed { program, names };
    let mut outputs: Vec<String> = (0..size).map(|i| format!("{}[{i}]", names[names.len() - 1])).collect();
    program.written().for_each(|(i, id)| outputs[i] = printed.name(id));
    let mut body = String::new();
    program.live_steps().for_each(|(id, op)| printed.line(&mut body, id, op));
    write!(text, "fn {name}({taken}) -> Vector {{\n{body}    return Vector({});\n}}\n\n", outputs.join(", "))
        .expect("a string");
}

struct Printed<'a> {
    program: &'a Program,
    names: &'a [&'a str],
}

impl Printed<'_> {
    fn name(&self, id: Id) -> String {
        match self.program.step(id) {
            Op::Input(vector, index) => format!("{}[{index}]", self.names[vector]),
            Op::Constant(value) => number(value),
            _ => format!("t{id}"),
        }
    }

    fn line(&self, body: &mut String, id: Id, op: Op) {
        let name = |id: Id| self.name(id);
        let factor = |k: Factor| match k {
            Factor::Literal(value) => number(value),
            Factor::Slot(slot) => format!("k[{slot}]"),
        };
        let expression = match op {
            Op::Input(..) | Op::Constant(_) => return,
            Op::Scale(k, x) => format!("{} * {}", factor(k), name(x)),
            Op::Mul(x, y) => format!("{} * {}", name(x), name(y)),
            Op::Add(x, y) => format!("{} + {}", name(x), name(y)),
            Op::Sub(x, y) => format!("{} - {}", name(x), name(y)),
            Op::ScaleAdd(k, x, z) => format!("fma({}, {}, {})", factor(k), name(x), name(z)),
            Op::MulAdd(x, y, z) => format!("fma({}, {}, {})", name(x), name(y), name(z)),
            Op::NegMulAdd(x, y, z) => format!("fma(-{}, {}, {})", name(x), name(y), name(z)),
            Op::Affine(k, x, offset) => format!("fma({}, {}, {})", number(k), name(x), number(offset)),
            Op::MulOffset(x, y, offset) => format!("fma({}, {}, {})", name(x), name(y), number(offset)),
        };
        writeln!(body, "    let t{id} = {expression};").expect("a string");
    }
}

fn list(values: impl Iterator<Item = f64>) -> String {
    values.map(number).collect::<Vec<_>>().join(", ")
}

/// Rounded as the CPU's tables are.
fn number(value: f64) -> String {
    format!("{:?}f", value as f32)
}
