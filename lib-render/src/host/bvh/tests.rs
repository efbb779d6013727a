//! T29 (hostile triangles) and T9's part for this tree (brute force and tree agree to the bit).

use super::reference::{Ray, brute_force, traverse};
use super::tree::{Kind, Tree};
use super::*;
use crate::host::random::Random;

const SEED: u64 = 0x0b0c_5e55;

fn random() -> Random {
    println!("seed {SEED:#x}");
    Random(SEED)
}

/// `count` triangles of size `size` at random places in the cube [-1, 1]³.
fn soup(random: &mut Random, count: usize, size: f32) -> Vec<Triangle> {
    let corner = |at: [f32; 3], by: [f32; 3]| [0, 1, 2].map(|k| at[k] + size * by[k]);
    let triangle = |random: &mut Random| {
        let at = random.point();
        [0; 3].map(|_| corner(at, random.point()))
    };
    (0..count).map(|_| triangle(random)).collect()
}

fn scaled(triangles: &[Triangle], by: f32) -> Vec<Triangle> {
    triangles.iter().map(|t| t.map(|v| v.map(|x| x * by))).collect()
}

/// Checks everything that holds for any tree, and returns it.
fn build(triangles: &[Triangle]) -> Bvh {
    let bvh = Bvh::build(triangles);
    let dropped = bvh.dropped.non_finite + bvh.dropped.zero_area;
    assert_eq!(bvh.order.len() + dropped, triangles.len());
    let mut numbers = bvh.order.clone();
    numbers.sort_unstable();
    numbers.dedup();
    assert_eq!(numbers.len(), bvh.order.len(), "each triangle has one slot");
    assert!((1..=MAX_DEPTH).contains(&bvh.depth));
    assert!(bvh.waiting <= MAX_WAITING);
    // Nodes and slots in the order in which a walk meets them, boxes exact.
    let (mut next_node, mut next_slot) = (1, 0);
    let mut deepest = 0;
    let mut open = vec![(0, 1)];
    let mut last = Vec::new();
    while let Some((index, depth)) = open.pop() {
        deepest = deepest.max(depth);
        let node: &BvhNode = &bvh.nodes[index];
        for (child, bounds) in node.child.into_iter().zip(node.bounds) {
            let exact = match child {
                ChildRef::Inner(child) => {
                    open.push((child as usize, depth + 1));
                    next_node += 1;
                    bvh.nodes[child as usize].bounds.iter().fold(Bounds::EMPTY, |all, b| all.union(b))
                }
                ChildRef::Leaf { first, count } => {
                    assert!(count as usize <= MAX_LEAF);
                    let members = &bvh.order[first as usize..][..count as usize];
                    last.push((first, count));
                    next_slot += count as usize;
                    members.iter().fold(Bounds::EMPTY, |all, &n| all.union(&Bounds::of(&triangles[n as usize])))
                }
            };
            assert_eq!(bounds, exact);
        }
    }
    assert_eq!((next_node, next_slot, deepest), (bvh.nodes.len(), bvh.order.len(), bvh.depth));
    last.sort_unstable();
    assert!(last.windows(2).all(|w| w[0].0 + w[0].1 <= w[1].0), "leaves do not overlap");
    bvh
}

/// Rays at random corners and insides of the triangles, and anywhere.
fn rays(random: &mut Random, triangles: &[Triangle], count: usize, scale: f32) -> Vec<Ray> {
    let mut ray = |i: usize| {
        let origin = random.point().map(|x| 2.0 * x * scale);
        let triangle = triangles[(random.bits() % triangles.len() as u64) as usize];
        let target = match i % 3 {
            0 => triangle[i % 2],
            1 => [0, 1, 2].map(|k| triangle[0][k] / 3.0 + triangle[1][k] / 3.0 + triangle[2][k] / 3.0),
            _ => random.point().map(|x| x * scale),
        };
        Ray { origin, direction: [0, 1, 2].map(|k| (target[k] - origin[k]) / scale) }
    };
    (0..count).map(&mut ray).collect()
}

