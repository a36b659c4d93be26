//! A method folder that is not registered is found.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::manifests::{read, root};

/// Crates below `methods/` that hold no method.
const SUPPORT: &[&str] = &["blockers", "contract", "gpu", "horizons", "light", "proxies", "registry", "sh"];

/// A crate below `methods/`.
struct Folder {
    name: String,
    /// Whether its sources implement the trait.
    implements: bool,
}

/// What is missing for every method to be on the list. `dependencies` are those of the registry's manifest, `families`
/// the first parts of the ids that it lists.
fn missing(folders: &[Folder], dependencies: &BTreeSet<String>, families: &BTreeSet<String>) -> Vec<String> {
    let mut found = Vec::new();
    for Folder { name, implements } in folders {
        if SUPPORT.contains(&name.as_str()) {
            if *implements {
                found.push(format!("methods/{name} implements a method: give it a folder of its own"));
            }
            continue;
        }
        if !dependencies.contains(&format!("halflight-{name}")) {
            found.push(format!("methods/{name} is not a dependency of methods/registry"));
        }
        if !families.contains(name) {
            found.push(format!("methods/{name} has no line in halflight_registry::methods()"));
        }
    }
    let known = |family: &&String| !folders.iter().any(|folder| folder.name == **family);
    found.extend(families.iter().filter(known).map(|family| format!("family {family} has no folder methods/{family}")));
    found
}

fn folders() -> Vec<Folder> {
    let methods = root().join("methods");
    let entries = fs::read_dir(&methods).expect("methods/ is readable").map(|entry| entry.expect("readable").path());
    let crates = entries.filter(|path| path.join("Cargo.toml").is_file());
    let folder = |path: std::path::PathBuf| Folder {
        name: path.file_name().expect("a name").to_string_lossy().into_owned(),
        implements: implements_method(&path.join("src")),
    };
    crates.map(folder).collect()
}

fn implements_method(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).expect("sources are readable").map(|entry| entry.expect("readable").path());
    entries.into_iter().any(|path| match path.is_dir() {
        true => implements_method(&path),
        false => fs::read_to_string(&path).is_ok_and(|text| text.contains(" Method for ")),
    })
}

fn families() -> BTreeSet<String> {
    halflight_registry::methods().iter().map(|method| method.info().family().to_string()).collect()
}

#[test]
fn every_method_folder_is_registered() {
    let found = missing(&folders(), &read("methods/registry").dependencies, &families());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn ids_are_unique_and_of_the_form_family_variant() {
    let methods = halflight_registry::methods();
    let ids: BTreeSet<&str> = methods.iter().map(|method| method.info().id).collect();
    assert_eq!(ids.len(), methods.len());
    let proper =
        |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-');
    for id in ids {
        let parts: Vec<&str> = id.split('/').collect();
        assert!(
            parts.len() == 2 && parts.iter().all(|part| proper(part)),
            "{id}: expected family/variant in lower case"
        );
    }
}

#[test]
fn a_method_folder_that_is_not_registered_is_found() {
    let stray = || Folder { name: "shadow-fields".into(), implements: true };
    let all: Vec<Folder> = folders().into_iter().chain([stray()]).collect();
    let dependencies = read("methods/registry").dependencies;
    let found = missing(&all, &dependencies, &families());
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found.iter().all(|line| line.contains("methods/shadow-fields")), "{found:?}");

    let only_linked: BTreeSet<String> = dependencies.into_iter().chain(["halflight-shadow-fields".into()]).collect();
    let found = missing(&all, &only_linked, &families());
    assert_eq!(found, ["methods/shadow-fields has no line in halflight_registry::methods()"]);
}

#[test]
fn a_method_hidden_in_a_support_crate_and_a_family_without_a_folder_are_found() {
    let hidden = [Folder { name: "blockers".into(), implements: true }];
    let found = missing(&hidden, &BTreeSet::new(), &BTreeSet::from(["shexp".to_string()]));
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains("methods/blockers") && found[1].contains("methods/shexp"), "{found:?}");
}
