//! Point clustering: sites are handed out to balls in flood-fill order, away from the balls' centres.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::Vec3;
use rayon::prelude::*;

use crate::samples::Samples;
use crate::voxels::Voxels;

/// Not yet handed out.
const NOBODY: u32 = u32::MAX;

/// The owner of every site. A site goes to the ball whose outside volume grows least when its radius is extended to
/// reach it; the neighbours of a site are offered to its owner (Ren 2006, §6.2).
pub(crate) fn flood(voxels: &Voxels, samples: &Samples, centers: &[Vec3]) -> Vec<u32> {
    let mut flood = Flood {
        samples,
        balls: centers.iter().map(|center| Growing::new(voxels, *center, 0.5 * samples.spacing)).collect(),
        owner: vec![NOBODY; samples.sites.len()],
        last_offer: vec![NOBODY; samples.sites.len()],
        heap: BinaryHeap::new(),
    };
    let seeds: Vec<usize> = centers.par_iter().map(|center| nearest(&samples.sites, *center)).collect();
    seeds.iter().enumerate().for_each(|(ball, site)| flood.offer(*site, ball));
    flood.run();
    for site in 0..samples.sites.len() {
        // Parts that hang together with no seed begin at their first site, with the ball that pays least for it.
        if flood.owner[site] == NOBODY {
            (0..centers.len()).for_each(|ball| flood.offer(site, ball));
            flood.run();
        }
    }
    flood.owner
}

/// The point nearest to a place; the first of several.
fn nearest(points: &[Vec3], place: Vec3) -> usize {
    let distance = |i: &usize| points[*i].distance_squared(place);
    (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

struct Flood<'a> {
    samples: &'a Samples,
    balls: Vec<Growing<'a>>,
    owner: Vec<u32>,
    /// The ball that was offered each site last: most repeated offers are caught by this alone.
    last_offer: Vec<u32>,
    heap: BinaryHeap<Offer>,
}

impl Flood<'_> {
    fn offer(&mut self, site: usize, ball: usize) {
        let cost = self.balls[ball].cost(self.samples.sites[site]);
        self.heap.push(Offer { cost, site: site as u32, ball: ball as u32 });
    }

    fn run(&mut self) {
        while let Some(Offer { site, ball, .. }) = self.heap.pop() {
            if self.owner[site as usize] != NOBODY {
                continue;
            }
            self.owner[site as usize] = ball;
            self.balls[ball as usize].extend(self.samples.sites[site as usize]);
            let samples = self.samples;
            for next in samples.neighbours(site as usize) {
                if self.owner[next] == NOBODY && self.last_offer[next] != ball {
                    self.last_offer[next] = ball;
                    self.offer(next, ball as usize);
                }
            }
        }
    }
}

/// A ball around a fixed centre, and its outside volume by radius, tabulated as far as it was asked.
struct Growing<'a> {
    voxels: &'a Voxels,
    center: Vec3,
    radius: f32,
    step: f32,
    table: Vec<f32>,
}

impl<'a> Growing<'a> {
    fn new(voxels: &'a Voxels, center: Vec3, step: f32) -> Self {
        Growing { voxels, center, radius: 0.0, step, table: Vec::new() }
    }

    fn extend(&mut self, point: Vec3) {
        self.radius = self.radius.max(self.center.distance(point));
    }

    /// Outside volume added by extending the radius to a point.
    fn cost(&mut self, point: Vec3) -> f32 {
        let distance = self.center.distance(point);
        if distance <= self.radius { 0.0 } else { self.outside(distance) - self.outside(self.radius) }
    }

    fn outside(&mut self, radius: f32) -> f32 {
        let position = radius / self.step;
        let i = position as usize;
        while self.table.len() < i + 2 {
            let volume = self.voxels.outside(self.center, self.table.len() as f32 * self.step);
            let grown = self.table.last().map_or(volume, |last| volume.max(*last));
            self.table.push(grown);
        }
        self.table[i] + (position - i as f32) * (self.table[i + 1] - self.table[i])
    }
}

/// A site offered to a ball. The cheapest is greatest, then the lower site and ball, so that order never depends on
/// the heap.
#[derive(PartialEq)]
struct Offer {
    cost: f32,
    site: u32,
    ball: u32,
}

impl Eq for Offer {}

impl Ord for Offer {
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.site.cmp(&self.site)).then(other.ball.cmp(&self.ball))
    }
}

impl PartialOrd for Offer {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
