//! Spheres around the cells of an octree (Hubbard 1995).

use glam::Vec3;

use crate::body::{Body, Parts};
use crate::cluster::Ball;
use crate::voxels::Voxels;

/// Cells are not divided more often: twice as finely as single precision tells points apart.
const DEEPEST: u32 = 24;
/// Half the side of the first cell, in the unit frame; the excess is for rounding.
const HALF: f32 = 0.500_01;

/// Starts with a cube around the object. The cell whose sphere has the largest outside volume is divided into octants, of
/// which those that hold points (of the surface or inside) are kept; it stays whole if there were more than `count` cells
/// then. Each is bounded by the sphere through its corners. Hubbard divides all cells of a level; dividing the worst serves
/// any count.
pub(crate) fn parts(body: &Body<'_>, count: usize) -> Parts {
    let all = (0..body.points.len() as u32).collect();
    let mut open = vec![Cell::new(&body.voxels, Vec3::ZERO, HALF, 0, all)];
    let mut whole: Vec<Cell> = Vec::new();
    while let Some(worst) = worst(&open) {
        let cell = open.swap_remove(worst);
        let octants = cell.octants(body);
        // What does not fit now never will: the number of cells only grows.
        if octants.is_empty() || open.len() + whole.len() + octants.len() > count {
            whole.push(cell);
        } else {
            open.extend(octants);
        }
    }
    let (balls, held) = whole.into_iter().map(|cell| (cell.ball, cell.held)).unzip();
    Parts { balls, held }
}

fn worst(cells: &[Cell]) -> Option<usize> {
    (0..cells.len()).max_by(|a, b| cells[*a].ball.outside.total_cmp(&cells[*b].ball.outside))
}

struct Cell {
    half: f32,
    depth: u32,
    ball: Ball,
    held: Vec<u32>,
}

impl Cell {
    fn new(voxels: &Voxels, center: Vec3, half: f32, depth: u32, held: Vec<u32>) -> Cell {
        // Points on a corner are held in spite of rounding.
        let radius = 1.000_01 * 3.0_f32.sqrt() * half;
        Cell { half, depth, ball: Ball { center, radius, outside: voxels.outside(center, radius) }, held }
    }

    /// The octants that hold points; none of a cell that needs no division.
    fn octants(&self, body: &Body<'_>) -> Vec<Cell> {
        if self.depth == DEEPEST || self.ball.outside == 0.0 {
            return Vec::new();
        }
        let mut held: [Vec<u32>; 8] = Default::default();
        for point in &self.held {
            let octant = body.points[*point as usize].cmpge(self.ball.center).bitmask();
            held[octant as usize].push(*point);
        }
        let half = 0.5 * self.half;
        let side = |octant: usize, axis: usize| if octant >> axis & 1 == 1 { half } else { -half };
        let center = |octant: usize| self.ball.center + Vec3::from([0, 1, 2].map(|axis| side(octant, axis)));
        let occupied = held.into_iter().enumerate().filter(|(_, held)| !held.is_empty());
        occupied.map(|(i, held)| Cell::new(&body.voxels, center(i), half, self.depth + 1, held)).collect()
    }
}
