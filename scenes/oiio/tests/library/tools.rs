//! OpenImageIO's programs, which write what the bridge reads.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use halflight_oiio::File;

/// Runs one of OpenImageIO's programs; none where it is not installed.
pub(crate) fn run(program: &str, arguments: &[&str]) -> Option<Output> {
    match Command::new(program).args(arguments).output() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: no {program} here (Debian: openimageio-tools)");
            None
        }
        output => Some(output.unwrap()),
    }
}

/// Copies of a picture beside it that `oiiotool` makes in one run, each with its options and name; none where it is not
/// installed. Options stay as they are for the copies that follow.
pub(crate) fn copies(from: &Path, wanted: &[(Vec<&str>, &str)]) -> Option<Vec<PathBuf>> {
    let paths: Vec<PathBuf> = wanted.iter().map(|(_, name)| from.with_file_name(name)).collect();
    let mut arguments = vec![from.to_str().unwrap()];
    for ((options, _), path) in wanted.iter().zip(&paths) {
        arguments.extend(options);
        arguments.extend(["-o", path.to_str().unwrap()]);
    }
    let output = run("oiiotool", &arguments)?;
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(paths)
}

/// The channels `R`, `G` and `B` of a file, texel after texel.
pub(crate) fn colours(path: &Path) -> Vec<f32> {
    let mut file = File::open(path, 1 << 20).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(file.channels[..3], ["R", "G", "B"]);
    file.read(0..3).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}
