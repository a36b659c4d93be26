//! The search for clusters of small outside volume: Lloyd rounds, then teleportation and trades between neighbours.

use std::f32::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;

use crate::cluster::{Ball, Clusters};
use crate::flood::flood;
use crate::samples::Samples;
use crate::voxels::Voxels;

/// Rounds of flood fill and fitting.
const LLOYD_ROUNDS: usize = 10;
/// Teleportations and trades tried afterwards.
const TRIALS: usize = 128;
/// Rounds of settling after a Lloyd round and after a trial.
const SETTLE_ROUNDS: usize = 3;
/// Least and most share to which a ball is shrunk when its rim is offered to its neighbours.
const TRADES: [f32; 2] = [0.6, 0.98];

/// Places by which the overlap of balls is measured.
const PROBES: usize = 64;

/// Steps that [`search`] reports.
pub(crate) const STEPS: u64 = (LLOYD_ROUNDS + TRIALS) as u64;

/// Clusters of all samples: the better of two searches side by side, since which way one goes is luck. `None` when
/// `progress` (told the steps done) answers no.
pub(crate) fn search<'a>(
    voxels: &'a Voxels,
    samples: &'a Samples,
    count: usize,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Option<Clusters<'a>> {
    let stopped = AtomicBool::new(false);
    let mut second = None;
    let first = rayon::in_place_scope(|scope| {
        scope.spawn(|_| {
            let middle = samples.sites.len() / 2;
            second = search_from(middle, voxels, samples, count, &mut |_| !stopped.load(Ordering::Relaxed));
        });
        let first = search_from(0, voxels, samples, count, progress);
        stopped.store(first.is_none(), Ordering::Relaxed);
        first
    })?;
    Some(second.filter(|second| second.error() < first.error()).unwrap_or(first))
}

/// Clusters of all samples, by one search; `first` is the site of its first centre.
fn search_from<'a>(
    first: usize,
    voxels: &'a Voxels,
    samples: &'a Samples,
    count: usize,
    progress: &mut dyn FnMut(u64) -> bool,
) -> Option<Clusters<'a>> {
    let mut clusters = lloyd_round(voxels, samples, &spread(&samples.sites, first, count));
    let mut best = clusters.clone();
    for round in 1..LLOYD_ROUNDS {
        progress(round as u64).then_some(())?;
        clusters = lloyd_round(voxels, samples, &reseeded(&clusters));
        if clusters.error() < best.error() {
            best = clusters.clone();
        }
    }
    let (mut failures, mut trades) = (0, 0);
    for trial in 0..TRIALS {
        progress((LLOYD_ROUNDS + trial) as u64).then_some(())?;
        let teleports = trial % 2 == 0;
        let mut tried = best.clone();
        if teleports {
            teleport(&mut tried, failures)
        } else {
            trade(&mut tried, trades)
        };
        tried.settle(SETTLE_ROUNDS);
        let better = tried.error() < best.error();
        if better {
            best = tried;
        }
        match teleports {
            true if better => failures = 0,
            true => failures += 1,
            false => trades += 1,
        }
    }
    Some(best)
}

/// Point clustering and cluster update (Ren 2006, §6.2).
fn lloyd_round<'a>(voxels: &'a Voxels, samples: &'a Samples, centers: &[Vec3]) -> Clusters<'a> {
    let mut held = vec![Vec::new(); centers.len()];
    for (site, owner) in flood(voxels, samples, centers).iter().enumerate() {
        held[*owner as usize].extend(samples.points_of(site));
    }
    let mut clusters = Clusters::new(voxels, &samples.points, held, centers);
    clusters.settle(SETTLE_ROUNDS);
    clusters
}

