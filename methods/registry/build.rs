//! Gives each registered family the hash of the sources that decide its results.

use std::env;
use std::fmt::Write;
use std::fs;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut table = String::from("const REVISIONS: &[(&str, &str)] = &[\n");
    for family in families(&fs::read_to_string("Cargo.toml")?) {
        let variable = format!("REVISION_{}", family.replace('-', "_").to_uppercase());
        halflight_revision::emit(&variable, &Path::new("..").join(family))?;
        writeln!(table, "    (\"{family}\", env!(\"{variable}\")),")?;
    }
    table.push_str("];\n");
    fs::write(Path::new(&env::var("OUT_DIR")?).join("revisions.rs"), table)?;
    Ok(())
}

/// The method crates among the registry's dependencies: all but the contract and what the build script itself uses.
fn families(manifest: &str) -> impl Iterator<Item = &str> {
    manifest
        .lines()
        .filter_map(|line| line.strip_prefix("halflight-")?.strip_suffix(".workspace = true"))
        .filter(|name| !matches!(*name, "contract" | "revision"))
}
