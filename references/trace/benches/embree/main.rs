//! Occlusion rays a second on one thread, ours and Embree's in turn on the same triangles and rays. `run`, beside this
//! file, builds the other side and starts it; without it there is nothing to compare with.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Instant;

use glam::Vec3;
use halflight_scenes::{Mesh, Shape, find};
use halflight_trace::{Geometry, Ray, World, clearance};

#[path = "../random.rs"]
mod random;
use random::Random;

const RAYS: usize = 1 << 17;
/// Rays of one receiver.
const BUNDLE: usize = 64;
/// Rays of one call: as many as are never shared between threads.
const BATCH: usize = 512;
/// Rays of one turn: short, so that whatever else the machine does meets all sides alike.
const SLICE: usize = 1 << 14;

const MESHES: [(&str, &str); 4] = [
    ("teapot-sunset", "teapot"),
    ("dino-elephant-courtyard", "elephant"),
    ("dino-elephant-courtyard", "dino"),
    ("bunny-studio", "bunny"),
];

/// From points around the mesh towards points in its box.
fn incoherent(random: &mut Random, mesh: &Mesh) -> Vec<Ray> {
    let low = mesh.positions.iter().fold(Vec3::INFINITY, |low, p| low.min(*p));
    let high = mesh.positions.iter().fold(Vec3::NEG_INFINITY, |high, p| high.max(*p));
    let (center, half) = ((low + high) / 2.0, (high - low) / 2.0);
    let mut ray = |_| {
        let origin = center + 1.2 * half.length() * random.direction();
        let target = center + half * Vec3::new(random.signed(), random.signed(), random.signed());
        Ray { origin, direction: (target - origin).normalize(), t_min: 0.0, t_max: f32::INFINITY }
    };
    (0..RAYS).map(&mut ray).collect()
}

/// From points on the surface, cosine-distributed about the normal.
fn receivers(random: &mut Random, mesh: &Mesh) -> Vec<Ray> {
    let reach = mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
    let mut bundle = |_| {
        let triangle = (random.unit() * mesh.triangles.len() as f32) as usize;
        let normal = mesh.face_normal(triangle);
        let origin = mesh.corners(triangle).iter().sum::<Vec3>() / 3.0 + clearance(reach) * normal;
        let direction = |_| (normal + 0.999 * random.direction()).normalize();
        let ray = |direction| Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY };
        (0..BUNDLE).map(direction).map(ray).collect::<Vec<_>>()
    };
    (0..RAYS / BUNDLE).flat_map(&mut bundle).collect()
}

/// Embree in a process of its own.
struct Embree(Child, BufReader<ChildStdout>);

impl Embree {
    fn new(driver: &str, folder: &Path, mesh: &Mesh, rays: &[Ray]) -> Self {
        let floats = |vectors: &mut dyn Iterator<Item = Vec3>| -> Vec<u8> {
            vectors.flat_map(|v| v.to_array()).flat_map(f32::to_le_bytes).collect()
        };
        let files = ["vertices", "triangles", "rays"].map(|name| folder.join(name));
        let indices: Vec<u8> = mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect();
        std::fs::write(&files[0], floats(&mut mesh.positions.iter().copied())).unwrap();
        std::fs::write(&files[1], indices).unwrap();
        std::fs::write(&files[2], floats(&mut rays.iter().flat_map(|ray| [ray.origin, ray.direction]))).unwrap();
        let mut command = Command::new(driver);
        let mut child = command.args(files).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let answers = BufReader::new(child.stdout.take().unwrap());
        Embree(child, answers)
    }

    /// Seconds, and rays blocked.
    fn trace(&mut self, robust: bool, first: usize) -> (f64, usize) {
        writeln!(self.0.stdin.as_mut().unwrap(), "{} {first} {SLICE}", u8::from(robust)).unwrap();
        let mut answer = String::new();
        self.1.read_line(&mut answer).unwrap();
        let (seconds, blocked) = answer.trim().split_once(' ').expect("an answer of Embree's");
        (seconds.parse().unwrap(), blocked.parse().unwrap())
    }
}