/// Centres to start from: after the first each is the site farthest from those before, at most one a site. The paper picks at
/// random; this needs no seed and leaves no part of the object without a centre.
fn spread(sites: &[Vec3], first: usize, count: usize) -> Vec<Vec3> {
    let mut distance = vec![f32::INFINITY; sites.len()];
    let mut centers = vec![sites[first]];
    while centers.len() < count.min(sites.len()) {
        let last = centers[centers.len() - 1];
        distance.iter_mut().zip(sites).for_each(|(d, site)| *d = d.min(site.distance_squared(last)));
        let farthest = (0..sites.len()).rev().max_by(|a, b| distance[*a].total_cmp(&distance[*b]));
        centers.push(sites[farthest.unwrap_or(0)]);
    }
    centers
}

/// The clusters' centres, those of empty clusters put where they split the worst.
fn reseeded(clusters: &Clusters<'_>) -> Vec<Vec3> {
    let mut centers: Vec<Vec3> = clusters.balls.iter().map(|ball| ball.center).collect();
    let empty = (0..centers.len()).filter(|c| clusters.held[*c].is_empty());
    for (empty, worst) in empty.zip(worst_first(clusters)) {
        if let Some([first, second]) = clusters.halves(worst) {
            (centers[worst], centers[empty]) = (first, second);
        }
    }
    centers
}

/// Cluster teleportation (Cohen-Steiner et al. 2004): the cluster of largest error is split in two, at the expense of
/// an empty one or of the one that shares most of its volume with others. After failures the next ones get their turn.
fn teleport(clusters: &mut Clusters<'_>, failures: usize) {
    let worst = worst_first(clusters);
    let empty = (0..clusters.balls.len()).find(|c| clusters.held[*c].is_empty());
    let (worst, slot) = match empty {
        Some(empty) => (worst[failures % worst.len()], empty),
        None => {
            let overlapping = most_overlapping_first(&clusters.balls);
            (worst[failures % worst.len().min(3)], overlapping[failures / 3 % overlapping.len()])
        }
    };
    if worst != slot {
        clusters.shrink(slot, 0.0);
        clusters.split(worst, slot);
    }
}

/// Offers the rim of one ball to its neighbours: each in turn, and each time (by the golden ratio) another share.
fn trade(clusters: &mut Clusters<'_>, turn: usize) {
    let count = clusters.balls.len();
    let share = TRADES[0] + (TRADES[1] - TRADES[0]) * (turn as f32 * 0.618_034).fract();
    clusters.shrink(turn % count, share);
}

/// Clusters that hold points, by falling outside volume.
fn worst_first(clusters: &Clusters<'_>) -> Vec<usize> {
    let mut order: Vec<usize> = (0..clusters.balls.len()).filter(|c| !clusters.held[*c].is_empty()).collect();
    order.sort_by(|a, b| clusters.balls[*b].outside.total_cmp(&clusters.balls[*a].outside));
    order
}

/// Balls by falling share of their volume that other balls cover.
fn most_overlapping_first(balls: &[Ball]) -> Vec<usize> {
    let probes = probes();
    let shared = |ball: &Ball| {
        let others: Vec<&Ball> = balls.iter().filter(|other| *other != ball && ball.touches(other)).collect();
        let covered = |probe: &&Vec3| others.iter().any(|other| other.holds(ball.center + **probe * ball.radius));
        probes.iter().filter(covered).count()
    };
    let shares: Vec<usize> = balls.iter().map(shared).collect();
    let mut order: Vec<usize> = (0..balls.len()).collect();
    order.sort_by_key(|c| std::cmp::Reverse(shares[*c]));
    order
}

/// Places spread evenly over the unit ball (points of the R2 sequence give the directions).
fn probes() -> Vec<Vec3> {
    let place = |i: usize| {
        let i = i as f32 + 0.5;
        let (z, turn) = (1.0 - 2.0 * (i * 0.754_877_7).fract(), TAU * (i * 0.569_840_3).fract());
        let flat = (1.0 - z * z).sqrt();
        Vec3::new(flat * turn.cos(), flat * turn.sin(), z) * (i / PROBES as f32).cbrt()
    };
    (0..PROBES).map(place).collect()
}
