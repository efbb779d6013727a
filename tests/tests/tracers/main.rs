//! The tracers beside the path tracer: light transport from the lights, alone and from both sides, and ambient occlusion. And the
//! cameras beside the pinhole.
//!
//! * [`agreement`]: they agree with the path tracer (T13), and [`pieces`]: on each piece of the library too,
//! * [`lenses`]: what lenses show agrees with what pinholes do (T13),
//! * [`roulette`]: what roulette costs (T16), and [`learned`]: that by what was learned (T13, T21),
//! * [`closed`]: closed forms (T4, T16), with and without what absorbs, and nothing through a closed wall (T19),
//! * [`bits`]: what changes no bit (T21), and that every sample of the built-in scenes is a number (T22).

mod agreement;
mod bits;
mod closed;
mod learned;
mod lenses;
mod pieces;
mod roulette;

use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Material, Scene};

/// Those whose paths start at lights.
const LIGHT_SIDES: [TracerKind; 2] = [TracerKind::Light, TracerKind::Bidirectional];

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

fn renderer(scene: &Scene, tracer: TracerKind, choices: Choices) -> Renderer {
    Renderer::new(scene, Options { tracer, choices, ..Options::default() }).unwrap_or_else(|e| panic!("{e}"))
}

/// A render of which every sample is a number.
fn image(renderer: &Renderer, camera: &Camera, size: [u32; 2], spp: u32, seed: u32) -> Image {
    let mut film = Film::of_size(size);
    renderer
        .render_with(camera, &mut film, Render { sample: 0, spp, seed }, &Handle::default())
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(film.dropped(), 0);
    film.mean()
}

/// The mean over an image, by channel.
fn mean_of(image: &Image) -> [f64; 3] {
    let sum = |c: usize| image.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>();
    [0, 1, 2].map(|c| sum(c) / image.pixels.len() as f64)
}

fn glass(roughness: f32) -> Material {
    Material { roughness, ..Material::glass("glass", 1.5) }
}

/// The same body, whose inside leaves this share of light after a distance.
fn absorbing(mut body: Material, distance: f32, color: [f32; 3]) -> Material {
    let volume = body.volume.as_mut().expect("it has an inside");
    (volume.attenuation_distance, volume.attenuation_color) = (distance, color);
    body
}
