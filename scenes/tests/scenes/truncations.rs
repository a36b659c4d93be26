//! Every shipped asset cut off somewhere: an error of one line that names it, or a whole scene, never a panic.

use std::path::Path;

use crate::folder::Folder;

const CUTS: usize = 100;

/// A scene that needs one file.
fn scene(file: &str) -> String {
    let extension = file.rsplit_once('.').map_or("", |(_, extension)| extension);
    let (object, light) = match extension {
        "ply" => (format!("mesh = {{ file = \"{file}\" }}"), String::new()),
        "bvh" => (format!("character = {{ file = \"{file}\", resolution = 16 }}"), String::new()),
        "exr" if file.contains("fault") => {
            (format!("heights = {{ file = \"{file}\", cell = [30.0, 30.0] }}"), String::new())
        }
        "png" => {
            let map = format!("emission = [1.0, 1.0, 1.0]\nemission_map = {{ file = \"{file}\" }}");
            (format!("plane = {{ size = [1.0, 1.0] }}\n{map}"), String::new())
        }
        "exr" => {
            ("plane = { size = [1.0, 1.0] }".into(), format!("[[lights]]\nenvironment = {{ file = \"{file}\" }}\n"))
        }
        other => panic!("an asset of a new kind, {other}"),
    };
    format!(
        "purpose = \"One asset\"\n[receivers.grid]\ncenter = [0.0, 0.0, 0.0]\nsize = [1.0, 1.0]\nresolution = [2, 2]\n\
         [[objects]]\nname = \"it\"\n{object}\nalbedo = [0.5, 0.5, 0.5]\n[[lights]]\nsky = {{ uniform = [1.0, 1.0, 1.0] }}\n{light}"
    )
}

#[test]
fn no_cut_brings_the_loader_down() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let mut state = 0x9e37_79b9_u64;
    let mut assets = 0;
    for path in std::fs::read_dir(data).unwrap().map(|entry| entry.unwrap().path()) {
        let file = path.file_name().unwrap().to_str().unwrap();
        if file.ends_with(".toml") {
            continue;
        }
        let (whole, folder, text) = (std::fs::read(&path).unwrap(), Folder::new(), scene(file));
        folder.write(file, &whole);
        folder.load(&text).unwrap_or_else(|error| panic!("{error}"));
        let mut refused = 0;
        for _ in 0..CUTS {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let end = (state >> 33) as usize % whole.len();
            folder.write(file, &whole[..end]);
            if let Err(error) = folder.load(&text) {
                let error = error.to_string();
                assert!(error.contains(file) && !error.contains('\n'), "cut at {end}: {error}");
                refused += 1;
            }
        }
        // The last number of a text may lose digits and still be one.
        assert!(refused >= CUTS - 1, "{file}: {refused} of {CUTS} refused");
        assets += 1;
    }
    assert!(assets >= 12, "{assets}");
}
