//! Sums of zonal vectors turned to directions of their own, in registers.
//!
//! What is summed is `zonal_l·p_lm(z)·(c_m or s_m)` with the leading coefficient of `p_lm` 1, so that constants are multiplied in once
//! a sum, not once a lobe. Where there are more sums than registers, columns of equal m are summed apart.

use std::f64::consts::PI;
use std::ops::Range;

use halflight_sh::index;

use crate::basis::{next_power, polynomial};
use crate::program::{Factor, Id, Op, Program};

/// Sums that stay in registers, beside what a lobe needs of the 32.
const MOST: usize = 22;

/// Sums with which a group of columns may end.
const ENOUGH: usize = 13;

/// Columns m that are summed together.
pub fn groups(order: usize) -> Vec<Range<usize>> {
    let sums = |columns: Range<usize>| -> usize { columns.map(|m| column_size(order, m)).sum() };
    let (mut groups, mut first) = (Vec::new(), 0);
    for m in 0..order {
        let ends = sums(first..m + 1) >= ENOUGH && sums(first..order) > MOST;
        if ends || m + 1 == order {
            groups.push(first..m + 1);
            first = m + 1;
        }
    }
    groups
}

fn column_size(order: usize, m: usize) -> usize {
    if m == 0 { order } else { 2 * (order - m) }
}

/// Adds a lobe to the sums of some columns. Inputs: the direction, the zonal vector, the sums so far.
pub fn build(order: usize, columns: Range<usize>) -> Program {
    let mut program = Program::default();
    let p = &mut program;
    let [x, y, z] = [0, 1, 2].map(|i| p.input(0, i));
    let mut power = None; // (x + iy)^m, none for m = 0
    for m in 0..columns.end {
        if m > 0 {
            power = Some(power.map_or((x, y), |(cos, sin)| next_power(p, (x, y), (cos, sin))));
        }
        let mut known = Vec::new();
        for l in (m..order).filter(|_| columns.contains(&m)) {
            let latitude = latitude(p, z, m, &mut known);
            let zonal = p.input(1, l);
            let Some((cos, sin)) = power else {
                let before = p.input(2, index(l, 0));
                let after = p.push(latitude.map_or(Op::Add(before, zonal), |value| Op::MulAdd(value, zonal, before)));
                p.output(index(l, 0), after);
                continue;
            };
            let factor = latitude.map_or(zonal, |value| p.push(Op::Mul(value, zonal)));
            for (azimuth, i) in [(sin, index(l, -(m as isize))), (cos, index(l, m as isize))] {
                let before = p.input(2, i);
                let after = p.push(Op::MulAdd(factor, azimuth, before));
                p.output(i, after);
            }
        }
    }
    program
}

/// `p_l = z·p_(l−1) − ((l−1)² − m²)/(4(l−1)² − 1)·p_(l−2)` from l = m on in turn; none for 1.
fn latitude(p: &mut Program, z: Id, m: usize, known: &mut Vec<Option<Id>>) -> Option<Id> {
    let below = (m + known.len()) as f64 - 1.0;
    let fall = (below * below - (m * m) as f64) / (4.0 * below * below - 1.0);
    let value = match known[..] {
        [] => None,
        [_] => Some(z),
        [.., None, Some(last)] => Some(p.push(Op::MulOffset(z, last, -fall))),
        [.., Some(before), Some(last)] => {
            let fallen = p.push(Op::Scale(Factor::Literal(-fall), before));
            Some(p.push(Op::MulAdd(z, last, fallen)))
        }
        [.., None] => unreachable!("only the first is 1"),
    };
    known.push(value);
    value
}

/// What brings each sum to `Σ √(4π/(2l+1))·zonal_l·y_lm`.
pub fn scales(order: usize) -> Vec<f64> {
    let mut scales = vec![0.0; order * order];
    for l in 0..order {
        for m in 0..=l {
            let leading = *polynomial(l, m).last().expect("at least a constant");
            let scale = (4.0 * PI / (2 * l + 1) as f64).sqrt() * leading;
            scales[index(l, m as isize)] = scale;
            scales[index(l, -(m as isize))] = scale;
        }
    }
    scales
}
