//! Instances that share their triangles: a scene of them looks as if all had been laid out in the world. Where transforms
//! round nothing, to the bit; else up to that rounding, without holes, and without a ray that meets the surface it leaves.
//!
//! `JERBOA_RAYS=N` sends N rays in each test instead of 2,000.

use glam::{DAffine3, DMat3, DQuat, DVec3, EulerRot, Vec3, vec3};
use jerboa_ir::lang::{Bool, Fun, Keep, entry};
use jerboa_lib_render::core::vec;
use jerboa_lib_render::geometry::offset::spawn_ray;
use jerboa_lib_render::geometry::triangle::Triangle as Met;
use jerboa_lib_render::geometry::{SurfaceElement, make_geometry};
use jerboa_lib_render::host::bvh::Triangle;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::{Choices, Known, Pass, Tables};
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::{Geometries, NONE, Primitives, binding};
use jerboa_lib_render::shader::make_shader;
use jerboa_lib_render::traverse::{AcceptFn, make_traverse};
use jerboa_scenes::{AlphaMode, Environment, Instance, Material, Mesh, Scene};
use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::probe::V;
use jerboa_tests::harness::rays::{AIMS, Place, SHAPES, declare_traversal, ray};

/// Whatever is there twice is shared.
fn shared() -> Choices {
    Choices { most_copies: 0, ..Choices::default() }
}

/// Nothing is.
fn flat() -> Choices {
    Choices { most_copies: u32::MAX, ..Choices::default() }
}

fn mesh(triangles: &[Triangle], material: usize) -> Mesh {
    Mesh {
        positions: triangles.iter().flatten().map(|p| Vec3::from(*p)).collect(),
        triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        material,
        ..Mesh::default()
    }
}

/// Instances of one mesh.
fn scene(mesh: Mesh, places: &[DAffine3]) -> Scene {
    Scene {
        materials: vec![Material::diffuse("grey", [0.5; 3])],
        meshes: vec![mesh],
        instances: places.iter().map(|to_world| Instance { mesh: 0, to_world: *to_world }).collect(),
        ..Scene::default()
    }
}

/// Kernels over the tables of a scene: what a ray hits, the surface there, and what a ray meets that leaves it.
fn bench() -> Bench {
    Bench::new(|| {
        let traverse = make_traverse();
        let all = AcceptFn::lam(|_, _| Bool::from(true));
        declare_traversal(traverse);
        let surface = move |b: &mut jerboa_ir::lang::Block, ray: Ray| {
            let hit = traverse.call(b, (ray, Keep(false.into()), all));
            let geometry = Met::of(b, hit).geometry();
            let surf = b.dispatch(geometry, |b, row| {
                make_geometry(row, make_shader(row.get(Geometries::MATERIAL))).surface_element.call(b, (ray, hit))
            });
            (hit, surf)
        };
        entry("surface", Fun::<Ray, (Hit, SurfaceElement)>::lam(surface));
        entry(
            "leave",
            Fun::<(Ray, vec::Vec3), (Hit, Hit)>::lam(move |b, (ray, dir)| {
                let (hit, surf) = surface(b, ray);
                (hit, traverse.call(b, (spawn_ray(surf, dir), Keep(false.into()), all)))
            }),
        );
    })
}

fn load(bench: &mut Bench, scene: &Scene, choices: &Choices) -> Tables {
    let tables = Tables::new(scene, choices, Known::Nothing);
    bench.load(&tables);
    tables
}

fn rows_of_primitives(tables: &Tables) -> u32 {
    tables.memory[binding::<Primitives>()].rows
}

fn rays() -> usize {
    number("JERBOA_RAYS", 2000)
}

/// A ray from a point near the scene at a point of a triangle, which is at least a tenth from the sides if it is inside.
fn aimed(random: &mut Random, triangles: &[Triangle], size: f32) -> (V, V) {
    let org = random.point().map(|x| 2.0 * size * x);
    let t = triangles[random.below(triangles.len())];
    let [a, b] = [0; 2].map(|_| 0.1 + 0.35 * random.uniform() as f32);
    (org, [0, 1, 2].map(|k| t[0][k] * (1.0 - a - b) + t[1][k] * a + t[2][k] * b - org[k]))
}

