//! Values against f64: hits (T18), Fresnel (T12), the distribution of normals (N4), frames (N7), warps.
//!
//! `JERBOA_RAYS` hits, 20,000 otherwise; the long version is
//!
//! ```sh
//! JERBOA_RAYS=10000000 cargo test --release -p jerboa-tests --test values -- --nocapture
//! ```

use jerboa_ir::lang::{Bool, F32, Fun, Keep, U32, entry};
use jerboa_lib_render::core::fresnel::fresnel_dielectric;
use jerboa_lib_render::core::microfacet::{Widths, ggx_d};
use jerboa_lib_render::core::onb::onb;
use jerboa_lib_render::core::sampling::*;
use jerboa_lib_render::core::triangle::uniform_triangle;
use jerboa_lib_render::core::vec::{Vec3, vec2, vec3};
use jerboa_lib_render::host::bvh::Bvh;
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::NONE;
use jerboa_lib_render::traverse::{AcceptFn, make_traverse};
use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::functions::fold;
use jerboa_tests::harness::rays::load;
use jerboa_tests::harness::sweep::{Left, Right, Sweep};

/// f at each argument.
fn fold1(args: &[f32], f: impl Fn(F32) -> F32) -> Vec<f32> {
    let pairs: Vec<[f32; 2]> = args.iter().map(|x| [*x, 0.0]).collect();
    fold(&pairs, |x, _| f(x))
}

/// n numbers from a to b, evenly spread and off the grid.
fn spread(n: usize, a: f64, b: f64) -> Vec<f32> {
    (0..n).map(|i| (a + (b - a) * ((i as f64 + 0.3819) / n as f64)) as f32).collect()
}

type V = [f64; 3];

fn sub(a: V, b: V) -> V {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: V) -> f64 {
    dot(a, a).sqrt()
}

/// Kernel `nearest`; puts one triangle on the bench.
fn bench() -> Bench {
    Bench::new(|| {
        let all = AcceptFn::lam(|_, _| Bool::from(true));
        let traverse = make_traverse();
        entry("nearest", Fun::<Ray, Hit>::lam(move |b, ray| traverse.call(b, (ray, Keep(false.into()), all))));
    })
}

fn place(bench: &mut Bench, corners: [[f32; 3]; 3]) {
    load(bench, &Bvh::build(&[corners]), &[corners]);
}

/// T18: t, u, v and the point of a hit, in units of 2^-23 of the largest coordinate as the ray's origin sees it, times
/// the condition: longest edge squared over twice the area that the ray sees, 1 or more for a triangle seen head-on.
#[test]
fn hits_are_within_8_ulp() {
    let mut random = Random::new(0x5eed_001a);
    let mut bench = bench();
    let mut worst = [0.0f64; 3];
    let mut hits = 0;
    for i in 0..number("JERBOA_RAYS", 20_000) / 20 {
        let (at, size) = (random.point(), 2f32.powi(-(random.below(13) as i32)));
        let scale = 2f32.powi(random.below(41) as i32 - 20);
        let corner = |random: &mut Random| random.point().iter().zip(at).map(|(x, c)| (c + size * x) * scale).collect();
        let corners: [Vec<f32>; 3] = std::array::from_fn(|_| corner(&mut random));
        let corners = corners.map(|c| [c[0], c[1], c[2]]);
        place(&mut bench, corners);
        for k in 0..20 {
            let org = random.point().map(|x| x * scale);
            let weights = {
                let (a, b) = (random.uniform().sqrt(), random.uniform());
                [1.0 - a, a * (1.0 - b), a * b]
            };
            let aim = |k: usize| (0..3).map(|c| weights[c] * f64::from(corners[c][k])).sum::<f64>();
            let dir = [0, 1, 2].map(|k| (aim(k) - f64::from(org[k])) as f32);
            let floats = [&org[..], &dir, &[f32::INFINITY]].concat();
            let args: Vec<u32> = floats.iter().map(|x| x.to_bits()).chain([NONE; 3]).collect();
            let hit = if i < 10 && k < 2 { bench.run_both("nearest", &args) } else { bench.run("nearest", &args) };
            // One aimed at an edge may pass by.
            if hit[0] == NONE {
                continue;
            }
            hits += 1;
            let [t, u, v] = [1, 2, 3].map(|k| f64::from(f32::from_bits(hit[k])));
            let [p0, p1, p2] = corners.map(|c| sub(c.map(f64::from), org.map(f64::from)));
            let dir = dir.map(f64::from);
            let (e1, e2) = (sub(p1, p0), sub(p2, p0));
            let n = cross(e1, e2);
            let exact_t = dot(n, p0) / dot(n, dir);
            let exact = dir.map(|d| exact_t * d);
            let within = sub(exact, p0);
            let (exact_u, exact_v) = (dot(n, cross(within, e2)) / dot(n, n), dot(n, cross(e1, within)) / dot(n, n));
            let longest = [e1, e2, sub(p2, p1)].map(length).into_iter().fold(0.0, f64::max);
            let condition = longest * longest * length(dir) / dot(n, dir).abs();
            let largest = [p0, p1, p2].concat().into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let unit = largest * condition * 2f64.powi(-23);
            let off = [0, 1, 2].map(|k| p0[k] + u * e1[k] + v * e2[k] - exact[k]);
            let errors = [
                (t - exact_t).abs() * length(dir) / unit,
                (u - exact_u).abs().max((v - exact_v).abs()) * longest / unit,
                length(off) / unit,
            ];
            for (w, e) in worst.iter_mut().zip(errors) {
                *w = w.max(e);
            }
        }
    }
    println!("{hits} hits: t {:.2}, u and v {:.2}, P {:.2}", worst[0], worst[1], worst[2]);
    assert!(worst.iter().all(|w| *w <= 8.0), "{worst:?}");
}

