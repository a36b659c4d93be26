//! The store: what was made is found, what is damaged is made again, and keys hold what counts.

mod support;

use std::fs;

use glam::{Quat, Vec3};
use halflight_contract::{Cache, Flow, Meter, NoMeter, Quantity};
use halflight_references::{Error, Estimate, Provenance, Quality, Reference, ReferenceStore, Request, State, obtain};
use halflight_scenes::{Pose, Rgb, Scene};
use support::*;

const QUALITY: Quality = Quality { standard_error: 0.05, min_samples: 16, max_samples: 64, batches: 8 };

fn small() -> Scene {
    let points: Vec<_> = (0..40).map(|i| (Vec3::new(i as f32 * 0.1 - 2.0, 0.2, 0.0), Vec3::Z)).collect();
    let mut ground = plate(0.0, 5.0);
    ground.casts = false;
    scene(vec![spheres(&[(Vec3::new(0.0, 0.0, 0.7), 0.5)]), ground], vec![sky(1.0)], &points)
}

fn take(store: &ReferenceStore, scene: &Scene) -> (Estimate, String, bool) {
    take_with(store, scene, &mut NoMeter).expect("an estimate")
}

fn take_with(store: &ReferenceStore, scene: &Scene, meter: &mut dyn Meter) -> Result<(Estimate, String, bool), Error> {
    let frame = &scene.frame(0);
    let reference = &Reference::TRUTH;
    let request = Request { reference, quantity: Quantity::Direct, scene, frame, quality: &QUALITY, seed: 3 };
    obtain(store, &request, &Cache::in_memory(), meter)
}

#[test]
fn what_was_made_is_kept_and_what_is_damaged_is_made_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = ReferenceStore::open(folder.path().join("deep/references")).expect("a store");
    let scene = small();
    let (made, key, new) = take(&store, &scene);
    assert!(new);
    assert_eq!(take(&store, &scene), (made.clone(), key.clone(), false));

    let path = store.path(&key);
    let whole = fs::read(&path).expect("the file");
    for damaged in [0, 1, 63, 64, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..damaged]).expect("written");
        assert_eq!(store.get(&key), None, "cut to {damaged} bytes");
    }
    for at in (0..whole.len()).step_by(97) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        fs::write(&path, bytes).expect("written");
        assert_eq!(store.get(&key), None, "byte {at} changed");
    }
    assert_eq!(take(&store, &scene), (made.clone(), key.clone(), true));
    assert!(fs::read(&path).expect("the file") == whole, "equal estimates are equal bytes");
    assert_eq!(fs::read_dir(path.parent().expect("a folder")).expect("listed").count(), 1, "no partial file stays");
}

#[test]
fn a_file_says_where_it_comes_from_and_how_good_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = ReferenceStore::open(folder.path()).expect("a store");
    let mut scene = small();
    scene.objects[1].albedo = Rgb::new(0.5, 0.25, 0.0);
    let (made, key, _) = take(&store, &scene);
    let (_, provenance) = store.get_with_provenance(&key).expect("kept");
    assert_eq!((provenance.reference.as_str(), provenance.scene.as_str()), ("truth", scene.name.as_str()));
    assert_eq!((provenance.receivers, provenance.quality, provenance.seed), (40, QUALITY, 3));
    let achieved = provenance.achieved.expect("it is whole");
    assert_eq!(achieved.samples, made.samples.iter().map(|n| u64::from(*n)).sum::<u64>());
    assert_eq!(achieved.sampled, 40);
    // Points have albedo 1, and the sky's mean radiance is 1.
    let variance: f64 = made.variance.iter().map(|v| f64::from(v.element_sum()) / 3.0).sum::<f64>() / 40.0;
    assert!((achieved.level - 1.0).abs() < 1e-6, "{achieved:?}");
    assert!((achieved.standard_error - variance.sqrt()).abs() < 1e-9, "{achieved:?}");
    let above = made.variance.iter().filter(|v| (v.element_sum() / 3.0).sqrt() > 0.05).count();
    assert_eq!(achieved.above_target, above);
    let entries = store.entries().expect("listed");
    assert_eq!((entries.len(), &entries[0].state), (1, &State::Whole(provenance)));
}

#[test]
fn two_who_want_the_same_make_it_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = ReferenceStore::open(folder.path()).expect("a store");
    let scene = small();
    let all: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| take(&store, &scene))).collect();
        threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    });
    assert_eq!(all.iter().filter(|(_, _, made)| *made).count(), 1);
    assert!(all.iter().all(|(estimate, _, _)| *estimate == all[0].0));
    assert_eq!(store.entries().expect("listed").len(), 1);
}

#[test]
fn a_store_that_cannot_be_made_is_one_clear_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "x").expect("written");
    let message = ReferenceStore::open(file.join("store")).expect_err("no folder").to_string();
    assert!(message.contains("file/store"), "{message}");
}

