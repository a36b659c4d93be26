//! Derived data: what several methods need of a scene, made once on first need and shared.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use halflight_scenes::{Content, Scene};

use crate::disk;
use crate::{Job, Meter, Result};

/// A recipe for a piece of derived data: a sphere set, SH lights, a hierarchy.
pub trait Derived: 'static {
    /// What is made.
    type Value: Send + Sync + 'static;
    /// Short name for reports and cache files.
    const NAME: &'static str;
    /// Raise it when the recipe changes its result.
    const REVISION: &'static str;
    /// Identity by content: equal keys mean equal values, whatever the scene is called.
    fn key(&self, scene: &Scene) -> String;
    /// Makes the value.
    fn make(&self, job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<Self::Value>;
    /// How to keep the value on disk, if that is worth while.
    fn codec(&self) -> Option<Codec<Self::Value>> {
        None
    }
}

/// Turns a value into bytes and back; `decode` answers `None` to bytes that it did not write.
pub struct Codec<V> {
    /// Value to bytes.
    pub encode: fn(&V) -> Vec<u8>,
    /// Bytes to value.
    pub decode: fn(&[u8]) -> Option<V>,
}

/// Nanoseconds that making something took: without what it derived in turn while in memory, with it on disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuildTime(pub u64);

/// A recipe's type and key.
pub(crate) type SlotKey = (TypeId, String);

/// The build time of one piece of derived data.
#[derive(Clone)]
pub(crate) struct Charge {
    key: SlotKey,
    name: &'static str,
    time: BuildTime,
}

/// A value, with its build time and those of all that it was derived from.
type Slot = (Arc<dyn Any + Send + Sync>, Arc<Vec<Charge>>);

/// Derived data by recipe and content, in memory and, where a recipe has a codec and the cache a folder, on disk.
#[derive(Default)]
pub struct Cache {
    folder: Option<PathBuf>,
    slots: Mutex<HashMap<SlotKey, Slot>>,
}

impl Cache {
    /// A cache in memory alone.
    pub fn in_memory() -> Self {
        Cache::default()
    }

    /// A cache that also keeps files in a folder, which is made on first need.
    pub fn in_folder(folder: &Path) -> Self {
        Cache { folder: Some(folder.to_path_buf()), slots: Mutex::default() }
    }

    pub(crate) fn derive<D: Derived>(
        &self,
        recipe: &D,
        job: &Job<'_, '_>,
        meter: &mut dyn Meter,
    ) -> Result<Arc<D::Value>> {
        let key: SlotKey = (TypeId::of::<D>(), recipe.key(job.scene));
        let held = self.slots.lock().expect("no recipe panics while holding the lock").get(&key).cloned();
        let (value, charges) = match held {
            Some(slot) => slot,
            None => {
                let slot = self.load_or_make(recipe, &key, job, meter)?;
                self.slots.lock().expect("as above").entry(key).or_insert(slot).clone()
            }
        };
        charge(&charges, job, meter);
        Ok(value.downcast().expect("slots are keyed by the recipe's type"))
    }

    fn load_or_make<D: Derived>(
        &self,
        recipe: &D,
        key: &SlotKey,
        job: &Job<'_, '_>,
        meter: &mut dyn Meter,
    ) -> Result<Slot> {
        let file = recipe.codec().zip(self.folder.as_deref()).map(|(codec, folder)| {
            let name = Content::of_parts([D::NAME.as_bytes(), D::REVISION.as_bytes(), key.1.as_bytes()]);
            (codec, folder.join(format!("{}-{name}", D::NAME)))
        });
        if let Some((codec, path)) = &file
            && let Some((time, value)) =
                disk::read(path).and_then(|(time, bytes)| Some((time, (codec.decode)(&bytes)?)))
        {
            return Ok((Arc::new(value), Arc::new(vec![Charge { key: key.clone(), name: D::NAME, time }])));
        }
        let (nested_before, start) = (job.deriving.get(), Instant::now());
        job.recipes.borrow_mut().push(Vec::new());
        let made = recipe.make(job, meter);
        let mut charges = job.recipes.borrow_mut().pop().expect("pushed above");
        let value = made?;
        let total = start.elapsed().as_nanos() as u64;
        let own = BuildTime(total - (job.deriving.get() - nested_before));
        job.deriving.set(nested_before + total);
        charges.push(Charge { key: key.clone(), name: D::NAME, time: own });
        if let Some((codec, path)) = &file {
            let all = BuildTime(charges.iter().map(|charge| charge.time.0).sum());
            disk::write(path, all, &(codec.encode)(&value))?;
        }
        Ok((Arc::new(value), Arc::new(charges)))
    }
}