/// Triangles of all instances in the world, numbered as in the scene.
fn in_world(scene: &Scene) -> Vec<Triangle> {
    jerboa_lib_render::host::tables::geometry::triangles(scene, DVec3::ZERO)
}

fn affine(matrix: DMat3, at: [f64; 3]) -> DAffine3 {
    DAffine3 { matrix3: matrix, translation: DVec3::from(at) }
}

/// Any turn, squeezed or stretched before: up to a thousand times along one axis, mirrored or not.
fn any_place(random: &mut Random, spread: f64, stretch: f64) -> DAffine3 {
    let mut uniform = |lo: f64, hi: f64| lo + (hi - lo) * random.uniform();
    let size = [0; 3].map(|_| stretch.powf(uniform(-1.0, 1.0)));
    let angles = [0; 3].map(|_| uniform(-3.0, 3.0));
    let mirror = if uniform(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
    let at = [0; 3].map(|_| uniform(-spread, spread));
    DAffine3::from_scale_rotation_translation(
        DVec3::from(size) * DVec3::new(mirror, 1.0, 1.0),
        DQuat::from_euler(EulerRot::XYZ, angles[0], angles[1], angles[2]),
        DVec3::from(at),
    )
}

/// The eight turns by multiples of 90 degrees that take the first octant to each octant.
fn octants() -> Vec<DMat3> {
    let turn = |axis: fn(f64) -> DMat3, quarters: u32| {
        // Exactly 0 and ±1.
        let m = axis(f64::from(quarters) * std::f64::consts::FRAC_PI_2).to_cols_array().map(f64::round);
        DMat3::from_cols_array(&m)
    };
    let around = (0..4).map(|i| turn(DMat3::from_rotation_y, i));
    around.flat_map(|m| [m, m * turn(DMat3::from_rotation_x, 2) * turn(DMat3::from_rotation_y, 1)]).collect()
}

/// A ragged heap in the first octant, on a lattice of 1/64, from 0 on: so zero of its frame is zero of the world.
fn heap(random: &mut Random, count: usize) -> Vec<Triangle> {
    let mut lattice = |lo: f64, size: f64| ((lo + size * random.uniform()) * 64.0).round() as f32 / 64.0;
    let first = [[0.0; 3], [0.5, 0.25, 0.125], [0.125, 0.375, 0.25]];
    let others = (1..count).map(|_| {
        let at = [0; 3].map(|_| lattice(0.25, 1.5));
        [0; 3].map(|_| at.map(|x| x + lattice(0.0, 0.5)))
    });
    std::iter::once(first).chain(others).collect()
}

#[test]
fn exact_instances_are_hit_as_if_laid_out_in_the_world() {
    let mut random = Random::new(0x5eed_2001);
    let mut bench = bench();
    for scale in [1.0, 0.25] {
        let places: Vec<DAffine3> = octants().into_iter().map(|m| affine(m * scale, [0.0; 3])).collect();
        let scene = scene(mesh(&heap(&mut random, 60), 0), &places);
        let triangles = in_world(&scene);
        let rays: Vec<[u32; 10]> = (0..rays())
            .map(|_| {
                let (org, dir) = aimed(&mut random, &triangles, scale as f32);
                ray(org, dir)
            })
            .collect();
        let mut hits = |choices: &Choices, rows: usize| -> Vec<Vec<u32>> {
            assert_eq!(rows_of_primitives(&load(&mut bench, &scene, choices)) as usize, rows);
            let mut run = |(i, ray): (usize, &[u32; 10])| {
                if i < 20 { bench.run_both("surface", ray) } else { bench.run("surface", ray) }
            };
            rays.iter().enumerate().map(&mut run).collect()
        };
        let (one, other) = (hits(&shared(), 60), hits(&flat(), 480));
        let differ = (0..rays.len()).filter(|i| one[*i] != other[*i]).count();
        println!("scale {scale}: {differ} of {} hits differ", rays.len());
        assert!(other.iter().all(|hit| hit[0] != NONE));
        assert_eq!(differ, 0);
    }
}

#[test]
fn any_instances_are_hit_as_if_laid_out_in_the_world_up_to_rounding() {
    let mut random = Random::new(0x5eed_2002);
    let mut bench = bench();
    let (mut sent, mut other) = (0, 0);
    for shape in &SHAPES {
        for (spread, stretch) in [(0.0, 1.0), (5.0, 4.0), (20.0, 4.0)] {
            let places: Vec<DAffine3> = (0..12).map(|_| any_place(&mut random, spread, stretch)).collect();
            let mut mesh = mesh(&(shape.triangles)(), 0);
            mesh.normals = Some(mesh.positions.iter().map(|p| (*p + vec3(0.1, 0.2, 0.3)).normalize()).collect());
            mesh.tangents = Some(mesh.positions.iter().map(|p| p.any_orthonormal_vector().extend(-1.0)).collect());
            mesh.uvs[0] = Some(mesh.positions.iter().map(|p| p.truncate()).collect());
            let scene = scene(mesh, &places);
            let triangles = in_world(&scene);
            let rays: Vec<[u32; 10]> = (0..rays() / 10)
                .map(|_| {
                    let (org, dir) = aimed(&mut random, &triangles, spread as f32 + 1.0);
                    ray(org, dir)
                })
                .collect();
            let mut hits = |choices: &Choices| -> Vec<Vec<u32>> {
                load(&mut bench, &scene, choices);
                rays.iter().map(|ray| bench.run("surface", ray)).collect()
            };
            for (one, two) in hits(&shared()).iter().zip(&hits(&flat())) {
                sent += 1;
                if one[0] != two[0] {
                    other += 1;
                    continue;
                }
                let [t, expected] = [one, two].map(|hit| f32::from_bits(hit[1]));
                let [one, two] =
                    [one, two].map(|surf| surf[4..].iter().map(|w| f32::from_bits(*w)).collect::<Vec<_>>());
                // How far off the plane.
                let apart = (0..3).map(|k| (one[k] - two[k]) * two[6 + k]).sum::<f32>().abs();
                assert!(apart <= 4e-6 * (spread as f32 + 4.0), "{}: t = {t}, not {expected}: {apart}", shape.name);
                // The face's normal, and the frame by the vertices' tangents.
                for k in 6..18 {
                    assert!((one[k] - two[k]).abs() < 2e-3, "{}: {k}: {} is not {}", shape.name, one[k], two[k]);
                }
            }
        }
    }
    // Those that graze, or pass the silhouette of something nearer.
    println!("{other} of {sent} rays hit another triangle");
    assert!(other * 200 < sent, "{other} of {sent}");
}

#[test]
fn closed_instances_have_no_holes() {
    let mut random = Random::new(0x5eed_2003);
    let mut bench = bench();
    let unit = Place { centre: [0.0; 3], scale: 1.0 };
    let mut sent = 0;
    for shape in &SHAPES {
        let triangles = (shape.triangles)();
        for (spread, stretch) in [(0.0, 1.0), (3.0, 3.0), (1000.0, 30.0), (1e-3, 1000.0)] {
            let places: Vec<DAffine3> = (0..2).map(|_| any_place(&mut random, spread, stretch)).collect();
            let scene = scene(mesh(&triangles, 0), &places);
            let tables = load(&mut bench, &scene, &shared());
            assert_eq!(rows_of_primitives(&tables) as usize, triangles.len());
            for aim in &AIMS {
                for i in 0..rays() / 100 {
                    let place = places[i % 2];
                    let (org, dir) = (aim.ray)(&mut random, unit, &triangles);
                    let org = place.transform_point3(Vec3::from(org).as_dvec3()).as_vec3().to_array();
                    let dir = place.transform_vector3(Vec3::from(dir).as_dvec3()).as_vec3().to_array();
                    let args = ray(org, dir);
                    let hit = if i == 0 { bench.run_both("nearest", &args) } else { bench.run("nearest", &args) };
                    assert_ne!(hit[0], NONE, "{}, {}: {place:?}: {args:x?}", shape.name, aim.name);
                    assert_ne!(bench.run("any", &args)[0], NONE, "{}, {}: {place:?}: {args:x?}", shape.name, aim.name);
                    sent += 1;
                }
            }
        }
    }
    println!("{sent} rays hit");
}

/// A cube from -1 to 1 about a point of its mesh's frame, whose zero has a speck of its own.
fn cube_at(middle: DVec3) -> Vec<Triangle> {
    let moved = |p: V| (DVec3::from(p.map(f64::from)) + middle).as_vec3().to_array();
    let speck = [[0.0; 3], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]];
    (SHAPES[1].triangles)().into_iter().map(|t| t.map(moved)).chain([speck]).collect()
}

