//! Cuts through hierarchies of blockers, and what makes bounding spheres look like what they bound (Ren 2006, §6.3).

use glam::Vec3;
use halflight_proxies::{Circle, Hierarchy, SelfShadow, seen};
use halflight_scenes::{Receivers, Sphere};
use halflight_sh::{Batch, Block, LANES};

use crate::clusters::Cluster;
use crate::{Blockers, Gather};

/// What rises of a bounding sphere above one receiver's tangent plane is at least this share of what rises above another's of the
/// cluster; where they differ more, so do the shapes that the self-shadow rules leave, and no ratio serves all.
const STEADY: f32 = 0.5;

/// Spheres that stand for all blockers at the receivers of a cluster.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cut {
    pub(crate) spheres: Vec<Sphere>,
    /// A ratio vector (37) a sphere: a factor for each band. None where bounding spheres are taken as they are.
    pub(crate) ratios: Vec<f32>,
}

impl Cut {
    pub(crate) fn blockers(&self) -> Blockers<'_> {
        Blockers { spheres: &self.spheres, ratios: &self.ratios }
    }
}

/// What was looked at to make cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Visits {
    /// Clusters of receivers.
    pub(crate) clusters: u64,
    /// Nodes of the hierarchy looked at.
    pub(crate) nodes: u64,
    /// Spheres of all cuts.
    pub(crate) spheres: u64,
    /// Spheres of the largest cut.
    pub(crate) largest: u64,
    /// Spheres seen in detail from the middle of clusters.
    pub(crate) detailed: u64,
    /// Ratios that were bounded.
    pub(crate) bounded: u64,
}

impl std::ops::Add for Visits {
    type Output = Visits;

    fn add(self, other: Visits) -> Visits {
        Visits {
            clusters: self.clusters + other.clusters,
            nodes: self.nodes + other.nodes,
            spheres: self.spheres + other.spheres,
            largest: self.largest.max(other.largest),
            detailed: self.detailed + other.detailed,
            bounded: self.bounded + other.bounded,
        }
    }
}

/// How cuts are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rule {
    /// Sine of the largest angle θmax that a parent may subtend.
    pub(crate) max_sin_angle: f32,
    /// Whether ratio vectors are found.
    pub(crate) ratios: bool,
}

/// The blockers of a frame in their hierarchy.
pub(crate) struct Forest<'a> {
    pub(crate) hierarchy: &'a Hierarchy,
    /// Bounding spheres of all nodes.
    pub(crate) bounds: &'a [Sphere],
    pub(crate) spheres: &'a [Sphere],
}

/// One cluster's view of a forest.
struct View<'a> {
    rule: Rule,
    gather: Gather,
    cluster: &'a Cluster,
    /// Position and normal of the central receiver.
    central: [Vec3; 2],
}

impl Forest<'_> {
    /// Fills the cut for a cluster.
    pub(crate) fn cut(
        &self,
        rule: Rule,
        gather: Gather,
        batch: Batch,
        receivers: &Receivers,
        cluster: &Cluster,
        cut: &mut Cut,
    ) -> Visits {
        let central = [receivers.position[cluster.central], receivers.geometric_normal[cluster.central]];
        let view = View { rule, gather, cluster, central };
        let nodes = self.select(&view);
        let mut visits = Visits { clusters: 1, nodes: nodes.visited, ..Visits::default() };
        visits.spheres = nodes.accepted.len() as u64;
        visits.largest = visits.spheres;
        cut.spheres.clear();
        cut.spheres.extend(nodes.accepted.iter().map(|&node| self.bounds[node]));
        cut.ratios.clear();
        if rule.ratios {
            self.ratios(&view, batch, &nodes.accepted, &mut cut.ratios, &mut visits);
        }
        visits
    }

    /// Goes down until nodes are small enough (36), leaving out what nobody sees.
    fn select(&self, view: &View<'_>) -> Selected {
        let (mut selected, mut node) = (Selected::default(), 0);
        while node < self.hierarchy.len() {
            selected.visited += 1;
            node = match view.judge(&self.bounds[node]) {
                Judgement::Unseen => self.hierarchy.next(node),
                judgement => {
                    let leaf = self.hierarchy.is_leaf(node);
                    if leaf || judgement == Judgement::Small {
                        selected.accepted.push(node);
                        self.hierarchy.next(node)
                    } else {
                        node + 1
                    }
                }
            }
        }
        selected
    }

    /// Ratio vectors (37) of accepted nodes.
    ///
    /// The bounding log is zonal, so that by the addition theorem its dot product with a leaf's, band by band, is that of their
    /// zonal coefficients times `P_l` of the angle between the two: `w_l = Σ z_l(leaf) P_l(cos γ) / z_l(bound)`.
    fn ratios(&self, view: &View<'_>, batch: Batch, nodes: &[usize], ratios: &mut Vec<f32>, visits: &mut Visits) {
        let order = batch.order();
        ratios.resize(nodes.len() * order, 1.0);
        let mut lanes = Detail::new(batch);
        for (&node, ratio) in nodes.iter().zip(ratios.chunks_exact_mut(order)) {
            if self.hierarchy.is_leaf(node) {
                continue;
            }
            let Some(bound) = view.circle(&self.bounds[node]) else {
                ratio.fill(0.0);
                continue;
            };
            let leaves = self.hierarchy.spheres(node);
            lanes.begin(bound);
            leaves.iter().filter_map(|&leaf| view.circle(&self.spheres[leaf as usize])).for_each(|leaf| {
                lanes.add(leaf);
            });
            visits.detailed += leaves.len() as u64;
            visits.bounded += lanes.ratio(leaves.len(), ratio);
        }
    }
}

