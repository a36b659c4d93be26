//! The plan: every cell, with what is to be done about it and why. Scenes are loaded and their receivers found, nothing else is computed or written here, so all that is
//! wrong with a request is found before any work.

use crate::settings::{Setting, grid};
use crate::suite::Entry;
use crate::{Error, judge};
use halflight_contract::{Backend, Method, Params, Phase, Quantity, Request, Support, Value};
use halflight_references::Reference;
use halflight_results::{Cell, Key, Record, Run, Store};
use halflight_scenes::{Frame, Scene};
use std::collections::{HashMap, HashSet};

/// What decides the results besides the entries.
#[derive(Clone, Debug)]
pub struct Terms {
    /// Seed of everything random.
    pub seed: u64,
    /// Where times are taken ([`halflight_results::Environment::class`]): results of another class are not reused.
    pub timed_on: String,
}

/// All that is to be run.
pub struct Plan {
    /// The scenes, each once.
    pub scenes: Vec<Stage>,
    /// The work, scene by scene.
    pub groups: Vec<Group>,
    /// Seed of everything random.
    pub seed: u64,
}

/// A scene and all its frames, posed.
pub struct Stage {
    /// The scene.
    pub scene: Scene,
    /// Its frames, as many of them as any group takes; each holds its receivers, about 80 bytes apiece.
    pub frames: Vec<Frame>,
}

/// The first frames of a scene, posed.
#[derive(Clone, Copy)]
struct Sequence {
    scene: usize,
    frames: usize,
}

/// A method with its parameters on all frames of a scene that are asked for.
#[derive(Clone)]
pub struct Group {
    /// Index into [`Plan::scenes`].
    pub scene: usize,
    /// The method.
    pub method: &'static dyn Method,
    /// Its parameters, complete.
    pub params: Params,
    /// What is computed.
    pub quantity: Quantity,
    /// Where.
    pub backend: Backend,
    /// Threads that times are taken on; those of all other work if nothing is said.
    pub threads: Option<usize>,
    /// The method's answer to the request.
    pub support: Support,
    /// One cell a frame.
    pub cells: Vec<Cell>,
    /// Frames in which nothing asks for light: no valid receiver.
    pub empty: Vec<u32>,
    /// What the cells' pictures are scored against.
    pub references: Vec<Reference>,
}

/// What is to be done about a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// It is run.
    Run,
    /// Its picture is in the store, its times are to be taken.
    Time,
    /// Its result is in the store.
    Cached,
    /// The method does not serve it, for this reason.
    Skip(String),
}

impl Group {
    /// `scene · method name=value …`, naming the parameters that are not at their default.
    pub fn label(&self, plan: &Plan) -> String {
        let defaults = Params::defaults(self.method.info().params);
        let usual: HashMap<_, _> = defaults.iter().collect();
        let set = self.params.iter().filter(|(name, value)| usual[name] != *value || *name == "order");
        let mut set: String = set.map(|(name, value)| format!(" {name}={value}")).collect();
        if let Some(threads) = self.threads {
            set += &format!(" on {threads} threads");
        }
        format!("{} · {}{set}", plan.scenes[self.scene].scene.name, self.method.info().id)
    }

    /// All that decides what is prepared: where it is equal, one group may be retuned to another.
    pub(crate) fn preparation(&self) -> (usize, &'static str, Quantity, Backend, Vec<String>) {
        let info = self.method.info();
        let fixed = |name: &str| info.params.iter().any(|spec| spec.name == name && spec.phase == Phase::Prepare);
        let values = self.params.iter().filter(|(name, _)| fixed(name)).map(|(_, value)| value.to_string());
        (self.scene, info.id, self.quantity, self.backend, values.collect())
    }

    /// What is to be done about one of the group's cells.
    pub fn state(&self, cell: &Cell, store: &Store) -> State {
        match (&self.support, store.outcome(&cell.key())) {
            (Support::Skip(why), _) => State::Skip(why.clone()),
            _ if self.empty.contains(&cell.frame) => State::Skip(format!("frame {} has no receiver", cell.frame)),
            // A failure is tried again: its cause may have lain outside the key, such as a full disk.
            (_, Some(Record::Run(run))) if has_picture(run, store) => {
                let timed = cell.timed_on.is_none() || store.times(&cell.key()).is_some();
                if timed { State::Cached } else { State::Time }
            }
            _ => State::Run,
        }
    }
}

