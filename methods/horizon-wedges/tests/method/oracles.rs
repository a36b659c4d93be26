//! Fields whose shading is known.

use glam::DVec3;
use halflight_contract::{Backend, Method, Params, Quantity, Request, Support};
use halflight_horizon_wedges::{AMBIENT, BLOCKERS, COMPLETE, HARD, PARTIAL, SWEEP, Variant};
use halflight_references::horizon::{Horizons, sky_irradiance};
use halflight_scenes::Rgb;

use crate::common::{ALL, WHITE, at, field, scene, shade, with_heights};

#[test]
fn a_flat_field_is_a_furnace_at_every_order() {
    let scene = scene("resolution = [9, 7]\ncell = [1, 2]\nramp = { slope = 0 }", WHITE);
    let white = |method: &Variant, order: usize, azimuths: &str| {
        let order = order.to_string();
        for radiance in shade(method, &scene, &[("order", &order), ("azimuths", azimuths)]) {
            assert!((radiance - Rgb::ONE).abs().max_element() < 1e-5, "{} {order}: {radiance}", method.info().id);
        }
    };
    (2..=8).flat_map(|order| ["4", "7", "16"].map(|azimuths| (order, azimuths))).for_each(|(order, azimuths)| {
        white(&COMPLETE, order, azimuths);
    });
    ALL.iter().for_each(|method| white(method, 4, "16"));
}

/// A trench without end whose floor has no width sees `cos α` of a uniform sky.
#[test]
fn the_bottom_of_a_long_trench_gets_the_cosine_of_its_walls() {
    let trench = "resolution = [129, 513]\ncell = [0.5, 0.5]\ntrench = { width = 0, depth = 30, wall = 45 }";
    let scene = scene(trench, WHITE);
    // Between azimuths the horizon is linear, which lets more light in; the truncation of order 4 takes some away.
    for (order, azimuths, low, high) in
        [("4", "16", 0.709, 0.716), ("8", "16", 0.709, 0.716), ("8", "64", 0.706, 0.7085)]
    {
        let picture = shade(&SWEEP, &scene, &[("order", order), ("azimuths", azimuths)]);
        let found = at(&picture, field(&scene), 64, 256);
        // The normal at the bottom is that of central differences: upright.
        assert!((low..high).contains(&found), "order {order}, {azimuths} azimuths: {found}");
    }
}

/// Against quadrature over the exact horizons under a uniform sky, the sky's lower half left out.
#[test]
fn exact_horizons_give_the_exact_irradiance_but_for_the_order() {
    let fractal =
        "resolution = [48, 40]\ncell = [1, 1.5]\nfractal = { seed = 3, amplitude = 6, wavelength = 20, octaves = 3 }";
    let scene = scene(fractal, WHITE);
    let field = field(&scene);
    let horizons = Horizons::new(field);
    for (order, bound) in [("4", 0.03), ("8", 0.012)] {
        let picture = shade(&SWEEP, &scene, &[("order", order), ("azimuths", "32")]);
        let (mut square, mut count) = (0.0, 0);
        for row in (4..36).step_by(3) {
            for column in (4..44).step_by(3) {
                let angles: Vec<f64> = (0..64)
                    .map(|i| horizons.at_vertex([column, row], f64::from(i) * std::f64::consts::TAU / 64.0))
                    .collect();
                let normal: DVec3 = field.normal(column, row).as_dvec3();
                let apart = f64::from(at(&picture, field, column, row)) - sky_irradiance(normal, &angles);
                square += apart * apart;
                count += 1;
            }
        }
        let rms = (square / f64::from(count)).sqrt();
        assert!(rms < bound, "order {order}: {rms}");
    }
}

