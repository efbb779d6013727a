//! T10: rays that leave surfaces and go to lights, traced. No surface shadows itself, its twin or its neighbours, and
//! whatever is in between shadows. `JERBOA_RAYS=N` sends N rays in each test instead of 10,000.

use jerboa_ir::lang::{Bool, F32, Fun, Keep, Row, entry};
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::geometry::offset::{spawn_ray, spawn_shadow_ray};
use jerboa_lib_render::geometry::{SurfaceElement, make_geometry};
use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::light::sample_light;
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::*;
use jerboa_lib_render::traverse::{AcceptFn, make_traverse};

use crate::geometry::no_shader;
use jerboa_tests::harness::bench::{Bench, Random, number, stream};
use jerboa_tests::harness::lights::set_area;
use jerboa_tests::harness::rays::{load, ray, set_plane};

/// Kernels: what a ray meets that leaves a hit in a direction, by the renderer's way to start and by two others; and what
/// lies between a hit and the light.
fn bench() -> Bench {
    Bench::new(|| {
        let traverse = make_traverse();
        let all = AcceptFn::lam(|_, _| Bool::from(true));
        let surface = move |b: &mut jerboa_ir::lang::Block, ray: Ray| {
            let hit = traverse.call(b, (ray, Keep(false.into()), all));
            let geometry = make_geometry(Row::<Geometries>::at(0u32), no_shader());
            (hit, geometry.surface_element.call(b, (ray, hit)))
        };
        let leave = |name: &str, start: fn(SurfaceElement, Vec3) -> Ray| {
            entry(
                name,
                Fun::<(Ray, Vec3), (Hit, Hit)>::lam(move |b, (ray, dir)| {
                    let (hit, surf) = surface(b, ray);
                    (hit, traverse.call(b, (start(surf, dir), Keep(false.into()), all)))
                }),
            );
        };
        leave("leave", spawn_ray);
        leave("leave_by_number", |surf, dir| Ray { org: surf.point, ..spawn_ray(surf, dir) });
        leave("leave_by_length", |surf, dir| Ray {
            org: surf.point + dir * F32::from(1e-3),
            skip: NONE.into(),
            ..spawn_ray(surf, dir)
        });
        entry(
            "shadow",
            Fun::<(Ray, Rng), (Hit, Hit)>::lam(move |b, (ray, rng)| {
                let (hit, surf) = surface(b, ray);
                let light = sample_light(b, rng, surf.point);
                (hit, traverse.call(b, (spawn_shadow_ray(surf, light), Keep(true.into()), all)))
            }),
        );
    })
}

/// Put triangles on the bench, for intersection and for shading.
fn place(bench: &mut Bench, triangles: &[Triangle]) {
    load(bench, &Bvh::build(triangles), triangles);
    bench.rows::<Primitives>(triangles.len());
    bench.rows::<Vertices>(3 * triangles.len());
    for (i, t) in triangles.iter().enumerate() {
        set_plane(bench, i, t);
        for (k, column) in [Primitives::I0, Primitives::I1, Primitives::I2].into_iter().enumerate() {
            bench.set(column, i, (3 * i + k) as u32);
            bench.set(Vertices::X, 3 * i + k, t[k][0]);
            bench.set(Vertices::Y, 3 * i + k, t[k][1]);
            bench.set(Vertices::Z, 3 * i + k, t[k][2]);
        }
    }
}

/// Sends rays to `t` and its coincident twin, and on from there in random directions; gives what they meet then.
fn leave(bench: &mut Bench, random: &mut Random, t: Triangle, met: &mut impl FnMut(&[u32])) {
    place(bench, &[t, t]);
    let scale = t.concat().into_iter().fold(0.0_f32, |m, x| m.max(x.abs()));
    for _ in 0..10 {
        let org = random.point().map(|x| 3.0 * x * scale);
        let (a, b) = (random.uniform() as f32, random.uniform() as f32);
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        let aim = [0, 1, 2].map(|k| t[0][k] * (1.0 - a - b) + t[1][k] * a + t[2][k] * b);
        let away = random.point().map(f32::to_bits);
        let out = bench.run("leave", &[&ray(org, [0, 1, 2].map(|k| aim[k] - org[k]))[..], &away].concat());
        if out[0] != NONE {
            met(&out[4..]);
        }
    }
}

