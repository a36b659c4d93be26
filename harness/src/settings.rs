//! Settings of parameters: `order=4`, `order=2..6`, `spheres=log(16..256,5)`, `self-shadow=all`, and the grids that they span.

use crate::Error;
use halflight_contract::{Kind, ParamError, ParamSpec};
use std::fmt;

/// The most values that one setting may list: a slip such as `order=2..6000000` is refused, not run.
const MOST: usize = 1000;

/// A parameter's name and the values that it takes in turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The parameter.
    pub name: String,
    /// Its values; a method's declaration decides what they mean.
    pub values: Vec<Series>,
}

/// One value or several, as written.
#[derive(Clone, Debug, PartialEq)]
pub enum Series {
    /// One, as text.
    One(String),
    /// `A..B`: the integers from A to B, both included.
    Integers(i64, i64),
    /// `lin(A..B,N)` or `log(A..B,N)`: N numbers from A to B, both included, with equal steps or equal ratios.
    Spaced {
        /// Whether ratios are equal, rather than steps.
        log: bool,
        /// A.
        from: f64,
        /// B, above A.
        to: f64,
        /// N, at least 2.
        count: usize,
    },
    /// `all`: every word of a choice, or both states of a switch.
    All,
}

impl std::str::FromStr for Setting {
    type Err = Error;

    /// Reads `name=values`, where values are separated by commas; [`Series`] tells what each may be.
    fn from_str(text: &str) -> Result<Self, Error> {
        let wrong = |message: &str| Error::Setting { text: text.to_owned(), message: message.to_owned() };
        let (name, values) = text.split_once('=').ok_or_else(|| wrong("expected NAME=VALUES, such as order=2..6"))?;
        let name = name.trim();
        if name.is_empty() {
            return Err(wrong("expected a parameter's name before `=`"));
        }
        Ok(Self { name: name.to_owned(), values: read(values).map_err(|message| wrong(&message))? })
    }
}

/// All that a text such as `2..6` or `2,4` or `log(0.1..10,5)` stands for.
pub(crate) fn read(text: &str) -> Result<Vec<Series>, String> {
    parts(text).map(|part| Series::read(part.trim())).collect()
}

/// What lies between commas outside of parentheses.
fn parts(text: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    text.split(move |c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        c == ',' && depth == 0
    })
}

impl Series {
    fn read(text: &str) -> Result<Self, String> {
        if let Some((log, inner)) = spaced(text) {
            return Self::read_spaced(log, inner).ok_or_else(|| {
                let (name, above) = if log { ("log", "0 < A < B") } else { ("lin", "A < B") };
                format!("expected {name}(A..B,N) with {above} and N from 2 to {MOST}, found `{text}`")
            });
        }
        match text.split_once("..") {
            _ if text.is_empty() => Err("expected a value between commas and after `=`".into()),
            _ if text == "all" => Ok(Self::All),
            Some((from, to)) => integers(text, from, to),
            None => Ok(Self::One(text.to_owned())),
        }
    }

    fn read_spaced(log: bool, inner: &str) -> Option<Self> {
        let (range, count) = inner.split_once(',')?;
        let (from, to) = range.split_once("..")?;
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        let (from, to, count) = (number(from)?, number(to)?, count.trim().parse().ok()?);
        (from < to && (from > 0.0 || !log) && (2..=MOST).contains(&count)).then_some(Self::Spaced {
            log,
            from,
            to,
            count,
        })
    }

    /// The values as text for a parameter that is declared so.
    fn expand(&self, spec: &ParamSpec) -> Result<Vec<String>, ParamError> {
        let refused =
            || ParamError::Value { name: spec.name, found: self.to_string(), expected: spec.kind.to_string() };
        let place = |i: usize, count: usize| i as f64 / (count - 1) as f64;
        match (self, spec.kind) {
            (Self::One(text), _) => Ok(vec![text.clone()]),
            (Self::Integers(from, to), _) => Ok((*from..=*to).map(|v| v.to_string()).collect()),
            (Self::Spaced { log, from, to, count }, Kind::Int { .. } | Kind::Float { .. }) => {
                let at = |i: usize| match (*log, place(i, *count)) {
                    (_, 0.0) => *from,
                    (_, 1.0) => *to,
                    (true, t) => from * (to / from).powf(t),
                    (false, t) => from + (to - from) * t,
                };
                let whole = matches!(spec.kind, Kind::Int { .. });
                let text = |v: f64| if whole { v.round().to_string() } else { six_digits(v) };
                let mut values: Vec<String> = (0..*count).map(|i| text(at(i))).collect();
                values.dedup();
                Ok(values)
            }
            (Self::All, Kind::Choice(words)) => Ok(words.iter().map(|word| (*word).to_owned()).collect()),
            (Self::All, Kind::Flag { .. }) => Ok(vec!["false".to_owned(), "true".to_owned()]),
            (Self::Spaced { .. } | Self::All, _) => Err(refused()),
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let values: Vec<String> = self.values.iter().map(ToString::to_string).collect();
        write!(f, "{}={}", self.name, values.join(","))
    }
}

impl fmt::Display for Series {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(text) => f.write_str(text),
            Self::Integers(from, to) => write!(f, "{from}..{to}"),
            Self::Spaced { log, from, to, count } => {
                write!(f, "{}({from}..{to},{count})", if *log { "log" } else { "lin" })
            }
            Self::All => f.write_str("all"),
        }
    }
}

/// What is between the parentheses of `log(…)`, which is true, or `lin(…)`.
fn spaced(text: &str) -> Option<(bool, &str)> {
    let inside = |name: &str| text.strip_prefix(name)?.trim_start().strip_prefix('(')?.strip_suffix(')');
    inside("log").map(|inner| (true, inner)).or_else(|| inside("lin").map(|inner| (false, inner)))
}

