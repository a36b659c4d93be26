//! Spheres along the medial axis, merged in pairs, in the style of Bradshaw and O'Sullivan 2004.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::Vec3;
use rayon::prelude::*;

use crate::body::{Body, Parts};
use crate::cluster::{Ball, Lanes, SLACK};
use crate::minimise::powell;
use crate::samples::thinned;

/// Evaluations of a radius in the search for the smallest ball around points, and its first step in radii.
const EVALUATIONS: usize = 80;
const STEP: f32 = 0.2;
/// Smallest radius, in the unit frame.
const SMALLEST: f32 = 1e-7;

/// 1. Around each sample inside (the points of a grid) the largest ball that holds no sample of the surface.
/// 2. Largest first, a ball is kept if it comes nearer than the samples' spacing to a sample, of the surface or inside,
///    that no kept ball comes near to. What is kept lies along the medial axis, where such balls are larger than those around.
///    Where there is none, as on thin parts and open surfaces, a sample is a ball of its own.
/// 3. Of two balls that touch, the smallest ball around the samples of both takes the place, until `count` are left. The
///    pair whose merger adds least goes first. Bradshaw and O'Sullivan take the pair that leaves the object least far; what is added
///    here is outside volume, so that the set is good in what it is measured by.
/// 4. Every point is given to the ball that it is nearest to, and balls are as large as their points ask.
pub(crate) fn parts(body: &Body<'_>, count: usize) -> Parts {
    let kept = cover(&body.samples.points, &inscribed_balls(body), body.samples.spacing);
    let mut merging = Merging::new(body, kept);
    merging.run(count);
    let mut balls: Vec<Ball> = merging.parts.into_iter().flatten().map(|part| part.ball).collect();
    let held = body.shared_out(balls.len(), |point| nearest(&balls, point));
    for (ball, held) in balls.iter_mut().zip(&held) {
        let distances = held.iter().map(|i| body.points[*i as usize].distance(ball.center));
        ball.radius = distances.fold(0.0, f32::max) * SLACK;
    }
    Parts { balls, held }
}

/// The balls of step 1.
fn inscribed_balls(body: &Body<'_>) -> Vec<Ball> {
    let inside = &body.samples.interior;
    let surface = &body.points[..body.points.len() - inside.len()];
    let surface = Lanes::new(thinned(surface, 0.5 * body.samples.spacing).into_iter().map(|i| surface[i]));
    inside.par_iter().map(|center| Ball { center: *center, radius: surface.nearest(*center), outside: 0.0 }).collect()
}

/// Step 2: balls, and for each the samples it covers first.
fn cover(samples: &[Vec3], balls: &[Ball], spacing: f32) -> Vec<(Ball, Vec<u32>)> {
    let mut order: Vec<&Ball> = balls.iter().collect();
    order.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let mut bare: Vec<u32> = (0..samples.len() as u32).collect();
    let mut kept = Vec::new();
    let mut keep = |ball: Ball, bare: &mut Vec<u32>| {
        let reach = (ball.radius + spacing) * (ball.radius + spacing);
        let near = |i: &mut u32| samples[*i as usize].distance_squared(ball.center) < reach;
        let covered: Vec<u32> = bare.extract_if(.., near).collect();
        if !covered.is_empty() {
            kept.push((ball, covered));
        }
    };
    order.into_iter().for_each(|ball| keep(*ball, &mut bare));
    while let Some(first) = bare.first() {
        keep(Ball { center: samples[*first as usize], ..Ball::default() }, &mut bare);
    }
    kept
}

/// A ball around some samples.
struct Part {
    ball: Ball,
    held: Vec<u32>,
}

/// Step 3.
struct Merging<'a> {
    body: &'a Body<'a>,
    /// Parts that were merged leave a gap.
    parts: Vec<Option<Part>>,
    heap: BinaryHeap<Merger>,
}

impl<'a> Merging<'a> {
    fn new(body: &'a Body<'a>, kept: Vec<(Ball, Vec<u32>)>) -> Self {
        let part = |(ball, held): (Ball, Vec<u32>)| Part { ball: smallest(body, ball.center, &held), held };
        Merging { body, parts: kept.into_par_iter().map(part).map(Some).collect(), heap: BinaryHeap::new() }
    }

    fn run(&mut self, count: usize) {
        let mut left = self.parts.len();
        while left > count {
            match self.heap.pop() {
                Some(merger) => left -= usize::from(self.merge(merger)),
                // At first, and when what is left hangs together nowhere.
                None => (0..self.parts.len()).for_each(|i| self.propose(i, i)),
            }
        }
    }

    /// Whether both parts were still there.
    fn merge(&mut self, Merger { pair: [a, b], ball, .. }: Merger) -> bool {
        if self.parts[a].is_none() || self.parts[b].is_none() {
            return false;
        }
        let held = [a, b].into_iter().filter_map(|i| self.parts[i].take()).flat_map(|part| part.held).collect();
        self.parts.push(Some(Part { ball, held }));
        self.propose(self.parts.len() - 1, usize::MAX);
        true
    }

