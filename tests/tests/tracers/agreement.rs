//! T13: independent renders agree with those of the path tracer.
//!
//! Sixteen renders are compared with the mean of 32 of the path tracer in luminance, by blocks ([`compare`]); seeds are fixed
//! and differ. The long form has [`MANY`] blocks and asks for T13 as it stands: right code fails a comparison for another seed with a
//! probability of 1 in 700 (4 standard errors of the mean, of sixteen renders, 1 in 860 at most; the share of blocks, 1 in
//! 3,700). The quick form has 100 blocks, of which 3 % say little, and allows what [`quick`] says: 1 in 800.
//!
//! ```text
//! JERBOA_BLOCKS=20 JERBOA_SPP=2 cargo test --release -p jerboa-tests --test tracers agree -- --nocapture --test-threads 1
//! ```

use glam::{DAffine3, DVec3, Vec3};
use jerboa_lib_render::host::compare::{BLOCK, T13, compare, mean_image};
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::{Image, luminance};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Environment, Instance, LightKind, Material, Mesh, Scene};
use jerboa_tests::harness::analytic::{light, place, rectangle, sphere};
use jerboa_tests::harness::bench::number;
use jerboa_tests::sources::shared_scenes;

use crate::{LIGHT_SIDES, absorbing, glass, image, load, renderer};

/// Blocks on a side of the film from which on T13 is asked as it stands.
const MANY: usize = 20;
/// Renders of a tracer, and those of the path tracer it is compared with.
const RENDERS: [u32; 2] = [16, 32];
pub const BOTH_SIDES: [TracerKind; 1] = [TracerKind::Bidirectional];

/// What the quick form leaves out: it is like another scene, or light so rare that 225 paths a block say nothing of their spread.
const LONG: [&str; 14] = [
    "cornell-box, matched",
    "diffuse ball",
    "plastic ball",
    "coarse plastic ball",
    "coarse metal ball",
    "mirrored normal map",
    "rough glass",
    "its caustic",
    "spot light",
    "sun",
    "sky",
    "sky and lamp",
    "at most 2 edges",
    "at most 4 edges",
];

/// Is this the long form?
fn is_long() -> bool {
    number("JERBOA_BLOCKS", 0) >= MANY
}

/// Pixels on a side of the film.
pub fn side() -> u32 {
    BLOCK * number("JERBOA_BLOCKS", MANY / 2) as u32
}

/// The luminance alone.
pub fn grey(mut image: Image) -> Image {
    image.pixels.iter_mut().for_each(|p| *p = [luminance(*p) as f32; 3]);
    image
}

/// What 100 blocks may show. One is expected beyond the quantile, 7 in 1 of 12,000 comparisons; the rms of their z is 1.03 ±
/// .08.
fn quick(t13: &T13) -> bool {
    t13.blocks_beyond <= 0.06 && (0.75..=1.35).contains(&t13.rms_z) && t13.max_z <= 8.0 && t13.mean_sigmas.abs() <= 4.0
}

/// A comparison.
pub struct Case<'a> {
    pub name: &'a str,
    pub scene: &'a Scene,
    /// How many times the usual number of samples it takes.
    pub effort: u32,
    pub choices: Choices,
}

impl<'a> Case<'a> {
    pub fn of(name: &'a str, scene: &'a Scene) -> Case<'a> {
        Case { name, scene, effort: 1, choices: Choices::default() }
    }

    /// Renders of a tracer, grey, under seeds from this one on.
    fn images(&self, tracer: TracerKind, [count, first]: [u32; 2]) -> Vec<Image> {
        let side = side();
        let spp = number("JERBOA_SPP", 1) as u32 * self.effort;
        let (renderer, camera) = (renderer(self.scene, tracer, self.choices), self.scene.camera_or_default());
        (first..first + count).map(|seed| grey(image(&renderer, &camera, [side; 2], spp, seed))).collect()
    }

    /// Tracers agree with the path tracer.
    pub fn agree(&self, tracers: &[TracerKind]) {
        self.agree_with(tracers, self);
    }

    /// Tracers agree with the path tracer in another scene that looks the same.
    fn agree_with(&self, tracers: &[TracerKind], reference: &Case) {
        if !is_long() && LONG.contains(&self.name) {
            return;
        }
        let [count, of_reference] = RENDERS;
        let expected = mean_and_variance(&reference.images(TracerKind::Path, [of_reference, 1000]));
        let fault = |tracer: &TracerKind| {
            let what = format!("{:<24} {}", self.name, tracer.kernel());
            fault(&what, &self.images(*tracer, [count, 1]), &expected)
        };
        assert_eq!(tracers.iter().filter_map(fault).collect::<Vec<_>>(), [""; 0]);
    }
}

