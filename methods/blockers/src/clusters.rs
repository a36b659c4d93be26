//! Clusters of receivers that lie close together and face alike (Ren 2006, §6.3).

use std::ops::Range;

use glam::Vec3;
use halflight_scenes::{Receivers, Revision};
use halflight_sh::LANES;
use rayon::prelude::*;

/// Receivers in clusters, found once for a revision of receivers.
///
/// Where the paper runs Lloyd's algorithm, the space of positions and normals is halved at the median of its longest side until
/// no part is too large: clusters are about as round, equally large and whole registers, and a camera that moves can afford them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clusters {
    pub(crate) made_for: Option<(Revision, usize)>,
    /// Valid receivers, those of a cluster together.
    members: Vec<usize>,
    pub(crate) clusters: Vec<Cluster>,
}

/// What a cut needs to know of a cluster.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    members: Range<usize>,
    /// A sphere around the receivers.
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
    /// The receiver nearest to the centre.
    pub(crate) central: usize,
    facing: Facing,
}

/// Bounds of the receivers' normals, and of the heights of their tangent planes over a cluster's centre.
#[derive(Clone, Copy, Debug)]
struct Facing {
    normal: Vec3,
    /// The largest distance of a normal from `normal`.
    spread: f32,
    heights: [f32; 2],
}

/// A receiver's position, its normal weighted against the scene's size, its number.
#[derive(Clone, Copy)]
#[repr(align(32))]
struct Entry {
    place: [f32; 6],
    receiver: u32,
}

/// Halving a normal's component from −1 to 1 counts like halving this share of the receivers' extent.
const NORMALS: f32 = 1.0;

/// Receivers whose sorting is worth a task.
const TASK: usize = 1024;

/// Valid receivers in the clusters of at most `size`, at least 16, that methods with cuts make of them.
pub fn clusters(receivers: &Receivers, size: usize) -> Vec<Vec<usize>> {
    let mut clusters = Clusters::default();
    clusters.update(receivers, size);
    clusters.clusters.iter().map(|cluster| clusters.members(cluster).to_vec()).collect()
}

impl Clusters {
    /// Makes clusters of at most `size` receivers, unless they are made already.
    pub(crate) fn update(&mut self, receivers: &Receivers, size: usize) {
        let made_for = Some((receivers.revision, size));
        if self.made_for == made_for {
            return;
        }
        self.made_for = made_for;
        let mut entries = entries(receivers);
        sort(&mut entries);
        self.members = entries.iter().map(|entry| entry.receiver as usize).collect();
        let mut ranges = Vec::new();
        split(0..entries.len(), size, &mut ranges);
        let cluster = |members| Cluster::new(receivers, &self.members, members);
        self.clusters = ranges.into_par_iter().map(cluster).collect();
    }

    /// The receivers of a cluster.
    pub(crate) fn members(&self, cluster: &Cluster) -> &[usize] {
        &self.members[cluster.members.clone()]
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.members.as_slice()) + size_of_val(self.clusters.as_slice())
    }
}

fn entries(receivers: &Receivers) -> Vec<Entry> {
    let valid = || (0..receivers.len()).filter(|&receiver| receivers.valid[receiver]);
    let (low, high) = bounds(valid().map(|receiver| receivers.position[receiver].to_array()));
    let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f32::max);
    let entry = |receiver: usize| {
        let normal = 0.5 * NORMALS * extent * receivers.geometric_normal[receiver];
        let Vec3 { x, y, z } = receivers.position[receiver];
        Entry { place: [x, y, z, normal.x, normal.y, normal.z], receiver: receiver as u32 }
    };
    valid().map(entry).collect()
}

fn bounds<const N: usize>(places: impl Iterator<Item = [f32; N]>) -> ([f32; N], [f32; N]) {
    places.fold(([f32::INFINITY; N], [f32::NEG_INFINITY; N]), |(mut low, mut high), place| {
        for axis in 0..N {
            // unlike `min` and `max` one instruction each
            low[axis] = if place[axis] < low[axis] { place[axis] } else { low[axis] };
            high[axis] = if place[axis] > high[axis] { place[axis] } else { high[axis] };
        }
        (low, high)
    })
}

/// The size of the first of two halves: whole registers, so that few lanes are idle. `None` if nothing is to be halved.
fn half(length: usize, size: usize) -> Option<usize> {
    (length > size.max(LANES)).then(|| (length / 2).next_multiple_of(LANES))
}

fn split(range: Range<usize>, size: usize, ranges: &mut Vec<Range<usize>>) {
    match half(range.len(), size) {
        _ if range.is_empty() => {}
        None => ranges.push(range),
        Some(half) => {
            let middle = range.start + half;
            split(range.start..middle, size, ranges);
            split(middle..range.end, size, ranges);
        }
    }
}

/// Down to single registers, so that receivers of a cluster that share one see alike.
fn sort(entries: &mut [Entry]) {
    let Some(half) = half(entries.len(), LANES) else { return };
    let (low, high) = bounds(entries.iter().map(|entry| entry.place));
    let side = |axis: &usize| high[*axis] - low[*axis];
    let axis = (0..6).max_by(|a, b| side(a).total_cmp(&side(b))).expect("six axes");
    entries
        .select_nth_unstable_by(half, |a, b| a.place[axis].total_cmp(&b.place[axis]).then(a.receiver.cmp(&b.receiver)));
    let (first, second) = entries.split_at_mut(half);
    if first.len() < TASK {
        [first, second].into_iter().for_each(sort);
    } else {
        rayon::join(|| sort(first), || sort(second));
    }
}

impl Cluster {
    fn new(receivers: &Receivers, all: &[usize], members: Range<usize>) -> Self {
        let numbers = &all[members.clone()];
        let (low, high) = bounds(numbers.iter().map(|&receiver| receivers.position[receiver].to_array()));
        let center = 0.5 * (Vec3::from_array(low) + Vec3::from_array(high));
        let distance = |receiver: usize| receivers.position[receiver].distance(center);
        let nearest = numbers.iter().copied().min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        Cluster {
            radius: numbers.iter().map(|&receiver| distance(receiver)).fold(0.0, f32::max),
            central: nearest.expect("clusters are not empty"),
            facing: Facing::new(receivers, numbers, center),
            center,
            members,
        }
    }

    /// Bounds of a point's height above the receivers' tangent planes.
    pub(crate) fn heights(&self, point: Vec3) -> [f32; 2] {
        let Facing { normal, spread, heights: [lowest, highest] } = self.facing;
        let to = point - self.center;
        let (height, blur) = (to.dot(normal), spread * to.length());
        [height - blur - highest, height + blur - lowest]
    }
}

impl Facing {
    fn new(receivers: &Receivers, numbers: &[usize], center: Vec3) -> Self {
        let normals = || numbers.iter().map(|&receiver| receivers.geometric_normal[receiver]);
        let normal = normals().sum::<Vec3>().normalize_or_zero();
        let height =
            |&receiver: &usize| (receivers.position[receiver] - center).dot(receivers.geometric_normal[receiver]);
        let (low, high) = bounds(numbers.iter().map(|receiver| [height(receiver)]));
        let spread = normals().map(|one| one.distance(normal)).fold(0.0, f32::max);
        Facing { normal, spread, heights: [low[0], high[0]] }
    }
}
