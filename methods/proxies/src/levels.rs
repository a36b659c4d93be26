//! Levels of a sphere hierarchy by Lloyd clustering (Ren 2006, §6.3).

use glam::Vec3;
use halflight_scenes::Sphere;

use crate::minimise::powell;

/// Mean number of children that is aimed at.
const BRANCHING: usize = 4;
/// Most rounds of assigning and fitting on a level.
const ROUNDS: usize = 16;
/// Evaluations of a ball's radius in one update of its centre.
const EVALUATIONS: usize = 60;
/// First step of the centre's search, in radii.
const STEP: f32 = 0.2;

/// A tree over numbered spheres.
pub(crate) enum Tree {
    Leaf(u32),
    Parent(Vec<Tree>),
}

/// The tree over some spheres, if there are any: levels from the leaves up, each with a quarter of the nodes below it.
pub(crate) fn tree(spheres: &[Sphere]) -> Option<Tree> {
    let mut level: Vec<(Tree, Sphere)> = (0..).map(Tree::Leaf).zip(spheres.iter().copied()).collect();
    while level.len() > 1 {
        level = parents(level);
    }
    level.pop().map(|(root, _)| root)
}

/// The next level; a node that is alone in its cluster stays as it is.
fn parents(level: Vec<(Tree, Sphere)>) -> Vec<(Tree, Sphere)> {
    let spheres: Vec<Sphere> = level.iter().map(|(_, sphere)| *sphere).collect();
    let clusters = lloyd(&spheres, spheres.len().div_ceil(BRANCHING));
    let mut members: Vec<Vec<(Tree, Sphere)>> = Vec::new();
    members.resize_with(spheres.len().div_ceil(BRANCHING), Vec::new);
    level.into_iter().zip(clusters).for_each(|(node, cluster)| members[cluster].push(node));
    let parent = |mut members: Vec<(Tree, Sphere)>| match members.len() {
        0 | 1 => members.pop(),
        _ => {
            let (children, spheres): (Vec<Tree>, Vec<Sphere>) = members.into_iter().unzip();
            Some((Tree::Parent(children), ball(&spheres)))
        }
    };
    members.into_iter().filter_map(parent).collect()
}

/// The cluster, one of `count`, of each sphere: that with the nearest centre. A cluster may stay empty.
fn lloyd(spheres: &[Sphere], count: usize) -> Vec<usize> {
    let mut centers = spread(spheres, count);
    let mut clusters = Vec::new();
    for _ in 0..ROUNDS {
        let nearest: Vec<usize> = spheres.iter().map(|sphere| nearest(&centers, sphere.center)).collect();
        if nearest == clusters {
            break;
        }
        clusters = nearest;
        for (cluster, center) in centers.iter_mut().enumerate() {
            let held = spheres.iter().zip(&clusters).filter(|(_, held)| **held == cluster);
            let held: Vec<Sphere> = held.map(|(sphere, _)| *sphere).collect();
            if !held.is_empty() {
                *center = ball(&held).center;
            }
        }
    }
    clusters
}

fn nearest(centers: &[Vec3], point: Vec3) -> usize {
    let distance = |center: &Vec3| center.distance_squared(point);
    let places = centers.iter().map(distance).enumerate();
    places.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(place, _)| place)
}

/// Centres far from one another: each is the one farthest from those before it.
fn spread(spheres: &[Sphere], count: usize) -> Vec<Vec3> {
    let mut centers = vec![mean(spheres)];
    let mut distances = vec![f32::INFINITY; spheres.len()];
    for place in 0..count {
        let last = centers[centers.len() - 1];
        for (distance, sphere) in distances.iter_mut().zip(spheres) {
            *distance = distance.min(sphere.center.distance_squared(last));
        }
        let farthest = distances.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(place, _)| place);
        if place == 0 {
            // The mean was only there to begin from the rim.
            centers.clear();
            distances.fill(f32::INFINITY);
        }
        centers.push(spheres[farthest].center);
    }
    centers
}

fn mean(spheres: &[Sphere]) -> Vec3 {
    spheres.iter().map(|sphere| sphere.center).sum::<Vec3>() / spheres.len() as f32
}

/// A small ball around spheres, searched for from their mean.
fn ball(spheres: &[Sphere]) -> Sphere {
    let reach = |center: Vec3| {
        let reaches = spheres.iter().map(|sphere| center.distance(sphere.center) + sphere.radius);
        reaches.fold(0.0, f32::max)
    };
    let start = mean(spheres);
    let (center, radius) = powell(start, STEP * reach(start), EVALUATIONS, reach);
    Sphere { center, radius }
}
