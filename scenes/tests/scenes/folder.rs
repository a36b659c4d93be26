//! A folder with a scene and its assets, for the time of a test.

use std::path::PathBuf;

use halflight_scenes::{Mesh, Scene, SceneError, Shape};

pub(crate) struct Folder(tempfile::TempDir);

/// A cube of half width 1 about the origin as quads, counter-clockwise from outside.
pub(crate) const CUBE_QUADS: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

pub(crate) fn cube_corner(index: u32) -> [f32; 3] {
    [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { 1.0 } else { -1.0 })
}

/// The cube as ASCII PLY.
pub(crate) fn cube_ply() -> String {
    let mut text = String::from(
        "ply\nformat ascii 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty float y\n\
         property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n",
    );
    for index in 0..8 {
        let [x, y, z] = cube_corner(index);
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c, d] in CUBE_QUADS {
        text += &format!("4 {a} {b} {c} {d}\n");
    }
    text
}

/// A valid scene with every kind of object and light that needs no file but `cube.ply`.
pub(crate) const SCENE: &str = r#"
purpose = "A cube and a sphere over a ground"

[camera]
eye = [0.0, -8.0, 3.0]
target = [0.0, 0.0, 0.5]
fov = 40.0
width = 24
height = 16

[receivers]
camera = {}

[[objects]]
name = "ground"
plane = { size = [20.0, 20.0] }
albedo = [0.5, 0.5, 0.5]
casts = false

[[objects]]
name = "cube"
mesh = { file = "cube.ply" }
translate = [-1.5, 0.0, 1.0]
albedo = [0.9, 0.2, 0.2]

[[objects]]
name = "ball"
sphere = { center = [1.5, 0.0, 1.0], radius = 1.0 }
albedo = [0.2, 0.2, 0.9]

[[lights]]
sky = { uniform = [1.0, 1.0, 1.0] }

[[lights]]
key = { direction = [1.0, 0.0, 1.0], angular_radius = 5.0, radiance = [10.0, 9.0, 8.0] }
"#;

impl Folder {
    /// A folder with `cube.ply`.
    pub(crate) fn new() -> Self {
        let folder = Folder(tempfile::tempdir().unwrap());
        folder.write("cube.ply", cube_ply());
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// The scene of a text, loaded as `scene.toml` of this folder.
    pub(crate) fn load(&self, text: &str) -> Result<Scene, SceneError> {
        self.write("scene.toml", text);
        Scene::load(&self.path("scene.toml"))
    }

    /// [`SCENE`] with replacements, each of which must find something.
    pub(crate) fn load_with(&self, replacements: &[(&str, &str)]) -> Result<Scene, SceneError> {
        self.load(&with(replacements))
    }

    /// The mesh of a file as a scene loads it; `options` go into its table.
    pub(crate) fn mesh(&self, file: &str, options: &str) -> Result<Mesh, SceneError> {
        let scene = self.load_with(&[(r#"{ file = "cube.ply" }"#, &format!(r#"{{ file = "{file}"{options} }}"#))])?;
        match &*scene.objects[1].shape {
            Shape::Mesh(mesh) => Ok(mesh.clone()),
            _ => panic!("the second object is a mesh"),
        }
    }
}

/// [`SCENE`] with replacements.
pub(crate) fn with(replacements: &[(&str, &str)]) -> String {
    replacements.iter().fold(SCENE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "nothing to replace: {from}");
        text.replace(from, to)
    })
}
