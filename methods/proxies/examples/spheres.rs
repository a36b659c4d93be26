//! Prints the tables of `docs/spheres.md`: outside volumes and times of all makers on shipped meshes, and by how much meshes
//! that change their shape leave their spheres.

use std::time::Instant;

use halflight_contract::{Backend, Cache, Job, NoMeter, Params};
use halflight_proxies::{DEFAULT_COUNT, Excess, Maker, proxies};
use halflight_scenes::{Mesh, Scene, Shape};

const COUNTS: [usize; 5] = [8, 16, 32, 64, 128];
/// Scenes and objects.
const MESHES: [(&str, &str); 6] = [
    ("bunny-studio", "bunny"),
    ("dino-elephant-courtyard", "dino"),
    ("dino-elephant-courtyard", "elephant"),
    ("teapot-sunset", "teapot"),
    ("lamp", "cow"),
    ("walker", "walker"),
];
const CLIPS: [&str; 4] = ["walker", "boxers", "battle", "deformers"];

fn main() {
    println!("| mesh | maker |{}", COUNTS.map(|count| format!(" {count} |")).concat());
    for (scene, name) in MESHES {
        let scene = shipped(scene);
        let object = scene.objects.iter().find(|object| object.name == name).expect("an object of the scene");
        let Shape::Mesh(mesh) = &*object.shape else { panic!("{name} is a mesh") };
        Maker::ALL.iter().for_each(|maker| outside_volumes(name, *maker, mesh));
    }
    println!(
        "\n| scene, object | frames | with excess | outside, mean % | outside, most % | farthest, m | relative, % |"
    );
    CLIPS.iter().for_each(|clip| excess(&shipped(clip)));
}

fn shipped(name: &str) -> Scene {
    halflight_scenes::find(name).expect("a shipped scene")
}

fn outside_volumes(name: &str, maker: Maker, mesh: &Mesh) {
    print!("| {name} | {} |", maker.name());
    for count in COUNTS {
        let start = Instant::now();
        let set = maker.make(mesh, count, &mut |_, _| true).expect("nobody cancels");
        print!(" {:.3} ({}, {:.2} s) |", set.outside_volume, set.spheres.len(), start.elapsed().as_secs_f64());
    }
    println!();
}

fn excess(scene: &Scene) {
    let (params, cache) = (Params::default(), Cache::in_memory());
    let job = Job::new(scene, &params, 1, Backend::Cpu, &cache);
    let proxies = proxies(&job, DEFAULT_COUNT, &mut NoMeter).expect("sphere sets");
    for (i, object) in scene.objects.iter().enumerate().filter(|(_, object)| object.deformation.is_some()) {
        let Some(proxy) = &proxies[i] else { continue };
        let frames = (0..scene.frame_count).map(|index| scene.frame(index));
        let found: Vec<Excess> = frames.map(|frame| proxy.excess(object, &frame.objects[i], frame.time)).collect();
        let most = |of: fn(&Excess) -> f32| found.iter().map(of).fold(0.0, f32::max);
        println!(
            "| {}, {} | {} | {} | {:.2} | {:.2} | {:.4} | {:.2} |",
            scene.name,
            object.name,
            found.len(),
            found.iter().filter(|excess| excess.outside > 0.0).count(),
            100.0 * found.iter().map(|excess| excess.outside).sum::<f32>() / found.len() as f32,
            100.0 * most(|excess| excess.outside),
            most(|excess| excess.farthest),
            100.0 * most(|excess| excess.relative),
        );
    }
}
