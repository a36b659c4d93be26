//! Clusters of points, each bounded by a ball, and the steps that lower their outside volume.

use glam::Vec3;
use rayon::prelude::*;

use crate::minimise::powell;
use crate::voxels::Voxels;

/// Evaluations of a ball's outside volume in one update of its centre.
const EVALUATIONS: usize = 60;
/// First step of the centre's search, in radii.
const STEP: f32 = 0.2;
/// Radii are larger than the distance to the farthest point by this factor, so that comparing squares never lets it out.
pub(crate) const SLACK: f32 = 1.000_001;
/// Balls that are asked to take a point that another gives away.
const TAKERS: usize = 16;

/// A ball, and its volume outside the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ball {
    pub(crate) center: Vec3,
    /// 0 for a ball without points.
    pub(crate) radius: f32,
    pub(crate) outside: f32,
}

impl Ball {
    pub(crate) fn holds(&self, point: Vec3) -> bool {
        point.distance_squared(self.center) <= self.radius * self.radius
    }

    pub(crate) fn touches(&self, other: &Ball) -> bool {
        let reach = self.radius + other.radius;
        other.radius > 0.0 && self.center.distance_squared(other.center) < reach * reach
    }

    /// How far outside the ball a point lies; negative inside.
    fn gap(&self, point: Vec3) -> f32 {
        point.distance(self.center) - self.radius
    }
}

/// Clusters: a partition of points, and a ball around each part.
#[derive(Clone)]
pub(crate) struct Clusters<'a> {
    voxels: &'a Voxels,
    points: &'a [Vec3],
    pub(crate) balls: Vec<Ball>,
    pub(crate) held: Vec<Vec<u32>>,
    /// Balls that are to be fitted again.
    loose: Vec<bool>,
    /// Balls that moved or grew, so that others may hand points over to them.
    moved: Vec<bool>,
}

impl<'a> Clusters<'a> {
    /// Fits balls around parts of the points, searching from the given centres.
    pub(crate) fn new(voxels: &'a Voxels, points: &'a [Vec3], held: Vec<Vec<u32>>, centers: &[Vec3]) -> Self {
        let balls = centers.iter().map(|center| Ball { center: *center, ..Ball::default() }).collect();
        let flags = vec![true; held.len()];
        let mut clusters = Clusters { voxels, points, balls, held, loose: flags.clone(), moved: flags };
        clusters.fit();
        clusters
    }

    /// Outside volume (35).
    pub(crate) fn error(&self) -> f32 {
        self.balls.iter().map(|ball| ball.outside).sum()
    }

    /// Hands points over to balls that hold them anyway and fits the balls that got smaller, until nothing changes or
    /// for so many rounds. The error does not grow.
    pub(crate) fn settle(&mut self, rounds: usize) {
        for _ in 0..rounds {
            let near_moved = |c: usize| self.moved[c] || self.neighbours(c).any(|o| self.moved[o]);
            let mut todo: Vec<usize> = (0..self.balls.len()).filter(|c| near_moved(*c)).collect();
            todo.sort_by(|a, b| self.balls[*b].outside.total_cmp(&self.balls[*a].outside));
            todo.into_iter().for_each(|c| self.hand_over(c));
            if !self.fit() {
                break;
            }
        }
    }

    /// Fits the loose balls; whether there were any.
    fn fit(&mut self) -> bool {
        let loose: Vec<usize> = (0..self.balls.len()).filter(|c| self.loose[*c]).collect();
        let fitted: Vec<Ball> = loose.par_iter().map(|c| self.bounding_ball(*c)).collect();
        self.moved.fill(false);
        self.loose.fill(false);
        for (c, ball) in loose.iter().zip(fitted) {
            self.balls[*c] = ball;
            self.moved[*c] = true;
        }
        !loose.is_empty()
    }

    /// A ball around a cluster's points with its centre where the outside volume is least.
    fn bounding_ball(&self, c: usize) -> Ball {
        let start = self.balls[c].center;
        if self.held[c].is_empty() {
            return Ball { center: start, ..Ball::default() };
        }
        let points = Lanes::new(self.held[c].iter().map(|i| self.points[*i as usize]));
        let radius = |center: Vec3| points.farthest(center) * SLACK;
        let outside = |center: Vec3| self.voxels.outside(center, radius(center));
        let (center, outside) = powell(start, STEP * radius(start), EVALUATIONS, outside);
        Ball { center, radius: radius(center), outside }
    }

    /// The ball that holds a point or needs to grow least to hold it.
    pub(crate) fn nearest(&self, point: Vec3) -> usize {
        let balls = (0..self.balls.len()).filter(|c| !self.held[*c].is_empty());
        balls.min_by(|a, b| self.balls[*a].gap(point).total_cmp(&self.balls[*b].gap(point))).unwrap_or(0)
    }

    fn neighbours(&self, c: usize) -> impl Iterator<Item = usize> {
        let ball = self.balls[c];
        (0..self.balls.len()).filter(move |o| *o != c && ball.touches(&self.balls[*o]))
    }

    fn hand_over(&mut self, c: usize) {
        let takers: Vec<usize> = self.neighbours(c).collect();
        let held = std::mem::take(&mut self.held[c]);
        for i in held {
            let point = self.points[i as usize];
            let taker = takers.iter().copied().find(|o| self.balls[*o].holds(point));
            self.held[taker.unwrap_or(c)].push(i);
        }
        let radius = self.farthest(c) * SLACK;
        self.loose[c] |= radius < 0.9999 * self.balls[c].radius;
        self.balls[c].radius = radius;
        if self.held[c].is_empty() {
            self.balls[c].outside = 0.0;
        }
    }

