//! What cuts through sphere hierarchies gain and cost (Ren et al. 2006, §6.3): time of a thread, sizes of cuts, the error that they
//! add, and how much larger it jumps between neighbours of two clusters than of one.
//!
//! `cargo bench -p halflight-shexp --bench cuts -- SCENE [NAME=VALUE]… [-- NAME=VALUE,… …]`: settings for all, then settings to
//! compare, each by commas.

use std::collections::BTreeMap;
use std::time::Instant;

use halflight_blockers::clusters;
use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, Output, Params, Prepared, Quantity};
use halflight_scenes::{Frame, Layout, Receivers, Rgb, Scene};

/// Frames looked at, and evaluations of each.
const FRAMES: usize = 3;
const ROUNDS: usize = 5;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let mut parts = args.split(|arg| arg == "--");
    let common = parts.next().unwrap_or_default();
    let (name, common) = common.split_first().map_or(("spheres-60", common), |(name, rest)| (name.as_str(), rest));
    let compared: Vec<String> = match parts.next() {
        Some(compared) => compared.to_vec(),
        None => ["cut=10", "cut=20", "cut=25", "cut=30", "cut=25,ratio=false"].map(String::from).to_vec(),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("a pool of one thread").install(|| compare(name, common, &compared));
}

fn compare(name: &str, common: &[String], compared: &[String]) {
    let scene = halflight_scenes::find(name).expect("a shipped scene");
    let method: &dyn Method = &halflight_shexp::Hyb;
    let folder = std::env::var_os("HALFLIGHT_CACHE").map_or_else(std::env::temp_dir, Into::into);
    let cache = Cache::in_folder(&folder);
    let settings = |text: &str| {
        let all = common.iter().map(String::as_str).chain(text.split(','));
        let pairs: Vec<_> = all.filter_map(|setting| setting.split_once('=')).collect();
        Params::resolve(method.info().params, pairs).expect("settings of the method")
    };
    let all: Vec<(&str, Params)> = std::iter::once("cut=0")
        .chain(compared.iter().map(String::as_str))
        .map(|text| (text, settings(text)))
        .collect();
    let frames: Vec<Frame> = (0..scene.frame_count.min(FRAMES)).map(|index| scene.frame(index)).collect();
    let mut ready: Vec<Candidate<'_>> =
        all.iter().map(|(text, params)| Candidate::new(method, &scene, text, params, &cache)).collect();
    for _ in 0..ROUNDS {
        for frame in &frames {
            ready.iter_mut().for_each(|candidate| candidate.run(frame));
        }
    }
    let receivers: usize = frames.iter().map(|frame| frame.receivers.valid.iter().filter(|v| **v).count()).sum();
    println!("{name} {}: {} receivers", common.join(" "), receivers / frames.len());
    println!(
        "| setting | update ms | shade ms | accumulated a receiver | cut | largest | nodes | added error | worst | seams |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let last = &frames[frames.len() - 1].receivers;
    let exact = ready[0].radiance.clone();
    for candidate in &ready {
        candidate.print(last, &exact, receivers / frames.len(), ROUNDS * frames.len());
    }
}

/// A setting made ready.
struct Candidate<'s> {
    name: String,
    cluster: usize,
    prepared: Box<dyn Prepared + 's>,
    /// Milliseconds that all evaluations took.
    update: f64,
    shade: f64,
    radiance: Vec<Rgb>,
    counters: Counters,
}

impl<'s> Candidate<'s> {
    fn new(method: &dyn Method, scene: &'s Scene, name: &str, params: &Params, cache: &Cache) -> Self {
        let job = Job::new(scene, params, 1, Backend::Cpu, cache);
        let prepared = method.prepare(&job, &mut Counters::default()).expect("a shipped scene can be prepared");
        Candidate {
            name: name.into(),
            cluster: params.int("cluster"),
            prepared,
            update: 0.0,
            shade: 0.0,
            radiance: Vec::new(),
            counters: Counters::default(),
        }
    }

