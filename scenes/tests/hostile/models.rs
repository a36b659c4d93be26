//! Every model of Debian's `assimp-testmodels` of a format that we read, the broken ones among them.

use std::path::{Path, PathBuf};

use crate::child::load;

const MODELS: &str = "/usr/share/assimp/models";

/// Most MiB that the process may grow by for all models; the largest file has 4.
const MOST_GROWTH: u64 = 128;

/// Files, or folders of them, that are refused, and what is said of each. Whatever else there is loads.
const REFUSED: &[(&str, &str)] = &[
    // More frames than its header says.
    ("BVH/Boxing_Toes.bvh", "expected nothing after the last frame"),
    // `3.1+e2` is no number.
    ("OBJ/number_formats.obj", "line 11: expected three numbers"),
    // Points and lines alone.
    ("OBJ/point_cloud.obj", "expected at least one triangle"),
    ("OBJ/testline.obj", "expected at least one triangle"),
    ("OBJ/testpoints.obj", "expected at least one triangle"),
    ("PLY/points.ply", "expected at least one triangle"),
    ("OFF/invalid.off", "expected a count of at least 3"),
    // Headers without `comment` and `element face`; and fewer vertices than the header says.
    ("PLY/Wuson.ply", "line 3: expected format, element, property, comment or end_header"),
    ("PLY/issue623.ply", "vertex 0 of 24: expected a list length"),
    ("PLY/pond.0.ply", "the file is truncated"),
    // glTF 1.0, once without its version.
    ("glTF/CesiumMilkTruck", "invalid type: map, expected a sequence"),
    ("glTF", "asset.version: expected 2.0, found \"1.0\""),
    ("glTF2/BoxTextured-glTF-techniqueWebGL", "\"KHR_technique_webgl\": Unsupported extension"),
    ("glTF2/BoxWithInfinites-glTF-Binary", "Missing data"),
    ("glTF2/IncorrectVertexArrays", "Missing data"),
    ("glTF2/IndexOutOfRange", "expected vertex indices below 24"),
    ("glTF2/MissingBin", "expected a readable file"),
    ("glTF2/RecursiveNodes", "expected a hierarchy without circles"),
    ("glTF2/SchemaFailures", "invalid type: string"),
    ("glTF2/TestNoRootNode/NoScene.gltf", "scene: Index out of bounds"),
    ("glTF2/TestNoRootNode/SceneWithoutNodes.gltf", "missing field `nodes`"),
    ("glTF2/draco", "\"KHR_draco_mesh_compression\": Unsupported extension"),
    // Points and lines, with and without indices.
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_00.gltf", "at least one mesh of triangles"),
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_01.gltf", "at least one mesh of triangles"),
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_02.gltf", "at least one mesh of triangles"),
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_03.gltf", "at least one mesh of triangles"),
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_07.gltf", "at least one mesh of triangles"),
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_08.gltf", "at least one mesh of triangles"),
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_09.gltf", "at least one mesh of triangles"),
    ("glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode/Mesh_PrimitiveMode_10.gltf", "at least one mesh of triangles"),
    ("glTF2/wrongTypes/badArray.gltf", "expected a sequence"),
    ("glTF2/wrongTypes/badNumber.gltf", "expected f32"),
    ("glTF2/wrongTypes/badObject.gltf", "expected an array"),
    ("glTF2/wrongTypes/badString.gltf", "expected a string"),
    ("glTF2/wrongTypes/badUint.gltf", "integer `-1`"),
    ("invalid", ""),
];

/// Files below a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    entries.into_iter().flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}

/// The entry of a scene for a model, if we read its format.
fn entry(path: &Path) -> Option<String> {
    let file = path.file_name()?.to_str()?;
    Some(match path.extension()?.to_str()?.to_lowercase().as_str() {
        "obj" | "off" | "ply" => {
            format!("mesh = {{ file = {file:?}, drop_degenerate = true }}\nalbedo = [0.5, 0.5, 0.5]")
        }
        "gltf" | "glb" => format!("gltf = {{ file = {file:?}, drop_degenerate = true }}"),
        "bvh" => format!("character = {{ file = {file:?}, resolution = 16 }}\nalbedo = [0.5, 0.5, 0.5]"),
        _ => return None,
    })
}

/// A scene beside a copy of a model's folder: a scene's assets lie beside it.
fn scene(model: &Path, entry: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let from = model.parent().unwrap();
    for file in files(from) {
        let to = folder.path().join(file.strip_prefix(from).unwrap());
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(&file, to).unwrap();
    }
    let text = format!(
        "purpose = \"One model\"\n[receivers.grid]\ncenter = [0.0, 0.0, 0.0]\nsize = [1.0, 1.0]\nresolution = [2, 2]\n\
         [[objects]]\nname = \"it\"\n{entry}\n[[lights]]\nsky = {{ uniform = [1.0, 1.0, 1.0] }}\n"
    );
    std::fs::write(folder.path().join("scene.toml"), text).unwrap();
    folder
}

#[test]
fn assimps_models_load_or_are_refused_in_a_line() {
    if !Path::new(MODELS).is_dir() {
        return eprintln!("skipped: no {MODELS} here (Debian: assimp-testmodels)");
    }
    let read = |model: PathBuf| entry(&model).map(|entry| (scene(&model, &entry), model));
    let scenes: Vec<(tempfile::TempDir, PathBuf)> = files(Path::new(MODELS)).into_iter().filter_map(read).collect();
    let paths: Vec<PathBuf> = scenes.iter().map(|(folder, _)| folder.path().join("scene.toml")).collect();
    let mut refused = 0;
    for ((folder, model), verdict) in scenes.iter().zip(load(&paths)) {
        let name = model.strip_prefix(MODELS).unwrap().to_str().unwrap();
        let reason = REFUSED.iter().find(|(file, _)| name == *file || name.starts_with(&format!("{file}/")));
        match (&verdict.error, reason) {
            (None, None) => {}
            (Some(error), Some((_, reason))) => {
                let plain = error.starts_with(folder.path().to_str().unwrap()) && !error.contains("\\n");
                assert!(plain && error.contains(reason), "{name}: {error}");
                refused += 1;
            }
            (error, reason) => panic!("{name}: {error:?}, expected {reason:?}"),
        }
        assert!(verdict.grown <= MOST_GROWTH, "{name}: grew to {} MiB", verdict.grown);
    }
    assert!(refused >= REFUSED.len(), "{refused}");
}
