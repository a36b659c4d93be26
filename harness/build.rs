//! Tells the program which compiler built it.

use std::process::Command;

fn main() {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("--version").output();
    let version = output.ok().and_then(|o| String::from_utf8(o.stdout).ok());
    println!("cargo:rustc-env=HALFLIGHT_RUSTC={}", version.as_deref().map_or("unknown rustc", str::trim));
    println!("cargo:rerun-if-changed=build.rs");
}