/// The tree finds, to the bit, what trying all its triangles finds; returns the share of rays that hit.
fn check_hits(triangles: &[Triangle], rays: &[Ray]) -> f64 {
    let bvh = build(triangles);
    let hits = rays.iter().filter(|ray| {
        let expected = brute_force(ray, triangles, &bvh.order);
        let found = traverse(ray, &bvh, triangles);
        assert_eq!(found.map(|(t, n)| (t.to_bits(), n)), expected.map(|(t, n)| (t.to_bits(), n)), "{ray:?}");
        found.is_some()
    });
    hits.count() as f64 / rays.len() as f64
}

#[test]
fn hits_are_those_of_brute_force_at_every_scale() {
    let mut random = random();
    let unit = soup(&mut random, 2000, 0.1);
    for scale in [1.0, 1e-18, 1e18] {
        let triangles = scaled(&unit, scale);
        let rays = rays(&mut random, &triangles, 600, scale);
        assert!(check_hits(&triangles, &rays) > 0.5, "scale {scale}");
    }
}

#[test]
fn ties_go_to_the_smallest_number_in_any_order() {
    // Each triangle four times, and a wall of squares whose edges are shared.
    let mut random = random();
    let mut triangles = soup(&mut random, 300, 0.3).repeat(4);
    for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x as f32, y as f32))) {
        let corner = |dx: f32, dy: f32| [(x + dx) / 10.0 - 1.0, (y + dy) / 10.0 - 1.0, 0.25];
        triangles.push([corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0)]);
        triangles.push([corner(0.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]);
    }
    for i in (1..triangles.len()).rev() {
        triangles.swap(i, (random.bits() % (i as u64 + 1)) as usize);
    }
    let rays = rays(&mut random, &triangles, 1500, 1.0);
    check_hits(&triangles, &rays);
}

#[test]
fn none_one_and_two_triangles() {
    let triangle = |z: f32| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
    let empty = build(&[]);
    assert_eq!((empty.nodes.len(), empty.depth, empty.bounds), (1, 1, Bounds::EMPTY));
    assert_eq!(empty.nodes[0], BvhNode::EMPTY);
    let ray = Ray { origin: [0.2, 0.2, 0.0], direction: [0.0, 0.0, 1.0] };
    assert_eq!(traverse(&ray, &empty, &[]), None);
    let one = [triangle(3.0)];
    assert_eq!(traverse(&ray, &build(&one), &one).map(|hit| hit.1), Some(0));
    let two = [triangle(4.0), triangle(2.0)];
    assert_eq!(traverse(&ray, &build(&two), &two).map(|hit| hit.1), Some(1));
}

#[test]
fn what_cannot_be_hit_is_dropped_and_counted() {
    let mut random = random();
    let points = soup(&mut random, 1000, 0.0);
    assert_eq!(build(&points).dropped, Dropped { non_finite: 0, zero_area: 1000 });
    let mut triangles = soup(&mut random, 10_000, 0.01);
    for i in (0..triangles.len()).step_by(100) {
        triangles[i][i % 3][i % 2] = f32::NAN;
    }
    triangles[1][0][0] = f32::INFINITY;
    triangles[2] = [[0.0; 3], [1.0; 3], [3.0; 3]];
    let bvh = build(&triangles);
    assert_eq!(bvh.dropped, Dropped { non_finite: 101, zero_area: 1 });
    assert!(bvh.bounds.hi.iter().all(|x| *x < 1.1));
}

#[test]
fn coincident_triangles_build_a_balanced_tree() {
    let one = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    let bvh = build(&vec![one; 100_000]);
    assert!(bvh.depth <= 17);
    // Half of them in one place, the others around: the rehearsal sees it.
    let mut triangles = soup(&mut random(), 20_000, 0.01);
    triangles.extend(vec![one; 20_000]);
    assert!(build(&triangles).depth <= 17);
}

