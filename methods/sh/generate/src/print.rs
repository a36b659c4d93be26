//! The source files.

use std::fmt::Write;

use halflight_sh::MAX_ORDER;

use crate::basis::{self, Output};
use crate::lobatto::Place;
use crate::program::Program;
use crate::single::{self, ROW, Tables};
use crate::sums;
use crate::triples::{self, Kind};
use crate::{Form, HEADER, wgsl};

/// Every file, by its path from the folder of `halflight-sh`.
pub fn files() -> Vec<(String, String)> {
    let mut files: Vec<_> = (1..=MAX_ORDER)
        .map(|order| (format!("kernels/src/product/generated/order_{order}.rs"), order_file(order)))
        .collect();
    files.push(("kernels/src/product/generated/mod.rs".into(), modules()));
    files.push(("benches/baseline/plain.rs".into(), baselines()));
    files.extend(wgsl::files());
    files
}

fn modules() -> String {
    let mut text = format!("{HEADER}\n//! The product kernels of each order.\n\n");
    (1..=MAX_ORDER).for_each(|order| writeln!(text, "pub(super) mod order_{order};").expect("a string"));
    text
}

fn order_file(order: usize) -> String {
    let [product, square] = [Kind::Product, Kind::Square].map(|kind| Form::fastest(order, kind));
    let mut text = format!(
        "{HEADER}\n//! Order {order}: {} instructions a product by {}, {} a square by {}.\n\n",
        product.count(order, Kind::Product),
        product.name(),
        square.count(order, Kind::Square),
        square.name()
    );
    let precision = if product == Form::Lobatto { "use crate::real::Precision;\n" } else { "" };
    write!(
        text,
        "use crate::block::Block;\nuse crate::product::{{Aligned, Part, Sink, Source, narrow}};\n{precision}use crate::simd::Lanes;\n\n"
    )
        .expect("a string");
    for (kind, form, name, inputs) in
        [(Kind::Product, product, "product", &["a", "b"][..]), (Kind::Square, square, "square", &["a"])]
    {
        let programs = form.build(order, kind);
        match form {
            Form::Triples => function(&mut text, name, inputs, false, "", &programs[0].1),
            Form::Lobatto => {
                if kind == Kind::Product {
                    tables(&mut text, &programs); // those of the square are the same
                }
                rings(&mut text, order, name, inputs, &programs);
            }
        }
    }
    single_pair(&mut text, order);
    for (name, inputs, output) in
        [("evaluate", &["d"][..], Output::Basis), ("rotate_zonal", &["d", "zonal"], Output::Lobe)]
    {
        function(&mut text, name, inputs, false, "", &basis::build(order, output));
    }
    sum_zonal(&mut text, order);
    text
}

/// The function that adds up zonal vectors turned to directions: a loop for each group of sums.
fn sum_zonal(text: &mut String, order: usize) {
    let mut body = String::new();
    for columns in sums::groups(order) {
        let name = format!("sum_columns_{}", columns.start);
        writeln!(body, "    {name}::<V>(zonal, directions, out, part);").expect("a string");
        let program = sums::build(order, columns);
        let numbers: Vec<usize> = program.outputs().collect();
        let mut lines = String::new();
        numbers.iter().for_each(|i| writeln!(lines, "    let mut sum{i} = V::constant(0.0);").expect("a string"));
        let one = program.loop_body(&["d", "zonal", "sum"], 2);
        let d = if one.contains("d.get(") { "d" } else { "_" };
        writeln!(
            lines,
            "    for (zonal, d) in zonal.chunks_exact({order}).zip(directions) {{\n        let ({d}, zonal) = (Part {{ blocks: d.as_slice(), part }}, Part {{ blocks: zonal, part }});"
        )
        .expect("a string");
        one.lines().for_each(|line| writeln!(lines, "    {line}").expect("a string"));
        lines.push_str("    }\n    let mut out = Part { blocks: out, part };\n");
        let scales = sums::scales(order);
        for i in numbers {
            writeln!(
                lines,
                "    let before: V = out.get({i});\n    out.set({i}, V::constant({:?}).mul_add(sum{i}, before));",
                scales[i]
            )
            .expect("a string");
        }
        sum_function(text, &name, &lines);
    }
    sum_function(text, "sum_zonal", &body);
}

fn sum_function(text: &mut String, name: &str, body: &str) {
    write!(
        text,
        "#[inline(always)]\npub(crate) fn {name}<V: Lanes>(zonal: &[Block<V::Scalar>], directions: &[[Block<V::Scalar>; 3]], out: &mut [Block<V::Scalar>], part: usize) {{\n{body}}}\n\n"
    )
    .expect("a string");
}

