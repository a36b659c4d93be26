//! 16 points at which accessibility is asked, side by side.

use glam::Vec3;
use halflight_sh::LANES;

/// One number a lane.
pub(crate) type Lanes = [f32; LANES];

/// Points with normals, coordinate by coordinate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Points {
    pub(crate) position: [Lanes; 3],
    pub(crate) normal: [Lanes; 3],
}

/// Vectors and the squares of their lengths.
pub(crate) struct Directions {
    pub(crate) vector: [Lanes; 3],
    pub(crate) square: Lanes,
}

impl Points {
    /// Up to 16 points; lanes beyond repeat the first, so that they ask for nothing that nobody else does.
    pub(crate) fn new(points: impl IntoIterator<Item = (Vec3, Vec3)>) -> Self {
        let mut lanes = Points { position: [[0.0; LANES]; 3], normal: [[0.0; LANES]; 3] };
        let mut count = 0;
        for (lane, (position, normal)) in points.into_iter().enumerate() {
            lanes.set(lane, position.to_array(), normal.to_array());
            count = lane + 1;
        }
        let first = [lanes.position, lanes.normal].map(|vectors| vectors.map(|axis| axis[0]));
        (count..LANES).for_each(|lane| lanes.set(lane, first[0], first[1]));
        lanes
    }

    /// From each point to one that all look at.
    pub(crate) fn to(&self, center: Vec3) -> Directions {
        let center = center.to_array();
        let vector: [Lanes; 3] =
            std::array::from_fn(|axis| self.position[axis].map(|position| center[axis] - position));
        let [x, y, z] = &vector;
        let square = std::array::from_fn(|lane| x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane]);
        Directions { vector, square }
    }

    fn set(&mut self, lane: usize, position: [f32; 3], normal: [f32; 3]) {
        for axis in 0..3 {
            self.position[axis][lane] = position[axis];
            self.normal[axis][lane] = normal[axis];
        }
    }
}
