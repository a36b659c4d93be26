//! Cuts through hierarchies of blockers, and what makes bounding spheres look like what they bound (Ren 2006, §6.3).

use glam::Vec3;
use halflight_proxies::{Circle, Hierarchy, SelfShadow, seen};
use halflight_scenes::{Receivers, Sphere};
use halflight_sh::Batch;

use crate::clusters::Cluster;
use crate::ratio::Ratios;
use crate::{Blockers, Gather};

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

    /// Ratio vectors of accepted nodes at the central receiver: 1 for leaves, 0 for what it does not see.
    fn ratios(&self, view: &View<'_>, batch: Batch, nodes: &[usize], ratios: &mut Vec<f32>, visits: &mut Visits) {
        let order = batch.order();
        ratios.resize(nodes.len() * order, 1.0);
        let mut lanes = Ratios::new(batch);
        for (&node, ratio) in nodes.iter().zip(ratios.chunks_exact_mut(order)) {
            if self.hierarchy.is_leaf(node) {
                continue;
            }
            let leaves = self.hierarchy.spheres(node);
            visits.detailed += leaves.len() as u64;
            let detail = leaves.iter().filter_map(|&leaf| view.circle(&self.spheres[leaf as usize]));
            let detail = detail.filter(|circle| circle.sin_angle >= view.gather.min_sin_angle);
            match view.circle(&self.bounds[node]) {
                Some(bound) => visits.bounded += lanes.ratio(bound, detail, ratio),
                None => ratio.fill(0.0),
            }
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
        // Behind some tangent planes and not behind others it has no look that a ratio could scale.
        if highest < -bound.radius {
            Judgement::Unseen
        } else if lowest > -bound.radius && bound.radius < self.rule.max_sin_angle * distance {
            Judgement::Small
        } else {
            Judgement::Large
        }
    }

    /// The circle that the central receiver sees, however small.
    fn circle(&self, sphere: &Sphere) -> Option<Circle> {
        let [position, normal] = self.central;
        seen(self.gather.self_shadow, position, normal, sphere)
    }
}

#[cfg(test)]
mod tests {
    use halflight_scenes::{Layout, Revision};

    use super::*;
    use crate::clusters::Clusters;

    fn wave(i: usize, phase: f32) -> f32 {
        (i as f32 * 2.399 + phase).sin()
    }

    /// Receivers on a globe that spheres surround, and a forest of those.
    fn scene() -> (Receivers, Vec<Sphere>, Hierarchy) {
        let normal = |i: usize| Vec3::new(wave(i, 0.0), wave(3 * i, 1.0), wave(7 * i, 2.0)).normalize();
        let normals: Vec<Vec3> = (0..500).map(normal).collect();
        let receivers = Receivers {
            layout: Layout::List,
            position: normals.iter().map(|normal| 0.5 * *normal).collect(),
            geometric_normal: normals.clone(),
            normal: normals,
            albedo: Vec::new(),
            valid: vec![true; 500],
            place: Vec::new(),
            revision: Revision(0),
        };
        let sphere = |i: usize| Sphere {
            center: 6.0 * Vec3::new(wave(i, 3.0), wave(5 * i, 4.0), wave(9 * i, 5.0)),
            radius: 0.1 + 0.3 * wave(i, 6.0).abs(),
        };
        let spheres: Vec<Sphere> = (0..200).map(sphere).collect();
        let hierarchy = Hierarchy::new(&spheres);
        (receivers, spheres, hierarchy)
    }

    fn circle(gather: &Gather, receivers: &Receivers, receiver: usize, sphere: &Sphere) -> Option<Circle> {
        let (position, normal) = (receivers.position[receiver], receivers.geometric_normal[receiver]);
        let circle = seen(gather.self_shadow, position, normal, sphere);
        circle.filter(|circle| circle.sin_angle >= gather.min_sin_angle)
    }

    #[test]
    fn a_cut_holds_what_is_seen_once_and_parents_below_the_angle_only() {
        let (receivers, spheres, hierarchy) = scene();
        let mut bounds = Vec::new();
        hierarchy.bounds(&spheres, &mut bounds);
        let forest = Forest { hierarchy: &hierarchy, bounds: &bounds, spheres: &spheres };
        let rule = Rule { max_sin_angle: 25f32.to_radians().sin(), ratios: true };
        let mut clusters = Clusters::default();
        clusters.update(&receivers, 32);
        let (mut parents, mut hidden) = (0, 0);
        for self_shadow in [SelfShadow::Continuous, SelfShadow::Paper, SelfShadow::Off] {
            for min_sin_angle in [0.0, 0.04] {
                let gather = Gather { self_shadow, min_sin_angle };
                for cluster in &clusters.clusters {
                    let central = [receivers.position[cluster.central], receivers.geometric_normal[cluster.central]];
                    let nodes = forest.select(&View { rule, gather, cluster, central });
                    let mut held = vec![0; spheres.len()];
                    for &node in &nodes.accepted {
                        hierarchy.spheres(node).iter().for_each(|&sphere| held[sphere as usize] += 1);
                        for &receiver in clusters.members(cluster).iter().filter(|_| !hierarchy.is_leaf(node)) {
                            let to = bounds[node].center - receivers.position[receiver];
                            assert!(bounds[node].radius < rule.max_sin_angle * to.length() * 1.000_01);
                            let behind = to.dot(receivers.geometric_normal[receiver]) <= -bounds[node].radius;
                            assert!(!behind || self_shadow == SelfShadow::Off);
                            parents += 1;
                        }
                    }
                    for (sphere, &times) in spheres.iter().zip(&held) {
                        let members = clusters.members(cluster);
                        let seen = members.iter().any(|&one| circle(&gather, &receivers, one, sphere).is_some());
                        assert!(times == 1 || (times == 0 && !seen), "held {times} times");
                        hidden += usize::from(times == 0);
                    }
                }
            }
        }
        assert!(parents > 1000 && hidden > 1000, "{parents} views of parents, {hidden} spheres left out");
    }
}
