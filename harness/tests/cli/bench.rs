//! The program on a tiny scene in a folder of its own.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// One sphere over a ground that casts no shadow, 4 × 3 receivers.
pub(crate) const SCENE: &str = r#"
purpose = "a test"

[receivers.grid]
center = [0.0, 0.0, 0.0]
size = [4.0, 3.0]
resolution = [4, 3]

[[objects]]
name = "ball"
sphere = { center = [0.0, 0.0, 1.0], radius = 0.5 }
albedo = [0.5, 0.5, 0.5]

[[lights]]
sky = { overcast = [1.0, 0.9, 0.8] }
"#;

pub(crate) struct Bench {
    pub(crate) dir: tempfile::TempDir,
}

/// What a command printed and how it ended.
pub(crate) struct Said {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Bench {
    /// A folder with the scene as `tiny.toml`.
    pub(crate) fn new() -> Self {
        let bench = Self { dir: tempfile::tempdir().unwrap() };
        bench.write("tiny.toml", SCENE);
        bench
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// Runs the program in the folder, with a cache there.
    pub(crate) fn halflight(&self, arguments: &str) -> Said {
        let Output { status, stdout, stderr } = self.command(arguments).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Said { code: status.code().unwrap(), out: text(stdout), err: text(stderr) }
    }

    /// The program in the folder, with a cache there.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_halflight"));
        command.current_dir(self.dir.path()).env("XDG_CACHE_HOME", self.path("cache"));
        command.args(arguments.split_whitespace());
        command
    }

    /// As [`Bench::halflight`]; it must succeed.
    pub(crate) fn well(&self, arguments: &str) -> String {
        let said = self.halflight(arguments);
        assert_eq!(said.code, 0, "halflight {arguments}: {}{}", said.out, said.err);
        said.out
    }

    /// The lines of a results directory.
    pub(crate) fn lines(&self, out: &str) -> Vec<Value> {
        let text = std::fs::read_to_string(self.path(out).join("results.jsonl")).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    /// Files below a folder with their content and time of change, sorted.
    pub(crate) fn files(&self, folder: &str) -> Vec<(PathBuf, Vec<u8>, std::time::SystemTime)> {
        let mut found = Vec::new();
        collect(&self.path(folder), &mut found);
        found.sort();
        found
    }

    /// Folders below a folder with their time of change, sorted.
    pub(crate) fn folders(&self, folder: &str) -> Vec<(PathBuf, std::time::SystemTime)> {
        let mut folders: Vec<PathBuf> =
            self.files(folder).iter().map(|(path, ..)| path.parent().unwrap().to_owned()).collect();
        folders.sort();
        folders.dedup();
        let changed = |path: PathBuf| (path.metadata().unwrap().modified().unwrap(), path);
        folders.into_iter().map(changed).map(|(time, path)| (path, time)).collect()
    }
}

fn collect(dir: &Path, found: &mut Vec<(PathBuf, Vec<u8>, std::time::SystemTime)>) {
    for entry in std::fs::read_dir(dir).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, found);
        } else {
            let changed = path.metadata().unwrap().modified().unwrap();
            found.push((path.clone(), std::fs::read(&path).unwrap(), changed));
        }
    }
}

/// The lines of a kind.
pub(crate) fn of_kind<'a>(lines: &'a [Value], kind: &str) -> Vec<&'a Value> {
    lines.iter().filter(|line| line["kind"] == kind).collect()
}

/// Ids of the methods that serve scenes without height fields, as [`SCENE`] is.
pub(crate) fn methods() -> Vec<&'static str> {
    let serves = |method: &&dyn halflight_contract::Method| {
        let params = halflight_contract::Params::defaults(method.info().params);
        let (quantity, backend) = (halflight_contract::Quantity::Direct, halflight_contract::Backend::Cpu);
        let request = halflight_contract::Request { quantity, backend, params: &params };
        let answer = method.supports(&halflight_scenes::SceneFacts::default(), &request);
        !matches!(answer, halflight_contract::Support::Skip(_))
    };
    halflight_registry::methods().into_iter().filter(serves).map(|method| method.info().id).collect()
}