/// Two instances in the same place, so that each surface has a twin with other numbers, and each triangle has neighbours. A cube
/// that is far from zero of its mesh's frame, but not from that of the world, is known by what transforms have rounded alone; there a
/// normal is off by up to 1e-3, so no ray leaves at less than a hundredth.
#[test]
fn no_ray_meets_the_instance_it_leaves_or_its_twin() {
    let mut random = Random::new(0x5eed_2004);
    let mut bench = bench();
    let (mut left, mut met) = (0, 0);
    let middles = [(DVec3::ZERO, 4.0), (DVec3::new(600.0, -700.0, 400.0), 2.0)];
    let scales = [1e-3, 0.03, 1.0, 30.0, 1e3];
    for ((middle, grazing), scale) in middles.into_iter().flat_map(|m| scales.map(|scale| (m, scale))) {
        for _ in 0..4 {
            let place = any_place(&mut random, 3.0, 2.0) * DAffine3::from_scale(DVec3::splat(scale));
            let to_world = place * DAffine3::from_translation(-middle);
            let scene = scene(mesh(&cube_at(middle), 0), &[to_world, to_world]);
            assert_eq!(rows_of_primitives(&load(&mut bench, &scene, &shared())) as usize, in_world(&scene).len() / 2);
            let matrix = place.matrix3;
            for _ in 0..rays() / 20 {
                // A side of the cube, from outside, and on to that side.
                let mut p = random.point().map(f64::from);
                let (axis, side) = (random.below(3), if random.uniform() < 0.5 { -1.0 } else { 1.0 });
                p[axis] = side;
                let mut away = random.point().map(f64::from);
                away[axis] = side * 10.0_f64.powf(-grazing * random.uniform());
                let target = place.transform_point3(DVec3::from(p));
                let org = target + matrix * (DVec3::from(away) + DVec3::from(random.point().map(f64::from)) * 0.01);
                let dir = (matrix * DVec3::from(away)).as_vec3().to_array().map(f32::to_bits);
                let args = ray(org.as_vec3().to_array(), (target - org).as_vec3().to_array());
                let out = bench.run("leave", &[&args[..], &dir].concat());
                if out[0] != NONE {
                    left += 1;
                    met += usize::from(out[4] != NONE);
                }
            }
        }
    }
    println!("{met} of {left} rays met the surface they left, or its twin");
    assert!(left > rays() && met == 0, "{met} of {left}");
}