/// The functions and tables with a ring in each lane.
fn single_pair(text: &mut String, order: usize) {
    let Tables { rings, forward, backward } = single::tables(order);
    let size = forward.len();
    writeln!(text, "/// Rings of the single product.\npub(crate) const RINGS: usize = {rings};\n").expect("a string");
    for (name, what, rows) in
        [("FORWARD", "Coefficients to rings.", forward), ("BACKWARD", "Rings to coefficients.", backward)]
    {
        writeln!(text, "/// {what}\npub(crate) static {name}: Aligned<[[f64; {ROW}]; {size}]> = Aligned([")
            .expect("a string");
        rows.iter().for_each(|row| writeln!(text, "    {row:?},").expect("a string"));
        writeln!(
            text,
            "]);\n/// {what}\npub(crate) static SINGLE_{name}: Aligned<[[f32; {ROW}]; {size}]> = Aligned(narrow(&{name}.0));\n"
        )
        .expect("a string");
    }
    let [product, square] = [Kind::Product, Kind::Square].map(|kind| single::build(order, kind));
    function(text, "rings_product", &["a", "b", "forward", "backward"], false, "", &product);
    function(text, "rings_square", &["a", "forward", "backward"], false, "", &square);
}

/// The tables of the pairs of rings in both precisions.
fn tables(text: &mut String, programs: &[(Place, Program)]) {
    let pairs: Vec<_> = programs.iter().map(|(_, program)| program.slots()).filter(|slots| !slots.is_empty()).collect();
    let (count, size) = (pairs.len(), pairs[0].len());
    writeln!(text, "/// The constants of each pair of rings.\nstatic PAIRS: [[f64; {size}]; {count}] = [")
        .expect("a string");
    for slots in pairs {
        writeln!(text, "    {slots:?},").expect("a string");
    }
    writeln!(text, "];\nstatic SINGLE_PAIRS: [[f32; {size}]; {count}] = narrow(&PAIRS);\n").expect("a string");
}

/// A function for each kind of ring, and the one that runs them all.
fn rings(text: &mut String, order: usize, name: &str, inputs: &[&str], programs: &[(Place, Program)]) {
    let arguments = format!("{}, out", inputs.join(", "));
    let outputs = order * order;
    let mut body = format!("    for i in 0..{outputs} {{\n        out.set(i, V::constant(0.0));\n    }}\n");
    for (at, (place, program)) in programs.iter().enumerate() {
        let (suffix, table) = match place {
            Place::Poles => ("at_poles", String::new()),
            Place::Equator => ("on_equator", String::new()),
            Place::Pair => ("on_pair", format!("k: &[V::Scalar; {}], ", program.slots().len())),
        };
        if programs[..at].iter().any(|(other, _)| other == place) {
            continue;
        }
        function(text, &format!("{name}_{suffix}"), inputs, true, &table, program);
        match place {
            Place::Pair => writeln!(
                body,
                "    for k in V::Scalar::table(&SINGLE_PAIRS, &PAIRS) {{\n        {name}_{suffix}::<V>(k, {arguments});\n    }}"
            ),
            _ => writeln!(body, "    {name}_{suffix}::<V>({arguments});"),
        }
        .expect("a string");
    }
    let sources: String = inputs.iter().map(|input| format!("{input}: &impl Source<V>, ")).collect();
    write!(
        text,
        "#[inline(always)]\npub(crate) fn {name}<V: Lanes>({sources}out: &mut (impl Source<V> + Sink<V>)) {{\n{body}}}\n\n"
    )
    .expect("a string");
}

/// A function of one program.
fn function(text: &mut String, name: &str, inputs: &[&str], adds: bool, table: &str, program: &Program) {
    let body = program.body(&[inputs, &["out"]].concat());
    let argument = |input: &&str| {
        let unused = if body.contains(&format!("{input}.get(")) { "" } else { "_" };
        format!("{unused}{input}: &impl Source<V>, ")
    };
    let sources: String = inputs.iter().map(argument).collect();
    let out = if adds { "(impl Source<V> + Sink<V>)" } else { "impl Sink<V>" };
    write!(text, "#[inline(always)]\npub(crate) fn {name}<V: Lanes>({table}{sources}out: &mut {out}) {{\n{body}}}\n\n")
        .expect("a string");
}

/// The scalar kernels that speed-ups are measured against.
fn baselines() -> String {
    let mut text = format!(
        "{HEADER}\n//! One product by factored triples with nothing shared between pairs, in scalar code.\n\nuse super::{{Scalar, Vector, VectorMut}};\n\ntype V = f32;\n"
    );
    for order in 2..=6 {
        let (program, size) = (triples::build_plain(order), order * order);
        let count = program.count();
        write!(
            text,
            "\n/// Order {order}: {count} instructions.\n#[target_feature(enable = \"avx2,fma\")]\npub(super) fn order_{order}(a: &[f32; {size}], b: &[f32; {size}], out: &mut [f32; {size}]) {{\n{}}}\n",
            program.body(&["a", "b"])
        )
        .expect("a string");
    }
    text
}
