//! Rates of the figures of Ren et al. 2006 at their true sizes: frames a second of update and shade, all threads, by the clock.
//!
//! `cargo bench -p halflight-shexp --bench rates -- [ROUNDS [CASE]…]`: cases are those of [`CASES`] whose names begin so; `HALFLIGHT_SIMD=avx2`
//! leaves the widest instructions out, `RAYON_NUM_THREADS` sets the threads.

use std::time::Instant;

use glam::Vec3;
use halflight_contract::{Backend, Cache, Flow, Job, Meter, Method, Params, Prepared, Quantity};
use halflight_scenes::{Frame, Scene};

/// A setting with the figure that it stands for.
struct Case {
    name: &'static str,
    scene: &'static str,
    /// Receivers on a grid of so many a side, or those of the scene.
    side: Option<usize>,
    method: &'static dyn Method,
    params: &'static [(&'static str, &'static str)],
    /// Frames a second asked of two cores.
    target: f64,
}

const FIG_8: Case = Case {
    name: "fig. 8, PS*-2",
    scene: "spheres-60",
    side: Some(200),
    method: &halflight_shexp::PsStar,
    params: &[("order", "6"), ("p", "2")],
    target: 120.0,
};

const CASES: &[Case] = &[
    FIG_8,
    Case { name: "fig. 8, HYB", method: &halflight_shexp::Hyb, params: &[("order", "6")], ..FIG_8 },
    Case {
        name: "dino size",
        scene: "herd@1.11",
        side: None,
        method: &halflight_shexp::Hyb,
        params: &[("cut", "20")],
        target: 40.0,
    },
    Case {
        name: "battle size",
        scene: "battle@1.238",
        side: None,
        method: &halflight_shexp::Hyb,
        params: &[("spheres", "61"), ("cut", "20")],
        target: 60.0,
    },
];

/// Frames that a scene's case goes through.
const FRAMES: usize = 3;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let rounds = args.first().and_then(|arg| arg.parse().ok()).unwrap_or(15);
    let chosen = |case: &Case| args.len() < 2 || args[1..].iter().any(|name| case.name.starts_with(name.as_str()));
    let folder = std::env::var_os("HALFLIGHT_CACHE").map_or_else(std::env::temp_dir, Into::into);
    let cache = Cache::in_folder(&folder);
    let cases: Vec<(&Case, Scene)> = CASES.iter().filter(|case| chosen(case)).map(|case| (case, scene(case))).collect();
    let mut ready: Vec<Running<'_>> = cases.iter().map(|(case, scene)| Running::new(case, scene, &cache)).collect();
    for _ in 0..rounds {
        ready.iter_mut().for_each(Running::round);
    }
    println!("{} threads, {:?}", rayon::current_num_threads(), halflight_sh::Simd::best());
    println!("| case | receivers | frames a second: median, quartiles | asked for | update ms | shade ms | quickest |");
    println!("|---|---|---|---|---|---|---|");
    ready.iter().for_each(Running::print);
}

fn scene(case: &Case) -> Scene {
    let scene = halflight_scenes::find(case.scene).expect("a shipped scene");
    let Some(side) = case.side else { return scene };
    let at = |i: usize| (i as f32 / (side - 1) as f32 - 0.5) * 6.4;
    let points: Vec<_> = (0..side * side).map(|i| (Vec3::new(at(i % side), at(i / side), 0.0), Vec3::Z)).collect();
    scene.with_receivers(&points)
}

/// A case made ready, with milliseconds of update and shade, frame by frame.
struct Running<'s> {
    case: &'s Case,
    frames: Vec<Frame>,
    prepared: Box<dyn Prepared + 's>,
    times: Vec<[f64; 2]>,
}

impl<'s> Running<'s> {
    fn new(case: &'s Case, scene: &'s Scene, cache: &Cache) -> Self {
        let params = Params::resolve(case.method.info().params, case.params.iter().copied()).expect("settings");
        let job = Job::new(scene, &params, 1, Backend::Cpu, cache);
        let prepared = case.method.prepare(&job, &mut Silent).expect("a shipped scene can be prepared");
        let frames = (0..scene.frame_count.min(FRAMES)).map(|index| scene.frame(index)).collect();
        let mut running = Running { case, frames, prepared, times: Vec::new() };
        running.round(); // not timed: receivers are clustered, scratch is touched
        running.times.clear();
        running
    }

    fn round(&mut self) {
        for frame in &self.frames {
            let start = Instant::now();
            self.prepared.update(frame, &mut Silent).expect("a frame of the scene");
            let middle = Instant::now();
            self.prepared.evaluate(frame, Quantity::Direct, &mut Silent).expect("direct light");
            let [update, shade] = [middle - start, middle.elapsed()].map(|time| 1e3 * time.as_secs_f64());
            self.times.push([update, shade]);
        }
    }

    fn print(&self) {
        let sorted = |value: fn(&[f64; 2]) -> f64| {
            let mut values: Vec<f64> = self.times.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let (whole, update, shade) = (sorted(|t| t[0] + t[1]), sorted(|t| t[0]), sorted(|t| t[1]));
        let (middle, quarter) = (whole.len() / 2, whole.len() / 4);
        let valid: usize = self.frames[0].receivers.valid.iter().filter(|valid| **valid).count();
        println!(
            "| {} | {valid} | {:.1}, {:.1}–{:.1} | {} | {:.2} | {:.2} | {:.1} |",
            self.case.name,
            1e3 / whole[middle],
            1e3 / whole[whole.len() - 1 - quarter],
            1e3 / whole[quarter],
            self.case.target,
            update[middle],
            shade[middle],
            1e3 / whole[0],
        );
    }
}

/// Nobody is told.
struct Silent;

impl Meter for Silent {
    fn begin(&mut self, _: &'static str) {}
    fn end(&mut self) {}
    fn count(&mut self, _: &'static str, _: u64) {}
    fn progress(&mut self, _: &'static str, _: u64, _: u64) -> Flow {
        Flow::Continue
    }
    fn derived(&mut self, _: &'static str, _: u64) {}
}
