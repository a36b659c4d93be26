//! S1: entries of Γ.

use super::super::bench::{Bench, Figure};
use super::super::row::{Figures, Judgement, Row, Verdict};
use crate::Error;
use halflight_sh::{MAX_ORDER, coefficients, gamma};

pub(crate) const S1: Row = Row {
    id: "S1",
    place: "§3, the table of \"nonzero entries in Γ\"",
    claim: "The triple product tensor Γ has 1, 10, 83, 369, 1164, 2961, 6586, 13018 nonzero entries at orders 1 to 8",
    paper: &[
        ("entries that selection rules allow, order 1", "1"),
        ("entries that selection rules allow, order 2", "10"),
        ("entries that selection rules allow, order 3", "83"),
        ("entries that selection rules allow, order 4", "369"),
        ("entries that selection rules allow, order 5", "1164"),
        ("entries that selection rules allow, order 6", "2961"),
        ("entries that selection rules allow, order 7", "6586"),
        ("entries that selection rules allow, order 8", "13018"),
    ],
    needs: "",
    measure,
    judge,
};

fn allowed_name(order: usize) -> String {
    format!("entries that selection rules allow, order {order}")
}

fn nonzero_name(order: usize) -> String {
    format!("entries above 1e-9, order {order}")
}

fn measure(_: &Bench) -> Result<Vec<Figure>, Error> {
    let counts = |order| {
        let size = coefficients(order);
        let triples = (0..size * size * size).map(|n| [n % size, n / size % size, n / size / size]);
        let allowed = triples.filter(|triple| allowed(*triple)).count();
        let nonzero = gamma(order).ordered_count();
        let entries = size * size * size;
        [
            Figure::exact(allowed_name(order), "", allowed as f64, entries),
            Figure::exact(nonzero_name(order), "", nonzero as f64, entries),
        ]
    };
    Ok((1..=MAX_ORDER).flat_map(counts).collect())
}

/// The selection rules of real harmonics: bands form a triangle of even perimeter; an even number of sines; and one |m| is the sum
/// of the others.
fn allowed(indices: [usize; 3]) -> bool {
    let [a, b, c] = indices.map(|i| {
        let l = i.isqrt();
        (l as isize, i as isize - (l * (l + 1)) as isize)
    });
    let triangle = (a.0 - b.0).abs() <= c.0 && c.0 <= a.0 + b.0 && (a.0 + b.0 + c.0) % 2 == 0;
    let sines = [a, b, c].iter().filter(|(_, m)| *m < 0).count();
    let [i, j, k] = [a, b, c].map(|(_, m)| m.abs());
    triangle && sines % 2 == 0 && (i + j == k || j + k == i || k + i == j)
}

fn judge(figures: &Figures<'_>) -> Option<Judgement> {
    let (mut agree, mut apart) = (Vec::new(), Vec::new());
    for order in 1..=MAX_ORDER {
        let (ours, nonzero) = (figures.value(&allowed_name(order))?, figures.value(&nonzero_name(order))?);
        let printed: f64 = S1.printed(&allowed_name(order))?.parse().ok()?;
        agree.push(ours == printed);
        if ours != printed {
            apart.push(format!("at order {order} it prints {printed} for {ours} (of which {nonzero} are not zero)"));
        }
    }
    let verdict = Verdict::of(&agree);
    let same = agree.iter().filter(|same| **same).count();
    let rest = if apart.is_empty() { String::new() } else { format!("; {}", apart.join(", ")) };
    let why = format!(
        "{same} of {MAX_ORDER} printed counts are those that selection rules allow{rest}; from order 4 on some allowed entries \
         vanish all the same, and generated code leaves those out too."
    );
    Some(Judgement { verdict, why })
}
