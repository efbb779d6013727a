//! The tree over many lights, as [`crate::light::tree`] walks it: split where power, solid angle of light and extent add up to
//! least (Conty Estevez and Kulla 2018, section 4.4, the surface area orientation heuristic).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::memory::{Memory, Table};
use crate::schema::{LightTree, TREE_LEAF};

/// From so many lights with a place on a tree draws them. In a long hall it wins from 8 on at the latest; where all lights are
/// equally near it costs a tenth to a quarter of the time and wins nothing, and few lights often are (`tests/runs/lights.txt`).
pub const TREE_FROM: usize = 16;
/// Deepest leaf: a trail has a bit for each level.
const MAX_DEPTH: u32 = 30;

/// Where light comes from, and where it goes.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Box, world.
    pub lo: DVec3,
    /// See [`Emission::lo`].
    pub hi: DVec3,
    /// Middle of the normals.
    pub axis: DVec3,
    /// Largest angle of a normal to the axis, in [0, π].
    pub normals: f64,
    /// Largest angle of light to its normal, in [0, π/2].
    pub light: f64,
    /// In any unit.
    pub power: f64,
}

impl Emission {
    fn union(self, o: Emission) -> Emission {
        let (axis, normals) = cone_around((self.axis, self.normals), (o.axis, o.normals));
        Emission {
            lo: self.lo.min(o.lo),
            hi: self.hi.max(o.hi),
            axis,
            normals,
            light: self.light.max(o.light),
            power: self.power + o.power,
        }
    }

    /// Power times the measure of directions times the squared diagonal, which lights in a line have too.
    fn cost(&self) -> f64 {
        let (o, w) = (self.normals, (self.normals + self.light).min(PI));
        let (sin, cos) = o.sin_cos();
        let rim = 2.0 * w * sin - (o - 2.0 * w).cos() - 2.0 * o * sin + cos;
        let directions = 2.0 * PI * (1.0 - cos) + FRAC_PI_2 * rim;
        self.power * directions * (self.hi - self.lo).length_squared()
    }
}

/// The smallest cone around two.
fn cone_around(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let apart = wide.0.angle_between(narrow.0);
    if (apart + narrow.1).min(PI) <= wide.1 {
        return wide;
    }
    let half = (wide.1 + apart + narrow.1) / 2.0;
    let around = wide.0.cross(narrow.0);
    if half >= PI || around.length_squared() == 0.0 {
        return (wide.0, PI);
    }
    (glam::DQuat::from_axis_angle(around.normalize(), half - wide.1) * wide.0, half)
}

/// A light that has not got its place yet.
#[derive(Clone, Copy)]
struct Item {
    emission: Emission,
    light: u32,
}

/// The tree over lights 0 to n − 1, and the trail of each: bit k says to which child to go from level k.
pub fn build(lights: &[Emission]) -> (Memory, Vec<u32>) {
    let total: f64 = lights.iter().map(|e| e.power).sum();
    let share = |e: &Emission| Emission { power: e.power / total, ..*e };
    let items = (0..).zip(lights).map(|(light, emission)| Item { light, emission: share(emission) });
    let mut builder = Builder { table: Table::new(), links: Vec::new(), trails: vec![0; lights.len()] };
    if !lights.is_empty() {
        builder.node(&mut items.collect::<Vec<_>>(), 0, 0);
    }
    let mut memory = builder.table.finish();
    for (node, link) in builder.links.iter().enumerate() {
        memory.words[node * LIGHT_TREE_COLUMNS + LightTree::LINK.0 as usize] = *link;
    }
    (memory, builder.trails)
}

const LIGHT_TREE_COLUMNS: usize = <LightTree as jerboa_ir::lang::Buf>::COLUMNS.len();

struct Builder {
    table: Table<LightTree>,
    links: Vec<u32>,
    trails: Vec<u32>,
}

impl Builder {
    fn node(&mut self, items: &mut [Item], depth: u32, trail: u32) {
        let all = items.iter().map(|i| i.emission).reduce(Emission::union).expect("no node is empty");
        self.push(&all);
        let node = self.links.len();
        if let [item] = items {
            self.links.push(TREE_LEAF | item.light);
            self.trails[item.light as usize] = trail;
            return;
        }
        self.links.push(0);
        let middle = split(items, depth);
        let (first, second) = items.split_at_mut(middle);
        self.node(first, depth + 1, trail);
        self.links[node] = self.links.len() as u32;
        self.node(second, depth + 1, trail | 1 << depth);
    }

