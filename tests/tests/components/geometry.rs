//! Surfaces from hits, and rays that leave them.

use jerboa_ir::lang::{Bool, F32, Fun, Row, U32, entry};
use jerboa_lib_render::bsdf::{Bsdf, BsdfSample};
use jerboa_lib_render::camera::make_camera;
use jerboa_lib_render::core::color::black;
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::geometry::make_geometry;
use jerboa_lib_render::geometry::offset::{offset_origin, spawn_shadow_ray};
use jerboa_lib_render::geometry::triangle::Triangle;
use jerboa_lib_render::light::DirectLightSample;
use jerboa_lib_render::material::{EmissionValue, Material};
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::*;
use jerboa_lib_render::shader::Shader;

use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::rays::set_plane;

/// A shader that nobody asks.
pub fn no_shader() -> Shader {
    Shader::lam(|_, _| {
        let bsdf = Bsdf {
            eval: Fun::lam(|_, _| black()),
            pdf: Fun::lam(|_, _| F32::from(0.0)),
            sample: Fun::lam(|_, (_, wo): (Rng, Vec3)| BsdfSample {
                wi: wo,
                weight: black(),
                pdf_dir: 0.0.into(),
                is_specular: false.into(),
                radiance_scale: 1.0.into(),
            }),
            is_specular: Bool::from(false),
        };
        let nothing = |_: &mut jerboa_ir::lang::Block, _| EmissionValue {
            intensity: black(),
            pdf_area: 0.0.into(),
            pdf_dir: 0.0.into(),
        };
        Material {
            bsdf,
            emission: Fun::lam(nothing),
            is_emissive: false.into(),
            is_unlit: false.into(),
            base: black(),
            absorption: black(),
            normal: jerboa_lib_render::core::vec::vec3(0.0, 0.0, 1.0),
        }
    })
}

/// The surface of primitive 0 of geometry 0 at weights (u, v).
fn surface(b: &mut jerboa_ir::lang::Block, u: F32, v: F32) -> jerboa_lib_render::geometry::SurfaceElement {
    let nowhere = Vec3 { x: 0.0.into(), y: 0.0.into(), z: 0.0.into() };
    let ray =
        Ray { org: nowhere, dir: nowhere, tmax: 0.0.into(), skip: NONE.into(), skip1: NONE.into(), skip2: NONE.into() };
    let hit = Hit { primitive: 0.into(), t: 0.0.into(), u, v };
    make_geometry(Row::<Geometries>::at(0u32), no_shader()).surface_element.call(b, (ray, hit))
}

/// Kernels: the surface; a moved point with its normal; a shadow ray to a point.
fn bench() -> Bench {
    let mut bench = Bench::new(|| {
        entry("surface", Fun::lam(|b, (u, v): (F32, F32)| surface(b, u, v)));
        entry(
            "alpha",
            Fun::lam(|b, (u, v): (F32, F32)| {
                let hit = Hit { primitive: 0.into(), t: 0.0.into(), u, v };
                Triangle::of(b, hit).alpha(b, Row::at(0u32))
            }),
        );
        entry(
            "offset",
            Fun::lam(|b, (u, v, w): (F32, F32, Vec3)| {
                let s = surface(b, u, v);
                (s.point, s.error, s.face_normal, offset_origin(s, w))
            }),
        );
        entry(
            "shadow",
            Fun::lam(|b, (u, v, end): (F32, F32, Vec3)| {
                let s = surface(b, u, v);
                let light = DirectLightSample {
                    wi: end - s.point,
                    pos: end,
                    distance: 1.0.into(),
                    intensity: black(),
                    pdf_dir: 1.0.into(),
                    is_delta: true.into(),
                    primitive: NONE.into(),
                    primitive1: NONE.into(),
                };
                spawn_shadow_ray(s, light)
            }),
        );
        let camera = make_camera();
        entry(
            "camera",
            Fun::lam(move |b, (i, j, key): (U32, U32, U32)| camera.call(b, (i, j, Rng::new(0.into(), 0.into(), key)))),
        );
    });
    bench.rows::<Vertices>(3);
    bench.rows::<Normals>(3);
    bench.rows::<Uvs>(3);
    bench.rows::<Tangents>(3);
    bench.rows::<Colors>(3);
    for (column, row) in [(Primitives::I1, 1), (Primitives::I2, 2), (Primitives::LIGHT, NONE)] {
        bench.set(column, 0, row);
    }
    bench
}

