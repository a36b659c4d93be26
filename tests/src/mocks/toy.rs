//! The toy that all mocks compute, and what they share besides.

use glam::Vec3;
use halflight_contract::{Error, Kind, Output, ParamSpec, Phase, Quantity, Request, Result, Support};
use halflight_scenes::{Frame, Mesh, Receivers, Rgb, Scene, Shape, Sphere};

/// Strength of shadows: what `evaluate` takes anew.
pub(super) const STRENGTH: ParamSpec = ParamSpec {
    name: "strength",
    kind: Kind::Float { min: 0.0, max: 2.0, default: 1.0 },
    phase: Phase::Evaluate,
    help: "factor on what every sphere covers",
};

/// Distance at which shadows end: what `update` takes anew.
pub(super) const RANGE: ParamSpec = ParamSpec {
    name: "range",
    kind: Kind::Float { min: 1.0, max: 100.0, default: 10.0 },
    phase: Phase::Update,
    help: "spheres farther than this many radii cast no shadow",
};

/// Size of spheres: what needs another `prepare`.
pub(super) const INFLATE: ParamSpec = ParamSpec {
    name: "inflate",
    kind: Kind::Float { min: 0.5, max: 2.0, default: 1.0 },
    phase: Phase::Prepare,
    help: "factor on the radius of every sphere",
};

/// Direct light alone.
pub(super) fn supports(request: &Request<'_>) -> Support {
    match request.quantity {
        Quantity::Direct => Support::Exact,
        other => Support::Skip(format!("computes direct light only, not {other}")),
    }
}

/// Mean radiance of the zenith and eight directions at 45° around it.
pub(super) fn mean_light(frame: &Frame) -> Rgb {
    let ring = (0..8).map(|i| {
        let (sin, cos) = (i as f32 * std::f32::consts::FRAC_PI_4).sin_cos();
        Vec3::new(cos, sin, 1.0).normalize()
    });
    ring.chain([Vec3::Z]).map(|direction| frame.radiance(direction)).sum::<Rgb>() / 9.0
}

/// Spheres of one object in rest position: its own, or one around its mesh.
pub(super) fn spheres_at_rest(shape: &Shape, inflate: f32) -> Vec<Sphere> {
    let around = |mesh: &Mesh| {
        let center = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len().max(1) as f32;
        let reach = mesh.positions.iter().map(|p| p.distance(center)).fold(0.0, f32::max);
        vec![Sphere { center, radius: reach }]
    };
    let spheres = match shape {
        Shape::Spheres(spheres) => spheres.clone(),
        Shape::Mesh(mesh) => around(mesh),
        Shape::Heights(field) => around(field.mesh()),
    };
    spheres.into_iter().map(|s| Sphere { radius: inflate * s.radius, ..s }).collect()
}

/// Spheres of every object that casts, at rest.
pub(super) fn casters_at_rest(scene: &Scene, inflate: f32) -> Vec<Vec<Sphere>> {
    let at_rest = |object: &halflight_scenes::Object| match object.casts {
        true => spheres_at_rest(&object.shape, inflate),
        false => Vec::new(),
    };
    scene.objects.iter().map(at_rest).collect()
}

/// One object's spheres carried to where it is in the frame.
pub(super) fn posed(object: usize, at_rest: &[Vec<Sphere>], frame: &Frame) -> Vec<Sphere> {
    let pose = frame.objects[object].pose;
    at_rest[object].iter().map(|s| Sphere { center: pose.point(s.center), ..*s }).collect()
}

/// Every sphere of the frame.
pub(super) fn all_posed(at_rest: &[Vec<Sphere>], frame: &Frame) -> Vec<Sphere> {
    (0..at_rest.len()).flat_map(|object| posed(object, at_rest, frame)).collect()
}

/// The share of the hemisphere that a sphere covers alone: `sin²θ · max(0, n·ω)`.
pub(super) fn covered(position: Vec3, normal: Vec3, sphere: &Sphere) -> f32 {
    let to = sphere.center - position;
    let distance = to.length().max(f32::MIN_POSITIVE);
    let sine = (sphere.radius / distance).min(1.0);
    sine * sine * normal.dot(to / distance).max(0.0)
}

/// Radiance at receiver `i`, where spheres cover the given shares.
pub(super) fn shaded(receivers: &Receivers, i: usize, light: Rgb, covered: f32) -> Rgb {
    if receivers.valid[i] { receivers.albedo[i] * light * (1.0 - covered).max(0.0) } else { Rgb::ZERO }
}

/// Copies results out.
pub(super) fn write(method: &'static str, results: &[Rgb], out: Output<'_>) -> Result<()> {
    match out {
        Output::Radiance(out) if out.len() == results.len() => {
            out.copy_from_slice(results);
            Ok(())
        }
        _ => Err(unsupported(method, "an output of another kind or length than what was evaluated")),
    }
}

/// An error that names the method.
pub(super) fn unsupported(method: &'static str, what: &str) -> Error {
    Error::Unsupported { method, what: what.into() }
}