#[test]
fn a_key_changes_with_what_counts_and_with_nothing_else() {
    let base = small();
    let frame = base.frame(0);
    let plain = Request {
        reference: &Reference::TRUTH,
        quantity: Quantity::Direct,
        scene: &base,
        frame: &frame,
        quality: &QUALITY,
        seed: 3,
    };
    let of = |scene: &Scene| Request { scene, frame: &scene.frame(0), ..plain }.key();
    let original = of(&base);
    assert_eq!((original.len(), of(&small())), (64, original.clone()));

    let mut same = base.clone();
    same.name = "another".into();
    same.objects[0].name = "another".into();
    same.objects.remove(1); // casts no shadow, and no receiver lies on it
    assert_eq!(of(&same), original);

    let mut others = vec![original];
    let mut add = |what: &str, key: String| {
        assert!(!others.contains(&key), "{what} does not count");
        others.push(key);
    };
    for id in ["sh-light:4", "sh-light:5", "sphere-proxies:8", "sphere-proxies:8:paper", "sh-light:4+sphere-proxies:8"]
    {
        add(id, Request { reference: &Reference::parse(id).expect(id), ..plain }.key());
    }
    add("seed", Request { seed: 4, ..plain }.key());
    add("quantity", Request { quantity: Quantity::Total, ..plain }.key());
    add("bounces", Request { quantity: Quantity::Indirect { bounces: 1 }, ..plain }.key());
    for quality in [
        Quality { standard_error: 0.04, ..QUALITY },
        Quality { min_samples: 8, ..QUALITY },
        Quality { max_samples: 128, ..QUALITY },
        Quality { batches: 16, ..QUALITY },
    ] {
        add("quality", Request { quality: &quality, ..plain }.key());
    }
    let mut with = |what: &str, change: &dyn Fn(&mut Scene)| {
        let mut scene = base.clone();
        change(&mut scene);
        add(what, of(&scene));
    };
    with("shape", &|scene| scene.objects[0] = spheres(&[(Vec3::new(0.0, 0.0, 0.7), 0.6)]));
    with("casting", &|scene| scene.objects[1].casts = true);
    with("emission", &|scene| scene.objects[1].emission = Rgb::X.into());
    with("light", &|scene| scene.lights[0] = sky(2.0).into());
    with("receivers", &|scene| *scene = scene.with_receivers(&[(Vec3::ZERO, Vec3::Z)]));
    with("pose", &|scene| {
        scene.objects[0].motion = vec![(0.0, Pose { rotation: Quat::IDENTITY, translation: Vec3::X })];
    });
}

#[test]
fn odd_numbers_of_receivers_and_colours_survive() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = ReferenceStore::open(folder.path()).expect("a store");
    let estimate = Estimate {
        mean: vec![Rgb::new(1.0, -2.0, 3.5e-30), Rgb::new(0.1, 0.0, 1e30), Rgb::ZERO],
        variance: vec![Rgb::new(1e-12, 2.0, 0.5), Rgb::ZERO, Rgb::ONE],
        samples: vec![64, u32::MAX, 0],
        batches: 16,
    };
    let layout = halflight_scenes::Layout::List;
    let provenance = Provenance {
        key: "odd".into(),
        revision: "old".into(),
        reference: "truth".into(),
        quantity: "direct".into(),
        scene: "Ünder".into(),
        frame: 0,
        receivers: 3,
        seed: 1,
        quality: QUALITY,
        achieved: None,
    };
    store.put(&estimate, layout, &provenance).expect("kept");
    assert_eq!(store.get_with_provenance("odd"), Some((estimate, provenance.clone())));
    assert_eq!(store.get("even"), None);
    fs::rename(store.path("odd"), store.path("even")).expect("renamed");
    assert_eq!(store.get("even"), None, "one estimate was taken for another");
    assert_eq!(store.state("even"), Some(State::Damaged));
}

/// Cancels at a report.
struct Impatient(u64);

impl Meter for Impatient {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { Flow::Cancel } else { Flow::Continue }
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

/// Counts receivers that were sampled.
struct Counting(u64);

impl Meter for Counting {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, done: u64, total: u64) -> Flow {
        if self.0 == 0 {
            self.0 = total - done;
        }
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}

#[test]
fn what_was_broken_off_goes_on_to_the_same_bits() {
    let points: Vec<_> = (0..3000).map(|i| (Vec3::new(i as f32 * 1e-3 - 1.5, 0.2, 0.0), Vec3::Z)).collect();
    let scene = small().with_receivers(&points);
    let fresh = tempfile::tempdir().expect("a folder");
    let (whole, key, _) = take(&ReferenceStore::open(fresh.path()).expect("a store"), &scene);

    let folder = tempfile::tempdir().expect("a folder");
    let store = ReferenceStore::open(folder.path()).expect("a store");
    assert!(take_with(&store, &scene, &mut Impatient(3)).is_err());
    let begun = folder.path().join(format!("{key}.begun"));
    let bytes = fs::read(&begun).expect("what was done");
    let Some(State::Begun { provenance, done, in_use: false }) = store.state(&key) else { panic!("it was begun") };
    assert!((256..3000).contains(&done) && provenance.receivers == 3000 && provenance.key == key);
    // What someone works on is known, and waited for until the meter loses its patience.
    let held = fs::File::open(&begun).expect("the file");
    held.lock().expect("locked");
    assert!(matches!(store.state(&key), Some(State::Begun { in_use: true, .. })));
    assert!(take_with(&store, &scene, &mut Impatient(2)).is_err());
    drop(held);
    assert!(fs::read(&begun).expect("the file") == bytes, "it was written to while in use");
    for spoil in ["nothing", "cut", "changed", "more"] {
        let mut spoilt = bytes.clone();
        match spoil {
            "cut" => spoilt.truncate(bytes.len() - 5),
            "changed" => spoilt[bytes.len() - 40] ^= 4,
            "more" => spoilt.extend([7; 100]),
            _ => {}
        }
        fs::write(&begun, spoilt).expect("written");
        let mut left = Counting(0);
        let (resumed, _, made) = take_with(&store, &scene, &mut left).expect("an estimate");
        assert!(made && resumed == whole, "{spoil}");
        // The first slab is whole in any case, the second where nothing was spoilt before its end.
        let first_slab = 256;
        assert!(left.0 <= 3000 - first_slab, "{spoil}: {} left", left.0);
        assert!(!begun.exists());
        fs::remove_file(store.path(&key)).expect("removed");
    }
}
