//! Loads scenes in a process of its own.

use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use halflight_scenes::Scene;

/// How the process hears of its scenes: their paths, line by line.
const SCENES: &str = "HALFLIGHT_HOSTILE_SCENES";

/// What stands before each verdict, the test runner's own words before it.
const TOLD: &str = "VERDICT ";

/// No run may take longer.
const MOST_TIME: Duration = Duration::from_secs(60);

/// What became of a scene, and by how many MiB the process had grown since its start when it was done with it.
#[derive(Debug)]
pub(crate) struct Verdict {
    pub(crate) error: Option<String>,
    pub(crate) grown: u64,
}

/// Loads scene files one after the other under `ulimit -v`, so that whoever asks for all memory does not get it.
///
/// # Panics
/// The process panics, aborts, is killed or takes too long.
pub(crate) fn load(scenes: &[PathBuf]) -> Vec<Verdict> {
    let paths: Vec<&str> = scenes.iter().map(|path| path.to_str().unwrap()).collect();
    let mut told = tempfile::tempfile().unwrap();
    let mut child = Command::new("sh")
        .args(["-c", "ulimit -v 6291456; exec \"$0\" \"$@\""])
        .arg(std::env::current_exe().unwrap())
        .args(["child::loads_what_it_is_told", "--exact", "--ignored", "--nocapture"])
        // Threads reserve addresses, which say nothing of the file.
        .envs([("RAYON_NUM_THREADS", "1"), ("MALLOC_ARENA_MAX", "1"), ("RUST_BACKTRACE", "0")])
        .env(SCENES, paths.join("\n"))
        .stdout(told.try_clone().unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let mut status = None;
    while status.is_none() && start.elapsed() < MOST_TIME {
        std::thread::sleep(Duration::from_millis(5));
        status = child.try_wait().unwrap();
    }
    if status.is_none() {
        child.kill().unwrap();
    }
    child.wait().unwrap();
    let mut text = String::new();
    told.rewind().unwrap();
    told.read_to_string(&mut text).unwrap();
    let verdicts: Vec<Verdict> =
        text.lines().filter_map(|line| line.split_once(TOLD)).map(|(_, rest)| verdict(rest)).collect();
    let at = paths.get(verdicts.len()).copied().unwrap_or("the end");
    assert!(status.is_some_and(|status| status.success()), "{status:?} at {at} (none: over {MOST_TIME:?})");
    assert_eq!(verdicts.len(), scenes.len(), "{text}");
    verdicts
}

fn verdict(told: &str) -> Verdict {
    let (grown, error) = told.split_once(' ').unwrap();
    Verdict { grown: grown.parse().unwrap(), error: (!error.is_empty()).then(|| error.to_owned()) }
}

/// Most addresses that this process has had, in MiB.
fn most_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmPeak:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap() >> 10
}

#[test]
#[ignore = "the other tests run it"]
fn loads_what_it_is_told() {
    let Ok(scenes) = std::env::var(SCENES) else { return };
    let before = most_memory();
    for scene in scenes.lines() {
        let error = Scene::load(Path::new(scene)).err().map(|error| error.to_string().replace('\n', "\\n"));
        println!("{TOLD}{} {}", most_memory() - before, error.unwrap_or_default());
    }
}
