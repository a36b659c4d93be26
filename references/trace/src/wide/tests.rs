//! Every kernel against the scalar one, and the tree against what its traversal relies on.

use glam::Vec3;

use super::build::build;
use super::kernel::Level;
use super::{BUNDLE, Bundle, Child, Hierarchy, Id, Opened, Stack};
use crate::traced_ray::TracedRay;
use crate::triangle::{Triangle, TrianglePacket};

/// Deterministic numbers in `[0, 1)`.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

fn hierarchy(triangles: &[Triangle], level: Level) -> Hierarchy<TrianglePacket> {
    let items = (0..).zip(triangles).map(|(primitive, t)| (*t, Id { geometry: 0, primitive }));
    build(&items.collect::<Vec<_>>(), level)
}

/// A flat grid: its triangles share edges that rays meet exactly, and many hits are tied.
fn grid(side: usize, step: f32) -> Vec<Triangle> {
    let at = |x: usize, y: usize| Vec3::new(x as f32 * step, y as f32 * step, 0.0);
    let quads = (0..side * side).map(|i| (i % side, i / side));
    let halves = |(x, y)| {
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        [Triangle([a, b, c]), Triangle([a, c, d])]
    };
    quads.flat_map(halves).collect()
}

fn soup(random: &mut Random, count: usize, size: f32) -> Vec<Triangle> {
    let mut triangle = |_| {
        let center = random.point();
        Triangle([0; 3].map(|_| center + random.point() * size))
    };
    (0..count).map(&mut triangle).collect()
}

/// Random rays, and rays aimed exactly at corners, edges and along axes.
fn rays(random: &mut Random, triangles: &[Triangle]) -> Vec<TracedRay> {
    let mut rays = Vec::new();
    for triangle in triangles {
        let [a, b, _] = triangle.0;
        let origin = random.point() * 2.0;
        let targets = [a, a + (b - a) * random.unit(), random.point()];
        rays.extend(targets.map(|target| TracedRay::new(origin, (target - origin).normalize(), 0.0)));
        rays.push(TracedRay::new(a + Vec3::Z, -Vec3::Z, 0.0));
        rays.push(TracedRay::new(a - Vec3::X, Vec3::X, 0.25));
    }
    rays.into_iter().flatten().collect()
}

#[test]
fn every_kernel_gives_the_bits_of_the_scalar_one() {
    let mut random = Random(1);
    let worlds = [soup(&mut random, 500, 0.3), grid(16, 0.1), soup(&mut random, 3, 1.0)];
    let mut hit = 0;
    for triangles in &worlds {
        let rays = rays(&mut random, triangles);
        let answers = |level: Level| {
            let (tree, mut stack) = (hierarchy(triangles, level), Stack::default());
            let mut answer = |(i, ray): (usize, &TracedRay)| {
                let t_max = if i % 3 == 0 { 1.5 } else { f32::INFINITY };
                let closest = tree.closest(ray, t_max, &mut stack);
                let any = tree.any(ray, t_max, &mut stack);
                assert_eq!(any, closest.is_some());
                closest.map(|(found, id)| (found.t.to_bits(), found.detail.map(f32::to_bits), id))
            };
            let closest: Vec<_> = rays.iter().enumerate().map(&mut answer).collect();
            for (first, chunk) in (0..).step_by(BUNDLE).zip(rays.chunks_exact(BUNDLE)) {
                let rays = std::array::from_fn(|i| chunk[i]);
                let ends = std::array::from_fn(|i| if (first + i) % 3 == 0 { 1.5 } else { f32::INFINITY });
                // Some bundles whole, some with few rays, which walk alone.
                let open = if first % 512 == 0 { u64::MAX } else { 0x1234_5678_9abc_def0 >> (first / BUNDLE % 64) };
                let hit = (0..BUNDLE).fold(0, |hit, i| hit | u64::from(closest[first + i].is_some()) << i);
                assert_eq!(tree.any_of(Bundle { rays: &rays, ends: &ends, open }, &mut stack), hit & open, "{level:?}");
            }
            closest
        };
        let expected = answers(Level::all()[0]);
        hit += expected.iter().flatten().count();
        for level in Level::all() {
            assert!(answers(level) == expected, "{level:?}");
        }
    }
    assert!(hit > 1000, "only {hit} hits");
}

/// Rays through the exact middle of a plane of triangles, along grid lines: the shear decides on which side of a line
/// they pass, and the boxes on either side end there.
#[test]
fn boxes_give_way_to_what_the_shear_rounds() {
    for level in Level::all() {
        let mut random = Random(5);
        let triangles = grid(32, 0.1);
        let (tree, mut stack) = (hierarchy(&triangles, level), Stack::default());
        let mut escaped = 0;
        for _ in 0..20_000 {
            let line = (1.0 + (random.unit() * 30.0).floor()) * 0.1;
            let target = Vec3::new(line, 0.1 + 3.0 * random.unit(), 0.0);
            let target = if random.unit() < 0.5 { target } else { Vec3::new(target.y, target.x, 0.0) };
            let origin = target + random.point() * Vec3::new(1.0, 1.0, 0.0) + Vec3::Z * (1.0 + random.unit());
            let ray = TracedRay::new(origin, (target - origin).normalize(), 0.0).unwrap();
            escaped += usize::from(!tree.any(&ray, f32::INFINITY, &mut stack));
        }
        assert_eq!(escaped, 0, "{level:?}");
    }
}

#[test]
fn a_child_keeps_its_index_and_lanes() {
    for count in 1..=8 {
        let Opened::Packet { index, lanes } = Child::packet(123_456_789, count).open() else { panic!("not a packet") };
        assert_eq!((index, lanes), (123_456_789, (1 << count) - 1));
    }
    assert!(matches!(Child::node(7).open(), Opened::Node(7)));
}

#[test]
fn the_tree_holds_every_primitive_once_and_fills_its_nodes() {
    let mut random = Random(3);
    let coincident = vec![Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]); 1000];
    for triangles in [soup(&mut random, 1, 0.1), soup(&mut random, 9, 0.1), soup(&mut random, 5000, 0.05), coincident] {
        let tree = hierarchy(&triangles, Level::of_this_machine());
        let mut seen = vec![0; triangles.len()];
        let (mut open, mut nodes, mut children) = (vec![(Child::node(0), 0)], 0, 0);
        while let Some((child, waiting)) = open.pop() {
            assert!(waiting + 8 <= tree.waiting, "the stack has {} entries", tree.waiting);
            match child.open() {
                Opened::Node(index) => {
                    let node = &tree.nodes[index];
                    let count = node.occupied.count_ones() as usize;
                    nodes += 1;
                    children += count;
                    open.extend(node.children[..count].iter().map(|child| (*child, waiting + count - 1)));
                }
                Opened::Packet { index, lanes } => (0..8).filter(|lane| lanes >> lane & 1 == 1).for_each(|lane| {
                    seen[tree.ids[index * 8 + lane].primitive as usize] += 1;
                }),
            }
        }
        assert_eq!(seen, vec![1; triangles.len()]);
        assert!(nodes == 1 || children >= 5 * nodes, "{children} children in {nodes} nodes");
    }
}

#[test]
fn of_tied_hits_the_first_in_the_tree_counts() {
    for level in Level::all() {
        let tree = hierarchy(&vec![Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]); 200], level);
        let ray = TracedRay::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z, 0.0).unwrap();
        let (_, id) = tree.closest(&ray, f32::INFINITY, &mut Stack::default()).unwrap();
        assert_eq!(id, tree.ids[0], "{level:?}");
    }
}
