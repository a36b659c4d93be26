//! The page.

use std::fmt::Write;

use super::{BEYOND, COUNTS, Case, ORDERS, Overlap, Stress, TRUTH};

/// The page of what was found, in Markdown.
pub fn markdown(stress: &Stress) -> String {
    let mut page = String::from(
        "# Numbers at their limits\n\n\
         What sphere-blocker methods do where circles overlap beyond reason, at extreme sizes, in deep shadow and under light of radiance 1e5.\n\
         Written by `cargo run --release -p halflight-tests --example stress`; `tests/tests/stress.rs` holds it against what the code does.\n\n\
         ## Onset of divergence\n\n",
    );
    let _ = write!(
        page,
        "N coincident circles of 15° overhead leave {TRUTH:.3} of a uniform sky's irradiance, whatever N. Products and exponentials of truncated\n\
         visibility grow where the truncated sum is positive, and fade where it is negative: the table gives the first N of\n\
         {COUNTS:?}\n\
         at which irradiance is what no visibility leaves, below 0 or above 1 by more than {BEYOND}; with the overlap guard off : on. \"–\": at none\n\
         of them. OL fades to black, but for order 7, where it leaves the range on the way.\n\n\
         ![the first N that diverges, guard off, against order](stress/onset.svg)\n\n"
    );
    table(&mut page, stress, |overlap| {
        let shown = |guard| overlap.onset(guard).map_or("–".into(), |count: usize| count.to_string());
        format!("{} : {}", shown(false), shown(true))
    });
    page.push_str(
        "\n![irradiance against N at order 4, guard off](stress/irradiance.svg)\n\n\
         Irradiance at N = 1, 10, 60, 1000, guard off, and at N = 1000, guard on:\n\n",
    );
    table(&mut page, stress, |overlap| {
        let at =
            |guard: usize, count| overlap.irradiance[guard][COUNTS.iter().position(|n| *n == count).expect("tried")];
        let [first, second, third, last] = [1, 10, 60, 1000].map(|count| number(at(0, count)));
        format!("{first}, {second}, {third}, {last} : {}", number(at(1, 1000)))
    });
    page.push_str(
        "\n## Extreme scenes\n\n\
         The largest magnitude of radiance over that of the open sky (1e5), guard off : on, and the receivers that the guard changed; where rays\n\
         tell the truth, ± the largest error with the guard on. The guard makes results possible, not right: where the mean of visibility has\n\
         diverged upwards it opens the sky, in the deepest shadow too. Off, it still acts above 1e30, where light times visibility could\n\
         overflow. What is not finite would be counted behind an exclamation mark.\n",
    );
    let mut names: Vec<&str> = Vec::new();
    stress.cases.iter().for_each(|case| names.push(case.name));
    names.dedup();
    for name in names {
        let cases: Vec<&Case> = stress.cases.iter().filter(|case| case.name == name).collect();
        let receivers = cases.first().map_or(0, |case| case.found[0].receivers);
        let truth = stress.brightest.iter().find(|(case, _)| *case == name);
        let truth = truth.map_or(String::new(), |(_, most)| format!(", which truly get at most {most:.3} of the sky"));
        let _ = write!(page, "\n### {name}: {receivers} receivers{truth}\n\n");
        header(&mut page);
        for row in cases.chunks(ORDERS.count()) {
            let _ = write!(page, "| `{}` |", row[0].method);
            row.iter().for_each(|case| {
                let [off, on] = &case.found;
                let lost = off.not_finite + on.not_finite;
                let lost = if lost > 0 { format!(" !{lost}") } else { String::new() };
                let error = on.error.map_or(String::new(), |error| format!(" ± {error:.3}"));
                let _ = write!(page, " {} : {}, {}{error}{lost} |", number(off.worst), number(on.worst), on.guarded);
            });
            page.push('\n');
        }
    }
    page
}

fn header(page: &mut String) {
    page.push_str("| order |");
    ORDERS.for_each(|order| {
        let _ = write!(page, " {order} |");
    });
    page.push_str("\n|---|");
    ORDERS.for_each(|_| page.push_str("---|"));
    page.push('\n');
}

fn table(page: &mut String, stress: &Stress, cell: impl Fn(&Overlap) -> String) {
    header(page);
    for row in stress.overlaps.chunks(ORDERS.count()) {
        let _ = write!(page, "| `{}` |", row[0].method);
        row.iter().for_each(|overlap| {
            let _ = write!(page, " {} |", cell(overlap));
        });
        page.push('\n');
    }
}

/// Three digits.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if !(0.001..1000.0).contains(&size) => format!("{value:.1e}"),
        size if size < 10.0 => format!("{value:.3}"),
        _ => format!("{value:.0}"),
    }
}
