//! The examples that a newcomer copies.

use std::path::Path;

use halflight_scenes::Scene;

/// The first TOML block of a text.
fn example(text: &str) -> &str {
    let (_, rest) = text.split_once("```toml\n").expect("a TOML block");
    rest.split_once("```").expect("the block ends").0
}

#[test]
fn the_readmes_example_is_a_scene() {
    let scene = Scene::parse(Path::new("example.toml"), example(include_str!("../../../README.md"))).expect("it loads");
    assert_eq!(scene.objects.len(), 2);
}

#[test]
fn the_format_pages_fields_are_the_formats() {
    // Its files do not exist, which is found out only after all fields were understood.
    let error =
        Scene::parse(Path::new("example.toml"), example(include_str!("../../README.md"))).expect_err("no files");
    assert!(error.to_string().contains("bunny.ply"), "{error}");
}