fn place(bench: &mut Bench, corners: [[f32; 3]; 3]) {
    set_plane(bench, 0, &corners);
    for (row, p) in corners.into_iter().enumerate() {
        bench.set(Vertices::X, row, p[0]);
        bench.set(Vertices::Y, row, p[1]);
        bench.set(Vertices::Z, row, p[2]);
    }
}

fn floats<const N: usize>(words: &[u32]) -> [f32; N] {
    std::array::from_fn(|i| f32::from_bits(words[i]))
}

fn vec(words: &[u32]) -> [f64; 3] {
    floats::<3>(words).map(f64::from)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

const FLAT: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

#[test]
fn a_flat_triangle_without_attributes_has_its_own_normal_and_some_frame() {
    let mut bench = bench();
    for scale in [1.0, 1e-18, 1e18] {
        place(&mut bench, FLAT.map(|p| p.map(|x| x * scale)));
        let s = bench.run_both("surface", &[0.25_f32, 0.5].map(f32::to_bits));
        assert_eq!(floats::<3>(&s), [0.5 * scale, scale, 0.0]);
        assert_eq!(floats::<3>(&s[6..]), [0.0, 0.0, 1.0], "face normal");
        assert_eq!(floats::<3>(&s[15..]), [0.0, 0.0, 1.0], "shading normal");
        assert_eq!(floats::<6>(&s[9..]), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0], "tangent and bitangent");
        assert_eq!(floats::<3>(&s[22..]), [1.0; 3], "no colours: white");
        assert_eq!(s[25..27], [0, NONE]);
    }
}

#[test]
fn attributes_are_interpolated_and_frames_are_orthonormal() {
    let mut random = Random::new(0x5eed_0003);
    let mut bench = bench();
    bench.set(Geometries::HAS_NORMALS, 0, true);
    bench.set(Geometries::HAS_UV0, 0, true);
    for round in 0..200 {
        bench.set(Geometries::HAS_TANGENTS, 0, round % 2 == 0);
        place(&mut bench, [random.point(), random.point(), random.point()]);
        for row in 0..3 {
            for (column, value) in [Normals::X, Normals::Y, Normals::Z].into_iter().zip(random.point()) {
                bench.set(column, row, if round % 7 == 0 { 0.0 } else { value });
            }
            for (column, value) in [Tangents::X, Tangents::Y, Tangents::Z].into_iter().zip(random.point()) {
                bench.set(column, row, if round % 8 == 0 { 0.0 } else { value });
            }
            bench.set(Tangents::SIGN, row, -1.0_f32);
            for (column, value) in [Uvs::U0, Uvs::V0].into_iter().zip(random.point()) {
                bench.set(column, row, if round % 9 == 0 { 0.0 } else { value });
            }
        }
        let s = bench.run_both("surface", &[0.2_f32, 0.3].map(f32::to_bits));
        let axes = [9, 12, 15].map(|at| vec(&s[at..]));
        for (i, j) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)] {
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((dot(axes[i], axes[j]) - expected).abs() < 1e-5, "round {round}: {axes:?}");
        }
        if round % 7 == 0 {
            assert_eq!(s[15..18], s[6..9], "no normal: the face's");
        }
    }
}

#[test]
fn colours_of_vertices_are_interpolated() {
    let mut bench = bench();
    place(&mut bench, FLAT);
    bench.set(Geometries::HAS_COLORS, 0, true);
    for (row, rgba) in [[1.0, 0.5, 0.0, 1.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.5, 1.0, 0.5_f32]].into_iter().enumerate() {
        for (column, value) in [Colors::R, Colors::G, Colors::B, Colors::A].into_iter().zip(rgba) {
            bench.set(column, row, value);
        }
    }
    let at = [0.25_f32, 0.5].map(f32::to_bits);
    assert_eq!(floats::<3>(&bench.run_both("surface", &at)[22..]), [0.25, 0.5, 0.5]);
    assert_eq!(floats::<1>(&bench.run_both("alpha", &at)), [0.25 + 0.25]);
}

#[test]
fn the_frame_follows_u_and_against_v() {
    let mut bench = bench();
    bench.set(Geometries::HAS_UV0, 0, true);
    // u along −y, v along −x: a picture seen from the front, turned by a quarter.
    for (uv, tangent, bitangent) in [
        ([[0.0, 0.0], [0.0, -1.0], [-1.0, 0.0_f32]], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0_f32]),
        ([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
    ] {
        place(&mut bench, FLAT);
        for (row, uv) in uv.into_iter().enumerate() {
            bench.set(Uvs::U0, row, uv[0]);
            bench.set(Uvs::V0, row, uv[1]);
        }
        let s = bench.run_both("surface", &[0.25_f32, 0.5].map(f32::to_bits));
        assert_eq!((floats::<3>(&s[9..]), floats::<3>(&s[12..])), (tangent, bitangent));
    }
}

/// Distance of a point from the plane of exact corners, in f64, on the side of the exact normal.
fn height(p: [f64; 3], corners: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p.map(f64::from));
    let sub = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let (u, v) = (sub(b, a), sub(c, a));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    dot(sub(p, a), n) / dot(n, n).sqrt()
}

