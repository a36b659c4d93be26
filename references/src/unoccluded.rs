//! What receivers would reflect with nothing in the way: `1/π ∫ L(ω) max(0, n·ω) dω`, without sampling.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DMat3, DVec3};
use halflight_light::ShLight;
use halflight_scenes::{Environment, KeyLight, Light, Sky};
use halflight_sh::{coefficients, irradiance_weights};

use crate::analytic;

/// Light whose unoccluded reflection is known for every normal.
pub(crate) enum Unoccluded {
    /// The sum of lights.
    Lights(Vec<Open>),
    /// Light in spherical harmonics.
    Harmonics(std::sync::Arc<ShLight>),
}

/// One light.
pub(crate) enum Open {
    Map(Box<OpenMap>),
    Sky(Sky),
    Key(KeyLight),
}

impl Unoccluded {
    pub(crate) fn of(lights: &[Light]) -> Self {
        Unoccluded::Lights(lights.iter().map(Open::of).collect())
    }

    /// Reflected radiance for albedo 1 and a unit normal.
    pub(crate) fn at(&self, normal: DVec3) -> DVec3 {
        match self {
            Unoccluded::Lights(lights) => lights.iter().map(|light| light.at(normal)).sum(),
            Unoccluded::Harmonics(light) => {
                let mut weights = [0.0; coefficients(halflight_sh::MAX_ORDER)];
                let weights = &mut weights[..coefficients(light.order)];
                irradiance_weights(light.order, normal.to_array(), weights);
                let sum = |channel: &Vec<f32>| channel.iter().zip(&*weights).map(|(c, w)| f64::from(*c) * w).sum();
                DVec3::from_array(light.rgb.each_ref().map(sum))
            }
        }
    }
}

impl Open {
    fn of(light: &Light) -> Self {
        match light {
            Light::Environment(map) => Open::Map(Box::new(OpenMap::new(map))),
            Light::Sky(sky) => Open::Sky(*sky),
            Light::Key(key) => Open::Key(*key),
        }
    }

    fn at(&self, normal: DVec3) -> DVec3 {
        match self {
            Open::Map(map) => map.at(normal),
            Open::Sky(Sky::Uniform(radiance)) => radiance.as_dvec3(),
            Open::Sky(Sky::Overcast(zenith)) => {
                zenith.as_dvec3() * analytic::overcast(normal.z.clamp(-1.0, 1.0).acos())
            }
            Open::Key(key) => open_key(key, normal),
        }
    }
}

/// What a surface of albedo 1 reflects of a key light with nothing in the way.
pub(crate) fn open_key(key: &KeyLight, normal: DVec3) -> DVec3 {
    let towards = key.direction.as_dvec3();
    // atan2 keeps its digits for a light at the zenith, where acos has lost half of them.
    let angle = towards.cross(normal).length().atan2(towards.dot(normal));
    key.radiance.as_dvec3() * analytic::circle(f64::from(key.angular_radius), angle)
}

/// An environment map, in blocks of texels whose light is known as a vector: what lies wholly above the horizon reflects its
/// product with the normal. Texels on the horizon are cut into cells.
pub(crate) struct OpenMap {
    map: Environment,
    blocks: Vec<Block>,
    /// `∫ sin²θ dθ` and `∫ sin θ cos θ dθ` of each row.
    rows: Vec<[f64; 2]>,
    /// `∫ cos φ dφ` and `∫ sin φ dφ` of each column.
    columns: Vec<[f64; 2]>,
    /// `sin θ`, `cos θ` and reach of the texels of each row.
    row_middles: Vec<[f64; 3]>,
    /// `cos φ` and `sin φ` of the middle of each column.
    column_middles: Vec<[f64; 2]>,
    /// Cells across and down a texel.
    cuts: usize,
    /// `sin θ`, `cos θ` and solid angle of the cells of each row of cells.
    cell_rows: Vec<[f64; 3]>,
    /// `cos φ` and `sin φ` of each column of cells.
    cell_columns: Vec<[f64; 2]>,
}

/// Texels on a side of a block.
const SIDE: usize = 8;
/// Cells on the horizon are this wide at most, in radians: the midpoint rule over them errs by a quarter of its square.
const CELL: f64 = 0.006;

/// A rectangle of texels.
struct Block {
    extent: Patch,
    texels: [std::ops::Range<usize>; 2],
    /// `∫ L ω dω`: times a normal, the light of each channel.
    light: DMat3,
}

/// A middle direction, and the sine of the angle within which everything lies; 2 if that is more than a right angle.
struct Patch {
    middle: DVec3,
    reach: f64,
}

impl Patch {
    /// Polar angles and azimuths from and to.
    fn new([top, bottom]: [f64; 2], [left, right]: [f64; 2]) -> Self {
        let (theta, phi) = (middle([top, bottom]), middle([left, right]));
        let widest = if top < FRAC_PI_2 && bottom > FRAC_PI_2 { 1.0 } else { top.sin().max(bottom.sin()) };
        let radius = 0.5 * (bottom - top) + 0.5 * (right - left) * widest;
        let direction = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        Patch { middle: direction, reach: if radius < FRAC_PI_2 { radius.sin() } else { 2.0 } }
    }
}