#[test]
fn no_ray_meets_the_surface_it_leaves() {
    let mut random = Random::new(0x5eed_0009);
    let mut bench = bench();
    // pbrt's test: every coordinate has a size of its own. Many are needles, so the twin may be met.
    let (rays, mut left) = (number("JERBOA_RAYS", 10_000), 0);
    for _ in 0..rays / 10 {
        let coordinate = |random: &mut Random| {
            10.0_f32.powf(16.0 * random.uniform() as f32 - 8.0) * (2.0 * random.uniform() as f32 - 1.0)
        };
        let t = [0; 3].map(|_| [0; 3].map(|_| coordinate(&mut random)));
        leave(&mut bench, &mut random, t, &mut |out| {
            left += 1;
            assert_ne!(out[0], 0, "{t:?}");
        });
    }
    println!("{left} rays left a surface");
    assert!(left > rays / 2);
}

/// A triangle whose altitude is an eighth of its longest side or more, also without any one of its coordinates.
fn well_shaped(random: &mut Random) -> Triangle {
    loop {
        let t = [0; 3].map(|_| random.point());
        let edges = [0, 1, 2].map(|i| [0, 1, 2].map(|k| f64::from(t[(i + 1) % 3][k]) - f64::from(t[i][k])));
        let longest = edges.map(|e| e.iter().map(|x| x * x).sum::<f64>()).into_iter().fold(0.0, f64::max);
        let faces = [0, 1, 2].map(|k| {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            (edges[0][a] * edges[1][b] - edges[0][b] * edges[1][a]).abs()
        });
        if faces.iter().all(|area| 8.0 * area >= longest) {
            return t;
        }
    }
}

#[test]
fn no_ray_meets_the_twin_of_the_surface_it_leaves() {
    let mut random = Random::new(0x5eed_000c);
    let mut bench = bench();
    let rays = number("JERBOA_RAYS", 10_000);
    let (mut left, mut met) = (0, 0);
    for round in 0..rays / 10 {
        let size = 10.0_f32.powf(16.0 * random.uniform() as f32 - 8.0);
        let away = if round % 2 == 0 { 0.0 } else { 100.0 };
        let mut t = well_shaped(&mut random).map(|p| p.map(|x| size * (x + away)));
        // Some lie in a plane where one coordinate has no error at all.
        if round % 4 == 0 {
            t.iter_mut().for_each(|p| p[round % 3] = 0.0);
        }
        leave(&mut bench, &mut random, t, &mut |out| {
            left += 1;
            met += u32::from(out[0] != NONE);
        });
    }
    println!("{met} of {left} rays met the twin");
    assert!(left > rays / 2 && met == 0);
}

/// A triangle with a neighbour on each side, all of them on one plane to the bit: corners on a lattice, z = x/2 + y/4.
/// `reach` is how much larger the neighbours are.
fn coplanar(random: &mut Random, reach: f64, scale: f32, at: [f64; 2]) -> Vec<Triangle> {
    let lattice = |random: &mut Random| [0; 2].map(|_| 4.0 * (250.0 * (2.0 * random.uniform() - 1.0)).round());
    let t = loop {
        let t = [0; 3].map(|_| lattice(random));
        let (e, f) = ([t[1][0] - t[0][0], t[1][1] - t[0][1]], [t[2][0] - t[0][0], t[2][1] - t[0][1]]);
        if (e[0] * f[1] - e[1] * f[0]).abs() > 1e5 {
            break t;
        }
    };
    let corner = |p: [f64; 2]| {
        let [x, y] = [p[0] + at[0], p[1] + at[1]];
        [x, y, x / 2.0 + y / 4.0].map(|x| x as f32 * scale)
    };
    // Beyond a side: its middle, as far again from the third corner.
    let beyond = |i: usize| {
        let (p, q, r) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
        [p, q, [0, 1].map(|k| p[k] + q[k] - r[k] + (reach - 1.0) * (p[k] + q[k] - 2.0 * r[k]))]
    };
    [t, beyond(0), beyond(1), beyond(2)].map(|t| t.map(corner)).to_vec()
}

