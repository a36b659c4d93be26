//! The scene: everything that a scene file says, loaded and checked.

use std::sync::Arc;

use glam::Vec3;
use halflight_trace::{Instance, World};

use crate::bodies::Part;
use crate::content::Collector;
use crate::{
    Bodies, Camera, Content, DistantLight, Frame, Light, Object, Placement, Pose, PosedLight, PosedObject, Receivers,
    Rgb, SceneFacts, Shape, placement,
};

/// A loaded scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name: the scene file's stem.
    pub name: String,
    /// One line: what this scene is for.
    pub purpose: String,
    /// Hash of everything that decides its pictures: shapes, albedos, motion, lights, camera, receivers and frames,
    /// but neither names nor where files lie.
    pub content: Content,
    /// Objects.
    pub objects: Vec<Object>,
    /// Distant lights.
    pub lights: Vec<DistantLight>,
    /// Camera, where the scene has one.
    pub camera: Option<Camera>,
    /// Where light is asked.
    pub placement: Placement,
    /// Number of frames, at least 1.
    pub frame_count: usize,
    /// Frames a second; frame `i` is at `i / fps` seconds.
    pub fps: f32,
    /// What loading had to repair, one line each.
    pub notices: Vec<String>,
    /// What frames share for tracing; an empty one is filled as worlds are asked for.
    pub bodies: Bodies,
}

/// Which objects a traced world holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// Those that cast shadows.
    Casters,
    /// All, as the camera sees them.
    All,
}

impl Scene {
    /// Facts for planning.
    pub fn facts(&self) -> SceneFacts {
        let mut facts = SceneFacts {
            objects: self.objects.len(),
            casters: self.objects.iter().filter(|object| object.casts).count(),
            emitters: self.objects.iter().filter(|object| object.emits()).count(),
            frames: self.frame_count,
            moving: self.objects.iter().any(|object| !object.rests()),
            turning: self.lights.iter().filter(|light| light.turn.is_some()).count(),
            deforming: self.objects.iter().filter(|object| object.deformation.is_some()).count(),
            receivers: self.receiver_count(),
            ..SceneFacts::default()
        };
        for object in &self.objects {
            match &*object.shape {
                Shape::Mesh(mesh) => facts.triangles += mesh.triangles.len(),
                Shape::Spheres(spheres) => {
                    facts.spheres += spheres.len();
                    facts.lamps += usize::from(object.emits());
                }
                Shape::Heights(field) => {
                    facts.triangles += field.triangles();
                    facts.height_fields += usize::from(object.casts);
                }
            }
        }
        for light in &self.lights {
            match light.rest {
                Light::Environment(_) => facts.environments += 1,
                Light::Sky(_) => facts.skies += 1,
                Light::Key(_) => facts.key_lights += 1,
            }
        }
        facts
    }

    /// The scene posed at frame `index < frame_count`, with its receivers.
    pub fn frame(&self, index: usize) -> Frame {
        assert!(index < self.frame_count, "the scene has {} frames", self.frame_count);
        let time = index as f32 / self.fps;
        let pose = |(index, object): (usize, &Object)| {
            let (shape, content) = object.shape_at(time);
            let pose = object.pose_at(time);
            PosedObject { object: index, shape, content, pose, revision: object.revision(content, pose) }
        };
        let objects: Vec<PosedObject> = self.objects.iter().enumerate().map(pose).collect();
        let now = |light: Light| PosedLight { revision: light.content().revision(), light };
        let lights = self.lights.iter().map(|light| now(light.at(time))).collect();
        let receivers = Arc::new(self.receivers(&objects));
        Frame { index, time, objects, lights, receivers }
    }

    /// The objects at a frame, ready to be traced. The geometry index of a hit is the index of its object; objects
    /// left out keep theirs. Hierarchies over triangles and spheres are built for the first frame that needs them;
    /// later ones get a new top level over what moves.
    pub fn world(&self, frame: &Frame, which: Which) -> World {
        self.trace(&frame.objects, which)
    }

