//! S6: sphere sets against their competitors.

use super::super::row::{Judgement, Row, Verdict, number};
use crate::Error;

const OURS: &str = "outside volume of the variational set, of the mesh's volume";
const MEDIAL: &str = "outside volume of the medial-axis style set, of the mesh's volume";
const OCTREE: &str = "outside volume of the octree, of the mesh's volume";

pub(crate) const S6: Row = Row {
    id: "S6",
    place: "Fig. 4",
    claim: "With as many spheres the variational set leaves less volume outside a mesh than the medial axis does, and far less than an octree",
    paper: &[(OURS, "0.35"), (MEDIAL, "0.52"), (OCTREE, "4.1")],
    needs: "sphere sets by the medial axis and by an octree, which `halflight_proxies` does not offer yet",
    measure: |_| Err(Error::Other(format!("row S6 needs {}", S6.needs))),
    judge: |figures| {
        let [ours, medial, octree] = figures.values([OURS, MEDIAL, OCTREE])?;
        let why = format!(
            "The variational set leaves {} times the medial-axis style set's volume outside, and {} times the octree's.",
            number(ours / medial),
            number(ours / octree)
        );
        Some(Judgement { verdict: Verdict::of(&[ours <= 0.67 * medial, ours <= 0.2 * octree]), why })
    },
};