impl Plan {
    /// Plans the entries: all combinations of scenes, methods and settings, equal ones once.
    ///
    /// # Errors
    /// A scene, method, parameter or reference is unknown or wrong.
    pub fn new(entries: &[Entry], terms: &Terms) -> Result<Self, Error> {
        let mut plan = Plan { scenes: Vec::new(), groups: Vec::new(), seed: terms.seed };
        let mut names: HashMap<String, usize> = HashMap::new();
        let mut known: HashMap<Vec<Key>, usize> = HashMap::new();
        for entry in entries {
            let jobs = jobs(entry)?;
            let quantities = entry.quantities.iter().map(|name| quantity(name)).collect::<Result<Vec<_>, _>>()?;
            for name in &scenes(entry) {
                let scene = match names.get(name) {
                    Some(scene) => *scene,
                    None => plan.add_scene(halflight_scenes::find(name)?),
                };
                names.insert(name.clone(), scene);
                let sequence = plan.pose(scene, entry.frames);
                let all = jobs.iter().flat_map(|job| quantities.iter().map(move |quantity| (job, *quantity)));
                for ((method, params), quantity) in all {
                    let group = plan.group(sequence, *method, params, quantity, &entry.references, terms)?;
                    let keys = group.cells.iter().map(Cell::key).collect();
                    match known.get(&keys) {
                        Some(&same) => merge(&mut plan.groups[same].references, group.references),
                        None => {
                            known.insert(keys, plan.groups.len());
                            plan.groups.push(group);
                        }
                    }
                }
            }
        }
        // Stable: within a scene, the order of the entries but for what one `prepare` serves, which goes in a row. A scene's
        // derived data are let go before the next one's.
        let mut first = HashMap::new();
        for (place, group) in plan.groups.iter().enumerate() {
            first.entry(group.preparation()).or_insert(place);
        }
        plan.groups.sort_by_key(|group| (group.scene, first[&group.preparation()]));
        Ok(plan)
    }

    /// The same work once for each number of threads; `class` says what times taken on so many hold for.
    #[must_use]
    pub fn on_threads(mut self, counts: &[usize], class: impl Fn(usize) -> String) -> Self {
        let on = |group: &Group, threads: usize| {
            let timed_on =
                |cell: &Cell| Cell { timed_on: cell.timed_on.as_ref().map(|_| class(threads)), ..cell.clone() };
            Group { threads: Some(threads), cells: group.cells.iter().map(timed_on).collect(), ..group.clone() }
        };
        // Side by side, so that they are timed side by side.
        self.groups = self.groups.iter().flat_map(|group| counts.iter().map(move |n| on(group, *n))).collect();
        self
    }

    /// Every cell with its group.
    pub fn cells(&self) -> impl Iterator<Item = (&Group, &Cell)> {
        self.groups.iter().flat_map(|group| group.cells.iter().map(move |cell| (group, cell)))
    }

    fn add_scene(&mut self, scene: Scene) -> usize {
        // The same content under two names is one scene.
        self.scenes.iter().position(|stage| stage.scene.content == scene.content).unwrap_or_else(|| {
            self.scenes.push(Stage { scene, frames: Vec::new() });
            self.scenes.len() - 1
        })
    }

    /// Poses the first so many frames of a scene, all if nothing is said.
    fn pose(&mut self, scene: usize, wanted: Option<usize>) -> Sequence {
        let Stage { scene: content, frames } = &mut self.scenes[scene];
        let count = wanted.unwrap_or(content.frame_count).min(content.frame_count);
        frames.extend((frames.len()..count).map(|frame| content.frame(frame)));
        Sequence { scene, frames: count }
    }

    fn group(
        &self,
        Sequence { scene, frames }: Sequence,
        method: &'static dyn Method,
        params: &Params,
        quantity: Quantity,
        references: &[String],
        terms: &Terms,
    ) -> Result<Group, Error> {
        let backend = Backend::Cpu;
        let Stage { scene: content, frames: posed } = &self.scenes[scene];
        let frames = &posed[..frames];
        let info = method.info();
        let revision = halflight_registry::revision(info.family());
        let cell = |frame: &Frame| Cell {
            scene: content.name.clone(),
            scene_hash: content.content.to_string(),
            method: info.id.to_owned(),
            revision: revision.unwrap_or("unregistered").to_owned(),
            params: params.iter().map(|(name, value)| (name.to_owned(), json(value))).collect(),
            backend: backend.to_string(),
            quantity: quantity.to_string(),
            seed: terms.seed,
            frame: frame.index as u32,
            receivers_hash: format!("{:016x}", frame.receivers.revision.0),
            timed_on: Some(terms.timed_on.clone()),
        };
        Ok(Group {
            scene,
            method,
            params: params.clone(),
            quantity,
            backend,
            threads: None,
            support: method.supports(&content.facts(), &Request { quantity, backend, params }),
            cells: frames.iter().map(cell).collect(),
            empty: frames.iter().filter(|f| !f.receivers.valid.contains(&true)).map(|f| f.index as u32).collect(),
            references: judge::references(references, quantity, params, content)?,
        })
    }
}

