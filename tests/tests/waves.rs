//! The device of streams against the scalar one: paths in any number in flight, sorted by shader or not, give the same
//! radiance and the same numbers of rays, sample by sample, to the bit (Law 9, T21). Every built-in scene at every level of
//! knowledge is in `renderer.rs`, threads and films in `determinism.rs`.

use jerboa_lib_render::host::device::{DeviceKind, Traversal};
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::renderer::{Cut, Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::Pass;
use jerboa_scenes::Scene;

const WHOLE: Window = Window { x: 0, y: 0, width: 23, height: 19 };

/// Shaders of several classes, misses, cut-outs on the way to lights, long paths.
const SCENES: [&str; 3] = ["material-balls", "alpha", "white-box"];

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

fn renderer(scene: &Scene, options: Options) -> Renderer {
    Renderer::new(scene, options).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// All words of all samples: radiance and rays.
fn samples(scene: &Scene, options: Options) -> Vec<u32> {
    let pass = Pass { size: [WHOLE.width, WHOLE.height], window: WHOLE, sample: 2, samples: 3, seed: 11 };
    renderer(scene, options)
        .samples(&scene.camera_or_default(), &pass)
        .unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

fn scalar() -> Options {
    Options { device: DeviceKind::CpuScalar, ..Options::default() }
}

#[test]
fn any_number_in_flight_gives_the_same_samples() {
    for scene in SCENES.map(load) {
        // Tracers of paths from lights have no streams.
        for tracer in TracerKind::ALL.into_iter().filter(|tracer| !tracer.is_splatting()) {
            let expected = samples(&scene, Options { tracer, ..scalar() });
            let all: &[u32] = if tracer == TracerKind::Path { &[1, 64, 1000, 4096] } else { &[5] };
            for slots in all.iter().copied() {
                let cut = Cut { slots, ..Cut::default() };
                for traversal in [Traversal::Native, Traversal::Ir] {
                    let found = samples(&scene, Options { tracer, cut, traversal, ..Options::default() });
                    assert!(found == expected, "{}, {}: {slots}, {traversal:?}", scene.name, tracer.kernel());
                }
            }
        }
    }
}

#[test]
fn neither_tiles_nor_devices_change_film_or_statistics() {
    let scene = load("material-balls");
    let render = |options: Options| {
        let mut film = Film::new(WHOLE);
        let job = Render { sample: 0, spp: 5, seed: 4 };
        let stats =
            renderer(&scene, options).render_with(&scene.camera_or_default(), &mut film, job, &Handle::default());
        let stats = stats.unwrap_or_else(|e| panic!("{e}"));
        (film, stats.spp, stats.closest_rays, stats.shadow_rays)
    };
    let expected = render(scalar());
    for tile in [1, 3, 16, 64] {
        for slots in [7, 512] {
            let found = render(Options { cut: Cut { tile, slots }, ..Options::default() });
            assert!(found == expected, "tiles of {tile}, {slots} in flight: {:?}", found.1);
        }
        assert!(render(Options { cut: Cut { tile, ..Cut::default() }, ..scalar() }) == expected, "tiles of {tile}");
    }
}

/// Kernels with equal residuals share their code, in one renderer and between renderers.
#[test]
fn equal_residuals_are_compiled_once() {
    let scene = load("cornell-box");
    let [first, second] = [0, 1].map(|_| renderer(&scene, Options::default()));
    for (a, b) in first.kernels().iter().zip(second.kernels()) {
        assert!(std::ptr::eq(&*a.code, &*b.code), "{}", a.name);
    }
    assert!(!std::ptr::eq(&*first.kernels()[0].code, &*first.kernels()[1].code));
}