/// T10: a ray starts on the side it goes to, and no farther from the point than a hundred-thousandth of the triangle and
/// eight units in the last place of the point. `JERBOA_RAYS=N` tries N points instead of 20,000.
#[test]
fn rays_start_on_the_side_they_go_to_and_close_to_the_point() {
    let mut random = Random::new(0x5eed_0004);
    let mut bench = bench();
    let mut longest = 0.0_f64;
    for i in 0..number("JERBOA_RAYS", 20_000) {
        let (size, far) = (10.0_f32.powf(16.0 * random.uniform() as f32 - 8.0), random.point());
        let away = if random.below(2) == 0 { 0.0 } else { 1000.0 * size };
        let corners = [0; 3].map(|_| {
            let p = random.point();
            [0, 1, 2].map(|k| p[k] * size + far[k] * away)
        });
        place(&mut bench, corners);
        // Inside, on a side, and at a corner.
        let (u, v) = (random.uniform() as f32, random.uniform() as f32);
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let (u, v) = [(u, v), (u, 0.0), (1.0 - v, v), (0.0, 1.0)][i % 4];
        let w = random.point();
        let out = bench.run("offset", &[u, v, w[0], w[1], w[2]].map(f32::to_bits));
        let (normal, org) = (vec(&out[6..]), vec(&out[9..]));
        let side = dot(normal, w.map(f64::from)).signum();
        assert!(side * height(org, corners) > 0.0, "{corners:?} at {u}, {v} towards {w:?}");
        let [p, q, r] = corners.map(|p| p.map(f64::from));
        let [u, v] = [u, v].map(f64::from);
        let point = [0, 1, 2].map(|k| p[k] + u * (q[k] - p[k]) + v * (r[k] - p[k]));
        let length = |v: [f64; 3]| dot(v, v).sqrt();
        let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let size = length(sub(q, p)).max(length(sub(r, p))).max(length(sub(r, q)));
        let bound = 1e-5 * size + 8.0 * f64::from(f32::EPSILON) * length(point);
        longest = longest.max(length(sub(org, point)) / bound);
    }
    println!("at most {longest:.2} bounds from the point");
    assert!(longest <= 1.0);
}

#[test]
fn offsets_scale_with_the_scene_to_the_bit() {
    let mut random = Random::new(0x5eed_0005);
    let mut bench = bench();
    for _ in 0..200 {
        let corners = [random.point(), random.point(), random.point()];
        let [w, end] = [random.point(), random.point()];
        let mut outs = [-40, 0, 33].map(|k| {
            let scale = 2.0_f32.powi(k);
            place(&mut bench, corners.map(|p| p.map(|x| x * scale)));
            let offset = bench.run("offset", &[0.3, 0.4, w[0], w[1], w[2]].map(f32::to_bits));
            let end = end.map(|x| x * scale);
            let shadow = bench.run("shadow", &[0.3, 0.4, end[0], end[1], end[2]].map(f32::to_bits));
            let lengths: [f32; 9] = floats([&offset[..6], &offset[9..]].concat().as_slice());
            let ray: [f32; 6] = floats(&shadow);
            (lengths.map(|x| x / scale), ray.map(|x| x / scale), offset[6..9].to_vec(), shadow[6])
        });
        assert_eq!(outs[0], outs[1]);
        assert_eq!(outs[1], outs[2]);
        assert_eq!(std::mem::take(&mut outs[0].3), 1.0_f32.to_bits(), "a shadow ray ends at 1");
    }
}

/// A film of 4 × 2 pixels, seen from (0, 5, 0) along −z.
fn with_film() -> Bench {
    let mut bench = bench();
    for (column, value) in [(Frame::WIDTH, 4_u32), (Frame::HEIGHT, 2)] {
        bench.set(column, 0, value);
    }
    for (column, value) in
        [(Frame::RIGHT_X, 2.0_f32), (Frame::UP_Y, 1.0), (Frame::FORWARD_Z, -1.0), (Frame::EYE_Y, 5.0)]
    {
        bench.set(column, 0, value);
    }
    bench
}

