//! Glass: solid, thin, tinted, nested, seen from inside, seen along its surface, and of index 1.

use super::shapes::{floor, panel, quad, sky, solid, sphere};
use super::surfaces::{checkerboard, on_checkerboard};
use crate::{Material, Scene, Volume};
use glam::{Vec3, vec3};

/// A glass ball, a glass block and a thin pane over a checkerboard, lit by a lamp and a sky.
pub(super) fn glass() -> Scene {
    let mut scene = on_checkerboard();
    let glass = scene.paint(Material::glass("glass", 1.5));
    let pane = scene.paint(Material { volume: None, ..Material::glass("pane", 1.5) });
    let lamp = scene.paint(Material::emitter("lamp", [8.0; 3]));
    scene.place(sphere(vec3(-1.2, 0.5, 0.0), 0.5, 5), glass);
    // A hair above the floor: where two surfaces coincide the one of smaller number is seen.
    scene.place(solid(vec3(-0.3, 0.01, -0.3), [Vec3::X * 0.7, Vec3::Y * 0.9, Vec3::Z * 0.7]), glass);
    scene.place(quad(vec3(0.8, 0.0, 0.4), Vec3::X, Vec3::Y), pane);
    scene.place(panel(vec3(0.0, 3.0, 0.0), 1.0, 1.0), lamp);
    scene.view([0.0, 1.4, 5.0], [0.0, 0.4, 0.0], 0.6, (640, 360));
    scene
}

/// A glass ball on a floor under a lamp of 2 x 2 centimetres, seen by the light that the ball gathers: a path from the camera
/// meets the lamp behind the ball by chance, one in 50,000.
pub(super) fn caustic() -> Scene {
    let mut scene = Scene::default();
    let paint = scene.paint(Material::diffuse("paint", [0.6; 3]));
    let glass = scene.paint(Material::glass("glass", 1.5));
    let lamp = scene.paint(Material::emitter("lamp", [20_000.0; 3]));
    scene.place(floor(Vec3::ZERO, 6.0, 6.0), paint);
    scene.place(sphere(vec3(0.0, 0.6, 0.0), 0.5, 5), glass);
    scene.place(panel(vec3(-1.2, 2.5, 0.0), 0.02, 0.02), lamp);
    scene.view([1.2, 1.6, 3.2], [0.4, 0.2, 0.0], 0.6, (480, 320));
    scene
}

/// The camera inside a glass cube in light that is 1 from everywhere: where no component of a direction exceeds
/// sqrt(1 - 1/1.5²) = 0.745 the light is trapped for ever (black), elsewhere the cube cannot be seen and radiance is 1.5²,
/// as it is within glass. That is so for 46.17 % of the picture.
pub(super) fn glass_trap() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let glass = scene.paint(Material::glass("glass", 1.5));
    scene.place(solid(Vec3::NEG_ONE, [Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0]), glass);
    scene.view([0.1, 0.2, 0.3], [0.1, 0.2, -1.0], 1.9, (256, 256));
    scene
}

/// A dense glass ball within a light one, a ball that is there twice, and two blocks of glass a hair (2^-16) apart.
pub(super) fn nested_glass() -> Scene {
    let mut scene = on_checkerboard();
    let (light, dense) = (scene.paint(Material::glass("light", 1.3)), scene.paint(Material::glass("dense", 1.7)));
    scene.place(sphere(vec3(-0.8, 0.6, 0.0), 0.5, 4), light);
    scene.place(sphere(vec3(-0.8, 0.6, 0.0), 0.3, 4), dense);
    for _ in 0..2 {
        scene.place(sphere(vec3(-0.1, 0.3, 0.5), 0.2, 4), dense);
    }
    let edges = [Vec3::X * 0.5, Vec3::Y * 0.8, Vec3::Z * 0.5];
    scene.place(solid(vec3(0.25, 0.01, 0.0), edges), light);
    scene.place(solid(vec3(0.75 + 1.0 / 65536.0, 0.01, 0.0), edges), dense);
    scene.view([0.0, 1.2, 4.0], [0.0, 0.5, 0.0], 0.6, (512, 384));
    scene
}

/// The floor of squares with a ball, a block and a thin pane of index 1 before it: none of them can be seen.
pub(super) fn air_glass() -> Scene {
    let mut scene = checkerboard();
    let air = scene.paint(Material::glass("air", 1.0));
    let pane = scene.paint(Material { volume: None, ..Material::glass("pane", 1.0) });
    scene.place(sphere(vec3(-1.2, 0.8, 2.0), 0.5, 4), air);
    scene.place(solid(vec3(-0.3, 0.3, 2.0), [Vec3::X * 0.7, Vec3::Y * 0.9, Vec3::Z * 0.7]), air);
    scene.place(quad(vec3(0.8, 0.3, 2.4), Vec3::X, Vec3::Y), pane);
    scene
}

/// A slab of glass a kilometre wide in light that is 1 from everywhere, seen from a hand's breadth above: every angle is
/// grazing. What is not reflected is refracted, and light that enters a block with parallel faces leaves it: radiance 1.
pub(super) fn grazing_glass() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let glass = scene.paint(Material::glass("glass", 1.5));
    scene.place(solid(vec3(-500.0, -1.0, -500.0), [Vec3::X * 1000.0, Vec3::Y, Vec3::Z * 1000.0]), glass);
    scene.view([0.0, 0.1, 2.0], [0.0, 0.09, 0.0], 0.8, (512, 256));
    scene
}

/// A slab of tinted air, 1 m thick, before light that is 1 from everywhere. In the direction (x, y, −1) a path through it is
/// √(1 + x² + y²) m long, of which a colour c per metre leaves c to that power: the picture's mean is a double integral.
pub(super) fn tinted_slab() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let air = Material::glass("tinted air", 1.0);
    let tint = air.volume.map(|v| Volume { attenuation_color: [0.9, 0.5, 0.2], attenuation_distance: 1.0, ..v });
    let air = scene.paint(Material { volume: tint, ..air });
    scene.place(solid(vec3(-3.0, -2.0, -2.0), [Vec3::X * 6.0, Vec3::Y * 4.0, Vec3::Z]), air);
    scene.view([0.0; 3], [0.0, 0.0, -1.0], 1.0, (256, 128));
    scene
}