#[test]
fn extreme_sizes_build_trees_like_ordinary_ones() {
    let unit = soup(&mut random(), 20_000, 0.02);
    let ordinary = build(&unit).depth;
    // A tenth of the largest float; and down to 2^-120 each coordinate keeps its bits, so the tree stays the same.
    for scale in [2.0_f32.powi(124), 2.0_f32.powi(-90)] {
        assert_eq!(build(&scaled(&unit, scale)).depth, ordinary, "scale {scale:e}");
    }
    let huge = scaled(&unit, 3.3e38);
    assert!(build(&huge).dropped.non_finite < huge.len());
    // Denormal corners are few distinct numbers: many triangles collapse, the others still make a tree.
    let denormal = build(&scaled(&unit, 1e-42));
    assert!(denormal.dropped.zero_area < unit.len());
}

#[test]
fn sizes_over_many_magnitudes_build_bounded_trees() {
    let mut random = random();
    for ratio in [1.0001_f32, 1.0017, 1.1, 2.0] {
        // From 1e37 downwards, starting again when it gets to 1e-37.
        let mut size = 1e37_f32;
        let unit = soup(&mut random, 30_000, 0.2);
        let mut triangles = Vec::new();
        for triangle in &unit {
            size = if size > 1e-37 { size / ratio } else { 1e37 };
            triangles.push(triangle.map(|v| v.map(|x| (x + 1.0) * size)));
        }
        build(&triangles);
    }
}

#[test]
fn chains_of_merges_build_bounded_trees() {
    // Triangles about one corner, each smaller than the last, merge one at a time. A short chain is built (1,966 levels
    // deep, without bounds) and its tail rebuilt; a long one, of pairs so that the first pass looks healthy, is not begun.
    for (count, copies, ratio) in [(2000, 1, 1.05), (1 << 13, 2, 1.01)] {
        let mut size = 1.0_f32;
        let mut triangles = Vec::new();
        for _ in 0..count {
            triangles.extend([[[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]]].repeat(copies));
            size /= ratio;
        }
        build(&triangles);
    }
}

/// A small thing of many triangles in a wide room of few: medians of the centres divide the thing, not the room.
#[test]
fn splits_by_surface_are_cheaper_than_at_the_median() {
    let mut random = random();
    let mut triangles = scaled(&soup(&mut random, 10_000, 0.02), 0.01);
    triangles.extend(soup(&mut random, 1000, 0.05));
    let boxes: Vec<Bounds> = triangles.iter().map(|t| Bounds::of(t)).collect();
    let [by_surface, at_median] =
        [super::sah::build(&boxes), super::median::build(&boxes)].map(|tree| cost(&tree, tree.root()));
    println!("surfaces of nodes over that of the root: {by_surface} and {at_median}");
    // 0.64 of it.
    assert!(by_surface < 0.75 * at_median, "{by_surface} against {at_median}");
}

/// The surfaces of all inner nodes below a node, in surfaces of the whole: how many of them a ray meets.
fn cost(tree: &Tree, node: super::tree::NodeId) -> f64 {
    match tree.kind_of(node) {
        Kind::Leaf(_) => 0.0,
        Kind::Inner(children) => {
            let own = tree.bounds_of(node).half_area() / tree.bounds().half_area();
            own + children.iter().map(|child| cost(tree, *child)).sum::<f64>()
        }
    }
}

#[test]
fn a_regular_grid_builds_a_shallow_tree() {
    // Equal costs everywhere, as in any tessellated plane.
    let mut triangles = Vec::new();
    for (x, y) in (0..200).flat_map(|x| (0..200).map(move |y| (x as f32, y as f32))) {
        triangles.push([[x, y, 0.0], [x + 1.0, y, 0.0], [x + 1.0, y + 1.0, 0.0]]);
        triangles.push([[x, y, 0.0], [x + 1.0, y + 1.0, 0.0], [x, y + 1.0, 0.0]]);
    }
    assert!(build(&triangles).depth <= 40);
}