impl OpenMap {
    fn new(map: &Environment) -> Self {
        let (width, height) = (map.width, map.height);
        let theta = |row: usize, rows: usize| PI * row as f64 / rows as f64;
        let phi = |column: usize, columns: usize| TAU * column as f64 / columns as f64;
        let columns = |count: usize| -> Vec<[f64; 2]> {
            let at = |column| middle([phi(column, count), phi(column + 1, count)]).sin_cos();
            (0..count).map(at).map(|(sin, cos)| [cos, sin]).collect()
        };
        let cuts = (PI / height as f64 / CELL).max(TAU / width as f64 / CELL).ceil() as usize;
        let (cells_down, cells_across) = (height * cuts, width * cuts);
        let mut open = OpenMap {
            map: map.clone(),
            blocks: Vec::new(),
            rows: (0..height).map(|row| row_moments(theta(row, height), theta(row + 1, height))).collect(),
            columns: (0..width).map(|column| column_moments(phi(column, width), phi(column + 1, width))).collect(),
            row_middles: (0..height)
                .map(|row| {
                    let extent = [theta(row, height), theta(row + 1, height)];
                    let (sin, cos) = middle(extent).sin_cos();
                    [sin, cos, Patch::new(extent, [0.0, phi(1, width)]).reach]
                })
                .collect(),
            column_middles: columns(width),
            cuts,
            cell_rows: (0..cells_down)
                .map(|row| {
                    let extent = [theta(row, cells_down), theta(row + 1, cells_down)];
                    let (sin, cos) = middle(extent).sin_cos();
                    [sin, cos, TAU / cells_across as f64 * (extent[0].cos() - extent[1].cos())]
                })
                .collect(),
            cell_columns: columns(cells_across),
        };
        for top in (0..height).step_by(SIDE) {
            for left in (0..width).step_by(SIDE) {
                let texels = [top..height.min(top + SIDE), left..width.min(left + SIDE)];
                open.blocks.push(open.block(texels));
            }
        }
        open
    }

    fn block(&self, texels: [std::ops::Range<usize>; 2]) -> Block {
        let mut light = DMat3::ZERO;
        for row in texels[0].clone() {
            for column in texels[1].clone() {
                let (radiance, vector) = (self.radiance(row, column), self.vector(row, column));
                light += DMat3::from_cols(radiance * vector.x, radiance * vector.y, radiance * vector.z);
            }
        }
        Block { extent: self.patch(&texels), texels, light }
    }

    fn patch(&self, [rows, columns]: &[std::ops::Range<usize>; 2]) -> Patch {
        let theta = |row: usize| PI * row as f64 / self.map.height as f64;
        let phi = |column: usize| TAU * column as f64 / self.map.width as f64;
        Patch::new([theta(rows.start), theta(rows.end)], [phi(columns.start), phi(columns.end)])
    }

    fn radiance(&self, row: usize, column: usize) -> DVec3 {
        self.map.texels[row * self.map.width + column].as_dvec3()
    }

    /// `∫ ω dω` over a texel.
    fn vector(&self, row: usize, column: usize) -> DVec3 {
        let ([across, down], [cos, sin]) = (self.rows[row], self.columns[column]);
        DVec3::new(across * cos, across * sin, down * TAU / self.map.width as f64)
    }

    fn at(&self, normal: DVec3) -> DVec3 {
        // The tables are in the map's own frame.
        let normal = glam::DQuat::from_rotation_z(-f64::from(self.map.rotation)) * normal;
        let mut sum = DVec3::ZERO;
        for block in &self.blocks {
            let height = normal.dot(block.extent.middle);
            if height >= block.extent.reach {
                sum += block.light * normal;
            } else if height > -block.extent.reach {
                sum += self.on_horizon(block, normal);
            }
        }
        sum / PI
    }

    fn on_horizon(&self, block: &Block, normal: DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for row in block.texels[0].clone() {
            let [sin, cos, reach] = self.row_middles[row];
            for column in block.texels[1].clone() {
                let [x, y] = self.column_middles[column];
                let height = sin * (normal.x * x + normal.y * y) + cos * normal.z;
                if height >= reach {
                    sum += self.radiance(row, column) * self.vector(row, column).dot(normal);
                } else if height > -reach {
                    sum += self.radiance(row, column) * self.by_cells(row, column, normal);
                }
            }
        }
        sum
    }

    fn by_cells(&self, row: usize, column: usize, normal: DVec3) -> f64 {
        let columns = &self.cell_columns[column * self.cuts..][..self.cuts];
        let rows = &self.cell_rows[row * self.cuts..][..self.cuts];
        rows.iter()
            .map(|[sin, cos, solid_angle]| {
                let heights =
                    columns.iter().map(|[x, y]| (sin * (normal.x * x + normal.y * y) + cos * normal.z).max(0.0));
                solid_angle * heights.sum::<f64>()
            })
            .sum()
    }
}

fn middle([from, to]: [f64; 2]) -> f64 {
    0.5 * (from + to)
}

fn row_moments(top: f64, bottom: f64) -> [f64; 2] {
    let squares = 0.5 * (bottom - top) - 0.25 * ((2.0 * bottom).sin() - (2.0 * top).sin());
    [squares, 0.5 * (bottom.sin().powi(2) - top.sin().powi(2))]
}

fn column_moments(left: f64, right: f64) -> [f64; 2] {
    [right.sin() - left.sin(), left.cos() - right.cos()]
}