/// Exact instances of something whole and of something with holes, in a room with a lamp, under a sky.
fn heaps(random: &mut Random) -> Scene {
    let places: Vec<DAffine3> = octants().into_iter().map(|m| affine(m, [0.0; 3])).collect();
    let mut scene = scene(mesh(&heap(random, 80), 0), &places);
    let mut veil = Material::diffuse("veil", [0.8, 0.3, 0.2]);
    veil.base_color[3] = 0.6;
    veil.alpha_mode = AlphaMode::Blend;
    scene.materials.push(Material { double_sided: true, ..veil });
    scene.materials.push(Material::emitter("lamp", [5.0; 3]));
    let lamp = [
        [[-1.0, 3.0, -1.0], [1.0, 3.0, -1.0], [1.0, 3.0, 1.0]],
        [[-1.0, 3.0, -1.0], [1.0, 3.0, 1.0], [-1.0, 3.0, 1.0]],
    ];
    scene.meshes.push(mesh(&heap(random, 30), 1));
    scene.meshes.push(mesh(&lamp, 2));
    let mut also = |mesh: usize, to_world: DAffine3| scene.instances.push(Instance { mesh, to_world });
    // The lamp among the instances, so that numbers of what is in the world do not begin at 0.
    places[..3].iter().for_each(|place| also(1, *place));
    also(2, DAffine3::IDENTITY);
    places[3..].iter().for_each(|place| also(1, *place));
    also(2, affine(DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0)), [0.0; 3]));
    let radiance = vec![[0.3, 0.4, 0.5]; 8];
    scene.environment = Some(Environment { width: 4, height: 2, radiance, intensity: 1.0, rotation_deg: 0.0 });
    scene
}