#[test]
fn references_lead_to_nodes_and_blocks() {
    let mut random = random();
    let triangles = soup(&mut random, 100, 0.1);
    let bvh = build(&triangles);
    let words = bvh.words(&triangles);
    let (mut open, mut found) = (vec![48], Vec::new());
    while let Some(at) = open.pop() {
        for &child in &words[at + 24..][..4] {
            if child < 1 << 31 {
                open.push(child as usize);
                continue;
            }
            let block = &words[(child & !(1 << 31)) as usize..][..40];
            for (lane, &number) in block[36..].iter().enumerate().filter(|(_, number)| **number != crate::schema::NONE)
            {
                let corners =
                    [0, 1, 2].map(|corner| [0, 1, 2].map(|k| f32::from_bits(block[12 * corner + 4 * k + lane])));
                assert_eq!(corners, triangles[number as usize]);
                found.push(number);
            }
        }
    }
    found.sort_unstable();
    assert_eq!(found, (0..100).collect::<Vec<_>>());
}

/// A hundred instances of two meshes among triangles of the world.
fn instances(random: &mut Random) -> (Vec<(u32, Triangle)>, Vec<MeshTree>, Vec<Placement>) {
    let in_world = (7000..).zip(soup(random, 50, 0.1)).collect();
    let trees = vec![MeshTree::build(soup(random, 30, 0.3)), MeshTree::build(soup(random, 40, 0.3))];
    let placement = |i: u32| {
        let lo = random.point();
        let bounds = Bounds { lo, hi: lo.map(|x| x + 0.1) };
        Placement { tree: i as usize % 2, first: 50 * i, bounds, zero: lo, to_frame: [[i as f32; 3]; 3] }
    };
    let placements = (0..100).map(placement).collect();
    (in_world, trees, placements)
}

#[test]
fn references_lead_to_instances_and_on_to_their_meshes() {
    let (in_world, trees, placements) = instances(&mut random());
    let words = Instanced::build(&in_world, &trees, &placements).expect("it fits").words;
    let mut meshes = [None; 2];
    let (mut open, mut firsts, mut numbers) = (vec![48], Vec::new(), Vec::<u32>::new());
    while let Some(at) = open.pop() {
        for &child in &words[at + 24..][..4] {
            let place = (child & !(1 << 31 | 1)) as usize;
            match (child >> 31, child & 1) {
                (0, _) => open.push(place),
                (_, 0) => numbers.extend(words[place + 36..][..4].iter().filter(|n| **n != crate::schema::NONE)),
                _ => {
                    let [mesh, first] = [words[place + 36], words[place + 37]];
                    let placement = &placements[first as usize / 50];
                    let planes = (0..3).flat_map(|k| [placement.bounds.lo[k], placement.bounds.hi[k]]);
                    assert!(words[place..][..24].chunks(4).map(|p| f32::from_bits(p[0])).eq(planes));
                    assert_eq!(f32::from_bits(words[place + 24]), placement.to_frame[0][0]);
                    assert_eq!([0, 1, 2].map(|k| f32::from_bits(words[place + 33 + k])), placement.zero);
                    assert_eq!(*meshes[placement.tree].get_or_insert(mesh), mesh);
                    firsts.push(first);
                }
            }
        }
    }
    firsts.sort_unstable();
    numbers.sort_unstable();
    assert!(firsts.into_iter().eq((0..100).map(|i| 50 * i)) && numbers.into_iter().eq(7000..7050));
    // Behind its box a mesh's tree, with numbers of its own.
    for (mesh, count) in meshes.into_iter().zip([30, 40]) {
        let (mut open, mut numbers) = (vec![mesh.expect("it has instances") as usize + 8], Vec::<u32>::new());
        while let Some(at) = open.pop() {
            for &child in &words[at + 24..][..4] {
                let place = (child & !(1 << 31)) as usize;
                match child >> 31 {
                    0 => open.push(place),
                    _ => numbers.extend(words[place + 36..][..4].iter().filter(|n| **n != crate::schema::NONE)),
                }
            }
        }
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..count));
    }
}

#[test]
fn what_a_walk_could_not_hold_is_not_built() {
    let (in_world, trees, placements) = instances(&mut random());
    let [whole, alone] = [&placements[..], &[]].map(|placements| {
        let fits = |most: &usize| Instanced::within(*most, &in_world, &trees, placements).is_some();
        (0..=MAX_WAITING).find(fits).expect("with the whole stack it fits")
    });
    println!("{whole} wait with instances, {alone} without");
    assert!(whole > alone && alone > 0);
}
