//! Windows attenuate band l of order n by cos(π/2 · l/2n) (Ren 2006, §7).

use std::f64::consts::PI;
use std::sync::Arc;

use glam::Vec3;
use halflight_contract::{Method, Params, Quantity};
use halflight_scenes::{KeyLight, Light, Placement, Rgb, Scene};
use halflight_sh::{circle_visibility, irradiance_weights, rotate_zonal};
use halflight_tests::checks::Case;
use halflight_tests::fixtures;

const ORDER: usize = 5;

fn factor(coefficient: usize) -> f64 {
    (0.5 * PI * coefficient.isqrt() as f64 / (2 * ORDER) as f64).cos()
}

fn methods() -> impl Iterator<Item = &'static dyn Method> {
    let has = |method: &&'static dyn Method, name| method.info().params.iter().any(|spec| spec.name == name);
    halflight_registry::methods()
        .into_iter()
        .filter(move |method| has(method, "window-light") && has(method, "spheres"))
}

fn values(method: &dyn Method, scene: &Scene, quantity: Quantity, setting: (&str, &str)) -> Option<Vec<f32>> {
    let order = ORDER.to_string();
    let params = Params::resolve(method.info().params, [("order", order.as_str()), setting]).expect("in range");
    let case = Case::new(method, scene, quantity).tuned(params);
    case.is_supported().then(|| case.fresh(&case.frames[0]).expect("it runs"))
}

#[test]
fn visibility_is_attenuated_band_by_band() {
    let scene = fixtures::overlapping_spheres();
    let mut tried = 0;
    for method in methods() {
        let quantity = Quantity::Visibility { order: ORDER as u8 };
        let both = ["false", "true"].map(|on| values(method, &scene, quantity, ("window-visibility", on)));
        let [Some(plain), Some(windowed)] = both else { continue };
        for (i, (plain, windowed)) in plain.iter().zip(&windowed).enumerate() {
            let expected = f64::from(*plain) * factor(i % (ORDER * ORDER));
            assert!((f64::from(*windowed) - expected).abs() < 1e-5, "{}: {windowed} for {expected}", method.info().id);
        }
        tried += 1;
    }
    assert!(tried >= 8, "{tried}");
}

#[test]
fn light_is_attenuated_band_by_band() {
    let key = KeyLight { direction: Vec3::new(0.6, 0.0, 0.8), angular_radius: 0.2, radiance: Rgb::new(9.0, 5.0, 2.0) };
    let normals = [Vec3::Z, Vec3::X, Vec3::new(0.0, 0.6, 0.8), Vec3::NEG_Y];
    let points = normals.map(|normal| (Vec3::ZERO, normal)).to_vec();
    let scene = fixtures::scene("windows", Vec::new(), vec![Light::Key(key)], Placement::Points(Arc::new(points)));
    // The disc: an open sky less what its circle leaves.
    let (mut zonal, mut disc) = ([0.0; ORDER], [0.0; ORDER * ORDER]);
    circle_visibility(ORDER, f64::from(key.angular_radius).cos(), &mut zonal);
    zonal.iter_mut().for_each(|value| *value = -*value);
    zonal[0] += (4.0 * PI).sqrt();
    rotate_zonal(ORDER, &zonal, key.direction.as_dvec3().to_array(), &mut disc);
    let mut tried = 0;
    for method in methods() {
        let Some(found) = values(method, &scene, Quantity::Direct, ("window-light", "true")) else { continue };
        for (normal, found) in normals.iter().zip(found.chunks_exact(3)) {
            let mut weights = vec![0.0; ORDER * ORDER];
            irradiance_weights(ORDER, normal.as_dvec3().to_array(), &mut weights);
            let terms = disc.iter().zip(&weights).enumerate();
            let share: f64 = terms.map(|(i, (light, weight))| factor(i) * light * weight).sum();
            for (radiance, found) in key.radiance.to_array().into_iter().zip(found) {
                let expected = f64::from(radiance) * share;
                assert!((f64::from(*found) - expected).abs() < 1e-5, "{}: {found} for {expected}", method.info().id);
            }
        }
        tried += 1;
    }
    assert!(tried >= 8, "{tried}");
}