/// T12: exact reflectance, f64 by the two polarisations.
#[test]
fn fresnel() {
    let truth = |cos: f64, eta: f64| {
        let sin2 = (1.0 - cos * cos) / (eta * eta);
        if sin2 >= 1.0 {
            return 1.0;
        }
        let t = (1.0 - sin2).sqrt();
        let (s, p) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
        (s * s + p * p) / 2.0
    };
    let mut cosines = spread(5_000, 0.0, 1.0);
    cosines.extend((0..60).map(|i| 10f32.powf(-7.0 + 0.1 * i as f32)));
    for eta in [1.5f32, 1.0 / 1.5, 1.33, 2.4, 0.9, 1.001] {
        let critical = (1.0 - f64::from(eta).powi(2)).max(0.0).sqrt();
        let near = (0..50).map(|i| (critical * (1.0 + 1e-9 * 1.5f64.powi(i))).min(1.0) as f32);
        let cosines: Vec<f32> = cosines.iter().copied().chain(near).collect();
        let pairs: Vec<[f32; 2]> = cosines.iter().map(|c| [*c, eta]).collect();
        for ([cos, _], r) in pairs.iter().zip(fold(&pairs, fresnel_dielectric)) {
            let expected = truth((*cos).into(), eta.into());
            let bound = (1.5e-7 / (f64::from(*cos) - critical).abs().sqrt()).max(5e-7);
            assert!((0.0..=1.0).contains(&r), "eta {eta}, cos {cos}: {r}");
            assert!((f64::from(r) - expected).abs() <= bound, "eta {eta}, cos {cos:e}: {r}, not {expected}");
        }
    }
    assert!(
        fold(&cosines.iter().map(|c| [*c, 1.0]).collect::<Vec<_>>(), fresnel_dielectric).iter().all(|r| *r <= 1e-7)
    );
    let third = 1.0 / 1.5;
    let table = [
        [1.0, 1.5],
        [0.5, 1.5],
        [0.1, 1.5],
        [0.01, 1.5],
        [1e-4, 1.5],
        [1.0, third],
        [0.9, third],
        [0.75, third],
        [0.5, third],
    ];
    let expected = [0.04, 0.089_186_71, 0.571_592_5, 0.943_752_5, 0.999_418_8, 0.04, 0.046_332_65, 0.5, 1.0];
    for (got, expected) in fold(&table, fresnel_dielectric).iter().zip(expected) {
        assert!((got - expected).abs() <= 1e-6, "{got}, not {expected}");
    }
    // Everything is reflected by an index of 0.
    assert_eq!(fold(&[[0.7, 0.0], [1.0, 0.0]], fresnel_dielectric), [1.0, 1.0]);
}

