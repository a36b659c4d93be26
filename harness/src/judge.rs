//! Which references judge a cell.
//!
//! A bare name takes the parameters of the method that the reference isolates: `sh-light` stands for light in SH of the
//! method's own order, `sphere-proxies` for as many spheres, under the same self-shadow rule, as the method uses. A method
//! without these parameters is not judged by that reference, nor a scene that has no such reference. A full name, such as
//! `sh-light:6`, is the same for all, and must be one that the scene has. Names may be joined: `sh-light+sphere-proxies`.

use crate::Error;
use halflight_contract::{Params, Quantity};
use halflight_references::{Change, Reference};
use halflight_scenes::Scene;

/// References by bare name, and the method's parameters that complete them.
const MATCHED: [(&str, &[&str]); 3] =
    [("sh-light", &["order"]), ("sphere-proxies", &["spheres", "self-shadow"]), ("sh-visibility", &["order"])];

/// A reference by its full name; a number that is left out has its default.
///
/// # Errors
/// There is no such reference.
pub(crate) fn parse(name: &str) -> Result<Reference, Error> {
    Reference::parse(name).map_err(|e| Error::Other(e.to_string()))
}

/// The references of these names for a quantity of a scene by a method with these parameters, each once.
///
/// # Errors
/// A name is none, or is full and the scene has no such reference of this quantity.
pub(crate) fn references(
    names: &[String],
    quantity: Quantity,
    params: &Params,
    scene: &Scene,
) -> Result<Vec<Reference>, Error> {
    let mut found = Vec::new();
    for name in names {
        let (full, bare) = complete(name, params);
        let Some(full) = full else { continue };
        let reference = parse(&full)?;
        match reference.serves(quantity, scene) {
            Ok(()) if !found.contains(&reference) => found.push(reference),
            Err(why) if !bare => return Err(Error::Other(format!("{}: reference of {quantity}: {why}", scene.name))),
            _ => {}
        }
    }
    Ok(found)
}

/// The approximations that a method with these parameters shares with a reference, in the order of an error budget.
pub(crate) fn shared(params: &Params) -> Vec<Change> {
    let of = |(name, parameters): &(&str, &[&str])| Reference::parse(&with_parameters(name, parameters, params)?).ok();
    MATCHED.iter().filter_map(of).flat_map(|reference| reference.changes().to_vec()).collect()
}

/// A name with the method's parameters, `None` if the method lacks one of them; and whether anything was completed.
fn complete(name: &str, params: &Params) -> (Option<String>, bool) {
    let matched = |part: &str| MATCHED.iter().find(|(bare, _)| *bare == part).map(|(_, parameters)| *parameters);
    let parts: Option<Vec<String>> = name
        .split('+')
        .map(|part| match matched(part) {
            Some(parameters) => with_parameters(part, parameters, params),
            None => Some(part.to_owned()),
        })
        .collect();
    (parts.map(|parts| parts.join("+")), name.split('+').any(|part| matched(part).is_some()))
}

fn with_parameters(name: &str, parameters: &[&str], params: &Params) -> Option<String> {
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
        references(&names, Quantity::Direct, params, &scene()).unwrap().iter().map(Reference::id).collect()
    }

    fn scene() -> Scene {
        halflight_scenes::find("sphere-plane").unwrap()
    }

    #[test]
    fn bare_names_take_the_methods_parameters() {
        const ALL: &[ParamSpec] = &[ORDER, SPHERES, RULE];
        let names = ["truth", "sh-light", "sphere-proxies", "sh-light:6", "truth", "sh-light+sh-visibility"];
        let all = ids(&names, &Params::defaults(ALL));
        let joined = "sh-light:3+sh-visibility:3";
        assert_eq!(all, ["truth", "sh-light:3", "sphere-proxies:7:paper", "sh-light:6", joined]);
        const FEW: &[ParamSpec] = &[SPHERES];
        assert_eq!(ids(&names, &Params::defaults(FEW)), ["truth", "sh-light:6"]);
    }

    #[test]
    fn unknown_references_are_refused() {
        let refused = |name: &str, quantity| {
            references(&[name.into()], quantity, &Params::defaults(&[]), &scene()).unwrap_err().to_string()
        };
        let error = refused("thruth", Quantity::Total);
        assert!(error.contains("`thruth`") && error.contains("expected truth"), "{error}");
        let error = refused("without:nobody", Quantity::Total);
        assert!(error.contains("no object `nobody`"), "{error}");
        let error = refused("unoccluded-indirect", Quantity::Direct);
        assert!(error.contains("expected indirect light"), "{error}");
    }
}