    fn farthest(&self, c: usize) -> f32 {
        let distance = |i: &u32| self.points[*i as usize].distance_squared(self.balls[c].center);
        self.held[c].iter().map(distance).fold(0.0, f32::max).sqrt()
    }

    /// Shrinks a ball to a share of its radius (0: to nothing); what it loses goes to the balls that need to grow least.
    pub(crate) fn shrink(&mut self, c: usize, share: f32) {
        let ball = self.balls[c];
        let mut takers: Vec<usize> = (0..self.balls.len()).filter(|o| *o != c && !self.held[*o].is_empty()).collect();
        let gap = |o: &usize| self.balls[*o].gap(ball.center);
        takers.sort_by(|a, b| gap(a).total_cmp(&gap(b)));
        takers.truncate(TAKERS);
        let limit = share * ball.radius;
        let held = std::mem::take(&mut self.held[c]);
        for i in held {
            let point = self.points[i as usize];
            let least =
                takers.iter().copied().min_by(|a, b| self.balls[*a].gap(point).total_cmp(&self.balls[*b].gap(point)));
            let stays = share > 0.0 && ball.center.distance(point) <= limit;
            let taker = least.filter(|_| !stays).unwrap_or(c);
            self.held[taker].push(i);
            if taker != c {
                self.grow(taker, point);
            }
        }
        self.balls[c].radius = self.farthest(c) * SLACK;
        self.loosen(c);
    }

    fn grow(&mut self, c: usize, point: Vec3) {
        if !self.balls[c].holds(point) {
            self.balls[c].radius = point.distance(self.balls[c].center) * SLACK;
            self.loosen(c);
        }
    }

    fn loosen(&mut self, c: usize) {
        self.loose[c] = true;
        self.moved[c] = true;
    }

    /// Gives the half of a cluster around one of its two points farthest apart to an empty one. Nothing happens to a
    /// cluster of a single place.
    pub(crate) fn split(&mut self, c: usize, empty: usize) {
        let Some([a, b]) = self.ends(c) else { return };
        let nearer_b = |i: &u32| {
            let point = self.points[*i as usize];
            point.distance_squared(b) < point.distance_squared(a)
        };
        let (second, first) = std::mem::take(&mut self.held[c]).into_iter().partition(nearer_b);
        for (c, held) in [(c, first), (empty, second)] {
            self.held[c] = held;
            self.balls[c].center = self.mean(c);
            self.balls[c].radius = self.farthest(c) * SLACK;
            self.loosen(c);
        }
    }

    /// Means of the two halves that [`Clusters::split`] would make.
    pub(crate) fn halves(&self, c: usize) -> Option<[Vec3; 2]> {
        let [a, b] = self.ends(c)?;
        let mut sums = [(Vec3::ZERO, 0.0); 2];
        for point in self.held[c].iter().map(|i| self.points[*i as usize]) {
            let sum = &mut sums[usize::from(point.distance_squared(b) < point.distance_squared(a))];
            *sum = (sum.0 + point, sum.1 + 1.0);
        }
        Some(sums.map(|(sum, n)| sum / n))
    }

    /// Two different points of a cluster that are (nearly) farthest apart.
    fn ends(&self, c: usize) -> Option<[Vec3; 2]> {
        let farthest_from = |place: Vec3| {
            let points = self.held[c].iter().map(|i| self.points[*i as usize]);
            points.max_by(|a, b| a.distance_squared(place).total_cmp(&b.distance_squared(place)))
        };
        let a = farthest_from(self.balls[c].center)?;
        let b = farthest_from(a)?;
        (a != b).then_some([a, b])
    }

    fn mean(&self, c: usize) -> Vec3 {
        let points = self.held[c].iter().map(|i| self.points[*i as usize]);
        points.sum::<Vec3>() / self.held[c].len().max(1) as f32
    }
}

/// Points in groups of eight, so that the compiler makes vectors of them.
pub(crate) struct Lanes {
    groups: Vec<[[f32; 8]; 3]>,
}

impl Lanes {
    pub(crate) fn new(points: impl Iterator<Item = Vec3>) -> Lanes {
        let points: Vec<Vec3> = points.collect();
        let group = |chunk: &[Vec3]| [0, 1, 2].map(|axis| std::array::from_fn(|i| chunk[i.min(chunk.len() - 1)][axis]));
        Lanes { groups: points.chunks(8).map(group).collect() }
    }

    /// Distance from a place to the farthest point; 0 without points.
    pub(crate) fn farthest(&self, place: Vec3) -> f32 {
        self.fold(place, 0.0, |distance, most| if distance > most { distance } else { most }).sqrt()
    }

    /// Distance from a place to the nearest point; infinite without points.
    pub(crate) fn nearest(&self, place: Vec3) -> f32 {
        self.fold(place, f32::INFINITY, |distance, least| if distance < least { distance } else { least }).sqrt()
    }

    /// What a choice between two, first by lane, leaves of the squared distances from a place.
    fn fold(&self, place: Vec3, start: f32, choice: impl Fn(f32, f32) -> f32) -> f32 {
        let mut chosen = [start; 8];
        for [x, y, z] in &self.groups {
            for (i, chosen) in chosen.iter_mut().enumerate() {
                let (dx, dy, dz) = (x[i] - place.x, y[i] - place.y, z[i] - place.z);
                *chosen = choice(dx * dx + dy * dy + dz * dz, *chosen);
            }
        }
        chosen.into_iter().fold(start, &choice)
    }
}
