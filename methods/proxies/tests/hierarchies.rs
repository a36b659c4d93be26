//! Hierarchies over spheres: what they bound, and that they are trees.

use glam::Vec3;
use halflight_proxies::Hierarchy;
use halflight_scenes::Sphere;
use proptest::prelude::*;

fn spheres(most: usize) -> impl Strategy<Value = Vec<Sphere>> {
    let radius = prop_oneof![Just(0.0f32), 0.01f32..2.0, 1e3f32..1e4];
    let coordinate = || prop_oneof![-5.0f32..5.0, Just(1.0), -1e5f32..1e5];
    let sphere = (coordinate(), coordinate(), coordinate(), radius);
    let sphere = sphere.prop_map(|(x, y, z, radius)| Sphere { center: Vec3::new(x, y, z), radius });
    prop::collection::vec(sphere, 0..most)
}

fn bounds(hierarchy: &Hierarchy, spheres: &[Sphere]) -> Vec<Sphere> {
    let mut bounds = Vec::new();
    hierarchy.bounds(spheres, &mut bounds);
    bounds
}

fn excess(outer: &Sphere, inner: &Sphere) -> f64 {
    let distance = outer.center.as_dvec3().distance(inner.center.as_dvec3());
    distance + f64::from(inner.radius) - f64::from(outer.radius)
}

proptest! {
    #[test]
    fn every_parent_bounds_its_children_in_any_pose(rest in spheres(60), moved in spheres(60)) {
        let hierarchy = Hierarchy::new(&rest);
        let moved: Vec<Sphere> = rest.iter().enumerate().map(|(i, at_rest)| *moved.get(i).unwrap_or(at_rest)).collect();
        for pose in [&rest, &moved] {
            let bounds = bounds(&hierarchy, pose);
            for node in 0..hierarchy.len() {
                for child in hierarchy.children(node) {
                    let excess = excess(&bounds[node], &bounds[child]);
                    prop_assert!(excess <= 0.0, "{:?} leaves {excess} of {:?} out", bounds[node], bounds[child]);
                }
                for leaf in hierarchy.spheres(node) {
                    prop_assert!(excess(&bounds[node], &pose[*leaf as usize]) <= 0.0);
                }
            }
        }
    }

    #[test]
    fn every_sphere_is_one_leaf_and_parents_have_several_children(rest in spheres(100)) {
        let hierarchy = Hierarchy::new(&rest);
        let leaves: Vec<usize> = (0..hierarchy.len()).filter(|node| hierarchy.is_leaf(*node)).collect();
        let mut numbers: Vec<u32> = leaves.iter().flat_map(|leaf| hierarchy.spheres(*leaf)).copied().collect();
        numbers.sort_unstable();
        prop_assert_eq!(numbers, (0..rest.len() as u32).collect::<Vec<_>>());
        for node in (0..hierarchy.len()).filter(|node| !hierarchy.is_leaf(*node)) {
            let children: Vec<usize> = hierarchy.children(node).collect();
            prop_assert!(children.len() > 1);
            let below: Vec<u32> = children.iter().flat_map(|child| hierarchy.spheres(*child)).copied().collect();
            prop_assert_eq!(below, hierarchy.spheres(node));
        }
        prop_assert_eq!(hierarchy.is_empty(), rest.is_empty());
        prop_assert!(rest.is_empty() || hierarchy.next(0) == hierarchy.len());
    }

    #[test]
    fn a_forest_is_its_trees(first in spheres(20), second in spheres(20)) {
        let trees = [Hierarchy::new(&first), Hierarchy::new(&second)];
        let mut forest = trees[0].clone();
        forest.append(&trees[1]);
        let all: Vec<Sphere> = first.iter().chain(&second).copied().collect();
        let apart = [bounds(&trees[0], &first), bounds(&trees[1], &second)].concat();
        prop_assert_eq!(bounds(&forest, &all), apart);
        let second_root = trees[0].len();
        prop_assert!(second.is_empty() || forest.next(second_root) == forest.len());
    }
}

#[test]
fn four_children_are_the_rule_and_neighbours_stay_together() {
    let sphere = |i: usize| {
        let wave = |phase: f32| (i as f32 * 2.399 + phase).sin();
        Sphere { center: Vec3::new(wave(0.0), wave(1.7) * wave(i as f32), wave(3.1 * i as f32)), radius: 0.05 }
    };
    let rest: Vec<Sphere> = (0..512).map(sphere).collect();
    let hierarchy = Hierarchy::new(&rest);
    let parents = (0..hierarchy.len()).filter(|node| !hierarchy.is_leaf(*node)).count();
    let branching = (hierarchy.len() - 1) as f32 / parents as f32;
    assert!((3.5..=4.5).contains(&branching), "{branching} children a parent");
    let bounds = bounds(&hierarchy, &rest);
    let smallest = (0..hierarchy.len()).filter(|node| (3..6).contains(&hierarchy.spheres(*node).len()));
    let radii: Vec<f32> = smallest.map(|node| bounds[node].radius).collect();
    let mean = radii.iter().sum::<f32>() / radii.len() as f32;
    assert!(mean < 0.3 * bounds[0].radius, "four spheres of 512 span {mean} of {}", bounds[0].radius);
}