#[test]
fn the_camera_sees_row_0_at_the_top_and_jitters_within_the_pixel() {
    let mut bench = with_film();
    for (i, j) in (0..2).flat_map(|j| (0..4).map(move |i| (i, j))) {
        let ray: [f32; 7] = floats(&bench.run_both("camera", &[i, j, 7]));
        assert_eq!((ray[0..3].to_vec(), ray[6]), (vec![0.0, 5.0, 0.0], f32::INFINITY));
        let (x, y) = (ray[3] / -ray[5], ray[4] / -ray[5]);
        assert!((i as f32 - 2.0..i as f32 - 1.0).contains(&x), "{x} in column {i}");
        assert!((-(j as f32)..=1.0 - j as f32).contains(&y), "{y} in row {j}");
        assert!((ray[3..6].iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-6);
    }
}

/// Each kind of camera beside the pinhole's ray (d, −1) through the same point of the film.
#[test]
fn cameras_of_every_kind_follow_their_formulas() {
    let mut bench = with_film();
    let (radius, focus) = (0.5, 3.0);
    // The lens in units of half a metre, the depth of a quarter.
    for (column, value) in [
        (Frame::LENS_RIGHT, radius),
        (Frame::LENS_UP, 2.0 * radius),
        (Frame::LENS_SIZE, 0.5),
        (Frame::FOCUS, 4.0 * focus as f32),
        (Frame::LENS_SHARE, 2.0),
    ] {
        bench.set(column, 0, value);
    }
    let mut squares = 0.0;
    for key in 0..1000 {
        let (i, j) = (key % 4, key / 4 % 2);
        let mut ray = |kind: u32| -> [f64; 6] {
            bench.set(Settings::CAMERA, 0, kind);
            floats::<6>(&bench.run_both("camera", &[i, j, key])).map(f64::from)
        };
        let pinhole = ray(CAMERA_PINHOLE);
        let d = [3, 4].map(|c| pinhole[c] / -pinhole[5]);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 2e-6, "{a}, not {b}; key {key}");

        let parallel = ray(CAMERA_ORTHOGRAPHIC);
        assert_eq!(parallel[3..], [0.0, 0.0, -1.0]);
        parallel[..3].iter().zip([d[0], 5.0 + d[1], 0.0]).for_each(|(a, b)| close(*a, b));

        let fish = ray(CAMERA_FISHEYE);
        let angle = d[0].hypot(d[1]);
        close(-fish[5], angle.cos());
        close(fish[3] * d[1], fish[4] * d[0]);
        assert!(fish[3] * d[0] >= 0.0 && fish[4] * d[1] >= 0.0, "towards the point of the film");

        let thin = ray(CAMERA_THIN);
        let lens = [thin[0], thin[1] - 5.0];
        assert!(thin[2] == 0.0 && lens[0].hypot(lens[1]) <= f64::from(radius) + 1e-6, "{lens:?}");
        squares += lens[0] * lens[0] + lens[1] * lens[1];
        let along = focus / -thin[5];
        (0..2).for_each(|c| close(lens[c] + thin[3 + c] * along, d[c] * focus));
    }
    // Uniform over a disk: the mean square is r² / 2, that of one sample has the variance r⁴ / 12.
    let r2 = f64::from(radius * radius);
    assert!((squares / 1000.0 - r2 / 2.0).abs() < 4.0 * r2 / 12_000.0_f64.sqrt(), "{squares}");
}

#[test]
fn a_ray_offset_moves_both_ends_by_the_largest_coordinate() {
    let mut bench = bench();
    place(&mut bench, FLAT.map(|p| [p[0] + 4.0, p[1], p[2] + 0.5]));
    bench.set(Settings::HAS_RAY_OFFSET, 0, true);
    bench.set(Settings::RAY_OFFSET, 0, 1e-3_f32);
    let shadow = bench.run("shadow", &[0.25, 0.25, 4.5, 0.5, 2.0].map(f32::to_bits));
    let [x, y, z, .., end] = floats::<7>(&shadow);
    // The point is (4.5, .5, .5): 5.5 thousandths upwards, beside the bound on rounding, and a hundredth of the way is left out.
    assert!((x - 4.5).abs() < 1e-5 && (y - 0.5).abs() < 1e-5, "{x} {y}");
    assert!((z - 0.5055).abs() < 3e-6 && (end - 0.99).abs() < 1e-6, "{z} {end}");
}
