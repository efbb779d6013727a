//! What changes no bit of a picture (Law 9, T11, T15, T21), and that all of its samples are numbers (T22).

use glam::{DVec3, Vec3};
use jerboa_ir::print;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::{Choices, Known};
use jerboa_scenes::{Camera, Lens, LightKind, Material, Scene, builtin};
use jerboa_tests::harness::analytic::{light, place, rectangle, sphere};
use jerboa_tests::harness::bench::number;
use jerboa_tests::harness::metamorphic::{dyadic, scaled, translated};

use crate::{LIGHT_SIDES, absorbing, image, load, renderer};

/// Those of this test.
const ALL: [TracerKind; 3] = [TracerKind::Light, TracerKind::Bidirectional, TracerKind::Occlusion];

/// Law 9: neither threads, tiles, windows nor knowledge change a bit of what falls on a film from anywhere.
#[test]
fn splats_do_not_depend_on_how_the_work_is_cut() {
    let scene = load("glass");
    let camera = scene.camera_or_default();
    for tracer in ALL {
        let film = |known: Known, threads: usize, tile: u32, window: Option<Window>| {
            let mut options = Options { known, tracer, device: DeviceKind::CpuScalar, ..Options::default() };
            options.cut.tile = tile;
            let renderer = Renderer::new(&scene, options).unwrap_or_else(|e| panic!("{e}"));
            let mut film = window.map_or_else(|| Film::of_size([24, 16]), |w| Film::crop([24, 16], w));
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let job = Render { sample: 0, spp: 3, seed: 5 };
            pool.install(|| renderer.render_with(&camera, &mut film, job, &Handle::default()))
                .unwrap_or_else(|e| panic!("{e}"));
            film
        };
        let expected = film(Known::Structure, 1, 16, None);
        assert!(expected.mean().pixels.iter().flatten().sum::<f32>() > 0.0);
        for (known, threads, tile) in [(Known::Structure, 3, 5), (Known::All, 1, 16), (Known::Nothing, 2, 7)] {
            assert!(film(known, threads, tile, None) == expected, "{}, {known:?}", tracer.kernel());
        }
        let window = Window { x: 5, y: 3, width: 9, height: 8 };
        let part = film(Known::Structure, 2, 4, Some(window)).mean();
        let whole = expected.mean();
        for (i, pixel) in part.pixels.iter().enumerate() {
            let [x, y] = [i as u32 % window.width + window.x, i as u32 / window.width + window.y];
            assert_eq!(*pixel, whole.pixels[(y * 24 + x) as usize], "{}: {x},{y}", tracer.kernel());
        }
    }
}

/// T15, and T11 of size: neither where a scene stands nor how large it is changes a bit of what any tracer shows, but for distances,
/// which are as large as it is. As for the path tracer, `tests/tests/metamorphic.rs`.
#[test]
fn no_bit_tells_where_a_scene_stands_or_its_size() {
    let choices = Choices { most_copies: 0, ..Choices::default() };
    for tracer in TracerKind::ALL.into_iter().filter(|tracer| *tracer != TracerKind::Path) {
        let seen =
            |scene: &Scene| image(&renderer(scene, tracer, choices), &scene.camera_or_default(), [24, 24], 2, 15);
        let here = seen(&dyadic());
        let something = here.pixels.iter().filter(|p| **p != [0.0; 3]).count();
        assert!(something > 50, "{}: {something} pixels show something", tracer.kernel());
        assert!(seen(&translated(&dyadic(), 1_048_576.0)) == here, "{}, moved", tracer.kernel());
        let shows_distance = [TracerKind::Depth, TracerKind::AovPlace].contains(&tracer);
        assert!(shows_distance || seen(&scaled(&dyadic(), 13)) == here, "{}, scaled", tracer.kernel());
    }
}

/// T21 on films that no tile and no vector fits: on one thread and on many, made again, and in two runs.
#[test]
fn films_of_any_shape_are_the_same_again() {
    for (name, tracer) in ["glass", "many-lights", "sunlit"].into_iter().flat_map(|name| ALL.map(|t| (name, t))) {
        let scene = load(name);
        let [first, again] = [(); 2].map(|()| renderer(&scene, tracer, Choices::default()));
        for size in [[1, 1], [3, 5], [7, 1], [18, 17]] {
            let film = |renderer: &Renderer, threads: usize, parts: &[[u32; 2]]| {
                let mut film = Film::of_size(size);
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                for [sample, spp] in parts {
                    let job = Render { sample: *sample, spp: *spp, seed: 3 };
                    let done = pool.install(|| {
                        renderer.render_with(&scene.camera_or_default(), &mut film, job, &Handle::default())
                    });
                    done.unwrap_or_else(|e| panic!("{e}"));
                }
                film
            };
            let expected = film(&first, 1, &[[0, 5]]);
            for (renderer, threads, parts) in
                [(&first, 2, [[0, 5]].as_slice()), (&first, 8, &[[0, 5]]), (&again, 2, &[[0, 2], [2, 3]])]
            {
                let found = film(renderer, threads, parts);
                assert!(found == expected, "{name}, {}, {size:?}, {threads} threads, {parts:?}", tracer.kernel());
            }
        }
    }
}