/// What is wrong with renders that should have this mean, whose variance is beside it.
pub fn fault(what: &str, renders: &[Image], (mean, variance): &(Image, Image)) -> Option<String> {
    let found = compare(renders, mean, Some(variance)).unwrap_or_else(|e| panic!("{e}"));
    let t13 = found.t13.expect("there are enough renders");
    let T13 { rms_z, blocks_beyond, max_z, mean_sigmas, .. } = t13;
    let figures =
        format!("rms z {rms_z:.2}, beyond {:.1} %, largest {max_z:.1}, mean {mean_sigmas:+.1}", 100.0 * blocks_beyond);
    let line = format!("{what:<39} {figures}");
    println!("{line}");
    let agrees = if is_long() { t13.pass } else { quick(&t13) };
    (!agrees).then_some(line)
}

/// The mean of some images, and the variance of it, per pixel and channel.
pub fn mean_and_variance(images: &[Image]) -> (Image, Image) {
    let (mean, n) = (mean_image(images), images.len() as f32);
    let spread = |i: usize, c: usize| {
        let square = |image: &Image| (image.pixels[i][c] - mean.pixels[i][c]).powi(2);
        images.iter().map(square).sum::<f32>() / (n * (n - 1.0))
    };
    let pixels = (0..mean.pixels.len()).map(|i| [0, 1, 2].map(|c| spread(i, c))).collect();
    let variance = Image { pixels, ..mean };
    (mean, variance)
}

/// A floor, a lamp of a square metre above it (not in sight), and a body.
pub fn under_lamp(body: Mesh, material: Material) -> Scene {
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-3.0, 0.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0);
    place(&mut scene, floor, Material::diffuse("floor", [0.7, 0.6, 0.5]), 1.0, DVec3::ZERO);
    let lamp = rectangle(Vec3::new(-0.8, 3.0, -0.5), Vec3::X, Vec3::Z);
    place(&mut scene, lamp, Material::emitter("lamp", [10.0; 3]), 1.0, DVec3::ZERO);
    place(&mut scene, body, material, 0.5, DVec3::new(0.0, 0.6, 0.0));
    scene.cameras = vec![Camera::look_at("above", DVec3::new(0.5, 2.0, 3.0), DVec3::new(0.0, 0.45, 0.0), 0.5)];
    scene
}

/// A ball of 20·4^`level` triangles with the normals of a round one.
pub fn smooth_ball(level: u32) -> Mesh {
    let ball = sphere(level);
    Mesh { normals: Some(ball.positions.clone()), ..ball }
}

#[test]
fn they_agree_in_a_diffuse_room() {
    let mut scene = load("cornell-box");
    // Below the lamp, which the light tracer does not see.
    scene.cameras = vec![Camera::look_at("low", DVec3::new(0.0, 1.0, 6.8), DVec3::new(0.0, 0.7, 0.0), 0.22)];
    Case::of("cornell-box, low", &scene).agree(&LIGHT_SIDES);
}

/// Normals that lie far from the faces: what Veach's adjoint factor is for. On the coarsest ball, an icosahedron, the light
/// tracer misses what [`tracer::light`](jerboa_lib_render::tracer::light) says.
#[test]
fn they_agree_on_smooth_normals() {
    for (name, coarse, material) in [
        ("diffuse ball", "coarse diffuse ball", Material::diffuse("ball", [0.3, 0.7, 0.8])),
        ("plastic ball", "coarse plastic ball", Material::plastic("ball", [0.3, 0.7, 0.8], 0.5)),
        ("metal ball", "coarse metal ball", Material::metal("ball", [0.9, 0.7, 0.8], 0.4)),
    ] {
        Case::of(name, &under_lamp(smooth_ball(1), material.clone())).agree(&LIGHT_SIDES);
        Case::of(coarse, &under_lamp(smooth_ball(0), material)).agree(&BOTH_SIDES);
    }
}

