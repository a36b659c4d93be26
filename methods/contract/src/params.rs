//! Parameters: declared once by the method, read by sweeps, the command line and the docs.

use std::collections::BTreeMap;
use std::fmt;

/// The phase from which a change of a parameter takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// A change needs a new `prepare`.
    Prepare,
    /// A change needs `update` and `evaluate`.
    Update,
    /// A change needs `evaluate` alone.
    Evaluate,
}

/// Type, range and default of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// An integer in `min..=max`.
    Int {
        /// Smallest value.
        min: i64,
        /// Largest value.
        max: i64,
        /// Value when nothing is said.
        default: i64,
    },
    /// A finite number in `min..=max`.
    Float {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// Value when nothing is said.
        default: f64,
    },
    /// One of several words; the first is the default.
    Choice(&'static [&'static str]),
    /// On or off.
    Flag {
        /// Value when nothing is said.
        default: bool,
    },
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Kind::Int { min, max, .. } => write!(f, "an integer from {min} to {max}"),
            Kind::Float { min, max, .. } => write!(f, "a number from {min} to {max}"),
            Kind::Choice(words) => write!(f, "one of {}", words.join(", ")),
            Kind::Flag { .. } => f.write_str("true or false"),
        }
    }
}

/// One declared parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamSpec {
    /// Name on the command line and in results.
    pub name: &'static str,
    /// Type, range, default.
    pub kind: Kind,
    /// From where a change takes effect.
    pub phase: Phase,
    /// One line of help.
    pub help: &'static str,
}

impl ParamSpec {
    /// The value when nothing is said.
    pub fn default(&self) -> Value {
        match self.kind {
            Kind::Int { default, .. } => Value::Int(default),
            Kind::Float { default, .. } => Value::Float(default),
            Kind::Choice(words) => Value::Choice(words[0]),
            Kind::Flag { default } => Value::Flag(default),
        }
    }

    /// Reads a value from text, checking type and range.
    pub fn parse(&self, text: &str) -> Result<Value, ParamError> {
        let value = match self.kind {
            Kind::Int { min, max, .. } => text.parse().ok().filter(|v| (min..=max).contains(v)).map(Value::Int),
            Kind::Float { min, max, .. } => text.parse().ok().filter(|v| (min..=max).contains(v)).map(Value::Float),
            Kind::Choice(words) => words.iter().find(|w| **w == text).map(|w| Value::Choice(w)),
            Kind::Flag { .. } => text.parse().ok().map(Value::Flag),
        };
        value.ok_or_else(|| ParamError::Value {
            name: self.name,
            found: text.to_string(),
            expected: self.kind.to_string(),
        })
    }
}

/// A parameter's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Integer.
    Int(i64),
    /// Number.
    Float(f64),
    /// Word.
    Choice(&'static str),
    /// Switch.
    Flag(bool),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Int(v) => write!(f, "{v}"),
            Value::Float(v) => write!(f, "{v}"),
            Value::Choice(v) => f.write_str(v),
            Value::Flag(v) => write!(f, "{v}"),
        }
    }
}

/// A complete set of parameter values: one for each spec, in range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Params {
    values: BTreeMap<&'static str, Value>,
}

impl Params {
    /// Every parameter at its default.
    pub fn defaults(specs: &'static [ParamSpec]) -> Self {
        Params { values: specs.iter().map(|spec| (spec.name, spec.default())).collect() }
    }

    /// Defaults, with the given names set from text.
    pub fn resolve<'a>(
        specs: &'static [ParamSpec],
        settings: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<Self, ParamError> {
        let mut params = Params::defaults(specs);
        for (name, text) in settings {
            let spec = specs.iter().find(|spec| spec.name == name).ok_or_else(|| ParamError::Unknown {
                name: name.to_string(),
                known: specs.iter().map(|spec| spec.name).collect::<Vec<_>>().join(", "),
            })?;
            params.values.insert(spec.name, spec.parse(text)?);
        }
        Ok(params)
    }

    /// All values by name.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, Value)> {
        self.values.iter().map(|(name, value)| (*name, *value))
    }

    /// An integer parameter. Panics if the method did not declare it so.
    pub fn int(&self, name: &str) -> usize {
        match self.values.get(name) {
            Some(Value::Int(v)) => usize::try_from(*v).expect("integer parameters that are counts are not negative"),
            other => panic!("parameter {name} is not declared as an integer: {other:?}"),
        }
    }

    /// A number parameter. Panics if the method did not declare it so.
    pub fn float(&self, name: &str) -> f64 {
        match self.values.get(name) {
            Some(Value::Float(v)) => *v,
            other => panic!("parameter {name} is not declared as a number: {other:?}"),
        }
    }

    /// A choice parameter. Panics if the method did not declare it so.
    pub fn choice(&self, name: &str) -> &'static str {
        match self.values.get(name) {
            Some(Value::Choice(v)) => v,
            other => panic!("parameter {name} is not declared as a choice: {other:?}"),
        }
    }

    /// A flag parameter. Panics if the method did not declare it so.
    pub fn flag(&self, name: &str) -> bool {
        match self.values.get(name) {
            Some(Value::Flag(v)) => *v,
            other => panic!("parameter {name} is not declared as a flag: {other:?}"),
        }
    }

    /// The first phase from which a change from `before` takes effect; `None` if nothing that is declared differs.
    pub fn first_change(&self, before: &Params, specs: &[ParamSpec]) -> Option<Phase> {
        let changed = |spec: &&ParamSpec| self.values.get(spec.name) != before.values.get(spec.name);
        specs.iter().filter(changed).map(|spec| spec.phase).min()
    }

    /// Takes the place of `before` without preparing again: an error if a parameter of phase `prepare` differs.
    pub fn retune(&self, before: &mut Params, specs: &[ParamSpec]) -> crate::Result<()> {
        let changed = |spec: &&ParamSpec| self.values.get(spec.name) != before.values.get(spec.name);
        match specs.iter().filter(|spec| spec.phase == Phase::Prepare).find(changed) {
            Some(spec) => Err(crate::Error::NeedsPrepare { name: spec.name }),
            None => {
                before.clone_from(self);
                Ok(())
            }
        }
    }
}