/// Of rays that leave the first of coplanar triangles, on both sides and down to a hundred-thousandth above the plane, how
/// many meet one of them; and how many there are.
fn met_neighbours(kernel: &str, reach: f64, scale: f32) -> (usize, usize) {
    let mut random = Random::new(0x5eed_000f);
    let mut bench = bench();
    let (mut left, mut met) = (0, 0);
    for round in 0..number("JERBOA_RAYS", 10_000) / 20 {
        let at = if round % 2 == 0 { [0.0; 2] } else { [40_000.0, -24_000.0] };
        let triangles = coplanar(&mut random, reach, scale, at);
        place(&mut bench, &triangles);
        let t = triangles[0];
        for i in 0..20 {
            let (a, b) = (random.uniform() as f32, random.uniform() as f32);
            let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            // Inside, and very close to a side.
            let a = if i % 2 == 0 { a } else { 1e-7 * a };
            let aim = [0, 1, 2].map(|k| t[0][k] * (1.0 - a - b) + t[1][k] * a + t[2][k] * b);
            let org = random.point().map(|x| 1000.0 * x * scale);
            let org = [0, 1, 2].map(|k| org[k] + t[0][k]);
            let (x, y) = (random.uniform() - 0.5, random.uniform() - 0.5);
            let side = if i % 3 == 0 { -1.0 } else { 1.0 };
            let above = side * 10.0_f64.powf(-5.0 * random.uniform());
            // The normal is (-1/2, -1/4, 1).
            let dir = [x - above / 2.0, y - above / 4.0, x / 2.0 + y / 4.0 + above].map(|x| (x as f32).to_bits());
            let out = bench.run(kernel, &[&ray(org, [0, 1, 2].map(|k| aim[k] - org[k]))[..], &dir].concat());
            if out[0] != NONE {
                left += 1;
                met += usize::from(out[4] != NONE);
            }
        }
    }
    println!("{kernel}: {met} of {left} rays met a coplanar triangle, {reach} times as large, at scale {scale:e}");
    (met, left)
}

#[test]
fn no_ray_meets_the_neighbours_on_the_plane_it_leaves() {
    for (reach, scale) in [(1.0, 1.0), (1.0, 2.0_f32.powi(-40)), (1.0, 2.0_f32.powi(40)), (8.0, 1.0)] {
        let (met, left) = met_neighbours("leave", reach, scale);
        assert!(left > number("JERBOA_RAYS", 10_000) / 2 && met == 0, "{met} of {left}");
    }
}

/// What N1 replaces, on the rays of the test above: skipping the primitive alone, and an absolute length.
#[test]
fn other_ways_to_start_meet_the_neighbours() {
    let (met, left) = met_neighbours("leave_by_number", 1.0, 1.0);
    assert!(1000 * met > left, "{met} of {left}");
    let (met, left) = met_neighbours("leave_by_length", 1.0, 1e4);
    assert!(10 * met > left, "{met} of {left}");
}

