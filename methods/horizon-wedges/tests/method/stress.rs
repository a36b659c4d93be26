//! What must hold of all fields: turned, moved, between cells, by any instructions and threads, odd ones.

use std::path::Path;
use std::process::Command;

use glam::{Vec2, Vec3};
use halflight_contract::Method;
use halflight_horizon_wedges::{HARD, MARCH, Variant};
use halflight_scenes::{Rgb, Scene};

use crate::common::{ALL, WHITE, at, field, scene, shade, with_heights};

fn id(method: &Variant) -> &'static str {
    method.info().id
}

/// Hills under a sky and a key light.
fn hills(resolution: &str) -> Scene {
    let fractal = "fractal = { seed = 3, amplitude = 6, wavelength = 20, octaves = 3 }";
    scene(&format!("resolution = {resolution}\ncell = [1, 1]\n{fractal}"), &lights())
}

fn lights() -> String {
    format!("{WHITE}[[lights]]\nkey = {{ direction = [1, 0.2, 0.5], angular_radius = 4, radiance = [200, 200, 200] }}")
}

#[test]
fn a_field_turned_by_a_quarter_is_shaded_as_the_one_that_was_not() {
    // Symmetric samples, since the cells' diagonals do not turn.
    let flat = "resolution = [33, 33]\ncell = [1, 1]\nramp = { slope = 0 }";
    let lights = |x: f32, y: f32| {
        format!(
            "{WHITE}[[lights]]\nkey = {{ direction = [{x}, {y}, 0.5], angular_radius = 4, radiance = [200, 200, 200] }}"
        )
    };
    let bump = |x: f32, y: f32| 5.0 * (-0.02 * (x * x + y * y)).exp();
    let height = |x: f32, y: f32| bump(x - 4.0, y + 3.0) + 0.7 * bump(x + 6.0, y - 8.0);
    let centred = |i: usize| i as f32 - 16.0;
    let first = with_heights(&scene(flat, &lights(0.9, 0.2)), |i, j| height(centred(i), centred(j)));
    // (x, y) of the second is (y, −x) of the first.
    let second = with_heights(&scene(flat, &lights(-0.2, 0.9)), |i, j| height(centred(j), -centred(i)));
    for method in ALL {
        let settings = [("azimuths", "16")];
        let (a, b) = (shade(&method, &first, &settings), shade(&method, &second, &settings));
        let mut apart = 0;
        for (i, j) in (4..29).flat_map(|i| (4..29).map(move |j| (i, j))) {
            let (x, y) = (centred(i), centred(j));
            let there = at(&a, field(&first), i, j);
            let here = at(&b, field(&second), (16.0 - y) as usize, (16.0 + x) as usize);
            apart += usize::from((there - here).abs() > 2e-3);
        }
        // Rounding decides at the edge of a hard shadow.
        let edge = if method.info().id == HARD.info().id { 6 } else { 0 };
        assert!(apart <= edge, "{}: {apart} differ", method.info().id);
    }
}

/// Hills amid a plain, and the same some cells farther.
#[test]
fn a_field_moved_by_whole_cells_is_shaded_alike() {
    let flat = scene("resolution = [96, 96]\ncell = [1, 1]\nramp = { slope = 0 }", &lights());
    let bump = |x: f32, y: f32| (6.0 * (-0.02 * (x * x + y * y)).exp() - 0.01).max(0.0);
    let hill = |x: f32, y: f32| bump(x - 40.0, y - 44.0) + bump(x - 50.0, y - 38.0);
    let first = with_heights(&flat, |i, j| hill(i as f32, j as f32));
    let moved = with_heights(&flat, |i, j| hill(i as f32 - 7.0, j as f32 - 5.0));
    for method in ALL {
        let (a, b) = (shade(&method, &first, &[]), shade(&method, &moved, &[]));
        let apart = |(i, j): (usize, usize)| (at(&a, field(&flat), i, j) - at(&b, field(&flat), i + 7, j + 5)).abs();
        let worst = (20..70).flat_map(|i| (20..70).map(move |j| (i, j))).map(apart).fold(0.0, f32::max);
        // Samples of a pyramid's levels lie elsewhere on what moved, and so do lines that are swept.
        let marched = [MARCH, HARD].iter().any(|other| id(other) == id(&method));
        assert!(worst < if marched { 1e-5 } else { 0.01 }, "{}: {worst}", id(&method));
    }
}

