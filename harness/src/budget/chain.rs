//! The steps from the truth to a method.

use crate::judge;
use halflight_contract::{Backend, Method, Params, Quantity, Request, Support};
use halflight_references::Reference;
use halflight_scenes::Scene;

/// A walk, and what could not be walked.
#[derive(Clone)]
pub struct Walk {
    /// The steps, from the truth to the method.
    pub steps: Vec<Step>,
    /// What was left out, each with its reason.
    pub left_out: Vec<String>,
}

/// A step: everything before it, and one approximation more.
#[derive(Clone)]
pub struct Step {
    /// What it adds: `truth`, `+ sh-light:4`, a method's id.
    pub name: String,
    /// One line: what that is.
    pub about: String,
    /// What shows it.
    pub what: What,
}

/// What is asked for a step's picture.
#[derive(Clone)]
pub enum What {
    /// A reference.
    Reference(Reference),
    /// A method with its parameters.
    Method(&'static dyn Method, Params),
}

/// The walk from the truth to a method: first the approximations that the method shares with a reference, by the parameters
/// that it declares, all kept that came before; then the methods that it approximates, by their own word
/// ([`Method::approximates`]), with those of its parameters that they declare; then the method. Steps that the scene has no
/// reference for, or a method does not serve, are left out.
pub fn walk(scene: &Scene, quantity: Quantity, method: &'static dyn Method, params: &Params) -> Walk {
    let about = Reference::TRUTH.about();
    let truth = Step { name: Reference::TRUTH.id(), about, what: What::Reference(Reference::TRUTH) };
    let mut walk = Walk { steps: vec![truth], left_out: Vec::new() };
    let mut changes = Vec::new();
    for change in judge::shared(params) {
        let reference = Reference::with(changes.iter().cloned().chain([change.clone()]));
        match reference.serves(quantity, scene) {
            Ok(()) => {
                let (name, about) = (format!("+ {}", change.id()), change.kind().about.to_owned());
                walk.steps.push(Step { name, about, what: What::Reference(reference) });
                changes.push(change);
            }
            Err(why) => walk.left_out.push(why),
        }
    }
    for (method, params) in approximated(method, params) {
        let (facts, backend) = (scene.facts(), Backend::Cpu);
        match method.supports(&facts, &Request { quantity, backend, params: &params }) {
            Support::Skip(why) => walk.left_out.push(format!("{}: {why}", method.info().id)),
            _ => {
                let (name, about) = (method.info().id.to_owned(), method.info().about.to_owned());
                walk.steps.push(Step { name, about, what: What::Method(method, params) });
            }
        }
    }
    walk
}

/// The methods that a method approximates, the farthest first, and itself.
fn approximated(method: &'static dyn Method, params: &Params) -> Vec<(&'static dyn Method, Params)> {
    let mut chain = vec![(method, params.clone())];
    let mut present = method;
    while let Some(next) = present.approximates().and_then(halflight_registry::find) {
        if chain.iter().any(|(known, _)| known.info().id == next.info().id) {
            break;
        }
        chain.push((next, taken_over(params, next)));
        present = next;
    }
    chain.reverse();
    chain
}

/// A method's parameters: those given as far as it declares them and takes their values, its defaults for the rest.
fn taken_over(params: &Params, method: &dyn Method) -> Params {
    let specs = method.info().params;
    let given: Vec<(&str, String)> = params.iter().map(|(name, value)| (name, value.to_string())).collect();
    let takes = |name: &str, text: &str| specs.iter().any(|spec| spec.name == name && spec.parse(text).is_ok());
    let settings = given.iter().filter(|(name, text)| takes(name, text)).map(|(name, text)| (*name, text.as_str()));
    Params::resolve(specs, settings).unwrap_or_else(|_| Params::defaults(specs))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(walk: &Walk) -> Vec<&str> {
        walk.steps.iter().map(|step| step.name.as_str()).collect()
    }

    #[test]
    fn a_walk_adds_one_thing_a_step() {
        let scene = halflight_scenes::find("bunny-studio").unwrap();
        let method = halflight_registry::find("shexp/hyb").unwrap();
        let settings = [("order", "3"), ("spheres", "9"), ("self-shadow", "paper"), ("window-light", "true")];
        let params = Params::resolve(method.info().params, settings).unwrap();
        let walk = walk(&scene, Quantity::Direct, method, &params);
        let expected = [
            "truth",
            "+ sh-light:3",
            "+ sphere-proxies:9:paper",
            "+ sh-visibility:3",
            "sh-product/ordered",
            "shexp/eigen",
            "shexp/hyb",
        ];
        assert_eq!(names(&walk), expected);
        assert!(walk.left_out.is_empty());
        let What::Reference(all) = &walk.steps[3].what else { panic!("a reference") };
        assert_eq!(all.id(), "sh-light:3+sphere-proxies:9:paper+sh-visibility:3");
        let What::Method(_, product) = &walk.steps[4].what else { panic!("a method") };
        assert_eq!((product.int("order"), product.flag("window-light")), (3, true));
    }

    #[test]
    fn what_a_scene_has_no_reference_for_is_left_out_with_its_reason() {
        let mut scene = halflight_scenes::find("sphere-plane").unwrap();
        scene.lights.clear();
        let method = halflight_registry::find("sh-product/ordered").unwrap();
        let walk = walk(&scene, Quantity::Indirect { bounces: 1 }, method, &Params::defaults(method.info().params));
        assert_eq!(names(&walk), ["truth"]);
        assert!(walk.left_out[0].contains("no distant light"), "{:?}", walk.left_out);
        assert!(walk.left_out.iter().any(|why| why.starts_with("sh-product/ordered: ")), "{:?}", walk.left_out);
    }

    #[test]
    fn every_method_that_is_approximated_is_there() {
        for method in halflight_registry::methods() {
            let named = method.approximates();
            assert!(named.is_none_or(|id| halflight_registry::find(id).is_some()), "{}", method.info().id);
        }
    }
}
