//! Small scenes, built in code: what checks run on where the caller has nothing better.

use std::f32::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use glam::{Vec2, Vec3};
use halflight_scenes::{
    Bodies, Content, DistantLight, Emission, Environment, Grid, HeightField, KeyLight, Light, Mesh, Object, Placement,
    Pose, Rgb, Scene, Shape, Sky, Sphere,
};

/// Every fixture of exact spheres, and hills. [`mesh_in_two_lights`] is left out: what methods derive from a mesh takes long, and
/// checks derive it many times.
pub fn all() -> Vec<Scene> {
    vec![sphere_over_plane(), overlapping_spheres(), moving_sphere(), two_lights(), moving_lamp(), stress(), hills()]
}

/// A sphere in a coloured ground under an overcast sky, on a grid: the ground's plane cuts it, and some receivers are
/// inside.
pub fn sphere_over_plane() -> Scene {
    let ball = sphere(Vec3::new(0.2, -0.1, 0.4), 0.6);
    scene("sphere-over-plane", vec![ground(), spheres("ball", vec![ball])], vec![overcast()], grid())
}

/// Forty overlapping spheres, and receivers of all normals among and inside them, under an environment map.
pub fn overlapping_spheres() -> Scene {
    let mut random = Random::default();
    let blockers = (0..40).map(|_| sphere(random.in_cube(), 0.1 + 0.3 * random.next())).collect();
    let points = (0..48).map(|_| (1.5 * random.in_cube(), random.direction())).collect();
    scene("overlapping-spheres", vec![spheres("heap", blockers)], vec![gradient()], Placement::Points(Arc::new(points)))
}

/// A sphere that moves over the ground within three frames, beside one that does not.
pub fn moving_sphere() -> Scene {
    let there = |x| Pose { translation: Vec3::new(x, 0.0, 0.0), ..Pose::IDENTITY };
    let still = spheres("still", vec![sphere(Vec3::new(1.5, 1.5, 0.2), 0.15)]);
    let mut ball = spheres("ball", vec![sphere(Vec3::new(-1.5, 0.0, 0.15), 0.1)]);
    ball.motion = vec![(0.0, there(0.0)), (2.0, there(3.0))];
    Scene { frame_count: 3, ..scene("moving-sphere", vec![ground(), ball, still], vec![overcast()], grid()) }
}

/// Two objects of spheres over the ground under an environment map and a key light.
pub fn two_lights() -> Scene {
    let low = spheres("low", vec![sphere(Vec3::new(-0.5, 0.0, 0.3), 0.4)]);
    let high = spheres("high", vec![sphere(Vec3::new(0.6, 0.5, 1.5), 0.5), sphere(Vec3::new(0.9, 0.5, 1.2), 0.4)]);
    scene("two-lights", vec![ground(), low, high], vec![gradient(), key()], grid())
}

/// Two heaps of small spheres beside a ground that is large for them, so that bounding spheres may stand for them, under an
/// overcast sky. Left out of [`all`]: it is for methods with cuts.
pub fn heaps() -> Scene {
    let mut random = Random::default();
    let mut heap = |center: Vec3| {
        let spheres = (0..40).map(|_| sphere(center + 0.2 * random.in_cube(), 0.03 + 0.07 * random.next()));
        spheres.collect::<Vec<Sphere>>()
    };
    let objects = vec![
        ground(),
        spheres("left", heap(Vec3::new(-0.5, 0.2, 0.25))),
        spheres("right", heap(Vec3::new(0.6, -0.3, 0.5))),
    ];
    scene("heaps", objects, vec![overcast()], grid_of([24, 20]))
}

/// A lamp that circles a sphere over the ground within three frames, under an overcast sky.
pub fn moving_lamp() -> Scene {
    let there = |x, y| Pose { translation: Vec3::new(x, y, 0.0), ..Pose::IDENTITY };
    let ball = spheres("ball", vec![sphere(Vec3::new(0.0, 0.0, 0.5), 0.4)]);
    let lamp = spheres("lamp", vec![sphere(Vec3::new(0.0, 0.0, 1.3), 0.1)]);
    let motion = vec![(0.0, there(1.2, 0.0)), (1.0, there(0.0, 1.2)), (2.0, there(-1.2, 0.0))];
    let lamp = Object { emission: Emission::Even(Rgb::new(9.0, 6.0, 3.0)), motion, ..lamp };
    Scene { frame_count: 3, ..scene("moving-lamp", vec![ground(), ball, lamp], vec![overcast()], grid()) }
}