/// The rounding keeps keys of cells from hanging on the last bits of a power.
fn six_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    rounded.to_string()
}

fn integers(text: &str, from: &str, to: &str) -> Result<Series, String> {
    let wrong = || {
        format!(
            "expected a range A..B of integers with A not above B, or lin(A..B,N) or log(A..B,N) of numbers, found `{text}`"
        )
    };
    let (from, to): (i64, i64) = (from.parse().map_err(|_| wrong())?, to.parse().map_err(|_| wrong())?);
    if from > to {
        return Err(wrong());
    }
    if to.abs_diff(from) >= MOST as u64 {
        return Err(format!("expected at most {MOST} values, found `{text}`"));
    }
    Ok(Series::Integers(from, to))
}

/// Every combination of the values that settings have for the parameters that are declared so, the last setting varying
/// fastest; one empty combination for no settings. A value that a setting names twice counts once.
///
/// # Errors
/// A setting is of no declared parameter, or its values are not of the declared type.
pub(crate) fn grid(settings: &[&Setting], specs: &[ParamSpec]) -> Result<Vec<Vec<(String, String)>>, ParamError> {
    let mut points = vec![Vec::new()];
    for setting in settings {
        let spec = specs.iter().find(|spec| spec.name == setting.name).ok_or_else(|| ParamError::Unknown {
            name: setting.name.clone(),
            known: specs.iter().map(|spec| spec.name).collect::<Vec<_>>().join(", "),
        })?;
        let mut values = Vec::new();
        for value in &setting.values {
            for value in value.expand(spec)? {
                if !values.contains(&value) {
                    values.push(value);
                }
            }
        }
        let extend = |point: &Vec<(String, String)>, value: &String| {
            let mut point = point.clone();
            point.push((setting.name.clone(), value.clone()));
            point
        };
        points = points.iter().flat_map(|point| values.iter().map(move |value| extend(point, value))).collect();
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_contract::Phase;

    const fn spec(name: &'static str, kind: Kind) -> ParamSpec {
        ParamSpec { name, kind, phase: Phase::Evaluate, help: "" }
    }
    const SPECS: &[ParamSpec] = &[
        spec("order", Kind::Int { min: -10, max: 1000, default: 4 }),
        spec("x", Kind::Float { min: 0.0, max: 100.0, default: 1.0 }),
        spec("rule", Kind::Choice(&["paper", "continuous", "off"])),
        spec("on", Kind::Flag { default: true }),
    ];

    fn values(text: &str) -> Result<String, String> {
        let setting: Setting = text.parse().map_err(|e: Error| e.to_string())?;
        let points = grid(&[&setting], SPECS).map_err(|e| e.to_string())?;
        Ok(points.iter().map(|point| point[0].1.as_str()).collect::<Vec<_>>().join(" "))
    }

    #[test]
    fn settings_are_read() {
        for (text, expected) in [
            ("order=2..6", "2 3 4 5 6"),
            ("order=-1..1, 7", "-1 0 1 7"),
            ("order=2,4,2", "2 4"),
            ("rule=paper", "paper"),
            ("rule=all", "paper continuous off"),
            ("on=all", "false true"),
            ("x=0.5", "0.5"),
            ("x=log(0.01..1,5)", "0.01 0.0316228 0.1 0.316228 1"),
            ("x=lin(0..1,3),log( 2 .. 8 , 2 )", "0 0.5 1 2 8"),
            ("order=log(16..256,5)", "16 32 64 128 256"),
            ("order=log(1..4,9)", "1 2 3 4"),
            ("order=lin(-2..2,3)", "-2 0 2"),
        ] {
            assert_eq!(values(text).as_deref(), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_told_with_what_was_expected() {
        for bad in [
            "order",
            "=3",
            "order=",
            "order=6..2",
            "order=2..x",
            "order=1..1000000000000",
            "p=2,,3",
            "x=0.1..0.5",
            "x=log(0..1,5)",
            "x=log(2..1,5)",
            "x=log(1..2)",
            "x=log(1..2,1)",
            "x=lin(1..2,1000000)",
            "x=log(1..inf,3)",
        ] {
            let message = values(bad).unwrap_err();
            assert!(message.starts_with(&format!("--set {bad}: expected")), "{message}");
        }
        for (bad, expected) in [
            ("ordre=4", "unknown parameter ordre: expected one of order, x, rule, on"),
            ("order=all", "parameter order: expected an integer from -10 to 1000, found \"all\""),
            ("rule=log(1..2,3)", "parameter rule: expected one of paper, continuous, off, found \"log(1..2,3)\""),
            ("on=lin(0..1,2)", "parameter on: expected true or false, found \"lin(0..1,2)\""),
        ] {
            assert_eq!(values(bad).unwrap_err(), expected);
        }
    }

    #[test]
    fn a_grid_holds_every_combination() {
        let settings: Vec<Setting> = ["order=1,2", "rule=all"].iter().map(|s| s.parse().unwrap()).collect();
        let points = grid(&settings.iter().collect::<Vec<_>>(), SPECS).unwrap();
        assert_eq!(points.len(), 6);
        assert_eq!(points[1], [("order".into(), "1".into()), ("rule".into(), "continuous".into())]);
        assert_eq!(grid(&[], SPECS), Ok(vec![vec![]]));
    }

    #[test]
    fn values_print_as_they_are_written() {
        for text in ["order=2..6", "x=log(0.01..1,5)", "x=lin(0..1,3)", "rule=all", "rule=paper"] {
            let setting: Setting = text.parse().unwrap();
            assert_eq!(format!("{}={}", setting.name, setting.values[0]), text);
        }
    }
}
