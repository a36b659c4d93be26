//! The store: what was made is found, what is damaged is made again, and keys hold what counts.

mod support;

use std::fs;

use glam::{Quat, Vec3};
use halflight_contract::{Cache, NoMeter};
use halflight_references::{Estimate, Quality, Reference, ReferenceStore, key, obtain};
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
    let (cache, frame) = (Cache::in_memory(), scene.frame(0));
    obtain(store, &Reference::Truth, scene, &frame, &QUALITY, 3, &cache, &mut NoMeter).expect("an estimate")
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
    let of = |scene: &Scene| key(&Reference::Truth, scene, &scene.frame(0), &QUALITY, 3);
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
    let frame = base.frame(0);
    add("reference", key(&Reference::ShLight { order: 4 }, &base, &frame, &QUALITY, 3));
    add("order", key(&Reference::ShLight { order: 5 }, &base, &frame, &QUALITY, 3));
    add("proxies", key(&Reference::parse("sphere-proxies:8").expect("one"), &base, &frame, &QUALITY, 3));
    add("rule", key(&Reference::parse("sphere-proxies:8:paper").expect("one"), &base, &frame, &QUALITY, 3));
    add("seed", key(&Reference::Truth, &base, &frame, &QUALITY, 4));
    for quality in [
        Quality { standard_error: 0.04, ..QUALITY },
        Quality { min_samples: 8, ..QUALITY },
        Quality { max_samples: 128, ..QUALITY },
        Quality { batches: 16, ..QUALITY },
    ] {
        add("quality", key(&Reference::Truth, &base, &frame, &quality, 3));
    }
    let mut with = |what: &str, change: &dyn Fn(&mut Scene)| {
        let mut scene = base.clone();
        change(&mut scene);
        add(what, of(&scene));
    };
    with("shape", &|scene| scene.objects[0] = spheres(&[(Vec3::new(0.0, 0.0, 0.7), 0.6)]));
    with("casting", &|scene| scene.objects[1].casts = true);
    with("light", &|scene| scene.lights[0] = sky(2.0));
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
    store.put("odd", &estimate, layout, "a note").expect("kept");
    assert_eq!(store.get("odd"), Some(estimate));
    assert_eq!(store.get("even"), None);
}