/// A height field that rises within three frames below a sphere that moves over it, under an environment map and two key lights, one of
/// them low.
pub fn hills() -> Scene {
    let there = |x, z| Pose { translation: Vec3::new(x, 0.0, z), ..Pose::IDENTITY };
    let height = |i: usize| {
        let (x, y) = ((i % 12) as f32, (i / 12) as f32);
        0.4 * (1.1 * x).sin() * (0.9 * y + 0.3).cos() + if x > 8.0 { 0.5 } else { 0.0 }
    };
    let heights = (0..120).map(height).collect();
    let field = HeightField::new([12, 10], Vec2::new(-2.0, -1.8), Vec2::new(0.35, 0.4), heights);
    let mut ground = object("ground", Shape::Heights(field), true);
    ground.motion = vec![(0.0, there(0.0, 0.0)), (2.0, there(0.3, 0.5))];
    let mut ball = spheres("ball", vec![sphere(Vec3::new(0.0, 0.0, 1.4), 0.3)]);
    ball.motion = vec![(0.0, there(0.0, 0.0)), (2.0, there(1.0, 0.2))];
    let low = KeyLight {
        direction: Vec3::new(-0.8, 0.6, 0.15).normalize(),
        angular_radius: 3f32.to_radians(),
        radiance: Rgb::new(40.0, 30.0, 20.0),
    };
    let lights = vec![gradient(), key(), Light::Key(low)];
    Scene { frame_count: 3, ..scene("hills", vec![ground, ball], lights, Placement::Heights { object: 0 }) }
}

/// An octahedron over the ground under an environment map and a key light.
pub fn mesh_in_two_lights() -> Scene {
    let gem = object("gem", Shape::Mesh(octahedron(Vec3::new(0.0, 0.0, 0.8), 0.5)), true);
    scene("mesh-in-two-lights", vec![ground(), gem], vec![gradient(), key()], grid())
}

/// What drives approximations out of their domain: two hundred coincident circles overhead, spheres tiny and huge, and
/// receivers at the centre, inside, and on the surface of a sphere.
pub fn stress() -> Scene {
    let overhead = (1..=200).map(|i| {
        let height = 1.0 + 0.01 * i as f32;
        sphere(Vec3::new(0.0, 0.0, height), height * 15f32.to_radians().sin())
    });
    let odd = [
        sphere(Vec3::new(0.3, 0.0, 0.01), 1e-6),
        sphere(Vec3::new(0.0, 0.0, -2e5), 2e5),
        sphere(Vec3::new(5.0, 0.0, 0.0), 0.5),
        sphere(Vec3::new(8.0, 0.0, 1e4), 9.9e3),
    ];
    let positions = [
        Vec3::ZERO,
        Vec3::new(0.3, 0.0, 0.01),
        Vec3::new(0.3, 0.0, 0.0),
        Vec3::new(5.0, 0.0, 0.0),
        Vec3::new(5.0, 0.0, 0.2),
        Vec3::new(5.0, 0.0, 0.5),
        Vec3::new(5.5, 0.0, 0.0),
        Vec3::new(0.0, 0.0, 1.05),
        Vec3::new(0.0, 0.0, 100.0),
        Vec3::new(-1e4, 0.0, 0.0),
    ];
    let normals = [Vec3::Z, Vec3::X, -Vec3::Z, Vec3::new(0.6, 0.0, 0.8)];
    let points = positions.iter().flat_map(|p| normals.map(|n| (*p, n))).collect();
    let blockers = spheres("blockers", overhead.chain(odd).collect());
    scene("stress", vec![blockers], vec![gradient(), overcast()], Placement::Points(Arc::new(points)))
}

