//! Receivers: the points where light is asked, in structure-of-arrays form.

use glam::{Vec2, Vec3};

use crate::content::Collector;
use crate::{Revision, Rgb};

/// How receivers are laid out, for pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// Row-major image of camera pixels, of a plane grid or of a height field; receiver `i` is pixel `(i % width, i / width)`.
    Image {
        /// Pixels a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Points without a picture.
    List,
}

/// Where a receiver lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Object index, if it lies on one.
    pub object: Option<u32>,
    /// Triangle, vertex or sphere index within the object.
    pub primitive: u32,
    /// Barycentric weights of the triangle's second and third corner.
    pub barycentrics: [f32; 2],
    /// Texture or grid coordinates; on a height field `(i, j)` at vertex `(i, j)`.
    pub uv: Vec2,
}

/// All receivers of a frame. Every vector has the same length. Entries with `valid == false` (camera pixels that
/// see no surface) hold zeros, and their output is ignored.
#[derive(Clone, Debug)]
pub struct Receivers {
    /// Picture layout.
    pub layout: Layout,
    /// Positions in metres.
    pub position: Vec<Vec3>,
    /// Unit geometric normals, on the side from which the receiver is seen.
    pub geometric_normal: Vec<Vec3>,
    /// Unit shading normals.
    pub normal: Vec<Vec3>,
    /// Diffuse albedo.
    pub albedo: Vec<Rgb>,
    /// Whether the receiver exists.
    pub valid: Vec<bool>,
    /// Where each lies.
    pub place: Vec<Place>,
    /// Changes exactly when any of the above does.
    pub revision: Revision,
}

/// One receiver.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub(crate) position: Vec3,
    pub(crate) geometric_normal: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) albedo: Rgb,
    pub(crate) place: Place,
}

impl Place {
    pub(crate) const NOWHERE: Place = Place { object: None, primitive: 0, barycentrics: [0.0; 2], uv: Vec2::ZERO };
}

impl Receiver {
    const NONE: Receiver = Receiver {
        position: Vec3::ZERO,
        geometric_normal: Vec3::ZERO,
        normal: Vec3::ZERO,
        albedo: Rgb::ZERO,
        place: Place::NOWHERE,
    };
}

impl Receivers {
    /// Gathers receivers into arrays; `None` is an entry that is not valid.
    pub(crate) fn gather(layout: Layout, receivers: &[Option<Receiver>]) -> Self {
        fn column<T>(receivers: &[Option<Receiver>], field: impl Fn(&Receiver) -> T) -> Vec<T> {
            receivers.iter().map(|receiver| field(receiver.as_ref().unwrap_or(&Receiver::NONE))).collect()
        }
        Receivers {
            layout,
            position: column(receivers, |r| r.position),
            geometric_normal: column(receivers, |r| r.geometric_normal),
            normal: column(receivers, |r| r.normal),
            albedo: column(receivers, |r| r.albedo),
            valid: receivers.iter().map(Option::is_some).collect(),
            place: column(receivers, |r| r.place),
            revision: revision(layout, receivers),
        }
    }

    /// Some of them, by index, as a list.
    pub fn select(&self, indices: &[usize]) -> Receivers {
        let receiver = |&i: &usize| {
            self.valid[i].then_some(Receiver {
                position: self.position[i],
                geometric_normal: self.geometric_normal[i],
                normal: self.normal[i],
                albedo: self.albedo[i],
                place: self.place[i],
            })
        };
        Receivers::gather(Layout::List, &indices.iter().map(receiver).collect::<Vec<_>>())
    }

    /// Number of receivers, valid or not.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }
}

fn revision(layout: Layout, receivers: &[Option<Receiver>]) -> Revision {
    let (width, height) = match layout {
        Layout::Image { width, height } => (width, height),
        Layout::List => (0, 0),
    };
    let all = Collector::new("receivers").word(width).word(height);
    let all = all.list(receivers, |all, receiver| match receiver {
        None => all.word(0),
        Some(Receiver { position, geometric_normal, normal, albedo, place }) => {
            let all = all.word(1).vec3(*position).vec3(*geometric_normal).vec3(*normal).vec3(*albedo);
            let all = all.word(place.object.map_or(0, |object| object as usize + 1)).word(place.primitive as usize);
            all.floats(&place.barycentrics).vec2(place.uv)
        }
    });
    all.finish().revision()
}
