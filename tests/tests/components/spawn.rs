//! Rays that leave surfaces and go to lights, traced: no surface shadows itself, its twin or its neighbours, and whatever
//! is in between shadows.

use jerboa_ir::lang::{Bool, Fun, Keep, Row, entry};
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::geometry::make_geometry;
use jerboa_lib_render::geometry::offset::{spawn_ray, spawn_shadow_ray};
use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::light::sample_light;
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::*;
use jerboa_lib_render::traverse::{AcceptFn, make_traverse};

use crate::geometry::no_shader;
use crate::lights::set_area;
use crate::traverse::{load, ray};
use jerboa_tests::harness::bench::{Bench, Random, stream};

/// Kernels: the primitive that a ray in a direction from a hit meets, without and with the knowledge of where it starts;
/// and the one between a hit and the light.
fn bench() -> Bench {
    Bench::new(|| {
        let traverse = make_traverse();
        let all = AcceptFn::lam(|_, _| Bool::from(true));
        let surface = move |b: &mut jerboa_ir::lang::Block, ray: Ray| {
            let hit = traverse.call(b, (ray, Keep(false.into()), all));
            let geometry = make_geometry(Row::<Geometries>::at(0u32), no_shader());
            (hit, geometry.surface_element.call(b, (ray, hit)))
        };
        entry(
            "leave",
            Fun::<(Ray, Vec3), (Hit, Hit)>::lam(move |b, (ray, dir)| {
                let (hit, surf) = surface(b, ray);
                (hit, traverse.call(b, (spawn_ray(surf, dir), Keep(false.into()), all)))
            }),
        );
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
    let mut left = 0;
    for _ in 0..1000 {
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
    assert!(left > 5000);
}

#[test]
fn no_ray_meets_the_twin_of_the_surface_it_leaves() {
    let mut random = Random::new(0x5eed_000c);
    let mut bench = bench();
    let (mut left, mut met) = (0, 0);
    for round in 0..1000 {
        let size = 10.0_f32.powf(16.0 * random.uniform() as f32 - 8.0);
        let away = if round % 2 == 0 { 0.0 } else { 100.0 };
        let mut t = [0; 3].map(|_| random.point().map(|x| size * (x + away)));
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
    assert!(left > 5000 && met == 0);
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
            let (u, v) = (0.5 * random.uniform() as f32, 0.5 * random.uniform() as f32);
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
    let (height, gap) = (2.0_f32, 64.0 * 2.0 * f32::EPSILON);
    for (z, all) in [(4.0 * gap, true), (height - gap, true), (height + gap, false)] {
        let mut triangles = room(height, [0.0; 3]);
        triangles.push([[-50.0, -50.0, z], [50.0, -50.0, z], [0.0, 90.0, z]]);
        let expected = if all { 2000 } else { 0 };
        assert_eq!(blocked(&mut bench, &mut random, &triangles, 2000), expected, "a plate at {z}");
    }
}