/// A scene of one frame.
pub fn scene(name: &str, objects: Vec<Object>, lights: Vec<Light>, placement: Placement) -> Scene {
    let parts = objects.iter().map(|object| object.content).chain(lights.iter().map(Light::content));
    let parts: Vec<String> = parts.map(|content| content.to_string()).chain([format!("{name}{placement:?}")]).collect();
    Scene {
        name: name.into(),
        purpose: "contract checks".into(),
        content: Content::of(parts.concat().as_bytes()),
        objects,
        lights: lights.into_iter().map(DistantLight::from).collect(),
        camera: None,
        placement,
        frame_count: 1,
        fps: 1.0,
        notices: Vec::new(),
        bodies: Bodies::default(),
    }
}

/// An object that casts shadows, of exact spheres.
pub fn spheres(name: &str, spheres: Vec<Sphere>) -> Object {
    object(name, Shape::Spheres(spheres), true)
}

/// A sphere.
pub fn sphere(center: Vec3, radius: f32) -> Sphere {
    Sphere { center, radius }
}

fn object(name: &str, shape: Shape, casts: bool) -> Object {
    Object {
        name: name.into(),
        content: shape.content(),
        shape: Arc::new(shape),
        albedo: Rgb::new(0.8, 0.6, 0.4),
        texture: None,
        emission: Emission::NONE,
        casts,
        motion: Vec::new(),
        pivot: Vec3::ZERO,
        deformation: None,
    }
}

fn ground() -> Object {
    let corner = |x, y| Vec3::new(x, y, 0.0);
    let mesh = Mesh {
        positions: vec![corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)],
        normals: vec![Vec3::Z; 4],
        uvs: Vec::new(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    object("ground", Shape::Mesh(mesh), false)
}

/// Receivers on the ground, which is the first object.
fn grid() -> Placement {
    grid_of([9, 8])
}

fn grid_of(resolution: [usize; 2]) -> Placement {
    Placement::Grid(Grid { center: Vec3::ZERO, size: Vec2::splat(4.0), resolution, normal: Vec3::Z, object: Some(0) })
}

fn octahedron(center: Vec3, radius: f32) -> Mesh {
    let axes = [Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Y, Vec3::Z, -Vec3::Z];
    let sides = (0..4).flat_map(|i| {
        let next = (i + 1) % 4;
        [[i, next, 4], [next, i, 5]]
    });
    Mesh {
        positions: axes.iter().map(|axis| center + radius * *axis).collect(),
        normals: axes.to_vec(),
        uvs: Vec::new(),
        triangles: sides.collect(),
    }
}

fn key() -> Light {
    Light::Key(KeyLight {
        direction: Vec3::new(0.6, 0.0, 0.8),
        angular_radius: 20f32.to_radians(),
        radiance: Rgb::new(3.0, 2.5, 2.0),
    })
}

fn overcast() -> Light {
    Light::Sky(Sky::Overcast(Rgb::new(1.0, 1.1, 1.2)))
}

/// A map that is bright in one quarter and dim elsewhere, dark below.
fn gradient() -> Light {
    let (width, height) = (16, 8);
    let texel = |i: usize| {
        let (azimuth, polar) = ((i % width) as f32 / width as f32 * 2.0 * PI, (i / width) as f32 / height as f32 * PI);
        let bright = if polar < FRAC_PI_2 { 0.2 + azimuth.cos().max(0.0) } else { 0.1 };
        Rgb::new(bright, 0.9 * bright, 0.5 + 0.3 * azimuth.sin())
    };
    let texels = Arc::new((0..width * height).map(texel).collect());
    Light::Environment(Environment { width, height, texels, rotation: 0.3 })
}

/// A linear congruential generator (Knuth's MMIX constants), so that fixtures are the same everywhere.
#[derive(Default)]
struct Random(u64);

impl Random {
    /// In `[0, 1)`.
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    /// In `[−1, 1)³`.
    fn in_cube(&mut self) -> Vec3 {
        2.0 * Vec3::new(self.next(), self.next(), self.next()) - 1.0
    }

    /// Uniform over the unit sphere.
    fn direction(&mut self) -> Vec3 {
        let (z, azimuth) = (2.0 * self.next() - 1.0, 2.0 * PI * self.next());
        let (sin, cos) = azimuth.sin_cos();
        let rim = (1.0 - z * z).sqrt();
        Vec3::new(rim * cos, rim * sin, z).normalize()
    }
}
