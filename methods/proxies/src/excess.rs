//! By how much a posed mesh leaves the spheres that stand for it.

use halflight_scenes::{Object, PosedObject, Shape};

use crate::Proxy;
use crate::voxels::bounds;

/// Share of the model's size by which carried spheres and vertices may differ by rounding.
const ROUNDING: f32 = 1e-5;

/// By how much the vertices of an object at one time leave its spheres, which hold them all at rest: the centres follow
/// the mesh, the radii stay (Ren 2006, §6.2, takes them for a bound "assuming typical articulated motion").
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excess {
    /// Share of the vertices that lie outside all spheres (by more than rounding), in `[0, 1]`.
    pub outside: f32,
    /// Largest distance from such a vertex to the nearest sphere, in metres.
    pub farthest: f32,
    /// The same relative to the longest side of the bounding box at rest.
    pub relative: f32,
}

impl Proxy {
    /// The excess of an object where it is at a time (`of` at `time` is `object`). Nothing leaves what is no mesh. It asks for every
    /// vertex and sphere, so that it belongs beside a frame, not into it.
    pub fn excess(&self, of: &Object, object: &PosedObject, time: f32) -> Excess {
        let (Shape::Mesh(rest), Shape::Mesh(mesh)) = (&*of.shape, &*object.shape) else { return Excess::default() };
        let spheres = self.posed(of, object, time);
        let gap = |point| spheres.iter().map(|s| s.center.distance(point) - s.radius).fold(f32::INFINITY, f32::min);
        let (low, high) = bounds(&rest.positions);
        let size = (high - low).max_element();
        let gaps = mesh.positions.iter().map(|p| gap(object.pose.point(*p)));
        let outside: Vec<f32> = gaps.filter(|gap| *gap > ROUNDING * size).collect();
        let farthest = outside.iter().copied().fold(0.0, f32::max);
        Excess {
            outside: outside.len() as f32 / mesh.positions.len().max(1) as f32,
            farthest,
            relative: if size > 0.0 { farthest / size } else { 0.0 },
        }
    }
}