/// What a light lies in follows an edit of it.
#[test]
fn an_edited_solid_absorbs_the_light_within_it() {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    place(&mut scene, floor, Material::diffuse("floor", [0.5; 3]), 1.0, DVec3::ZERO);
    let fog = absorbing(Material::glass("fog", 1.0), 1.0, [0.5; 3]);
    place(&mut scene, sphere(1), fog, 0.4, DVec3::new(0.0, 1.5, 0.0));
    scene.lights = vec![light(LightKind::Point, 1.0, 1.5)];
    let camera = Camera::look_at("side", DVec3::new(0.6, 1.2, 0.9), DVec3::ZERO, 0.4);
    let seen = |renderer: &Renderer| image(renderer, &camera, [24, 16], 4, 1);
    for tracer in LIGHT_SIDES {
        let mut edited = renderer(&scene, tracer, Choices::default());
        let former = seen(&edited);
        let mut thicker = scene.clone();
        let fog = thicker.materials.len() - 1;
        thicker.materials[fog] = absorbing(thicker.materials[fog].clone(), 0.1, [0.5; 3]);
        edited.set_material(&thicker, fog).unwrap_or_else(|e| panic!("{e}"));
        assert!(seen(&edited) != former, "{}", tracer.kernel());
        assert!(seen(&edited) == seen(&renderer(&thicker, tracer, Choices::default())), "{}", tracer.kernel());
    }
}

/// T25: what absorbs, and what a light lies in, is read where something absorbs, and nowhere else.
#[test]
fn what_does_not_absorb_is_in_no_residual() {
    for (name, absorbs) in [("tinted-slab", true), ("glass", false), ("nested-glass", false), ("caustic", false)] {
        let scene = load(name);
        for tracer in LIGHT_SIDES {
            let renderer = renderer(&scene, tracer, Choices::default());
            let text = print(&renderer.kernels()[0].residual.program);
            let body = &text[text.find("\nfun ").expect("a residual has a function")..];
            assert_eq!(body.contains("ABSORPTION_R"), absorbs, "{name}, {}", tracer.kernel());
        }
    }
}

/// T22. The quick form leaves out what is like another scene; `JERBOA_ALL=1` does not.
#[test]
fn no_built_in_scene_drops_a_sample() {
    const QUICK: [&str; 12] = [
        "facing-mirrors",
        "layered",
        "alpha",
        "nested-glass",
        "tinted-slab",
        "many-lights",
        "hot-texel",
        "edge-light",
        "needles",
        "odd-normals",
        "pebbles",
        "empty",
    ];
    let all = number("JERBOA_ALL", 0) > 0;
    for name in builtin::list().iter().map(|b| b.name).filter(|name| all || QUICK.contains(name)) {
        let scene = load(name);
        let camera = scene.camera_or_default();
        // Paths from lights end in pinholes only, and those from both sides do not know lights with a size.
        let is_pinhole = matches!(camera.lens, Lens::Pinhole { .. });
        let is_sized = |kind| matches!(kind, LightKind::Sphere { .. } | LightKind::Disk { .. } | LightKind::Sun { .. });
        let has_sized = scene.lights.iter().any(|light| is_sized(light.kind));
        let is_refused = |tracer: TracerKind| {
            tracer.is_splatting() && !is_pinhole || tracer == TracerKind::Bidirectional && has_sized
        };
        for tracer in ALL.into_iter().filter(|tracer| !is_refused(*tracer)) {
            let seen = image(&renderer(&scene, tracer, Choices::default()), &camera, [24, 16], 4, 22);
            let bad = seen.pixels.iter().filter(|p| !p.iter().all(|c| c.is_finite() && *c >= 0.0)).count();
            assert_eq!(bad, 0, "{name}, {}: {bad} pixels are no light", tracer.kernel());
        }
    }
}

#[test]
fn a_gpu_is_refused_with_what_to_do() {
    let scene = load("cornell-box");
    for tracer in LIGHT_SIDES {
        let options = Options { tracer, device: DeviceKind::GpuWavefront, ..Options::default() };
        let error = Renderer::new(&scene, options).err().expect("it has no sums that all paths add to").to_string();
        assert!(error.contains("--device cpu"), "{error}");
    }
}