/// A wall seen under the azimuth φ0 takes most light from a lamp at φ0, not half a step beside it.
#[test]
fn a_narrow_wall_hides_the_light_behind_it() {
    let flat = "resolution = [65, 65]\ncell = [1, 1]\nramp = { slope = 0 }";
    // A pillar to the east of the middle; the light goes round it.
    let pillar =
        |column: usize, row: usize| if (40..=42).contains(&column) && (31..=33).contains(&row) { 12.0 } else { 0.0 };
    for (method, settings) in [
        (PARTIAL, vec![("swath", "22.5"), ("offset", "4"), ("key-azimuths", "3")]),
        (PARTIAL, vec![("swath", "22.5"), ("offset", "4"), ("key-azimuths", "8")]),
        (SWEEP, vec![("swath", "22.5"), ("key-azimuths", "1")]),
        (SWEEP, vec![("swath", "360"), ("azimuths", "64"), ("order", "6")]),
        (COMPLETE, vec![("azimuths", "64"), ("offset", "4")]),
    ] {
        let lit = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let lights = format!(
                "[[lights]]\nkey = {{ direction = [{cos}, {sin}, 0.4], angular_radius = 2, radiance = [1, 1, 1] }}"
            );
            let scene = with_heights(&scene(flat, &lights), pillar);
            at(&shade(&method, &scene, &settings), field(&scene), 32, 32)
        };
        let angles = (-20..=20).map(|step| 2.0 * step as f32);
        let dark: Vec<(f32, f32)> = angles.map(|angle| (angle, lit(angle))).collect();
        // The centroid of what is missing: where the wall is.
        let open = dark.iter().map(|(_, value)| *value).fold(0.0, f32::max);
        let missing: f32 = dark.iter().map(|(_, value)| open - value).sum();
        let centre: f32 = dark.iter().map(|(angle, value)| angle * (open - value)).sum::<f32>() / missing;
        assert!(centre.abs() < 0.5, "{} {settings:?}: the darkest azimuth is {centre}°", method.info().id);
    }
}

/// A light that faces the receiver gives it, through an open swath, what it gives without one.
#[test]
fn swaths_leave_unshadowed_light_its_level() {
    let flat = "resolution = [5, 5]\ncell = [1, 1]\nramp = { slope = 0 }";
    let lights = "[[lights]]\nkey = { direction = [0.6, 0, 0.8], angular_radius = 10, radiance = [1, 1, 1] }";
    let sine = 10f32.to_radians().sin();
    let (facing, level) = (sine * sine, 0.8 * sine * sine);
    let scene = scene(flat, lights);
    for (swath, azimuths) in [("0", "3"), ("90", "3"), ("45", "32"), ("11.25", "1"), ("2", "8")] {
        for [light, visibility] in [["false"; 2], ["true", "false"], ["false", "true"], ["true"; 2]] {
            let shaded = |how| {
                let windows = [("window-light", light), ("window-visibility", visibility)];
                let settings = [("swath", swath), ("key-azimuths", azimuths), ("key-level", how)];
                shade(&SWEEP, &scene, &[&settings[..], &windows].concat())[0].x
            };
            assert!((shaded("ground") / level - 1.0).abs() < 1e-3, "{swath}: {}", shaded("ground"));
            // The receiver is level: less than the one that gets most, which may face elsewhere than the light's middle.
            assert!(shaded("facing") < 1.001 * facing, "{swath}: {}", shaded("facing"));
        }
    }
}

/// A light that sinks below the horizon fades to nothing.
#[test]
fn light_from_below_the_horizon_gives_nothing() {
    let flat = "resolution = [5, 5]\ncell = [1, 1]\nramp = { slope = 0 }";
    for method in [PARTIAL, HARD] {
        for (down, bound) in [(-0.02f32, 0.0014), (-0.2, 1e-6), (-1.0, 1e-6)] {
            let light = format!(
                "[[lights]]\nkey = {{ direction = [0.6, 0.3, {down}], angular_radius = 3, radiance = [1, 1, 1] }}"
            );
            let found = shade(&method, &scene(flat, &light), &[])[0].x;
            assert!((-1e-6..bound).contains(&found), "{} at {down}: {found}", method.info().id);
        }
    }
}