    fn run(&mut self, frame: &Frame) {
        self.counters = Counters::default();
        let start = time();
        self.prepared.update(frame, &mut self.counters).expect("a frame of the scene");
        let middle = time();
        self.prepared.evaluate(frame, Quantity::Direct, &mut self.counters).expect("direct light");
        self.shade += time() - middle;
        self.update += middle - start;
        self.radiance.resize(frame.receivers.len(), Rgb::ZERO);
        self.prepared.read(Output::Radiance(&mut self.radiance), &mut self.counters).expect("as many as receivers");
    }

    fn print(&self, receivers: &Receivers, exact: &[Rgb], count: usize, runs: usize) {
        let amount = |name: &str| self.counters.0.get(name).copied().unwrap_or(0) as f64;
        let valid = || (0..receivers.len()).filter(|&i| receivers.valid[i]);
        let level = valid().map(|i| grey(exact[i])).sum::<f32>() / valid().count() as f32;
        let error: Vec<f32> = self.radiance.iter().zip(exact).map(|(a, b)| (grey(*a) - grey(*b)) / level).collect();
        let rms = (valid().map(|i| error[i] * error[i]).sum::<f32>() / valid().count() as f32).sqrt();
        let worst = valid().map(|i| error[i].abs()).fold(0.0, f32::max);
        let clusters_met = amount("receiver clusters").max(1.0);
        println!(
            "| {} | {:.2} | {:.2} | {:.1} | {:.1} | {} | {:.0} | {:.3}% | {:.1}% | {} |",
            self.name,
            self.update / runs as f64,
            self.shade / runs as f64,
            amount("blockers accumulated") / count as f64,
            amount("spheres in cuts") / clusters_met,
            amount("largest cut"),
            amount("hierarchy nodes visited") / clusters_met,
            100.0 * rms,
            100.0 * worst,
            seams(receivers, &error, self.cluster),
        );
    }
}

/// Root mean square of what the error changes by between neighbours on a flat place, in percent: of two clusters, of one cluster.
fn seams(receivers: &Receivers, error: &[f32], cluster: usize) -> String {
    let Layout::Image { width, .. } = receivers.layout else { return "–".into() };
    let mut of = vec![usize::MAX; receivers.len()];
    for (number, members) in clusters(receivers, cluster).iter().enumerate() {
        members.iter().for_each(|&member| of[member] = number);
    }
    let mut sums = [(0.0f32, 0u32); 2];
    for a in (0..receivers.len().saturating_sub(width + 1)).filter(|a| receivers.valid[*a]) {
        for b in [a + 1, a + width] {
            let alike = receivers.valid[b] && receivers.geometric_normal[a].dot(receivers.geometric_normal[b]) > 0.999;
            let near = (receivers.position[a] - receivers.position[b]).dot(receivers.geometric_normal[a]).abs() < 1e-3;
            if alike && near && (b % width != 0 || b == a + width) {
                let sum = &mut sums[usize::from(of[a] == of[b])];
                *sum = (sum.0 + (error[a] - error[b]).powi(2), sum.1 + 1);
            }
        }
    }
    let [across, within] = sums.map(|(sum, count)| 100.0 * (sum / count.max(1) as f32).sqrt());
    format!("{across:.3} : {within:.3}")
}

fn grey(colour: Rgb) -> f32 {
    (colour.x + colour.y + colour.z) / 3.0
}

/// Milliseconds that this thread has run, or, where the system does not tell, of the clock.
fn time() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    nanoseconds.unwrap_or_else(|| START.get_or_init(Instant::now).elapsed().as_nanos() as f64) * 1e-6
}

/// Keeps what is counted.
#[derive(Default)]
struct Counters(BTreeMap<&'static str, u64>);

impl Meter for Counters {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, counter: &'static str, amount: u64) {
        *self.0.entry(counter).or_default() += amount;
    }
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}
