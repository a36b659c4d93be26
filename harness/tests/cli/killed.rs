//! A run that is killed at any moment loses nothing that was finished.

use crate::bench::{Bench, SCENE};
use crate::same::assert_same;
use halflight_results::{Record, Store};
use std::collections::BTreeSet;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Two scenes, with skips among the cells.
const SUITE: &str = "about = 'x'\n[[entry]]\nscenes = ['tiny.toml', 'other.toml']\nmethods = ['shexp/hyb', 'sh-product/ordered']\n\
                     set = { order = '2..3', self-shadow = ['paper', 'off'] }\nreferences = ['truth', 'sh-light']\nquantities = ['direct', 'total']\n";

/// Numbers from 0 to 1 (Knuth's MMIX generator): where in a run it is killed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn outcomes(store: &Store) -> Vec<Record> {
    store.outcomes().cloned().collect()
}

#[test]
fn kills_lose_no_finished_cell() {
    kill(6, 2);
}

/// Longer: `cargo test --release -p halflight --test cli -- --ignored`.
#[test]
#[ignore = "takes half a minute"]
fn fifty_kills_lose_no_finished_cell() {
    kill(50, 6);
}

/// Kills a suite so many times at random moments, and more often until what it left differs at so many of them.
fn kill(kills: usize, least_moments: usize) {
    let bench = Bench::new();
    bench.write("other.toml", &SCENE.replace("radius = 0.5", "radius = 0.8"));
    bench.write("suite.toml", SUITE);
    let command = |out: &str| format!("run --suite suite.toml --repeats 2 --out {out} --cache cache-{out}");
    let started = Instant::now();
    bench.well(&command("whole"));
    let whole = started.elapsed();

    let (mut random, mut landed, mut store) = (Random(7), 0, 0);
    // How much was in the store when a kill came.
    let mut moments = BTreeSet::new();
    while landed < kills || (moments.len() < least_moments && landed < 10 * kills) {
        let out = format!("killed-{store}");
        let before = outcomes(&Store::open(bench.path(&out)).unwrap());
        let mut child = bench.command(&command(&out)).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_secs_f64(whole.as_secs_f64() * random.next()));
        if child.try_wait().unwrap().is_some() {
            // It was done before; the next one begins anew.
            assert_same(&bench.path("whole"), &bench.path(&out));
            store += 1;
            continue;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        landed += 1;
        let after = Store::open(bench.path(&out)).unwrap();
        moments.insert(std::fs::metadata(after.path()).map_or(0, |file| file.len()));
        assert!(outcomes(&after).starts_with(&before), "a finished cell was lost");
        for record in after.outcomes() {
            let Record::Run(run) = record else { continue };
            after.read_picture(run.image.as_ref().unwrap()).unwrap();
            for score in after.scores(&run.cell.key()) {
                after.read_reference(&score.reference_image).unwrap();
            }
        }
    }
    let out = format!("killed-{store}");
    bench.well(&command(&out));
    assert_same(&bench.path("whole"), &bench.path(&out));
    let told = bench.well(&command(&out));
    assert!(told.starts_with("0 cells run"), "{told}");
    assert!(moments.len() >= least_moments, "kills came at {} moments of a run only: {moments:?}", moments.len());
}