fn ours(world: &World, rays: &[Ray], bundled: bool) -> (f64, usize) {
    let mut blocked = [false; BATCH];
    let mut count = 0;
    let start = Instant::now();
    for batch in rays.chunks(if bundled { BUNDLE } else { BATCH }) {
        let blocked = &mut blocked[..batch.len()];
        if bundled {
            let directions: [Vec3; BUNDLE] = std::array::from_fn(|i| batch[i].direction);
            world.occluded_from(batch[0].origin, 0.0, &directions, blocked);
        } else {
            world.occluded(batch, blocked);
        }
        count += blocked.iter().filter(|blocked| **blocked).count();
    }
    (start.elapsed().as_secs_f64(), count)
}

/// A rate in million rays a second for each side, from the shortest time of every slice; ratios of ours to each other's,
/// the median and the quartiles over all turns; rays blocked.
struct Comparison {
    rates: [f64; 3],
    ratios: [[f64; 3]; 2],
    blocked: [usize; 3],
}

fn compare(world: &World, rays: &[Ray], bundled: bool, embree: &mut Embree, rounds: usize) -> Comparison {
    let mut best = vec![[f64::INFINITY; 3]; rays.len() / SLICE];
    let mut ratios = [Vec::new(), Vec::new()];
    let mut blocked = [0; 3];
    // The first round warms up.
    for round in 0..=rounds {
        for (slice, best) in best.iter_mut().enumerate() {
            let first = slice * SLICE;
            let ours = ours(world, &rays[first..][..SLICE], bundled);
            let answers = [ours, embree.trace(true, first), embree.trace(false, first)];
            if round == 0 {
                (0..3).for_each(|i| blocked[i] += answers[i].1);
                continue;
            }
            (0..3).for_each(|i| best[i] = best[i].min(answers[i].0));
            (0..2).for_each(|i| ratios[i].push(answers[i + 1].0 / answers[0].0));
        }
    }
    let rate = |i: usize| rays.len() as f64 / 1e6 / best.iter().map(|best| best[i]).sum::<f64>();
    Comparison { rates: [0, 1, 2].map(rate), ratios: ratios.map(quartiles), blocked }
}

/// The median and the quartiles.
fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [values.len() / 2, values.len() / 4, values.len() * 3 / 4].map(|i| values[i])
}

fn main() {
    let Ok(driver) = std::env::var("EMBREE_DRIVER") else {
        println!("started without Embree: use references/trace/benches/embree/run");
        return;
    };
    let rounds = std::env::args().skip(1).find_map(|a| a.parse().ok()).unwrap_or(21);
    let folder = tempfile::tempdir().unwrap();
    println!(
        "Million rays a second from the shortest times; ratios of them, and [quartiles over turns]; {rounds} rounds."
    );
    println!("mesh      rays         ours  robust default   ours/robust         ours/default        blocked");
    for (scene, name) in MESHES {
        let scene = find(scene).unwrap();
        let object = scene.objects.iter().find(|o| o.name == name).unwrap();
        let Shape::Mesh(mesh) = &*object.shape else { panic!("{name} is a mesh") };
        let world = World::build(&[Geometry::Triangles { positions: &mesh.positions, triangles: &mesh.triangles }]);
        let mut random = Random(1);
        let sets = [("incoherent", incoherent(&mut random, mesh)), ("receivers", receivers(&mut random, mesh))];
        for (kind, rays) in sets {
            let mut embree = Embree::new(&driver, folder.path(), mesh, &rays);
            let bundled = kind == "receivers";
            let Comparison { rates: [ours, robust, default], ratios, blocked } =
                compare(&world, &rays, bundled, &mut embree, rounds);
            let [[_, r1, r3], [_, d1, d3]] = ratios;
            println!(
                "{name:9} {kind:10} {ours:6.2}  {robust:6.2}  {default:6.2}   {:.2} [{r1:.2} {r3:.2}]    {:.2} [{d1:.2} {d3:.2}]    {blocked:?}",
                ours / robust,
                ours / default,
            );
            embree.0.kill().unwrap();
            embree.0.wait().unwrap();
        }
    }
}
