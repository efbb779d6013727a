//! Light of every kind, where the answer is known or hard to find.

use super::shapes::{floor, panel, quad, sky, solid, sphere, varied};
use crate::{Environment, Light, LightKind, Material, Scene, Sky};
use glam::{DAffine3, DVec3, Vec3, vec3};
use std::f64::consts::FRAC_PI_2;

/// A grey floor (albedo 1/2, at y = 0, its front up) seen from above, for light of known irradiance E: radiance E / 2π.
fn grey_floor() -> Scene {
    let mut scene = Scene::default();
    let grey = scene.paint(Material::diffuse("floor", [0.5; 3]));
    scene.place(floor(Vec3::ZERO, 8.0, 8.0), grey);
    scene.view([0.0, 4.0, 4.0], [0.0, 0.0, 0.0], 0.6, (256, 256));
    scene
}

/// Straight down from a point.
fn down_from(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z)) * DAffine3::from_rotation_x(-FRAC_PI_2)
}

fn light(kind: LightKind, intensity: f32, to_world: DAffine3) -> Light {
    Light { name: "light".into(), kind, intensity: [intensity; 3], to_world }
}

/// 1 candela at height 1 over the origin: irradiance 1 / d³ at distance d from the light.
pub(super) fn point_light() -> Scene {
    let mut scene = grey_floor();
    scene.lights.push(light(LightKind::Point, 1.0, down_from(0.0, 1.0, 0.0)));
    scene
}

/// The same with a cone: full up to 0.3, nothing from 0.5 radians on.
pub(super) fn spot() -> Scene {
    let mut scene = grey_floor();
    scene.lights.push(light(LightKind::Spot { inner: 0.3, outer: 0.5 }, 1.0, down_from(0.0, 1.0, 0.0)));
    scene
}

/// 1 lux from 60 degrees above the horizon: irradiance sin 60°, but for the shadow of a block.
pub(super) fn sun() -> Scene {
    let mut scene = grey_floor();
    let slant = DAffine3::from_rotation_y(0.5) * DAffine3::from_rotation_x(-60f64.to_radians());
    scene.lights.push(light(LightKind::Directional, 1.0, slant));
    let block = scene.paint(Material::diffuse("block", [0.2, 0.4, 0.6]));
    scene.place(solid(vec3(-0.3, 0.0, -0.3), [Vec3::X * 0.6, Vec3::Y * 0.8, Vec3::Z * 0.6]), block);
    scene
}

/// A ball of light beside a metal ball and a glass ball, a disk of light over them, and a low sun, on a grey floor.
pub(super) fn round_lights() -> Scene {
    let mut scene = grey_floor();
    let metal = scene.paint(Material::metal("metal", [0.9, 0.7, 0.4], 0.15));
    let glass = scene.paint(Material::glass("glass", 1.5));
    scene.place(sphere(vec3(-0.7, 0.4, -0.2), 0.4, 5), metal);
    scene.place(sphere(vec3(0.7, 0.4, -0.2), 0.4, 5), glass);
    scene.lights.push(light(LightKind::Sphere { radius: 0.12 }, 0.5, down_from(0.0, 0.3, 0.3)));
    let disk = LightKind::Disk { inner: 0.4, outer: 0.9, radius: 0.3 };
    scene.lights.push(light(disk, 2.0, down_from(0.0, 1.6, -0.4)));
    let slant = DAffine3::from_rotation_y(-2.6) * DAffine3::from_rotation_x(-12f64.to_radians());
    scene.lights.push(light(LightKind::Sun { angle: 0.05 }, 1.5, slant));
    scene.view([0.0, 1.0, 3.4], [0.0, 0.5, 0.0], 0.7, (400, 300));
    scene
}

/// A ball, a block and a metal ball on a floor under a clear sky and its sun, 35 degrees high and behind the camera's right
/// shoulder.
pub(super) fn sunlit() -> Scene {
    let sky = Sky { elevation_deg: 35.0, azimuth_deg: 130.0, width: 256, ..Sky::default() };
    let sky = sky.environment().expect("the numbers are in range");
    let mut scene = Scene { environment: Some(Environment { intensity: 2.0, ..sky }), ..Scene::default() };
    let [stone, wood, clay, steel] = [
        Material::diffuse("stone", [0.4, 0.38, 0.35]),
        Material::diffuse("wood", [0.1, 0.25, 0.5]),
        Material::plastic("clay", [0.7, 0.25, 0.15], 0.5),
        Material::metal("steel", [0.8; 3], 0.2),
    ]
    .map(|material| scene.paint(material));
    scene.place(floor(Vec3::ZERO, 400.0, 400.0), stone);
    scene.place(sphere(vec3(-0.9, 0.5, 0.0), 0.5, 4), clay);
    scene.place(solid(vec3(-0.2, 0.0, -0.4), [Vec3::X * 0.6, Vec3::Y, Vec3::Z * 0.6]), wood);
    scene.place(sphere(vec3(1.1, 0.5, 0.1), 0.5, 4), steel);
    scene.view([0.0, 1.3, 4.5], [0.0, 0.5, 0.0], 0.6, (480, 270));
    scene
}