/// The same of a normal map, on a card that lamp and sky shine on and on its mirror image.
#[test]
fn they_agree_on_normal_maps() {
    let mut scene = load("mirrored-maps");
    let (eye, middle) = (DVec3::new(0.0, 0.0, 5.0), DVec3::new(0.85, -0.05, -0.25));
    for (name, x) in [("normal map", -1.0), ("mirrored normal map", 1.0)] {
        let at = DVec3::new(x, 1.0, 1.0) * middle;
        scene.cameras = vec![Camera::look_at("card", eye, at, 0.15)];
        Case::of(name, &scene).agree(&LIGHT_SIDES);
    }
}

/// Rough glass scatters into all directions, so both sides can be connected there, within it too.
#[test]
fn they_agree_on_rough_glass() {
    Case::of("rough glass", &under_lamp(smooth_ball(2), glass(0.5))).agree(&LIGHT_SIDES);
    let amber = absorbing(glass(0.5), 0.3, [0.8, 0.5, 0.1]);
    Case::of("rough amber", &under_lamp(smooth_ball(2), amber)).agree(&LIGHT_SIDES);
}

/// A lamp that amber surrounds: its light is absorbed on the way to each vertex that asks for it, and on its own way out. The
/// path tracer must find the same where it finds the lamp by chance alone, as a surface that is merely bright.
#[test]
fn they_agree_on_a_lamp_in_amber() {
    let mut scene = under_lamp(sphere(2), absorbing(glass(0.6), 0.2, [0.8, 0.5, 0.1]));
    scene.materials[1].emissive = [0.0; 3];
    place(&mut scene, sphere(1), Material::emitter("core", [20.0; 3]), 0.25, DVec3::new(0.0, 0.6, 0.0));
    let mut by_chance = scene.clone();
    let core = by_chance.materials.last_mut().expect("it is the last");
    (core.base_color, core.emissive, core.unlit) = ([20.0, 20.0, 20.0, 1.0], [0.0; 3], true);
    let all = [&[TracerKind::Path], LIGHT_SIDES.as_slice()].concat();
    Case::of("lamp in amber", &scene).agree_with(&all, &Case { effort: 2, ..Case::of("by chance", &by_chance) });
}

