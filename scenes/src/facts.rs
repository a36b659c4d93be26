//! Facts about a scene that decide what is run, before any work.

/// What a method may ask before it says whether it supports a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneFacts {
    /// Objects, and how many of them cast shadows.
    pub objects: usize,
    /// Objects that cast shadows.
    pub casters: usize,
    /// Objects that emit light.
    pub emitters: usize,
    /// Those of them that are spheres.
    pub lamps: usize,
    /// Triangles of all meshes and height fields.
    pub triangles: usize,
    /// Height fields that cast shadows.
    pub height_fields: usize,
    /// Exact spheres of all objects.
    pub spheres: usize,
    /// Environment maps.
    pub environments: usize,
    /// Analytic skies.
    pub skies: usize,
    /// Circular key lights.
    pub key_lights: usize,
    /// Environments and key lights that turn.
    pub turning: usize,
    /// Frames in the sequence.
    pub frames: usize,
    /// Whether any object moves or deforms.
    pub moving: bool,
    /// Objects that change their shape.
    pub deforming: usize,
    /// Receivers a frame.
    pub receivers: usize,
}

impl SceneFacts {
    /// Lights that are infinitely far away.
    pub fn distant_lights(&self) -> usize {
        self.environments + self.skies + self.key_lights
    }
}