/// A square lamp of side 1 and radiance 1 at height 1: radiance 0.119728235 of the floor straight below it.
pub(super) fn quad_light() -> Scene {
    let mut scene = grey_floor();
    let lamp = scene.paint(Material::emitter("lamp", [1.0; 3]));
    scene.place(panel(Vec3::Y, 1.0, 1.0), lamp);
    scene
}

/// A square lamp of side 1 and radiance 2π 1e8 at height 1e4, where it fills 1e-8 steradians: irradiance 2π, radiance 1 (but
/// for (4/1e4)² of it at the rim of the floor).
pub(super) fn far_lamp() -> Scene {
    let mut scene = grey_floor();
    let lamp = scene.paint(Material::emitter("lamp", [std::f32::consts::TAU * 1e8; 3]));
    scene.place(panel(Vec3::Y * 1e4, 1.0, 1.0), lamp);
    scene
}

/// A square lamp of side 1e-10 and radiance 2π 1e20 at height 1: at an angle θ from below it, radiance cos⁴ θ.
pub(super) fn pinpoint_lamp() -> Scene {
    let mut scene = grey_floor();
    let lamp = scene.paint(Material::emitter("lamp", [std::f32::consts::TAU * 1e20; 3]));
    scene.place(panel(Vec3::Y, 1e-10, 1e-10), lamp);
    scene
}

/// 256 lamps of many colours, sizes and strengths over a city of blocks, and 16 point lights.
pub(super) fn many_lights() -> Scene {
    let mut scene = grey_floor();
    let colors = [[1.0, 0.3, 0.2], [0.3, 1.0, 0.4], [0.3, 0.5, 1.0], [1.0, 0.8, 0.5]];
    let lamps = colors.map(|c| scene.paint(Material::emitter("lamp", c.map(|x: f32| x * 20.0))));
    let stone = scene.paint(Material::diffuse("stone", [0.6; 3]));
    for i in 0..256 {
        let (x, z) = ((i % 16) as f32 * 0.5 - 3.75, (i / 16) as f32 * 0.5 - 3.75);
        let (height, side) = (0.1 + 0.6 * varied(i), 0.02 + 0.1 * varied(7 * i));
        scene.place(panel(vec3(x, height, z), side, side), lamps[i as usize % 4]);
        if i % 3 == 0 {
            let base = vec3(x + 0.15, 0.0, z + 0.1);
            scene.place(solid(base, [Vec3::X * 0.2, Vec3::Y * height, Vec3::Z * 0.2]), stone);
        }
        if i % 16 == 5 {
            let position = down_from(f64::from(x), 1.0, f64::from(z));
            scene.lights.push(light(LightKind::Point, 0.05, position));
        }
    }
    scene.view([0.0, 5.0, 7.0], [0.0, 0.0, 0.0], 0.7, (640, 480));
    scene
}

/// A ball on a floor under a blue sky with a small, strong sun.
pub(super) fn environment() -> Scene {
    let mut scene = grey_floor();
    let ball = scene.paint(Material::plastic("ball", [0.6, 0.5, 0.4], 0.3));
    scene.place(sphere(vec3(0.0, 0.5, 0.0), 0.5, 5), ball);
    let sun = vec3(0.5, 0.7, 0.4).normalize();
    scene.environment = Some(sky(256, |d| {
        // 0.9994: a disc of 2 degrees' radius.
        let glow = if d.dot(sun) > 0.9994 { 2000.0 } else { 0.0 };
        let height = d.y.max(0.0);
        [0.3 + glow, 0.5 + 0.9 * glow, 0.6 + 0.4 * height + 0.7 * glow]
    }));
    scene.view([0.0, 1.2, 4.0], [0.0, 0.4, 0.0], 0.5, (400, 300));
    scene
}

/// A black sky with one texel of a million and bright rows at both poles, where texels have hardly any solid angle.
pub(super) fn hot_texel() -> Scene {
    let mut scene = grey_floor();
    let mut sky = sky(64, |_| [0.0; 3]);
    let width = sky.width as usize;
    let last_row = width * (sky.height as usize - 1);
    sky.radiance[..width].fill([100.0; 3]);
    sky.radiance[last_row..].fill([100.0; 3]);
    sky.radiance[9 * width + 20] = [1e6; 3];
    scene.environment = Some(sky);
    scene
}

/// A lamp that stands on the floor (the floor touches its plane) and a point light a millionth above the floor.
pub(super) fn edge_light() -> Scene {
    let mut scene = grey_floor();
    let lamp = scene.paint(Material::emitter("lamp", [2.0; 3]));
    scene.place(quad(vec3(-0.5, 0.0, -0.5), Vec3::X, Vec3::Y), lamp);
    scene.lights.push(light(LightKind::Point, 1e-6, down_from(0.5, 1e-6, 0.5)));
    scene
}