    /// The same scene with receivers at given positions and unit normals, albedo 1.
    pub fn with_receivers(&self, points: &[(Vec3, Vec3)]) -> Scene {
        Scene { placement: Placement::Points(Arc::new(points.to_vec())), ..self.clone() }.as_changed()
    }

    /// The scene after its fields were changed: its content is that of what it holds now. An object whose shape was changed
    /// must have that shape's content.
    pub fn as_changed(self) -> Scene {
        Scene { content: self.compute_content(), ..self }
    }

    pub(crate) fn compute_content(&self) -> Content {
        let all = Collector::new("scene").word(self.frame_count).float(self.fps);
        let all = all.list(&self.objects, |all, object| {
            let all = object.emission.collect(all.content(object.content).vec3(object.albedo));
            let all = all.word(object.casts.into()).vec3(object.pivot);
            let all = all.list(object.texture.as_slice(), |all, texture| all.content(texture.content()));
            let all = all.list(object.deformation.as_slice(), |all, deformation| all.content(deformation.content()));
            all.list(&object.motion, |all, (time, pose)| all.float(*time).quat(pose.rotation).vec3(pose.translation))
        });
        let all = all.list(&self.lights, |all, light| all.content(light.content()));
        let seen = matches!(self.placement, Placement::Camera).then_some(self.camera).flatten();
        let all = all.list(seen.as_slice(), |all, camera| camera.collect(all));
        self.placement.collect(all).finish()
    }

    /// What never moves is one body, so that rays pay for two levels only where something does.
    fn trace(&self, posed: &[PosedObject], which: Which) -> World {
        let held = posed.iter().filter(|posed| which == Which::All || self.objects[posed.object].casts);
        let (fixed, moving): (Vec<_>, Vec<_>) =
            held.partition(|posed| self.objects[posed.object].rests() && posed.pose == Pose::IDENTITY);
        let fixed: Vec<Part> = fixed.into_iter().map(|posed| Part::new(posed.object as u32, posed)).collect();
        let instance = |posed: &PosedObject| {
            let (index, part) = (posed.object as u32, Part::new(0, posed));
            let body = match self.objects[posed.object].deformation {
                None => self.bodies.of(&[part]),
                Some(_) => self.bodies.passing(index, part),
            };
            Instance::new(body, posed.pose.rotation, posed.pose.translation, index)
        };
        World::new(self.bodies.of(&fixed), &moving.into_iter().map(instance).collect::<Vec<_>>())
    }

    fn receivers(&self, objects: &[PosedObject]) -> Receivers {
        match &self.placement {
            Placement::Camera => {
                let camera = self.camera.as_ref().expect("a scene with camera receivers has a camera");
                let posed: Vec<_> = objects.iter().map(PosedObject::in_place).collect();
                placement::pixels(camera, &self.trace(objects, Which::All), &self.objects, &posed)
            }
            Placement::Vertices { object } => match &*objects[*object].in_place() {
                Shape::Mesh(mesh) => placement::vertices(*object, mesh, &self.objects[*object]),
                _ => unreachable!("vertex receivers lie on a mesh"),
            },
            Placement::Heights { object } => match &*objects[*object].in_place() {
                Shape::Heights(field) => placement::heights(*object, field, self.objects[*object].albedo),
                _ => unreachable!("receivers of a height field lie on one"),
            },
            Placement::Grid(grid) => match grid.object {
                Some(object) => grid.receivers(self.objects[object].albedo, objects[object].pose),
                None => grid.receivers(Rgb::ONE, Pose::IDENTITY),
            },
            Placement::Points(points) => placement::points(points),
        }
    }

    fn receiver_count(&self) -> usize {
        match &self.placement {
            Placement::Camera => self.camera.map_or(0, |camera| camera.width * camera.height),
            Placement::Vertices { object } => match &*self.objects[*object].shape {
                Shape::Mesh(mesh) => mesh.positions.len(),
                _ => 0,
            },
            Placement::Heights { object } => match &*self.objects[*object].shape {
                Shape::Heights(field) => field.heights().len(),
                _ => 0,
            },
            Placement::Grid(grid) => grid.resolution[0] * grid.resolution[1],
            Placement::Points(points) => points.len(),
        }
    }
}