/// N7: orthonormal for every normal, −z and its neighbours included.
#[test]
fn frames() {
    let mut normals: Vec<[f32; 3]> = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [-0.0, 0.0, -1.0]];
    for (i, z) in spread(500, -1.0, 1.0).into_iter().enumerate() {
        let (s, phi) = ((1.0 - z * z).max(0.0).sqrt(), i as f32 * 2.4);
        normals.push([s * phi.cos(), s * phi.sin(), z]);
        let t = 1e-4 * z;
        normals.push([t * phi.cos(), t * phi.sin(), -(1.0 - t * t).sqrt()]);
    }
    for [x, y, z] in normals {
        let part = |pick: fn(Vec3, Vec3) -> F32| {
            f64::from(
                fold1(&[0.0], |_| {
                    let (s, t) = onb(vec3(x, y, z));
                    pick(s, t)
                })[0],
            )
        };
        let s = [part(|s, _| s.x), part(|s, _| s.y), part(|s, _| s.z)];
        let t = [part(|_, t| t.x), part(|_, t| t.y), part(|_, t| t.z)];
        let n = [x, y, z].map(f64::from);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let length = dot(n, n);
        let worst = [dot(s, t), dot(s, n), dot(t, n), dot(s, s) - length, dot(t, t) - length].map(f64::abs);
        assert!(worst.iter().all(|e| *e < 4e-7), "[{x}, {y}, {z}]: {worst:?}");
        let handed = dot([s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]], n);
        assert!((handed - 1.0).abs() < 1e-6);
    }
}

/// N4: the distribution of normals down to the smallest rough α, from the normal to far outside the lobe.
#[test]
fn ggx() {
    let mut random = Random::new(0x5eed_001b);
    let sweep = Sweep::new(|b, cell, alpha: F32| {
        let load = |x: U32| x.float_of_bits();
        let (x, z) = (load(b.load(Left::WORD, cell)), load(b.load(Right::WORD, cell)));
        ggx_d(vec3(x, 0.0, z), Widths::round(alpha)).bits()
    });
    let n = number("JERBOA_RAYS", 20_000);
    let mut worst = 0.0f64;
    for alpha in [1e-3f32, 0.01, 0.1, 0.5, 1.0] {
        let (mut xs, mut zs, mut words) = (vec![], vec![], vec![0; n]);
        for _ in 0..n {
            let tan = f64::from(alpha) * (random.uniform() * 12.0 - 6.0).exp2();
            xs.push((tan / (1.0 + tan * tan).sqrt()) as f32);
            zs.push((1.0 / (1.0 + tan * tan).sqrt()) as f32);
        }
        let bits = |v: &[f32]| v.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
        sweep.fill(&[alpha.to_bits()], [&bits(&xs), &bits(&zs)], &mut words);
        for ((x, z), word) in xs.iter().zip(&zs).zip(words) {
            let (a2, x2, z2) = (f64::from(alpha).powi(2), f64::from(*x).powi(2), f64::from(*z).powi(2));
            let expected = 1.0 / (std::f64::consts::PI * a2 * (x2 / a2 + z2).powi(2));
            worst = worst.max((f64::from(f32::from_bits(word)) / expected - 1.0).abs());
        }
    }
    println!("GGX: {worst:e} relative");
    assert!(worst <= 1e-6, "{worst:e}");
}

/// Warps stay in their shapes and are centred.
#[test]
fn warps() {
    let us: Vec<[f32; 2]> = (0..4096).map(|i| [(i % 64) as f32 / 64.0, (i / 64) as f32 / 64.0]).collect();
    let inside = |f: fn(F32, F32) -> F32, lo: f32, hi: f32, mean: f32| {
        let values = fold(&us, f);
        assert!(values.iter().all(|x| (lo..=hi).contains(x)));
        let got = values.iter().sum::<f32>() / values.len() as f32;
        assert!((got - mean).abs() < 0.02, "{got}, not {mean}");
    };
    inside(
        |u, v| {
            let d = concentric_disk(vec2(u, v));
            d.x * d.x + d.y * d.y
        },
        0.0,
        1.000_001,
        0.5,
    );
    inside(|u, v| cosine_hemisphere(vec2(u, v)).z, 0.0, 1.0, 2.0 / 3.0);
    inside(|u, v| uniform_triangle(vec2(u, v)).x, 0.0, 1.0, 1.0 / 3.0);
    inside(
        |u, v| {
            let w = uniform_triangle(vec2(u, v));
            w.x + w.y
        },
        0.0,
        1.0,
        2.0 / 3.0,
    );
    inside(|u, v| uniform_sphere(vec2(u, v)).z, -1.0, 1.0, 0.0);
    inside(|u, v| uniform_sphere(vec2(u, v)).length2(), 0.999_999, 1.000_001, 1.0);
    inside(|u, v| 1.0 - uniform_cone(vec2(u, v), 0.1.into()).z, 0.0, 0.100_001, 0.05);
}