    fn push(&mut self, e: &Emission) {
        use LightTree as T;
        let middle = ((e.lo + e.hi) / 2.0).as_vec3();
        // From the rounded middle to the farthest corner, rounded up.
        let reach = (e.hi - middle.as_dvec3()).abs().max((e.lo - middle.as_dvec3()).abs()).length();
        let radius = if reach > 0.0 { (reach as f32).next_up() } else { 0.0 };
        let (sin, cos) = e.normals.sin_cos();
        self.table
            .push()
            .set_all([T::X, T::Y, T::Z, T::RADIUS], [middle.x, middle.y, middle.z, radius])
            .set_all([T::AXIS_X, T::AXIS_Y, T::AXIS_Z], e.axis.as_vec3().to_array())
            .set_all([T::COS_NORMALS, T::SIN_NORMALS], [cos as f32, sin as f32])
            .set_all([T::COS_LIGHT, T::POWER], [e.light.cos() as f32, e.power as f32]);
    }
}

/// Orders lights so that the first and the rest cost least; says how many are the first. In the middle where the tree would
/// get too deep.
fn split(items: &mut [Item], depth: u32) -> usize {
    let n = items.len();
    let order = |items: &mut [Item], axis: usize| {
        let middle = |i: &Item| i.emission.lo[axis] + i.emission.hi[axis];
        items.sort_by(|a, b| middle(a).total_cmp(&middle(b)).then(a.light.cmp(&b.light)));
    };
    let mut best = (f64::INFINITY, 0, n / 2);
    if depth + n.next_power_of_two().trailing_zeros() < MAX_DEPTH {
        for axis in 0..3 {
            order(items, axis);
            let mut costs = vec![0.0; n];
            let mut so_far: Option<Emission> = None;
            for i in (1..n).rev() {
                let all = so_far.map_or(items[i].emission, |s| s.union(items[i].emission));
                costs[i] = all.cost();
                so_far = Some(all);
            }
            let mut first = items[0].emission;
            for i in 1..n {
                let cost = first.cost() + costs[i];
                if cost < best.0 {
                    best = (cost, axis, i);
                }
                first = first.union(items[i].emission);
            }
        }
    }
    order(items, best.1);
    best.2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, axis: DVec3, normals: f64) -> Emission {
        let lo = DVec3::new(x, 0.0, 0.0);
        Emission { lo, hi: lo + DVec3::splat(0.1), axis, normals, light: FRAC_PI_2, power: 1.0 }
    }

    /// Follow a trail: the light it leads to, and its level.
    fn follow(tree: &Memory, trail: u32) -> (u32, u32) {
        let link = |node: usize| tree.words[node * LIGHT_TREE_COLUMNS + LightTree::LINK.0 as usize];
        let (mut node, mut level) = (0, 0);
        while link(node) & TREE_LEAF == 0 {
            node = if trail >> level & 1 == 0 { node + 1 } else { link(node) as usize };
            level += 1;
        }
        (link(node) & !TREE_LEAF, level)
    }

    #[test]
    fn trails_lead_to_their_lights() {
        for n in [1_usize, 2, 3, 33, 1000] {
            // Evenly, each twice as far as the one before, and all in one place.
            for place in [|i: usize| i as f64, |i: usize| 2_f64.powi(i as i32 % 500), |_| 0.0] {
                let lights: Vec<_> = (0..n).map(|i| at(place(i), DVec3::Y, 0.0)).collect();
                let (tree, trails) = build(&lights);
                assert_eq!((tree.rows as usize, trails.len()), (2 * n - 1, n));
                for (i, trail) in trails.iter().enumerate() {
                    let (light, level) = follow(&tree, *trail);
                    assert!(light as usize == i && level <= MAX_DEPTH, "light {i} of {n}: {light}, level {level}");
                }
            }
        }
    }

    #[test]
    fn cones_hold_both() {
        let directions = [DVec3::X, DVec3::Y, -DVec3::X, DVec3::new(1.0, 2.0, -0.5).normalize()];
        for (a, b) in directions.iter().flat_map(|a| directions.map(|b| (*a, b))) {
            for (s, t) in [(0.0, 0.0), (0.3, 0.1), (1.5, 2.0), (PI, 0.2)] {
                let (axis, angle) = cone_around((a, s), (b, t));
                let holds = |d: DVec3, r: f64| (axis.angle_between(d) + r).min(PI) <= angle + 1e-6;
                assert!(
                    (axis.length() - 1.0).abs() < 1e-9 && holds(a, s) && holds(b, t),
                    "{a} {s}, {b} {t}: {axis} {angle}"
                );
            }
        }
    }
}