#[derive(Default)]
struct Selected {
    accepted: Vec<usize>,
    visited: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Judgement {
    /// No receiver of the cluster is shadowed by anything inside.
    Unseen,
    /// It may stand for what it bounds.
    Small,
    Large,
}

impl View<'_> {
    fn judge(&self, bound: &Sphere) -> Judgement {
        let distance = bound.center.distance(self.cluster.center) - self.cluster.radius;
        if bound.radius < self.gather.min_sin_angle * distance {
            return Judgement::Unseen;
        }
        let [lowest, highest] = match self.gather.self_shadow {
            SelfShadow::Off => [f32::INFINITY; 2],
            _ => self.cluster.heights(bound.center),
        };
        if highest < -bound.radius {
            return Judgement::Unseen;
        }
        let [least, most] = [lowest, highest].map(|height| height.min(bound.radius) + bound.radius);
        match bound.radius < self.rule.max_sin_angle * distance && least >= STEADY * most {
            true => Judgement::Small,
            false => Judgement::Large,
        }
    }

    /// The circle that the central receiver sees, if it counts.
    fn circle(&self, sphere: &Sphere) -> Option<Circle> {
        let [position, normal] = self.central;
        let circle = seen(self.gather.self_shadow, position, normal, sphere);
        circle.filter(|circle| circle.sin_angle >= self.gather.min_sin_angle)
    }
}

/// Leaf circles, a lane each, and what they sum to along a bounding circle.
struct Detail {
    batch: Batch,
    bound: Circle,
    sines: Block<f32>,
    cosines: Block<f32>,
    filled: usize,
    zonal: Vec<Block<f32>>,
    sums: Vec<f32>,
}

impl Detail {
    fn new(batch: Batch) -> Self {
        Detail {
            batch,
            bound: Circle { axis: Vec3::Z, sin_angle: 0.0 },
            sines: Block::ZERO,
            cosines: Block::ZERO,
            filled: 0,
            zonal: vec![Block::ZERO; batch.order()],
            sums: vec![0.0; batch.order()],
        }
    }

    fn begin(&mut self, bound: Circle) {
        self.bound = bound;
        self.filled = 0;
        self.sums.fill(0.0);
    }

    fn add(&mut self, leaf: Circle) {
        if self.filled == LANES {
            self.flush();
        }
        self.sines.0[self.filled] = leaf.sin_angle;
        self.cosines.0[self.filled] = leaf.axis.dot(self.bound.axis);
        self.filled += 1;
    }

    /// Adds `z_l P_l` of all lanes to the sums.
    fn flush(&mut self) {
        self.sines.0[self.filled..].fill(0.0); // blocks nothing: all bands are 0
        self.batch.circle_logs(&[self.sines], &mut self.zonal);
        let (mut below, mut legendre) = ([0.0; LANES], [1.0; LANES]);
        for (l, (zonal, sum)) in self.zonal.iter().zip(&mut self.sums).enumerate() {
            let (factor, rest) = ((2 * l + 1) as f32 / (l + 1) as f32, l as f32 / (l + 1) as f32);
            for lane in 0..LANES {
                *sum += zonal.0[lane] * legendre[lane];
                let above = factor * self.cosines.0[lane] * legendre[lane] - rest * below[lane];
                (below[lane], legendre[lane]) = (legendre[lane], above);
            }
        }
        self.filled = 0;
    }

    /// Writes the ratios of the sums to the bounding circle's bands, at most as large as there are leaves; how many had to be
    /// bounded.
    fn ratio(&mut self, leaves: usize, ratio: &mut [f32]) -> u64 {
        self.flush();
        self.batch.circle_logs(&[Block::splat(self.bound.sin_angle)], &mut self.zonal);
        let most = leaves as f32;
        let mut bounded = 0;
        for ((sum, zonal), ratio) in self.sums.iter().zip(&self.zonal).zip(ratio) {
            let exact = sum / zonal.0[0];
            *ratio = if exact.is_nan() { 0.0 } else { exact.clamp(-most, most) };
            bounded += u64::from(*ratio != exact);
        }
        bounded
    }
}