/// Receivers a thousandth of a cell on either side of the lines of the grid, upright so that nothing else changes there.
#[test]
fn light_is_continuous_across_cells() {
    const APART: f32 = 1e-3;
    let scene = hills("[40, 36]");
    let (origin, cell) = (field(&scene).origin(), field(&scene).cell());
    let sides = |at: [f32; 2], across: [f32; 2]| {
        [-APART, APART].map(|side| {
            let [x, y] = [0, 1].map(|axis| at[axis] + side * across[axis]);
            ((origin + cell * Vec2::new(x, y)).extend(30.0), Vec3::Z)
        })
    };
    let spots: Vec<(Vec3, Vec3)> = (4..30)
        .map(|line| (line as f32, 5.0 + 0.83 * line as f32))
        .flat_map(|(line, between)| [sides([line, between], [1.0, 0.0]), sides([between, line], [0.0, 1.0])])
        .flatten()
        .collect();
    let scene = scene.with_receivers(&spots);
    for method in ALL.iter().filter(|method| id(method) != id(&HARD)) {
        let lit = shade(method, &scene, &[]);
        let jump = |pair: &[Rgb]| (pair[0] - pair[1]).abs().max_element();
        let worst = lit.chunks_exact(2).map(jump).fold(0.0, f32::max);
        assert!(worst < 1e-3, "{}: {worst}", id(method));
    }
}

/// By the machine's widest instructions and by narrower ones, which a program is told of before it starts.
#[test]
fn instruction_sets_agree() {
    const FILE: &str = "HALFLIGHT_TWIN";
    let lit = || -> Vec<f32> {
        let scene = hills("[70, 50]");
        ALL.iter().flat_map(|method| shade(method, &scene, &[])).flat_map(|rgb| rgb.to_array()).collect()
    };
    if let Some(path) = std::env::var_os(FILE) {
        let bytes: Vec<u8> = lit().into_iter().flat_map(f32::to_le_bytes).collect();
        return std::fs::write(path, bytes).expect("a file for the twin");
    }
    let own = lit();
    for simd in ["portable", "avx2"] {
        let path = std::env::temp_dir().join(format!("halflight-twin-{simd}-{}", std::process::id()));
        let mut twin = Command::new(std::env::current_exe().expect("a program"));
        twin.args(["--exact", "stress::instruction_sets_agree"]).env(FILE, &path).env("HALFLIGHT_SIMD", simd);
        assert!(twin.output().expect("it starts").status.success(), "{simd}");
        let bytes = std::fs::read(&path).expect("what the twin wrote");
        std::fs::remove_file(&path).expect("it is there");
        let other = bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().expect("four")));
        assert_eq!(bytes.len(), 4 * own.len());
        // At the edge of a hard shadow rounding decides.
        let apart = own.iter().zip(other).filter(|(own, other)| (*own - other).abs() > 1e-4).count();
        assert!(apart <= 3 * 6, "{simd}: {apart} of {} differ", own.len());
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let fractal =
        "resolution = [70, 50]\ncell = [1, 1]\nfractal = { seed = 3, amplitude = 6, wavelength = 20, octaves = 3 }";
    let lights = format!(
        "{WHITE}[[lights]]\nkey = {{ direction = [1, 0.2, 0.5], angular_radius = 4, radiance = [200, 200, 200] }}"
    );
    let scene = scene(fractal, &lights);
    for method in ALL {
        let by = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| shade(&method, &scene, &[]))
        };
        assert_eq!(by(1), by(2), "{}", method.info().id);
    }
}

#[test]
fn odd_fields_give_finite_light() {
    let lights =
        format!("{WHITE}[[lights]]\nkey = {{ direction = [1, 0.2, 0.1], angular_radius = 1, radiance = [9, 9, 9] }}");
    let sizes = ["[2, 2]", "[2, 40]", "[40, 2]", "[3, 5]"];
    for (size, cell) in sizes.iter().flat_map(|size| ["[1, 1]", "[1e-3, 1e3]"].map(|cell| (size, cell))) {
        let flat = scene(&format!("resolution = {size}\ncell = {cell}\nramp = {{ slope = 0 }}"), &lights);
        for scale in [1e6f32, 1.0, 1e-6] {
            let scene = with_heights(&flat, |i, j| scale * ((7 * i + 5 * j) % 4) as f32);
            for method in ALL {
                let picture = shade(&method, &scene, &[]);
                assert!(picture.iter().all(|rgb| rgb.is_finite()), "{} {size} {cell} {scale}", method.info().id);
            }
        }
    }
}

/// Walls as steep as numbers allow, and pits beside them.
#[test]
fn cliffs_give_finite_light() {
    let flat = scene("resolution = [24, 20]\ncell = [1, 1]\nramp = { slope = 0 }", &lights());
    for height in [1e6f32, 1e30, -1e30] {
        let scene = with_heights(&flat, |i, j| if (8..16).contains(&i) && j % 7 < 3 { height } else { 0.0 });
        for method in ALL {
            let picture = shade(&method, &scene, &[]);
            assert!(picture.iter().all(|rgb| rgb.is_finite()), "{} {height}", id(&method));
        }
    }
}

#[test]
fn a_field_of_one_vertex_is_no_field() {
    let text = "purpose = 'test'\n[receivers]\nheights = { object = 'field' }\n[[objects]]\nname = 'field'\n\
                albedo = [1, 1, 1]\n[objects.heights]\nresolution = [1, 1]\ncell = [1, 1]\nramp = { slope = 0 }\n";
    let told = Scene::parse(Path::new("test.toml"), &format!("{text}{WHITE}")).expect_err("too small").to_string();
    assert!(told.contains("resolution") || told.contains("heights"), "{told}");
}
