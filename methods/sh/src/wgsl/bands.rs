//! What is done for each circle, written out band by band.
//!
//! Nothing here loops: arrays that a loop indexes leave registers, and lavapipe ends all loops of a thread after 65 535 rounds in sum.

use std::f64::consts::PI;

use crate::coefficients;
use crate::pieces::DEGREE;
use crate::small::TERMS;

/// The functions of an order.
pub(super) fn functions(order: usize) -> String {
    let sums = list(coefficients(order), |i| format!("fma(factor, b[{i}], a[{i}])"));
    let scaled = list(order, |l| format!("zonal[{l}] * factors[{l}]"));
    let small = list(order, |l| format!("small_log({l}u, square)"));
    let large = list(order, |l| format!("piece_value(LARGE, {l}u, place)"));
    let (small_powers, large_powers) = (horner("square", "", TERMS), horner("place.position", "PIECES * ", DEGREE + 1));
    let visibility = visibility(order);
    format!(
        "
/// `a + factor·b`.
fn added(a: Vector, factor: f32, b: Vector) -> Vector {{
    return Vector({sums});
}}

/// Each band times its factor.
fn scaled_bands(zonal: Zonal, factors: Zonal) -> Zonal {{
    return Zonal({scaled});
}}

/// Over `sin²θ`.
fn small_log(band: u32, square: f32) -> f32 {{
    let first = TERMS * band;
{small_powers}    return value * square;
}}

fn piece_value(base: u32, function_number: u32, place: Place) -> f32 {{
    let first = base + PIECES * (4u + (DEGREE + 1u) * function_number) + place.piece;
{large_powers}    return value;
}}

fn circle_log(sine: f32) -> Zonal {{
    let s = clamp(sine, 0f, 1f);
    let square = s * s;
    if square <= SMALL_END {{
        return Zonal({small});
    }}
    let place = find_piece(LARGE, circle_height(s));
    return Zonal({large});
}}

fn circle_visibility(sine: f32) -> Zonal {{
{visibility}}}
"
    )
}

fn list(count: usize, item: impl Fn(usize) -> String) -> String {
    (0..count).map(item).collect::<Vec<_>>().join(", ")
}

/// Horner's rule on coefficients in `tables`, from that of 1 at `first` on.
fn horner(x: &str, apart: &str, terms: usize) -> String {
    let mut text = format!("    var value = tables[first + {apart}{}u];\n", terms - 1);
    for k in (0..terms - 1).rev() {
        text += &format!("    value = fma(value, {x}, tables[first + {apart}{k}u]);\n");
    }
    text
}

/// `√(π/(2l+1))·(P_(l+1) − P_(l−1))` at the rim, `1 + P_1` in band 0, as the CPU's recurrence has it.
fn visibility(order: usize) -> String {
    let mut text = String::from("    let p0 = 1f;\n    let p1 = 1f - circle_height(sine);\n");
    for l in 1..order {
        let (back, on) = (literal(l as f64 / (l + 1) as f64), literal((2 * l + 1) as f64 / (l + 1) as f64));
        text += &format!("    let p{} = fma(-p{}, {back}, {on} * p1 * p{l});\n", l + 1, l - 1);
    }
    let band = |l: usize| match l {
        0 => format!("{} * (1f + p1)", literal(PI.sqrt())),
        _ => format!("{} * (p{} - p{})", literal((PI / (2 * l + 1) as f64).sqrt()), l + 1, l - 1),
    };
    text + &format!("    return Zonal({});\n", list(order, band))
}

fn literal(value: f64) -> String {
    format!("{:?}f", value as f32)
}
