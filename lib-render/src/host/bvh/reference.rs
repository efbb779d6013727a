//! What a ray hits, written as plainly as possible: the tests' measure for a tree and its layout.
//!
//! The triangle test is the watertight one of Woop, Benthin & Wald 2013 without its f64 fallback (inclusive signs, no
//! contraction), and barycentrics are normalised before t, so that nothing under- or overflows between 1e-18 and 1e18
//! (accuracy.md, N2 as amended).

use super::{Bounds, Bvh, ChildRef, Triangle};

/// Room for rounding in the slab test: the far plane is Ize's 2 ulp (2013), the near one as much on the other side, so
/// that a box is passed over only if no t computed in it can win.
const FAR_PAD: f32 = 1.000_000_4;
const NEAR_PAD: f32 = 0.999_999_6;

#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub origin: [f32; 3],
    pub direction: [f32; 3],
}

/// Parameter along the ray and number of the triangle, ordered as hits are preferred.
pub(super) type Hit = (f32, u32);

/// The closest hit with t > 0 among all triangles but the dropped ones, tried one by one.
pub(super) fn brute_force(ray: &Ray, triangles: &[Triangle], numbers: &[u32]) -> Option<Hit> {
    let hits = numbers.iter().filter_map(|&n| Some((intersect(ray, &triangles[n as usize])?, n)));
    hits.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
}

/// The closest hit, by the tree.
pub(super) fn traverse(ray: &Ray, bvh: &Bvh, triangles: &[Triangle]) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    let mut open = vec![ChildRef::Inner(0)];
    while let Some(next) = open.pop() {
        match next {
            ChildRef::Inner(index) => {
                let node = &bvh.nodes[index as usize];
                let far = best.map_or(f32::INFINITY, |(t, _)| t);
                for side in 0..4 {
                    if enters(ray, &node.bounds[side], far) {
                        open.push(node.child[side]);
                    }
                }
            }
            ChildRef::Leaf { first, count } => {
                for &number in &bvh.order[first as usize..][..count as usize] {
                    let hit = intersect(ray, &triangles[number as usize]).map(|t| (t, number));
                    best = match (best, hit) {
                        (Some(old), Some(new)) if new < old => hit,
                        (None, _) => hit,
                        _ => best,
                    };
                }
            }
        }
    }
    best
}

/// Whether the ray may meet the box before `far`. Planes in the order of the direction's sign; NaN (a ray within a slab's plane) drops out.
fn enters(ray: &Ray, b: &Bounds, far: f32) -> bool {
    let (mut near_t, mut far_t) = (0.0_f32, far);
    for k in 0..3 {
        let inverse = 1.0 / ray.direction[k];
        let (near, far) = if inverse.is_sign_negative() { (b.hi[k], b.lo[k]) } else { (b.lo[k], b.hi[k]) };
        let entry = (near - ray.origin[k]) * inverse * NEAR_PAD;
        let exit = (far - ray.origin[k]) * inverse * FAR_PAD;
        near_t = if entry > near_t { entry } else { near_t };
        far_t = if exit < far_t { exit } else { far_t };
    }
    near_t <= far_t
}

/// t of the ray in the triangle, if positive and finite.
fn intersect(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    let d = ray.direction;
    let z = (0..3).fold(0, |best, k| if d[k].abs() > d[best].abs() { k } else { best });
    let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
    if d[z] < 0.0 {
        (x, y) = (y, x);
    }
    let [shear_x, shear_y, scale] = [d[x] / d[z], d[y] / d[z], 1.0 / d[z]];
    let [a, b, c] = triangle.map(|v| {
        let to = [0, 1, 2].map(|k| v[k] - ray.origin[k]);
        [to[x] - shear_x * to[z], to[y] - shear_y * to[z], scale * to[z]]
    });
    let edges = [c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]];
    if edges.iter().any(|e| *e < 0.0) && edges.iter().any(|e| *e > 0.0) {
        return None;
    }
    let determinant = edges[0] + edges[1] + edges[2];
    if determinant == 0.0 {
        return None;
    }
    let [u, v, w] = edges.map(|e| e / determinant);
    let t = u * a[2] + v * b[2] + w * c[2];
    (t > 0.0 && t < f32::INFINITY).then_some(t)
}