/// A quantity that makes a picture, by its name.
pub(crate) fn quantity(name: &str) -> Result<Quantity, Error> {
    let known = [Quantity::Direct, Quantity::Total].into_iter();
    let known = known.chain((1..=u8::MAX).map(|bounces| Quantity::Indirect { bounces }));
    let found = known.into_iter().find(|quantity| quantity.to_string() == name);
    found.ok_or_else(|| Error::unknown("quantity", name, ["direct", "indirect-N", "total"]))
}

/// The methods of an entry with every combination of its settings.
fn jobs(entry: &Entry) -> Result<Vec<(&'static dyn Method, Params)>, Error> {
    let methods = entry.methods.iter().map(|name| methods(name)).collect::<Result<Vec<_>, _>>()?.concat();
    let declared = |m: &&'static dyn Method| m.info().params.iter().map(|spec| spec.name);
    let known: HashSet<&str> = methods.iter().flat_map(declared).collect();
    let mut seen = HashSet::new();
    for setting in &entry.set {
        if !known.contains(setting.name.as_str()) {
            let mut known: Vec<&str> = known.into_iter().collect();
            known.sort_unstable();
            return Err(Error::unknown("parameter", &setting.name, known));
        }
        if !seen.insert(&setting.name) {
            let message = "expected each parameter once; several values go into one setting, such as a,b".to_owned();
            return Err(Error::Setting { text: setting.name.clone(), message });
        }
    }
    let mut jobs = Vec::new();
    for method in methods {
        jobs.extend(combinations(method, &entry.set)?.into_iter().map(|params| (method, params)));
    }
    Ok(jobs)
}

/// Every combination of those settings that the method declares.
fn combinations(method: &'static dyn Method, set: &[Setting]) -> Result<Vec<Params>, Error> {
    let specs = method.info().params;
    let own: Vec<&Setting> = set.iter().filter(|s| specs.iter().any(|spec| spec.name == s.name)).collect();
    let resolve = |point: Vec<(String, String)>| {
        Params::resolve(specs, point.iter().map(|(name, text)| (name.as_str(), text.as_str())))
            .map_err(|source| Error::Param { method: method.info().id, source })
    };
    let points = grid(&own, specs).map_err(|source| Error::Param { method: method.info().id, source })?;
    points.into_iter().map(resolve).collect()
}

/// The scenes of an entry, `all` spelled out.
fn scenes(entry: &Entry) -> Vec<String> {
    let named = |name: &String| match name.as_str() {
        "all" => halflight_scenes::shipped().into_iter().map(|(name, ..)| name).collect(),
        name => vec![name.to_owned()],
    };
    entry.scenes.iter().flat_map(named).collect()
}

/// The registered methods that a name stands for: one by its id, those of a family by `family/*`, every one by `all`.
fn methods(name: &str) -> Result<Vec<&'static dyn Method>, Error> {
    let family = name.strip_suffix("/*");
    let named = |method: &&'static dyn Method| name == "all" || family == Some(method.info().family());
    let found: Vec<_> = halflight_registry::methods().into_iter().filter(named).collect();
    if found.is_empty() { Ok(vec![method(name)?]) } else { Ok(found) }
}

/// A registered method by its id.
pub(crate) fn method(id: &str) -> Result<&'static dyn Method, Error> {
    let known = || halflight_registry::methods().into_iter().map(|m| m.info().id);
    halflight_registry::find(id).ok_or_else(|| Error::unknown("method", id, known()))
}

/// A method's parameters with these settings, each of one value.
pub(crate) fn single(method: &'static dyn Method, set: &[Setting]) -> Result<Params, Error> {
    let wrong = |source| Error::Param { method: method.info().id, source };
    let points = grid(&set.iter().collect::<Vec<_>>(), method.info().params).map_err(wrong)?;
    let [point] = points.as_slice() else {
        let of = |s: &Setting| {
            format!("{}={}", s.name, s.values.iter().map(ToString::to_string).collect::<Vec<_>>().join(","))
        };
        let text = set.iter().map(of).collect::<Vec<_>>().join(" --set ");
        return Err(Error::Setting { text, message: "expected one value here".into() });
    };
    let settings = point.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    Params::resolve(method.info().params, settings).map_err(wrong)
}

fn has_picture(run: &Run, store: &Store) -> bool {
    run.image.as_ref().is_none_or(|image| store.has_image(image))
}

fn merge(into: &mut Vec<Reference>, more: Vec<Reference>) {
    for reference in more {
        if !into.contains(&reference) {
            into.push(reference);
        }
    }
}

/// A parameter as cells have it.
pub(crate) fn json(value: Value) -> serde_json::Value {
    match value {
        Value::Int(v) => v.into(),
        Value::Float(v) => v.into(),
        Value::Choice(v) => v.into(),
        Value::Flag(v) => v.into(),
    }
}