/// A parameter that was not understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParamError {
    /// No such parameter.
    #[error("unknown parameter {name}: expected one of {known}")]
    Unknown {
        /// What was given.
        name: String,
        /// What exists.
        known: String,
    },
    /// Wrong type or out of range.
    #[error("parameter {name}: expected {expected}, found {found:?}")]
    Value {
        /// The parameter.
        name: &'static str,
        /// What was given.
        found: String,
        /// What it takes.
        expected: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECS: &[ParamSpec] = &[
        ParamSpec { name: "order", kind: Kind::Int { min: 1, max: 8, default: 4 }, phase: Phase::Prepare, help: "" },
        ParamSpec {
            name: "angle",
            kind: Kind::Float { min: 0.0, max: 45.0, default: 1.5 },
            phase: Phase::Update,
            help: "",
        },
        ParamSpec { name: "rule", kind: Kind::Choice(&["soft", "hard"]), phase: Phase::Evaluate, help: "" },
        ParamSpec { name: "guard", kind: Kind::Flag { default: true }, phase: Phase::Evaluate, help: "" },
    ];

    #[test]
    fn defaults_and_settings() {
        let params = Params::resolve(SPECS, [("order", "8"), ("rule", "hard")]).expect("in range");
        assert_eq!((params.int("order"), params.float("angle")), (8, 1.5));
        assert_eq!((params.choice("rule"), params.flag("guard")), ("hard", true));
        assert_eq!(Params::resolve(SPECS, []), Ok(Params::defaults(SPECS)));
    }

    #[test]
    fn what_is_out_of_range_or_of_another_type_is_refused_by_name_and_expectation() {
        let wrong = [
            ("order", "0", "an integer from 1 to 8"),
            ("order", "9", "an integer from 1 to 8"),
            ("order", "4.0", "an integer from 1 to 8"),
            ("angle", "-0.1", "a number from 0 to 45"),
            ("angle", "NaN", "a number from 0 to 45"),
            ("angle", "inf", "a number from 0 to 45"),
            ("rule", "Soft", "one of soft, hard"),
            ("guard", "yes", "true or false"),
            ("guard", "", "true or false"),
        ];
        for (name, text, expected) in wrong {
            let error = Params::resolve(SPECS, [(name, text)]).expect_err(text).to_string();
            assert_eq!(error, format!("parameter {name}: expected {expected}, found {text:?}"));
        }
        let error = Params::resolve(SPECS, [("ordre", "4")]).expect_err("unknown").to_string();
        assert_eq!(error, "unknown parameter ordre: expected one of order, angle, rule, guard");
    }

    #[test]
    fn every_value_reads_back_from_what_it_prints() {
        for spec in SPECS {
            assert_eq!(spec.parse(&spec.default().to_string()), Ok(spec.default()), "{}", spec.name);
        }
    }

    #[test]
    fn the_first_change_decides_what_is_done_again() {
        let held = Params::defaults(SPECS);
        let first = |settings: &[(&str, &str)]| {
            let other = Params::resolve(SPECS, settings.iter().copied()).expect("in range");
            other.first_change(&held, SPECS)
        };
        assert_eq!(first(&[("order", "4")]), None);
        assert_eq!(first(&[("guard", "false"), ("rule", "hard")]), Some(Phase::Evaluate));
        assert_eq!(first(&[("guard", "false"), ("angle", "3")]), Some(Phase::Update));
        assert_eq!(first(&[("guard", "false"), ("angle", "3"), ("order", "5")]), Some(Phase::Prepare));
    }

    #[test]
    fn retuning_takes_live_parameters_and_refuses_the_rest_whole() {
        let mut held = Params::defaults(SPECS);
        let live = Params::resolve(SPECS, [("angle", "2"), ("guard", "false")]).expect("in range");
        live.retune(&mut held, SPECS).expect("live");
        assert_eq!(held, live);
        let other = Params::resolve(SPECS, [("angle", "3"), ("order", "2")]).expect("in range");
        let refused = other.retune(&mut held, SPECS);
        assert!(matches!(refused, Err(crate::Error::NeedsPrepare { name: "order" })), "{refused:?}");
        assert_eq!(held, live);
    }
}