    /// Proposes to merge a part with those before `limit` (and not itself) that touch it, or with the nearest one.
    fn propose(&mut self, i: usize, limit: usize) {
        let Some(part) = &self.parts[i] else { return };
        let others =
            || (0..self.parts.len().min(limit)).filter(|j| *j != i).filter_map(|j| Some((j, self.parts[j].as_ref()?)));
        let mut partners: Vec<(usize, &Part)> = others().filter(|(_, other)| part.ball.touches(&other.ball)).collect();
        if partners.is_empty() {
            let gap = |other: &Part| other.ball.center.distance(part.ball.center) - other.ball.radius;
            partners.extend(others().min_by(|a, b| gap(a.1).total_cmp(&gap(b.1))));
        }
        let merger = |(j, other): (usize, &Part)| {
            let held: Vec<u32> = part.held.iter().chain(&other.held).copied().collect();
            let ball = smallest(self.body, 0.5 * (part.ball.center + other.ball.center), &held);
            Merger { added: ball.outside - part.ball.outside - other.ball.outside, pair: [i, j], ball }
        };
        let mergers: Vec<Merger> = partners.into_par_iter().map(merger).collect();
        self.heap.extend(mergers);
    }
}

/// The smallest ball around samples, nearly.
fn smallest(body: &Body<'_>, start: Vec3, held: &[u32]) -> Ball {
    let points = Lanes::new(held.iter().map(|i| body.samples.points[*i as usize]));
    let step = STEP * points.farthest(start);
    let (center, radius) = powell(start, step, EVALUATIONS, |center| points.farthest(center));
    let radius = radius.max(SMALLEST);
    Ball { center, radius, outside: body.voxels.outside(center, radius) }
}

fn nearest(balls: &[Ball], point: Vec3) -> usize {
    let gap = |ball: &Ball| point.distance(ball.center) - ball.radius;
    (0..balls.len()).min_by(|a, b| gap(&balls[*a]).total_cmp(&gap(&balls[*b]))).unwrap_or(0)
}

/// A pair of parts and the ball that would take their place. The one that adds the least outside volume is greatest, then the
/// lower pair, so that order never depends on the heap.
#[derive(PartialEq)]
struct Merger {
    added: f32,
    pair: [usize; 2],
    ball: Ball,
}

impl Eq for Merger {}

impl Ord for Merger {
    fn cmp(&self, other: &Self) -> Ordering {
        other.added.total_cmp(&self.added).then(other.pair.cmp(&self.pair))
    }
}

impl PartialOrd for Merger {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    /// The medial axis of a torus is the circle in its middle, and each ball on it has the tube's radius.
    #[test]
    fn the_first_balls_of_a_torus_lie_on_its_circle() {
        let mesh = shapes::torus(1.0, 0.3);
        let body = Body::new(&mesh, 8).expect("it has a size");
        let balls = inscribed_balls(&body);
        let off = |ball: &Ball| (2.6 * ball.center.truncate().length() - 1.0).hypot(2.6 * ball.center.z);
        assert!(balls.iter().all(|ball| (off(ball) + 2.6 * ball.radius - 0.3).abs() < 0.04));
        let kept = cover(&body.samples.points, &balls, body.samples.spacing);
        let spacing = 2.6 * body.samples.spacing;
        let volume = |ball: &Ball| ball.radius.powi(3);
        let (all, central): (f32, f32) = kept.iter().map(|(ball, _)| ball).fold((0.0, 0.0), |(all, central), ball| {
            (all + volume(ball), if off(ball) < 1.5 * spacing { central + volume(ball) } else { central })
        });
        assert!(central > 0.9 * all && kept.len() < balls.len() / 10, "{central} of {all}, {}", kept.len());
    }

    #[test]
    fn kept_balls_come_near_every_sample() {
        for (mesh, most) in [(shapes::cuboid(Vec3::new(1.0, 0.6, 0.3)), 0.1), (shapes::square(), 0.9)] {
            let body = Body::new(&mesh, 8).expect("it has a size");
            let (samples, spacing) = (&body.samples.points, body.samples.spacing);
            let kept = cover(samples, &inscribed_balls(&body), spacing);
            let mut covered: Vec<u32> = kept.iter().flat_map(|(_, held)| held.clone()).collect();
            covered.sort_unstable();
            assert!(covered.into_iter().eq(0..samples.len() as u32));
            let near = |p: &Vec3| kept.iter().any(|(ball, _)| ball.center.distance(*p) < ball.radius + spacing);
            assert!(samples.iter().all(near) && (kept.len() as f64) < most * samples.len() as f64, "{}", kept.len());
        }
    }
}
