//! Sphere sets that others make, for comparison (Ren 2006, fig. 4).

pub(crate) mod medial;
pub(crate) mod octree;
