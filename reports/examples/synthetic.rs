//! Writes a report of made-up pictures into a folder, for work on the page without running anything:
//! `cargo run -p halflight-reports --example synthetic -- FOLDER`.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dir = std::env::args().nth(1).ok_or("expected a folder")?;
    let store = synthetic::fill(dir.as_ref(), 160);
    halflight_reports::build(&store, "A report of made-up pictures").write(&store.dir().join("report.html"))?;
    Ok(())
}