fn pass() -> Pass {
    let window = Window { x: 0, y: 0, width: 24, height: 20 };
    Pass { size: [24, 20], window, sample: 0, samples: 4, seed: 3 }
}

fn samples(scene: &Scene, options: Options) -> Vec<u32> {
    let renderer = Renderer::new(scene, options).unwrap_or_else(|e| panic!("{e}"));
    renderer.samples(&scene.camera_or_default(), &pass()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn exact_instances_look_as_if_laid_out_in_the_world() {
    let scene = heaps(&mut Random::new(0x5eed_2005));
    let rows = |choices| rows_of_primitives(&Tables::new(&scene, choices, Known::Structure));
    assert_eq!((rows(&shared()), rows(&flat())), (80 + 30 + 4, 8 * (80 + 30) + 4));
    let image = |device, known, choices| samples(&scene, Options { device, known, choices, ..Options::default() });
    let expected = image(DeviceKind::Cpu, Known::Structure, flat());
    for device in DeviceKind::CPU {
        for known in [Known::Structure, Known::All] {
            assert!(image(device, known, shared()) == expected, "{device:?}, {known:?}");
        }
    }
}

/// Triangles of two meshes in the same place, one with holes and the other whole, each in a tree of its own: where there is a hole the
/// other is seen, elsewhere the smaller number, as if all were laid out in the world.
#[test]
fn what_lies_in_a_hole_is_seen_from_another_tree() {
    let mut random = Random::new(0x5eed_2008);
    let heap = heap(&mut random, 60);
    let places: Vec<DAffine3> = octants().into_iter().map(|m| affine(m, [0.0; 3])).collect();
    let holed = |alpha_mode: AlphaMode, alpha: f32| {
        let red = Material { double_sided: true, alpha_mode, ..Material::diffuse("holed", [0.9, 0.1, 0.1]) };
        Material { base_color: [0.9, 0.1, 0.1, alpha], ..red }
    };
    let of = |order: [usize; 2], holed: Material| {
        let mut scene = scene(mesh(&heap, 0), &[]);
        scene.meshes.push(Mesh { material: 1, ..scene.meshes[0].clone() });
        scene.materials.push(holed);
        let instance = |mesh| places.iter().map(move |to_world| Instance { mesh, to_world: *to_world });
        scene.instances = order.into_iter().flat_map(instance).collect();
        let (width, height, radiance) = (2, 1, vec![[1.0; 3]; 2]);
        scene.environment = Some(Environment { width, height, radiance, intensity: 1.0, rotation_deg: 0.0 });
        scene
    };
    let image = |scene: &Scene, tracer, device, choices| {
        samples(scene, Options { device, choices, tracer, ..Options::default() })
    };
    let opaque = holed(AlphaMode::Opaque, 1.0);
    for (mode, alpha) in [(AlphaMode::Mask(0.5), 0.4), (AlphaMode::Mask(0.5), 0.6), (AlphaMode::Blend, 0.5)] {
        for order in [[0, 1], [1, 0]] {
            let scene = of(order, holed(mode, alpha));
            let what = format!("{mode:?} of {alpha}, {order:?}");
            let expected = image(&scene, TracerKind::Path, DeviceKind::CpuScalar, flat());
            for (device, choices) in
                DeviceKind::CPU.map(|device| (device, shared())).into_iter().chain([(DeviceKind::Cpu, flat())])
            {
                assert!(
                    image(&scene, TracerKind::Path, device, choices) == expected,
                    "{what}, {device:?}, {choices:?}"
                );
            }
            // Where nothing is cut, or all of it, it is the picture of one mesh.
            let shown = |scene: &Scene| image(scene, TracerKind::Albedo, DeviceKind::Cpu, shared());
            let (found, first) = (shown(&scene), shown(&of(order, opaque.clone())));
            match (mode, alpha > 0.5, order) {
                (AlphaMode::Mask(_), false, _) => assert!(found == shown(&of([0, 0], opaque.clone())), "{what}"),
                (AlphaMode::Mask(_), true, _) | (_, _, [0, 1]) => assert!(found == first, "{what}"),
                _ => assert!(found != first, "{what}: some of it is cut"),
            }
        }
    }
}

/// A path is another one after the first hit that rounding decides, so means are compared.
#[test]
fn any_instances_look_as_if_laid_out_in_the_world_up_to_rounding() {
    let scene = Scene::load("builtin:pebbles").unwrap_or_else(|e| panic!("{e}"));
    let image = |choices| samples(&scene, Options { choices, ..Options::default() });
    let (one, other) = (image(Choices::default()), image(flat()));
    let values =
        |words: &[u32]| words[..3 * 24 * 20 * 4].iter().map(|w| f64::from(f32::from_bits(*w))).collect::<Vec<_>>();
    let apart: Vec<f64> = values(&one).iter().zip(&values(&other)).map(|(a, b)| a - b).collect();
    let count = apart.len() as f64;
    let mean = apart.iter().sum::<f64>() / count;
    let error = (apart.iter().map(|d| (d - mean).powi(2)).sum::<f64>()).sqrt() / count;
    let same = apart.iter().filter(|d| d.abs() < 1e-3).count();
    println!("{same} of {count} samples are alike; the others differ by {mean:e} ± {error:e} in the mean");
    assert!(same as f64 > 0.9 * count && mean.abs() <= 4.0 * error);
}

#[test]
fn what_begins_to_emit_no_longer_shares() {
    let mut scene = heaps(&mut Random::new(0x5eed_2006));
    let options = Options { choices: shared(), ..Options::default() };
    let mut renderer = Renderer::new(&scene, options).unwrap_or_else(|e| panic!("{e}"));
    for radiance in [0.5, 0.0] {
        scene.materials[1].emissive = [radiance; 3];
        renderer.set_material(&scene, 1).unwrap_or_else(|e| panic!("{e}"));
        let edited = renderer.samples(&scene.camera_or_default(), &pass()).unwrap_or_else(|e| panic!("{e}"));
        assert!(edited == samples(&scene, options), "emission of {radiance}");
        let rows = if radiance > 0.0 { 80 + 8 * 30 + 4 } else { 80 + 30 + 4 };
        assert_eq!(rows_of_primitives(renderer.tables()), rows);
    }
}

/// T25: code for instances is in no residual of a scene that has none.
#[test]
fn only_scenes_with_instances_have_code_for_them() {
    let scene = heaps(&mut Random::new(0x5eed_2007));
    for (choices, expected) in [(shared(), true), (flat(), false)] {
        for device in DeviceKind::CPU {
            let renderer = Renderer::new(&scene, Options { choices, device, ..Options::default() });
            let renderer = renderer.unwrap_or_else(|e| panic!("{e}"));
            let texts = renderer.kernels().iter().map(|kernel| jerboa_ir::print(&kernel.residual.program));
            let reads = texts.map(|text| text.matches("read Instances.").count()).sum::<usize>();
            assert_eq!(reads > 0, expected, "{device:?}: {reads} reads");
        }
    }
}