/// A room's floor, and in its ceiling of the same plane a quad light with neighbours on all sides.
fn room(height: f32, at: [f32; 3]) -> Vec<Triangle> {
    let quad = |x0: f32, x1: f32, y0: f32, y1: f32, z: f32| {
        let p = [[x0, y0, z], [x0, y1, z], [x1, y1, z], [x1, y0, z]].map(|p| [0, 1, 2].map(|k| p[k] + at[k]));
        [[p[0], p[1], p[3]], [p[2], p[3], p[1]]]
    };
    let floor = [[-8.0, -8.0, 0.0], [8.0, -8.0, 0.0], [0.0, 8.0, 0.0]].map(|p| [0, 1, 2].map(|k| p[k] + at[k]));
    let light = quad(-1.0, 1.0, -1.0, 1.0, height);
    let around = [(-3.0, -1.0, -1.0, 1.0), (1.0, 3.0, -1.0, 1.0), (-1.0, 1.0, -3.0, -1.0), (-1.0, 1.0, 1.0, 3.0)];
    let ceiling = around.into_iter().flat_map(|(x0, x1, y0, y1)| quad(x0, x1, y0, y1, height));
    std::iter::once(floor).chain(light).chain(ceiling).collect()
}

/// Rays from below to the floor, then to the light; gives how many of the shadow rays were blocked.
fn blocked(bench: &mut Bench, random: &mut Random, triangles: &[Triangle], n: u32) -> u32 {
    place(bench, triangles);
    bench.rows::<LightChoice>(2);
    bench.set(LightChoice::CDF, 1, 1.0_f32);
    bench.set(Settings::LIGHT_COUNT, 0, 1_u32);
    bench.set(Lights::PROBABILITY, 0, 1.0_f32);
    bench.set(Lights::PRIMITIVE, 0, 1_u32);
    bench.set(Lights::PRIMITIVE1, 0, 2_u32);
    let [p, a, b] = triangles[1];
    let edge = |q: [f32; 3]| [0, 1, 2].map(|k| q[k] - p[k]);
    set_area(bench, 0, LIGHT_QUAD, p, edge(a), edge(b), 4.0);
    let floor = triangles[0];
    (0..n)
        .map(|i| {
            let [u, v] = [0; 2].map(|_| 0.01 + 0.48 * random.uniform() as f32);
            let aim = [0, 1, 2].map(|k| floor[0][k] * (1.0 - u - v) + floor[1][k] * u + floor[2][k] * v);
            let org = [aim[0], aim[1], aim[2] - 1.0];
            let args = [&ray(org, [0.0, 0.0, 1.0])[..], &stream(random.bits() as u32)].concat();
            let out = if i < 20 { bench.run_both("shadow", &args) } else { bench.run("shadow", &args) };
            assert_eq!(out[0], 0, "the floor is seen");
            u32::from(out[4] != NONE)
        })
        .sum()
}

#[test]
fn a_light_flush_with_the_ceiling_is_not_shadowed_by_it() {
    let mut random = Random::new(0x5eed_000a);
    let mut bench = bench();
    for (height, at) in [(2.0, [0.0; 3]), (0.01, [0.0; 3]), (5.0, [100.0, -70.0, 30.0]), (3000.0, [0.5; 3])] {
        assert_eq!(blocked(&mut bench, &mut random, &room(height, at), 4000), 0, "height {height} at {at:?}");
    }
}

#[test]
fn a_plate_shadows_a_few_ulps_before_the_light_and_not_behind_it() {
    let mut random = Random::new(0x5eed_000b);
    let mut bench = bench();
    let rays = number("JERBOA_RAYS", 10_000) as u32 / 10;
    for at in [[0.0; 3], [100.0, -70.0, 30.0], [-1000.0, 500.0, 2000.0]] {
        let height = 2.0_f32;
        let gap = 64.0 * f32::EPSILON * at.into_iter().fold(height, |m: f32, x: f32| m.max(x.abs()));
        // Above the floor, which is 16 wide, also as far as its rays may start.
        for (z, all) in [(gap + 16e-5, true), (height - gap, true), (height + gap, false)] {
            let mut triangles = room(height, at);
            let z = z + at[2];
            triangles
                .push([[-50.0, -50.0, z], [50.0, -50.0, z], [0.0, 90.0, z]].map(|p| [p[0] + at[0], p[1] + at[1], z]));
            let expected = if all { rays } else { 0 };
            assert_eq!(blocked(&mut bench, &mut random, &triangles, rays), expected, "a plate at {z}");
        }
    }
}