#[test]
fn hard_shadows_are_those_of_the_horizon() {
    let flat = "resolution = [65, 9]\ncell = [1, 1]\nramp = { slope = 0 }";
    let lights = "[[lights]]\nkey = { direction = [1, 0, 1], angular_radius = 1, radiance = [1, 1, 1] }";
    let scene = with_heights(&scene(flat, lights), |column, _| if column == 50 { 10.0 } else { 0.0 });
    let picture = shade(&HARD, &scene, &[]);
    let sine = 1f32.to_radians().sin();
    for column in 30..49 {
        let found = at(&picture, field(&scene), column, 4);
        let expected = if column >= 41 { 0.0 } else { sine * sine / 2f32.sqrt() };
        // At column 40 the wall's edge is just at the light's elevation; 145 samples over 65 m stand 0.45 m apart.
        if !(39..=41).contains(&column) {
            assert!((found - expected).abs() < 1e-6, "column {column}: {found} for {expected}");
        }
    }
}

#[test]
fn scenes_that_are_not_for_the_family_are_told_why() {
    let scene = scene("resolution = [5, 5]\ncell = [1, 1]\nramp = { slope = 0 }", WHITE);
    let answer = |method: &Variant, fields: usize, casters: usize, quantity| {
        let params = Params::defaults(method.info().params);
        let request = Request { quantity, backend: Backend::Cpu, params: &params };
        method.supports(&halflight_scenes::SceneFacts { height_fields: fields, casters, ..scene.facts() }, &request)
    };
    let direct = Quantity::Direct;
    for fields in [0, 2] {
        let told = answer(&PARTIAL, fields, 2, direct);
        assert!(matches!(&told, Support::Skip(why) if why.contains("one height field")), "{told:?}");
    }
    assert_eq!(answer(&PARTIAL, 1, 1, direct), Support::Exact);
    assert!(matches!(answer(&PARTIAL, 1, 3, direct), Support::Approximate(why) if why.contains("2 objects beside")));
    assert_eq!(answer(&BLOCKERS, 1, 3, direct), Support::Exact);
    let visibility = |order| Quantity::Visibility { order };
    assert_eq!(answer(&COMPLETE, 1, 1, visibility(4)), Support::Exact);
    assert!(matches!(answer(&COMPLETE, 1, 1, visibility(5)), Support::Skip(_)));
    assert!(matches!(answer(&PARTIAL, 1, 1, visibility(4)), Support::Skip(why) if why.contains("complete")));
    assert!(matches!(answer(&AMBIENT, 1, 1, visibility(2)), Support::Skip(_)));
}

/// A sphere over flat ground darkens what lies below it, as the method without blockers does not.
#[test]
fn blockers_above_the_field_cast_shadows_on_it() {
    let ball = "[[objects]]\nname = 'ball'\nsphere = { center = [0, 0, 3], radius = 1.5 }\nalbedo = [1, 1, 1]\n";
    let scene = scene("resolution = [21, 21]\ncell = [1, 1]\nramp = { slope = 0 }", &format!("{ball}{WHITE}"));
    let (with, without) = (shade(&BLOCKERS, &scene, &[]), shade(&PARTIAL, &scene, &[]));
    // The sphere's share of the cosine overhead is sin² of its radius.
    let expected = 1.0 - 0.25;
    let found = at(&with, field(&scene), 10, 10);
    assert!((found - expected).abs() < 0.05 && at(&without, field(&scene), 10, 10) > 0.999, "{found}");
    assert!(at(&with, field(&scene), 0, 0) > 0.98);
}

/// Receivers that are given as points on the field, or seen by a camera, are those of its vertices.
#[test]
fn receivers_are_found_by_grid_coordinates_or_by_where_they_are() {
    let fractal =
        "resolution = [24, 20]\ncell = [1, 1.5]\nfractal = { seed = 3, amplitude = 4, wavelength = 12, octaves = 2 }";
    let scene = scene(fractal, WHITE);
    let receivers = scene.frame(0).receivers;
    let points: Vec<_> = receivers.position.iter().copied().zip(receivers.normal.iter().copied()).collect();
    let listed = scene.with_receivers(&points);
    for method in [COMPLETE, SWEEP] {
        let (a, b) = (shade(&method, &scene, &[]), shade(&method, &listed, &[]));
        let most = a.iter().zip(&b).map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
        assert!(most < 2e-4, "{}: {most}", method.info().id);
    }
}
