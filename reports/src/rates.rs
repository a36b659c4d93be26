//! Papers' frame rates, beside what these results reach.

use crate::format::{escape, number};
use halflight_metrics::Interval;
use std::fmt::Write;

/// A case that a paper prints a frame rate of.
#[derive(Clone, Debug)]
pub struct Rate {
    /// What it is called, such as `battle size`.
    pub case: String,
    /// Where the paper prints it.
    pub place: String,
    /// What is computed: receivers, blockers, order.
    pub work: String,
    /// What the paper prints.
    pub printed: String,
    /// The paper's machine and year.
    pub device: String,
    /// What is computed here: a scene, a method and its settings.
    pub setting: String,
    /// What it reaches, by processor.
    pub reached: Vec<Reached>,
}

/// What a case reaches on one processor.
#[derive(Clone, Debug)]
pub struct Reached {
    /// The processor: `CPU, 2 threads`, or an adapter's name.
    pub on: String,
    /// Frames a second, update and shade; or why there are none.
    pub frames: Result<Interval, String>,
    /// Shadings a second by the device's own clock.
    pub passes: Option<Interval>,
}

/// The section; nothing where there are no rates.
pub(crate) fn section(rates: &[Rate]) -> String {
    if rates.is_empty() {
        return String::new();
    }
    let mut processors: Vec<&str> = Vec::new();
    for on in rates.iter().flat_map(|rate| &rate.reached).map(|reached| reached.on.as_str()) {
        if !processors.contains(&on) {
            processors.push(on);
        }
    }
    let heads: String = processors.iter().map(|on| format!("<th>{}</th>", escape(on))).collect();
    let mut html = format!(
        "<h2 id=\"rates\">Frame rates of the papers</h2><p class=\"note\">Frames a second: update, where everything was prepared and \
         another frame lay before, and shade, medians with their 95% interval; reading the result is not in them. Beside a \
         graphics processor's: what its passes of shading alone would reach by its own clock. The papers' scenes are others, of the same size.</p>\
         <div class=\"wide\"><table><thead><tr><th>case</th><th>the paper</th>{heads}</tr></thead><tbody>"
    );
    for rate in rates {
        let _ = write!(
            html,
            "<tr><th>{}<small>{}</small><small>{}</small></th><td>{}<small>{}</small><small>{}</small></td>",
            escape(&rate.case),
            escape(&rate.work),
            escape(&rate.setting),
            escape(&rate.printed),
            escape(&rate.device),
            escape(&rate.place)
        );
        for on in &processors {
            html += &rate.reached.iter().find(|reached| reached.on == **on).map_or("<td>–</td>".into(), cell);
        }
        html += "</tr>";
    }
    html + "</tbody></table></div>"
}

fn cell(reached: &Reached) -> String {
    let passes = reached
        .passes
        .map_or(String::new(), |passes| format!("<small>passes alone {} Hz</small>", number(passes.median)));
    match &reached.frames {
        Ok(Interval { median, low, high, .. }) => {
            format!("<td>{} Hz<small>{} to {}</small>{passes}</td>", number(*median), number(*low), number(*high))
        }
        Err(why) => format!("<td class=\"skipped text\">{}</td>", escape(why)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_processor_is_a_column_and_what_has_no_rate_says_why() {
        let reached = |on: &str, frames| Reached { on: on.into(), frames, passes: None };
        let interval = Interval { median: 81.0, low: 77.0, high: 83.0, count: 6 };
        let rate = |case: &str, reached| Rate {
            case: case.into(),
            place: "Fig. 1".into(),
            work: "7 receivers".into(),
            printed: "15.6 to 44.5 Hz".into(),
            device: "a <GPU>".into(),
            setting: "a b".into(),
            reached,
        };
        let both = vec![reached("CPU", Ok(interval)), reached("x, correctness only", Err("correctness only".into()))];
        let html = section(&[rate("one", both), rate("two", vec![reached("CPU", Err("skipped: lamps".into()))])]);
        for part in [
            "<th>CPU</th><th>x, correctness only</th>",
            "81.0 Hz<small>77.0 to 83.0",
            "skipped: lamps",
            "a &lt;GPU&gt;",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        assert_eq!((html.matches("<td>–</td>").count(), html.matches("<tr>").count()), (1, 3));
        assert!(section(&[]).is_empty());
    }
}
