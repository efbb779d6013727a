//! T22 of cameras, and of the components of a user's crate, at the ends of what their numbers may be: every pixel is a finite
//! number, and no sample is dropped.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3, Vec2};
use jerboa_example_custom::{components, facing, lamp, minnaert, rings, scene};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::library::Library;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_scenes::{Camera, Lens, Model, Scene};
use jerboa_tests::harness::analytic::glowing_box;

/// The picture of four samples a pixel, which are all there.
fn image(what: &str, renderer: &Renderer, camera: &Camera) -> Image {
    let mut film = Film::of_size([24, 16]);
    let job = Render { sample: 0, spp: 4, seed: 0 };
    renderer.render_with(camera, &mut film, job, &Handle::default()).unwrap_or_else(|e| panic!("{what}: {e}"));
    assert_eq!(film.dropped(), 0, "{what}");
    let image = film.mean();
    assert!(image.pixels.iter().flatten().all(|x| x.is_finite()), "{what}: {:?}", image.pixels);
    image
}

/// Of those that take cameras of any kind.
const ANY_LENS: [TracerKind; 3] = [TracerKind::Path, TracerKind::Occlusion, TracerKind::AovPlace];

/// Fields of view of next to nothing and of next to all, and lenses from none to one that is larger than the world; in a room that
/// glows all around, of which whatever is within it sees some.
#[test]
fn extreme_cameras_drop_nothing() {
    let focus = 2.0;
    let fields = [1e-30, 1e-12, 1e-6, 0.75, PI - 1e-6, PI - 1e-12, PI.next_down()];
    let apertures = [f64::from(f32::from_bits(1)), 1e-30, 1e-12, 0.1, 1e6, 1e18, 1e30];
    let sizes = [1e-30, 1e-12, 1e-6, 1e6, 1e12, 1e18];
    let angles = [f64::MIN_POSITIVE, 1e-30, 1e-12, 1e-6, PI.next_down(), PI, 1.5 * PI, 2.0 * PI];
    let thin = |(yfov, aperture): (f64, f64)| Lens::Thin { yfov, aperture, focus };
    let kinds: [(&str, Vec<Lens>); 4] = [
        ("pinhole", fields.map(|yfov| Lens::Pinhole { yfov }).into()),
        ("thin lens", fields.into_iter().flat_map(|yfov| apertures.map(|a| (yfov, a))).map(thin).collect()),
        ("orthographic", sizes.map(|ymag| Lens::Orthographic { ymag }).into()),
        ("fisheye", angles.map(|angle| Lens::Fisheye { angle }).into()),
    ];
    let is_within = |lens: &Lens| match *lens {
        Lens::Thin { aperture, .. } => aperture < 1.0,
        Lens::Orthographic { ymag } => ymag < 1.0,
        Lens::Pinhole { .. } | Lens::Fisheye { .. } => true,
    };
    let closed = glowing_box(0.5);
    let (mut room, camera) = (closed.scene.clone(), closed.looks[0].0.camera.clone());
    for (kind, lenses) in kinds {
        let pinholes = [TracerKind::Light, TracerKind::Bidirectional];
        let more = if kind == "pinhole" { &pinholes[..] } else { &[] };
        for tracer in ANY_LENS.iter().chain(more) {
            room.cameras = vec![Camera { lens: lenses[0], ..camera.clone() }];
            let options = Options { tracer: *tracer, ..Options::default() };
            let renderer = Renderer::new(&room, options).unwrap_or_else(|e| panic!("{e}"));
            for lens in &lenses {
                let what = format!("{lens:?}, {}", tracer.kernel());
                let seen = image(&what, &renderer, &Camera { lens: *lens, ..camera.clone() });
                let is_lit = *tracer == TracerKind::Path && is_within(lens);
                assert!(!is_lit || seen.pixels.iter().all(|p| p[0] > 0.0), "{what}: {:?}", seen.pixels);
            }
        }
    }
}

/// The example's square, with coordinates that many times as large and these numbers of its model, texture and lamp.
fn square(coordinates: f32, k: f32, width: f32, exponent: f32) -> Scene {
    let mut scene = scene();
    scene.meshes[0].uvs[0].iter_mut().flatten().for_each(|uv| *uv *= Vec2::splat(coordinates));
    scene.materials[0].model = Some(Model::named(minnaert::NAME).with("k", &[k]));
    scene.own = vec![
        Model::named(rings::NAME).with("width", &[width]).with("even", &[1.0; 3]).with("odd", &[0.0; 3]),
        Model::named(lamp::NAME).with("exponent", &[exponent]),
    ];
    scene
}

/// Who takes turns beside the path tracer.
const OTHERS: [TracerKind; 2] = [TracerKind::Light, TracerKind::Own(facing::NAME)];

#[test]
fn extreme_components_of_a_crate_drop_nothing() {
    let library = Library::new(components());
    let mut turns = OTHERS.into_iter().cycle();
    let mut check = |what: &str, scene: &Scene| {
        for tracer in [TracerKind::Path].into_iter().chain(turns.next()) {
            let options = Options { tracer, ..Options::default() };
            let renderer = Renderer::of(&library, scene, options).unwrap_or_else(|e| panic!("{what}: {e}"));
            image(&format!("{what}, {}", tracer.kernel()), &renderer, &scene.camera_or_default());
        }
    };
    let numbers = [(1.0, 1e-3, 0.0), (1e18, 1e-3, 100.0), (f32::MAX, 1e3, 0.0), (f32::from_bits(1), 1e-3, 100.0)];
    for (coordinates, width, exponent) in numbers {
        let k = if exponent > 0.0 { 8.0 } else { 1.0 };
        let what = format!("k {k}, exponent {exponent}, coordinates of {coordinates:e}, rings of {width}");
        check(&what, &square(coordinates, k, width, exponent));
    }
    // In the plane of the square, on it, a hair before it, behind it, out of this world, and turned away from a half of it.
    let places = [
        ([0.3, 0.2, 0.0], 0.3, 0.0),
        ([2.0, 0.0, 0.0], 0.3, 1.0),
        ([0.0; 3], 0.3, 0.0),
        ([0.3, 0.2, 1e-7], 0.3, 100.0),
        ([0.0, 0.0, 1e-30], 0.3, 0.0),
        ([0.0, 0.0, -1.0], 0.3, 100.0),
        ([0.0, 0.0, 1e15], 0.3, 0.0),
        ([0.0, 0.0, 0.5], PI / 2.0, 0.0),
        ([0.0, 0.0, 0.5], PI / 2.0, 8.5),
    ];
    for (at, turn, exponent) in places {
        let mut scene = square(1.0, 8.0, 0.2, exponent);
        scene.lights[0].to_world = DAffine3::from_translation(DVec3::from(at)) * DAffine3::from_rotation_x(turn);
        // Within what the film can hold: intensity over the squared distance.
        scene.lights[0].intensity = [1e-8; 3];
        check(&format!("a lamp at {at:?}, turned by {turn}, exponent {exponent}"), &scene);
    }
    // Seen along the square.
    for height in [1e-6, 0.0] {
        let mut scene = square(1.0, 8.0, 0.2, 1.0);
        scene.cameras = vec![Camera::look_at("along", DVec3::new(0.0, -4.0, height), DVec3::ZERO, 0.6)];
        check(&format!("the camera {height} above the square"), &scene);
    }
}