/// Charges build times to the recipe that is being made or else to the meter, each piece of data once.
fn charge(charges: &[Charge], job: &Job<'_, '_>, meter: &mut dyn Meter) {
    if let Some(recipe) = job.recipes.borrow_mut().last_mut() {
        for charge in charges {
            if recipe.iter().all(|present| present.key != charge.key) {
                recipe.push(charge.clone());
            }
        }
        return;
    }
    let mut charged = job.charged.borrow_mut();
    for Charge { key, name, time } in charges {
        if charged.insert(key.clone()) {
            meter.derived(name, time.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::time::Duration;

    use halflight_scenes::{Bodies, Placement};

    use super::*;
    use crate::{Backend, Error, Flow, NoMeter, Params};

    fn scene(name: &str) -> Scene {
        Scene {
            name: name.into(),
            purpose: String::new(),
            content: Content::of(name.as_bytes()),
            objects: Vec::new(),
            lights: Vec::new(),
            camera: None,
            placement: Placement::Points(Arc::default()),
            frame_count: 1,
            fps: 1.0,
            notices: Vec::new(),
            bodies: Bodies::default(),
        }
    }

    /// Keeps what it is charged.
    #[derive(Default)]
    struct Bill(Vec<(&'static str, u64)>);

    impl Bill {
        fn names(&self) -> Vec<&'static str> {
            self.0.iter().map(|(name, _)| *name).collect()
        }
    }

    impl Meter for Bill {
        fn begin(&mut self, _: &'static str) {}
        fn end(&mut self) {}
        fn count(&mut self, _: &'static str, _: u64) {}
        fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
            Flow::Continue
        }
        fn derived(&mut self, what: &'static str, nanoseconds: u64) {
            self.0.push((what, nanoseconds));
        }
    }

    /// Runs `work` with a job on that cache.
    fn with_job<T>(cache: &Cache, work: impl FnOnce(&Job<'_, '_>) -> T) -> T {
        let (scene, params) = (scene("a"), Params::default());
        work(&Job::new(&scene, &params, 0, Backend::Cpu, cache))
    }

    /// A number, slowly, with a count of how often it was made.
    struct Leaf<'a>(u64, &'a AtomicU64);

    const LEAF_TIME: Duration = Duration::from_millis(20);

    impl Derived for Leaf<'static> {
        type Value = u64;
        const NAME: &'static str = "leaf";
        const REVISION: &'static str = "1";
        fn key(&self, _: &Scene) -> String {
            self.0.to_string()
        }
        fn make(&self, _: &Job<'_, '_>, _: &mut dyn Meter) -> Result<u64> {
            self.1.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(LEAF_TIME);
            Ok(self.0)
        }
        fn codec(&self) -> Option<Codec<u64>> {
            let decode = |bytes: &[u8]| Some(u64::from_le_bytes(bytes.try_into().ok()?));
            Some(Codec { encode: |value| value.to_le_bytes().to_vec(), decode })
        }
    }

    static UNCOUNTED: AtomicU64 = AtomicU64::new(0);

    /// Derives two leaves, one of them twice.
    struct Branch;

    impl Derived for Branch {
        type Value = u64;
        const NAME: &'static str = "branch";
        const REVISION: &'static str = "1";
        fn key(&self, _: &Scene) -> String {
            String::new()
        }
        fn make(&self, job: &Job<'_, '_>, meter: &mut dyn Meter) -> Result<u64> {
            let leaf = |value, meter: &mut dyn Meter| job.derive(&Leaf(value, &UNCOUNTED), meter);
            Ok(*leaf(1, meter)? + *leaf(2, meter)? + *leaf(1, meter)?)
        }
    }

    #[test]
    fn data_is_made_once_and_charged_to_every_job_that_uses_it_but_once_each() {
        static MADE: AtomicU64 = AtomicU64::new(0);
        let cache = Cache::in_memory();
        let [first, second] = [0; 2].map(|_| {
            let mut bill = Bill::default();
            let value = with_job(&cache, |job| {
                job.derive(&Leaf(7, &MADE), &mut bill).expect("makes");
                job.derive(&Leaf(7, &MADE), &mut bill).expect("is held")
            });
            assert_eq!(*value, 7);
            bill.0
        });
        assert_eq!(MADE.load(Ordering::Relaxed), 1);
        assert_eq!(first, second);
        assert_eq!(first.len(), 1);
        assert!(first[0].1 >= LEAF_TIME.as_nanos() as u64);
    }

    #[test]
    fn what_was_derived_in_turn_is_charged_under_its_own_name_and_not_twice() {
        let cache = Cache::in_memory();
        let mut bill = Bill::default();
        with_job(&cache, |job| {
            assert_eq!(*job.derive(&Branch, &mut bill).expect("makes"), 4);
            job.derive(&Leaf(2, &UNCOUNTED), &mut bill).expect("is held");
        });
        assert_eq!(bill.names(), ["leaf", "leaf", "branch"]);
        assert!(bill.0[2].1 < LEAF_TIME.as_nanos() as u64, "the branch's own time: {:?}", bill.0);
        let mut again = Bill::default();
        with_job(&cache, |job| job.derive(&Branch, &mut again).expect("is held"));
        assert_eq!(again.0, bill.0);
    }

    #[test]
    fn a_file_stands_in_for_making_with_the_build_time_of_then() {
        static MADE: AtomicU64 = AtomicU64::new(0);
        let folder = tempfile::tempdir().expect("a folder");
        let derive = || {
            let mut bill = Bill::default();
            let cache = Cache::in_folder(folder.path());
            let value = with_job(&cache, |job| job.derive(&Leaf(9, &MADE), &mut bill)).expect("derives");
            (*value, bill.0)
        };
        let first = derive();
        assert_eq!(derive(), first);
        assert_eq!(MADE.load(Ordering::Relaxed), 1);
        let files: Vec<_> =
            std::fs::read_dir(folder.path()).expect("a folder").map(|f| f.expect("a file").path()).collect();
        assert_eq!(files.len(), 1, "no partial file stays: {files:?}");
        std::fs::write(&files[0], b"torn").expect("writes");
        assert_eq!(derive().0, 9);
        assert_eq!(MADE.load(Ordering::Relaxed), 2);
    }

    /// Fails the first time.
    struct Fails<'a>(&'a AtomicU64);

    impl Derived for Fails<'static> {
        type Value = ();
        const NAME: &'static str = "fails";
        const REVISION: &'static str = "1";
        fn key(&self, _: &Scene) -> String {
            String::new()
        }
        fn make(&self, _: &Job<'_, '_>, _: &mut dyn Meter) -> Result<()> {
            if self.0.fetch_add(1, Ordering::Relaxed) == 0 { Err(Error::Cancelled) } else { Ok(()) }
        }
    }

    #[test]
    fn an_error_is_not_kept() {
        static TRIES: AtomicU64 = AtomicU64::new(0);
        let cache = Cache::in_memory();
        with_job(&cache, |job| {
            assert!(matches!(job.derive(&Fails(&TRIES), &mut NoMeter), Err(Error::Cancelled)));
            let mut bill = Bill::default();
            job.derive(&Fails(&TRIES), &mut bill).expect("makes");
            assert_eq!(bill.names(), ["fails"]);
        });
    }

    #[test]
    fn threads_may_write_one_file_at_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("value");
        let (bytes, time) = (vec![5u8; 1 << 16], BuildTime(3));
        std::thread::scope(|scope| {
            let write = || (0..20).try_for_each(|_| disk::write(&path, time, &bytes));
            let writers: Vec<_> = (0..4).map(|_| scope.spawn(write)).collect();
            writers.into_iter().for_each(|writer| writer.join().expect("no panic").expect("writes"));
        });
        assert_eq!(disk::read(&path), Some((time, bytes)));
    }
}
