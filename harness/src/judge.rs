//! Which references judge a cell.
//!
//! A bare name takes the parameters of the method that the reference isolates: `sh-light` stands for light in SH of the
//! method's own order, `sphere-proxies` for as many spheres, under the same self-shadow rule, as the method uses. A method
//! without these parameters is not judged by that reference. A full name, such as `sh-light:6`, is the same for all.

use crate::Error;
use halflight_contract::{Params, Quantity};
use halflight_references::Reference;

/// References by bare name, and the method's parameters that complete them.
const MATCHED: [(&str, &[&str]); 2] = [("sh-light", &["order"]), ("sphere-proxies", &["spheres", "self-shadow"])];

/// A reference by its full name; a number that is left out has its default.
///
/// # Errors
/// There is no such reference.
pub(crate) fn parse(name: &str) -> Result<Reference, Error> {
    Reference::parse(name).map_err(|e| Error::Other(e.to_string()))
}

/// The references of these names for a quantity by a method with these parameters, each once. There are none of
/// indirect light.
pub(crate) fn references(names: &[String], quantity: Quantity, params: &Params) -> Result<Vec<Reference>, Error> {
    let mut found = Vec::new();
    for name in names {
        let full = match MATCHED.iter().find(|(bare, _)| bare == name) {
            Some((_, parameters)) => complete(name, parameters, params),
            None => Some(name.clone()),
        };
        let reference = full.map(|name| parse(&name)).transpose()?;
        let fits = |reference: &Reference| quantity == Quantity::Direct && !found.contains(reference);
        if let Some(reference) = reference.filter(fits) {
            found.push(reference);
        }
    }
    Ok(found)
}

fn complete(name: &str, parameters: &[&str], params: &Params) -> Option<String> {
    parameters.iter().try_fold(name.to_owned(), |name, parameter| {
        let (_, value) = params.iter().find(|(declared, _)| declared == parameter)?;
        Some(format!("{name}:{value}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use halflight_contract::{Kind, ParamSpec, Phase};

    const fn spec(name: &'static str, kind: Kind) -> ParamSpec {
        ParamSpec { name, kind, phase: Phase::Prepare, help: "" }
    }
    const ORDER: ParamSpec = spec("order", Kind::Int { min: 1, max: 8, default: 3 });
    const SPHERES: ParamSpec = spec("spheres", Kind::Int { min: 1, max: 64, default: 7 });
    const RULE: ParamSpec = spec("self-shadow", Kind::Choice(&["paper", "off"]));

    fn ids(names: &[&str], params: &Params) -> Vec<String> {
        let names: Vec<_> = names.iter().map(|n| n.to_string()).collect();
        references(&names, Quantity::Direct, params).unwrap().iter().map(Reference::id).collect()
    }

    #[test]
    fn bare_names_take_the_methods_parameters() {
        const ALL: &[ParamSpec] = &[ORDER, SPHERES, RULE];
        let names = ["truth", "sh-light", "sphere-proxies", "sh-light:6", "truth"];
        let all = ids(&names, &Params::defaults(ALL));
        assert_eq!(all, ["truth", "sh-light:3", "sphere-proxies:7:paper", "sh-light:6"]);
        const FEW: &[ParamSpec] = &[SPHERES];
        assert_eq!(ids(&names, &Params::defaults(FEW)), ["truth", "sh-light:6"]);
    }

    #[test]
    fn unknown_references_are_refused() {
        let error = references(&["thruth".into()], Quantity::Total, &Params::defaults(&[])).unwrap_err().to_string();
        assert!(error.contains("`thruth`") && error.contains("expected truth"), "{error}");
    }
}
