//! The hierarchy of a scene's blockers and the clusters of its receivers, kept from frame to frame.

use halflight_contract::{Meter, Params, counted, timed};
use halflight_proxies::{Hierarchy, PosedSpheres, Proxy};
#[cfg(feature = "gpu")]
use halflight_scenes::Revision;
use halflight_scenes::{Receivers, Scene, Sphere};

use crate::clusters::{Cluster, Clusters};
use crate::cut::{Forest, Visits};
use crate::params;

/// What cuts are made of.
#[derive(Default)]
pub(crate) struct Clustered {
    /// A tree an object, in the order in which blockers are posed.
    hierarchy: Hierarchy,
    bounds: Vec<Sphere>,
    clusters: Clusters,
}

impl Clustered {
    /// The trees of all objects that cast, at rest.
    pub(crate) fn new(scene: &Scene, proxies: &[Option<Proxy>]) -> Self {
        let mut hierarchy = Hierarchy::default();
        let casting = scene.objects.iter().zip(proxies).filter(|(object, _)| object.casts);
        casting.filter_map(|(_, proxy)| proxy.as_ref()).for_each(|proxy| {
            hierarchy.append(&Hierarchy::new(&proxy.set.spheres));
        });
        Clustered { hierarchy, ..Clustered::default() }
    }

    /// Follows blockers and receivers that moved.
    pub(crate) fn update(
        &mut self,
        blockers: &PosedSpheres,
        receivers: &Receivers,
        params: &Params,
        meter: &mut dyn Meter,
    ) {
        timed(meter, "fit the hierarchy", |_| self.hierarchy.bounds(&blockers.spheres, &mut self.bounds));
        let size = params.int(params::CLUSTER.name);
        timed(meter, "cluster receivers", |_| self.clusters.update(receivers, size));
    }

    pub(crate) fn forest<'a>(&'a self, blockers: &'a PosedSpheres) -> Forest<'a> {
        Forest { hierarchy: &self.hierarchy, bounds: &self.bounds, spheres: &blockers.spheres }
    }

    pub(crate) fn clusters(&self) -> &[Cluster] {
        &self.clusters.clusters
    }

    /// The receivers that clusters were found for, and their size.
    #[cfg(feature = "gpu")]
    pub(crate) fn made_for(&self) -> Option<(Revision, usize)> {
        self.clusters.made_for
    }

    pub(crate) fn members(&self, cluster: &Cluster) -> &[usize] {
        self.clusters.members(cluster)
    }

    /// Bytes held, by purpose.
    pub(crate) fn bytes(&self) -> [(&'static str, usize); 2] {
        let hierarchy = self.hierarchy.bytes() + size_of_val(self.bounds.as_slice());
        [("sphere hierarchy", hierarchy), ("receiver clusters", self.clusters.bytes())]
    }
}

pub(crate) fn report(meter: &mut dyn Meter, visits: &Visits) {
    let amounts = [
        ("receiver clusters", visits.clusters),
        ("hierarchy nodes visited", visits.nodes),
        ("spheres in cuts", visits.spheres),
        ("largest cut", visits.largest),
        ("spheres seen in detail", visits.detailed),
        ("ratios bounded", visits.bounded),
    ];
    counted(meter, &amounts);
}
