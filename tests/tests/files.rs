//! What a file asks for is seen in its image: colours of vertices, and cameras of every kind, against closed forms.
//!
//! Random tests have the seed 0 of the renderer.

use glam::{DAffine3, DVec3, Vec3, Vec4};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_scenes::{AlphaMode, Camera, Instance, Lens, Material, Mesh, Scene};

const SIDE: u32 = 64;

/// A square of [-1, 1]² in the plane z = 0, seen from z = 4 through this lens.
fn square(lens: Lens) -> Scene {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mesh = Mesh {
        positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let camera = Camera::look_at("front", DVec3::Z * 4.0, DVec3::ZERO, 1.0);
    Scene {
        name: "square".into(),
        meshes: vec![mesh],
        instances: vec![Instance { mesh: 0, to_world: DAffine3::IDENTITY }],
        materials: vec![Material::diffuse("white", [1.0; 3])],
        cameras: vec![Camera { lens, ..camera }],
        ..Scene::default()
    }
}

/// Base colours as the first camera sees them.
fn seen(scene: &Scene, spp: u32) -> Image {
    let options = Options { tracer: TracerKind::Albedo, spp, ..Options::default() };
    let renderer = Renderer::new(scene, options).unwrap_or_else(|e| panic!("{e}"));
    let mut film = Film::of_size([SIDE, SIDE]);
    renderer.render(&scene.cameras[0], &mut film).unwrap_or_else(|e| panic!("{e}"));
    film.mean()
}

fn pixel(image: &Image, x: u32, y: u32) -> [f32; 3] {
    image.pixels[(y * SIDE + x) as usize]
}

/// Half of the height is 2, so that the square covers the inner 32 x 32 pixels, whatever its distance.
#[test]
fn an_orthographic_square_covers_its_pixels_exactly() {
    let image = seen(&square(Lens::Orthographic { ymag: 2.0 }), 4);
    for (x, y) in (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE)) {
        let inside = (16..48).contains(&x) && (16..48).contains(&y);
        assert_eq!(pixel(&image, x, y), [if inside { 1.0 } else { 0.0 }; 3], "({x}, {y})");
    }
}

/// The square's edge is at the angle atan(1/4) off the axis: from the film's centre as far as that angle is of the whole.
#[test]
fn a_fisheye_shows_angles_as_distances() {
    let angle = 2.0;
    let image = seen(&square(Lens::Fisheye { angle }), 64);
    let edge = (0.25f64.atan() / (angle / 2.0) * f64::from(SIDE) / 2.0) as f32;
    let middle = SIDE / 2;
    let covered: f32 = (middle..SIDE).map(|x| pixel(&image, x, middle)[0]).sum();
    // The row lies half a pixel off the axis, which moves the edge by less than 0.01 pixels; 64 samples tell 0.2.
    assert!((covered - edge).abs() < 0.2, "{covered} pixels, not {edge}");
}

/// The edge of the square at depth 4 while depth f is sharp: it grows from nothing to all over the diameter of the circle of
/// confusion, aperture · |4 − f| / 4 on the plane in focus.
#[test]
fn a_thin_lens_blurs_by_the_circle_of_confusion() {
    let (yfov, aperture) = (0.8, 1.0);
    for focus in [2.0, 4.0, 8.0] {
        let image = seen(&square(Lens::Thin { yfov, aperture, focus }), 256);
        let pixels = f64::from(SIDE) / 2.0 / (yfov / 2.0f64).tan();
        let radius = aperture * (4.0f64 - focus).abs() / 4.0 / 2.0 / focus * pixels;
        let edge = f64::from(SIDE) / 2.0 + pixels / 4.0;
        for x in SIDE / 2..SIDE {
            let share = pixel(&image, x, SIDE / 2)[0];
            let (left, right) = (f64::from(x), f64::from(x + 1));
            if right < edge - radius - 1e-3 {
                assert_eq!(share, 1.0, "column {x}, focus {focus}: {edge} ± {radius}");
            } else if left > edge + radius + 1e-3 {
                assert_eq!(share, 0.0, "column {x}, focus {focus}: {edge} ± {radius}");
            } else if (edge - radius + 1.5..edge + radius - 2.5).contains(&left) {
                assert!(share > 0.0 && share < 1.0, "column {x}, focus {focus}: {share}");
            }
        }
    }
}

#[test]
fn a_renderer_refuses_a_camera_of_another_kind() {
    let scene = square(Lens::Pinhole { yfov: 1.0 });
    let renderer = Renderer::new(&scene, Options::default()).unwrap_or_else(|e| panic!("{e}"));
    let camera = Camera { lens: Lens::Orthographic { ymag: 1.0 }, ..scene.cameras[0].clone() };
    let error = renderer.render(&camera, &mut Film::of_size([4, 4])).unwrap_err().to_string();
    assert!(error.contains("Orthographic") && error.contains("Pinhole"), "{error}");
}

/// From red on the left to green on the right, times the base colour.
#[test]
fn colours_of_vertices_multiply_the_base_colour() {
    let mut scene = square(Lens::Orthographic { ymag: 1.0 });
    scene.materials[0].base_color = [1.0, 0.5, 1.0, 1.0];
    let [left, right] = [Vec4::new(1.0, 0.0, 0.25, 1.0), Vec4::new(0.0, 1.0, 0.25, 1.0)];
    scene.meshes[0].colors = Some(vec![left, right, right, left]);
    let image = seen(&scene, 16);
    for x in 0..SIDE {
        let green = (x as f32 + 0.5) / SIDE as f32;
        let expected = [1.0 - green, 0.5 * green, 0.25];
        for (got, expected) in pixel(&image, x, 20).into_iter().zip(expected) {
            // A sample lies within half a pixel.
            assert!((got - expected).abs() <= 0.5 / SIDE as f32 + 1e-5, "column {x}: {got}, not {expected}");
        }
    }
}

/// A surface that is there with the probability of its vertices' alpha.
#[test]
fn alpha_of_vertices_opens_surfaces() {
    let mut scene = square(Lens::Orthographic { ymag: 1.0 });
    scene.materials[0].alpha_mode = AlphaMode::Blend;
    scene.meshes[0].colors = Some(vec![Vec4::new(1.0, 1.0, 1.0, 0.25); 4]);
    let mean = seen(&scene, 4).pixels.iter().map(|p| f64::from(p[0])).sum::<f64>() / f64::from(SIDE * SIDE);
    let error = (0.25 * 0.75 / f64::from(4 * SIDE * SIDE)).sqrt();
    assert!((mean - 0.25).abs() < 4.0 * error, "{mean}, not 0.25 ± {error}");
}