/// Smooth glass cannot be connected with: its light is found by the paths that pass it.
#[test]
fn they_agree_under_smooth_glass() {
    let scene = under_lamp(smooth_ball(3), glass(0.0));
    Case::of("glass ball", &scene).agree(&BOTH_SIDES);
    // Its caustic alone, from the side: the light tracer does not see the ball.
    let mut below = scene;
    below.cameras = vec![Camera::look_at("low", DVec3::new(0.0, 0.6, 2.6), DVec3::new(0.0, 0.0, 0.4), 0.12)];
    Case { effort: 2, ..Case::of("its caustic", &below) }.agree(&LIGHT_SIDES);
    // Within the glass: every path crosses one interface, so the squared index does not cancel.
    let mut sunk = Scene::default();
    let bottom = rectangle(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    place(&mut sunk, bottom, Material::diffuse("bottom", [0.7; 3]), 1.0, DVec3::ZERO);
    let surface = rectangle(Vec3::new(-2.0, 1.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    place(&mut sunk, surface, glass(0.0), 1.0, DVec3::ZERO);
    let lamp = rectangle(Vec3::new(-0.8, 3.0, -0.5), Vec3::X, Vec3::Z);
    place(&mut sunk, lamp, Material::emitter("lamp", [10.0; 3]), 1.0, DVec3::ZERO);
    sunk.cameras = vec![Camera::look_at("in", DVec3::new(0.2, 0.7, 1.6), DVec3::new(0.0, 0.0, 0.0), 0.5)];
    Case { effort: 2, ..Case::of("under water", &sunk) }.agree(&LIGHT_SIDES);
}

/// Each kind of light: without extent, parallel, from all around, and all of them.
#[test]
fn they_agree_on_every_light() {
    let dark = |f: fn(&mut Scene)| {
        let mut scene = under_lamp(smooth_ball(1), Material::plastic("ball", [0.3, 0.7, 0.8], 0.6));
        scene.materials[1].emissive = [0.0; 3];
        f(&mut scene);
        scene
    };
    let sky = || Environment {
        width: 8,
        height: 4,
        radiance: (0..32).map(|i| [if i == 11 { 8.0 } else { 0.5 }; 3]).collect(),
        intensity: 1.0,
        rotation_deg: 0.0,
    };
    for (name, scene) in [
        ("point light", dark(|s| s.lights = vec![light(LightKind::Point, 10.0, 2.5)])),
        ("spot light", dark(|s| s.lights = vec![light(LightKind::Spot { inner: 0.3, outer: 0.5 }, 10.0, 2.5)])),
        ("sun", dark(|s| s.lights = vec![light(LightKind::Directional, 3.0, 2.5)])),
    ] {
        Case::of(name, &scene).agree(&LIGHT_SIDES);
    }
    // The camera sees floor and ball alone.
    let down = || vec![Camera::look_at("down", DVec3::new(0.4, 2.5, 1.2), DVec3::new(0.0, 0.2, 0.0), 0.5)];
    let mut sky_only = dark(|_| ());
    (sky_only.environment, sky_only.cameras) = (Some(sky()), down());
    Case::of("sky", &sky_only).agree(&LIGHT_SIDES);
    let mut all = under_lamp(smooth_ball(1), Material::plastic("ball", [0.3, 0.7, 0.8], 0.6));
    (all.environment, all.cameras) = (Some(sky()), down());
    Case::of("sky and lamp", &all).agree(&LIGHT_SIDES);
    all.lights = vec![light(LightKind::Point, 4.0, 2.5), light(LightKind::Directional, 1.0, 2.5)];
    Case::of("all lights", &all).agree(&LIGHT_SIDES);
}

/// Instances that share their triangles.
#[test]
fn they_agree_on_instances() {
    let mut scene = under_lamp(smooth_ball(1), Material::plastic("ball", [0.3, 0.7, 0.8], 0.5));
    let ball = scene.instances.pop().expect("the ball");
    for (x, z, turn) in [(-0.5, 0.1, 0.3), (0.4, -0.2, 1.1), (0.1, 0.5, -0.7)] {
        let to_world =
            DAffine3::from_translation(DVec3::new(x, -0.25, z)) * ball.to_world * DAffine3::from_rotation_z(turn);
        let squeezed = DAffine3::from_scale(DVec3::new(0.5, 0.8, 0.6));
        scene.instances.push(Instance { to_world: to_world * squeezed, ..ball.clone() });
    }
    let choices = Choices { most_copies: 0, ..Choices::default() };
    Case { choices, ..Case::of("instances", &scene) }.agree(&LIGHT_SIDES);
}

/// Every strategy is cut off at the same length.
#[test]
fn they_agree_on_short_paths() {
    let scene = load("cornell-box");
    // One edge is the camera's own: the same samples, not only the same mean.
    let seen = [TracerKind::Path, TracerKind::Bidirectional].map(|tracer| {
        let renderer = renderer(&scene, tracer, Choices { max_depth: Some(1), ..Choices::default() });
        image(&renderer, &scene.camera_or_default(), [24, 16], 4, 1)
    });
    assert!(seen[0] == seen[1] && seen[0].pixels.iter().any(|p| p[0] > 0.0));
    for depth in [2, 3, 4] {
        let choices = Choices { max_depth: Some(depth), ..Choices::default() };
        Case { choices, ..Case::of(&format!("at most {depth} edges"), &scene) }.agree(&BOTH_SIDES);
    }
}

/// The scene of the matched references, where it is at hand, as they were rendered.
#[test]
fn they_agree_on_a_matched_scene() {
    let Some(folder) = shared_scenes() else { return };
    let scene = Scene::load(folder.join("cornell-box/cornell-box.matched.glb")).unwrap_or_else(|e| panic!("{e}"));
    let choices = Choices { consistent_normals: false, max_depth: Some(16), ..Choices::default() };
    Case { choices, ..Case::of("cornell-box, matched", &scene) }.agree(&BOTH_SIDES);
}
