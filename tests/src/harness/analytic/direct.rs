//! Direct light on a floor: each kind of light at places where the integral is known.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::{DVec3, Vec3};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Environment, LightKind, Material, Mesh, Scene};

use super::painted::painted;
use super::{Closed, Look, inradius, light, place, rectangle, sphere, wavefront};
use crate::sources::shared_scenes;

/// Albedo of the floor, which is the first mesh of each scene of [`direct`].
pub const ALBEDO: f32 = 0.5;
/// Level of the spheres: 20,480 triangles.
const ROUND: u32 = 5;

/// A floor in the plane y = 0, lit directly by each kind of light.
pub fn direct() -> Vec<Closed> {
    let mut all = vec![four_square(), spot(), sun_on(8.0), grazed()];
    all.extend(
        [20.0, 2.0, 1.0, 0.5, 0.3, 0.1, 0.05, 0.01, 1e-3].map(|h| lamp(&format!("at height {h}"), above(h), false)),
    );
    all.extend([1.0, 0.01].map(|h| lamp(&format!("in two halves at height {h}"), above(h), true)));
    all.push(Closed { scene: wavefront("lamp"), ..lamp("of a Wavefront file", above(1.0), false) });
    let (needle, width) = ("a millionth wide", 1e-6);
    for (what, apart) in [(needle.to_string(), false), (format!("{needle}, in two halves"), true)] {
        all.push(lamp(&what, [Vec3::new(-0.5, 1.0, -0.5 * width), Vec3::X, Vec3::Z * width], apart));
    }
    // Its foot on the floor, so close that the floor's origin sees a quarter of the world full of it.
    let standing = |z: f32| [Vec3::new(-0.5, 0.0, -z), Vec3::X, Vec3::Y];
    for z in [0.5, 0.01] {
        all.push(Closed { effort: 9, ..lamp(&format!("that stands on the floor {z} away"), standing(z), false) });
    }
    all.extend([1.0, 0.3].map(tiles));
    all.push(lamp("in the plane of the floor", [Vec3::new(0.25, 0.0, -0.5), Vec3::Z, Vec3::X], false));
    all.extend([(0.1, 1.0, 15), (0.5, 1.0, 9), (0.99, 1.0, 1), (1.0, 30.0, 9)].map(ball));
    all.extend([(0.1, 1.0), (0.5, 1.0), (0.99, 1.0), (1.0, 30.0), (1e-4, 1.0), (1e-15, 1.0)].map(ball_of_light));
    all.extend([(0.5, 1.0), (1.0, 0.5), (1e-3, 1.0), (1.0, 0.1)].map(disk_of_light));
    all.extend([(0.0093, 60.0), (1e-6, 60.0), (1.0, 60.0), (std::f32::consts::PI, 90.0)].map(wide_sun));
    all.extend(painted());
    all.extend(skies());
    all
}

/// A floor from -side/2 to side/2.
pub(super) fn floor(side: f32, albedo: f32) -> Scene {
    let mut scene = Scene::default();
    let corner = Vec3::new(-side, 0.0, -side) / 2.0;
    let floor = rectangle(corner, Vec3::Z * side, Vec3::X * side);
    place(&mut scene, floor, Material::diffuse("floor", [albedo; 3]), 1.0, DVec3::ZERO);
    scene
}

pub(super) fn closed(name: String, scene: Scene, looks: Vec<(Look, f64)>) -> Closed {
    Closed {
        name,
        scene,
        looks,
        facets: 0.0,
        choices: Choices { max_depth: Some(2), ..Choices::default() },
        is_near: false,
        effort: 1,
    }
}

/// The origin alone, from the side: a hundredth of the distance across.
pub(super) fn origin(eye: DVec3) -> Look {
    Look::pixel(Camera::look_at("side", eye, DVec3::ZERO, 0.01), 101, 50, 50)
}

/// All of a floor of 2 x 2 and albedo 1 under a point light of 1 W at height 2, as in the tests of Ignis (Rodent's
/// successor): the mean of cos / d² is the solid angle of the floor, 4 atan(1 / √24), by its area; times 1 / 4π for the light
/// and 1 / π for the floor that is 0.005100456.
pub(super) fn four_square() -> Closed {
    let mut scene = floor(2.0, 1.0);
    scene.lights = vec![light(LightKind::Point, 0.25 * FRAC_1_PI as f32, 2.0)];
    let look = Look::whole(Camera::look_at("above", DVec3::Y * 3.0, DVec3::ZERO, 2.0 * (1.0_f64 / 3.0).atan()));
    let truth = (1.0 / 24_f64.sqrt()).atan() * 0.25 * FRAC_1_PI * FRAC_1_PI;
    assert!((truth - 0.005_100_456).abs() < 1e-9);
    closed("all of a square under a point light".into(), scene, vec![(look, truth)])
}

/// One candela at height 1 in a cone with a soft edge: the irradiance is the cosine over the squared distance, 1/d³, times
/// the ramp of the extension. From the middle out to where it is dark.
fn spot() -> Closed {
    let (inner, outer) = (0.3_f32, 0.5_f32);
    let mut scene = floor(8.0, ALBEDO);
    scene.lights = vec![light(LightKind::Spot { inner, outer }, 1.0, 1.0)];
    let [inner, outer] = [inner, outer].map(|x| f64::from(x).cos());
    let radiance = |p: DVec3| {
        let cos = 1.0 / (p - DVec3::Y).length();
        cos.powi(3) * ((cos - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2) * f64::from(ALBEDO) * FRAC_1_PI
    };
    let camera = Camera::look_at("camera", DVec3::new(0.0, 4.0, 4.0), DVec3::ZERO, 0.25);
    let looks = (0..10).map(|i| Look::pixel(camera.clone(), 1001, 500 + 50 * i, 500));
    closed("spot".into(), scene, looks.map(|look| (look.clone(), look.mean_on_floor(radiance))).collect())
}

/// A point light a millionth above a floor of 8 m, seen from five times as high: irradiance I / h². Points of such a floor
/// are known to 2.4e-7 along either axis, half a unit in the last place of its corners, which is a quarter of the height:
/// so the truth is known within (1 + 2/16)^1.5 − 1 = .2.
fn grazed() -> Closed {
    let (height, place) = (1e-6, DVec3::new(1.3, 0.0, 0.7));
    let mut scene = floor(8.0, ALBEDO);
    let above = light(LightKind::Point, 1e-6, height);
    scene.lights =
        vec![jerboa_scenes::Light { to_world: glam::DAffine3::from_translation(place) * above.to_world, ..above }];
    let truth = f64::from(1e-6_f32) / height.powi(2) * f64::from(ALBEDO) * FRAC_1_PI;
    let camera = Camera::look_at("close", place + DVec3::new(0.0, 5.0, 0.5) * height, place, 0.01);
    let looks = vec![(Look::pixel(camera, 101, 50, 50), truth)];
    Closed { facets: 0.2, ..closed("a point light a millionth away".into(), scene, looks) }
}

/// One lux at 30 degrees from the zenith on a floor of this side.
pub(super) fn sun_on(side: f32) -> Closed {
    let mut scene = floor(side, ALBEDO);
    let slant = glam::DAffine3::from_rotation_x(-60_f64.to_radians());
    scene.lights = vec![jerboa_scenes::Light { to_world: slant, ..light(LightKind::Directional, 1.0, 0.0) }];
    let truth = 60_f64.to_radians().sin() * f64::from(ALBEDO) * FRAC_1_PI;
    closed("sun".into(), scene, vec![(origin(DVec3::new(0.0, 1.0, 1.0)), truth)])
}

/// A square of side 1 straight above the origin, front down: corner and edges.
fn above(height: f64) -> [Vec3; 3] {
    [Vec3::new(-0.5, height as f32, -0.5), Vec3::X, Vec3::Z]
}

/// The origin under a parallelogram of radiance 1; `apart` makes its halves two lights.
fn lamp(what: &str, [corner, u, v]: [Vec3; 3], apart: bool) -> Closed {
    let mut scene = floor(8.0, ALBEDO);
    let whole = rectangle(corner, u, v);
    let halves = whole.triangles.chunks(if apart { 1 } else { 2 });
    for triangles in halves {
        let half = Mesh { triangles: triangles.to_vec(), ..whole.clone() };
        place(&mut scene, half, Material::emitter("lamp", [1.0; 3]), 1.0, DVec3::ZERO);
    }
    let corners = [corner, corner + u, corner + u + v, corner + v].map(|p| p.as_dvec3());
    let truth = f64::from(ALBEDO) * form_factor(&corners);
    // From below the lamp, or beside it.
    let height = f64::from(corner.y);
    let eye = if height > 0.0 { DVec3::new(0.0, height / 2.0, height / 2.0) } else { DVec3::new(-0.5, 0.5, 0.5) };
    // Where the squared distance varies a hundredfold over the lamp.
    let is_near = (0.0..0.3).contains(&if height > 0.0 { height } else { f64::from(corner.z.abs()) });
    Closed { is_near, ..closed(format!("lamp {what}"), scene, vec![(origin(eye), truth)]) }
}

/// A square lamp cut into 64, which are lights of a tree.
fn tiles(height: f64) -> Closed {
    const SIDE: usize = 8;
    let [corner, u, v] = above(height);
    let mut whole = lamp(&format!("in 64 tiles at height {height}"), [corner, u, v], false);
    let mut mesh = Mesh { material: whole.scene.meshes[1].material, ..Mesh::default() };
    for i in 0..SIDE * SIDE {
        let [x, y] = [i % SIDE, i / SIDE].map(|k| k as f32 / SIDE as f32);
        let tile = rectangle(corner + u * x + v * y, u / SIDE as f32, v / SIDE as f32);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(tile.positions);
        mesh.triangles.extend(tile.triangles.iter().map(|t| t.map(|k| k + first)));
    }
    whole.scene.meshes[1] = mesh;
    whole
}

/// Share of the light that arrives at the origin of the plane y = 0 from a polygon in y ≥ 0 of radiance 1, by its corners
/// (Lambert 1760; Baum, Rushmeier, Winget 1989, "Improving radiosity solutions through the use of analytically determined
/// form-factors", eq. 6). Corners that see the origin at an angle below 1e-8 are rounded away.
pub fn form_factor(corners: &[DVec3]) -> f64 {
    if corners.iter().all(|p| p.y == 0.0) {
        return 0.0;
    }
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let normal = a.cross(b);
        // The angle between them, without the loss of an arc cosine.
        let angle = normal.length().atan2(a.dot(b));
        if angle > 1e-8 { angle * normal.normalize().y } else { 0.0 }
    };
    (0..corners.len()).map(edge).sum::<f64>().abs() / (2.0 * PI)
}

/// Below a ball: its form factor is (r/d)², and that of a convex body between two balls lies between theirs.
fn ball((radius, distance, effort): (f64, f64, usize)) -> Closed {
    let mut scene = floor(4.0 * distance as f32, ALBEDO);
    let mesh = sphere(ROUND);
    let facets = 1.0 - inradius(&mesh).powi(2);
    place(&mut scene, mesh, Material::emitter("ball", [1.0; 3]), radius, DVec3::Y * distance);
    let truth = f64::from(ALBEDO) * (radius / distance).powi(2);
    let eye = DVec3::new(0.0, 0.05, 1.5) * distance;
    let ball = closed(format!("ball of radius {radius} at {distance}"), scene, vec![(origin(eye), truth)]);
    Closed { facets, effort, is_near: radius > 0.9 * distance, ..ball }
}

/// Straight below a ball of light: its form factor is (r/d)², so irradiance is I / d² whatever its radius.
fn ball_of_light((radius, distance): (f32, f64)) -> Closed {
    let mut scene = floor(8.0 * distance as f32, ALBEDO);
    scene.lights = vec![light(LightKind::Sphere { radius }, 1.0, distance)];
    let truth = f64::from(ALBEDO) * FRAC_1_PI / (distance * distance);
    let eye = DVec3::new(0.0, 0.05, 1.5) * distance;
    closed(format!("ball of light of radius {radius} at {distance}"), scene, vec![(origin(eye), truth)])
}

/// Straight below a disk of light that shines evenly to all sides here: irradiance is I / A times the integral of h / d³ over
/// the disk, 2 I / r² · (1 − h / √(h² + r²)).
fn disk_of_light((radius, height): (f32, f64)) -> Closed {
    let mut scene = floor(8.0, ALBEDO);
    let kind = LightKind::Disk { inner: 1.55, outer: std::f32::consts::FRAC_PI_2, radius };
    scene.lights = vec![light(kind, 1.0, height)];
    let (r2, d) = (f64::from(radius).powi(2), height.hypot(f64::from(radius)));
    // 1 − h / d without its loss.
    let truth = f64::from(ALBEDO) * FRAC_1_PI * 2.0 / (d * (d + height));
    assert!((truth - f64::from(ALBEDO) * FRAC_1_PI * 2.0 / r2 * (1.0 - height / d)).abs() < 1e-9 / r2);
    let eye = DVec3::new(0.0, height / 2.0, height / 2.0);
    let disk = closed(format!("disk of light of radius {radius} at {height}"), scene, vec![(origin(eye), truth)]);
    Closed { is_near: height < 0.3 * f64::from(radius), ..disk }
}

/// One lux of a sun so wide (radians), so many degrees high: what it gives a level plane is what it gives one that faces it,
/// times the sine.
fn wide_sun((angle, elevation): (f32, f64)) -> Closed {
    let mut scene = floor(8.0, ALBEDO);
    let slant = glam::DAffine3::from_rotation_x(-elevation.to_radians());
    scene.lights = vec![jerboa_scenes::Light { to_world: slant, ..light(LightKind::Sun { angle }, 1.0, 0.0) }];
    let truth = elevation.to_radians().sin() * f64::from(ALBEDO) * FRAC_1_PI;
    let looks = vec![(origin(DVec3::new(0.0, 1.0, 1.0)), truth)];
    closed(format!("sun of {angle} radians at {elevation} degrees"), scene, looks)
}

/// A floor under each of the [`maps`], and under a sky that somebody took.
fn skies() -> Vec<Closed> {
    let sky = |(name, map): (&str, Environment)| {
        let mut scene = floor(8.0, ALBEDO);
        let truth = f64::from(ALBEDO) * FRAC_1_PI * sky_irradiance(&map);
        scene.environment = Some(map);
        let looks = vec![(origin(DVec3::new(0.0, 1.0, 1.0)), truth)];
        Closed { effort: 9, ..closed(format!("sky: {name}"), scene, looks) }
    };
    maps().into_iter().chain(real_sky()).map(sky).collect()
}

/// The sky of the breakfast room with its sun, its green for all channels, where the shared scenes are at hand.
fn real_sky() -> Option<(&'static str, Environment)> {
    let mut scene = Scene::default();
    let file = shared_scenes()?.join("breakfast-room/env.hdr");
    scene.set_environment(file, 1.0, 40.0).unwrap_or_else(|e| panic!("{e}"));
    let mut map = scene.environment?;
    map.radiance.iter_mut().for_each(|[r, g, b]| (*r, *b) = (*g, *g));
    Some(("of the breakfast room", map))
}

/// Environment maps: uniform ones, single texels, rows at a pole, and maps of one column or row; turned by 40 degrees.
pub fn maps() -> Vec<(&'static str, Environment)> {
    let map = |width: u32, height: u32, dark: f32, lit: &[(u32, u32, f32)]| {
        let texel = |x, y| lit.iter().find(|l| (l.0, l.1) == (x, y)).map_or(dark, |l| l.2);
        let radiance = (0..width * height).map(|i| [texel(i % width, i / width); 3]).collect();
        Environment { width, height, radiance, intensity: 1.0, rotation_deg: 40.0 }
    };
    let pole: Vec<_> = (0..5).map(|x| (x, 0, 1.0)).collect();
    vec![
        ("one texel all over", map(1, 1, 1.0, &[])),
        ("a uniform map", map(8, 4, 1.0, &[])),
        ("one texel in the dark", map(16, 8, 0.0, &[(3, 2, 100.0)])),
        ("one texel of a million", map(64, 32, 1e-3, &[(20, 9, 1e6)])),
        ("a texel at the seam", map(16, 8, 0.0, &[(0, 1, 1.0)])),
        ("a row at the pole", map(5, 6, 0.0, &pole)),
        ("one column", map(1, 8, 0.0, &[(0, 1, 3.0)])),
        ("one row", map(8, 1, 0.0, &[(3, 0, 2.0)])),
    ]
}

/// Irradiance of a level plane by the upper half of a map, as it is looked up: bilinear, texel centres at half integers,
/// clamped at the poles. Around the zenith the interpolation keeps the mean of a row, and between two rows it is linear in
/// θ: so it is 2π ∫ m(θ) cos θ sin θ dθ, piece by piece in closed form. Green.
pub fn sky_irradiance(map: &Environment) -> f64 {
    let (width, height) = (map.width as usize, map.height as usize);
    let row_mean = |y: isize| {
        let y = y.clamp(0, height as isize - 1) as usize;
        map.radiance[y * width..][..width].iter().map(|t| f64::from(t[1])).sum::<f64>() / width as f64
    };
    // ∫ (a + k θ) sin 2θ / 2 dθ.
    let primitive = |a: f64, k: f64, t: f64| (k * (2.0 * t).sin() / 2.0 - (a + k * t) * (2.0 * t).cos()) / 4.0;
    let step = PI / height as f64;
    let pieces = (-1..height as isize).map(|y| {
        let (start, end) = ((y as f64 + 0.5) * step, (y as f64 + 1.5) * step);
        let k = (row_mean(y + 1) - row_mean(y)) / step;
        let (a, lo, hi) = (row_mean(y) - k * start, start.max(0.0), end.min(PI / 2.0));
        if lo < hi { primitive(a, k, hi) - primitive(a, k, lo) } else { 0.0 }
    });
    2.0 * PI * f64::from(map.intensity) * pieces.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn irradiance_of_skies() {
        let uniform =
            Environment { width: 3, height: 5, radiance: vec![[2.0; 3]; 15], intensity: 0.5, rotation_deg: 0.0 };
        assert!((sky_irradiance(&uniform) - PI).abs() < 1e-12);
        // A tent about θ of half width s, 1/16 of the way around: 2π/16 · sin 2θ / 2 · (1 − cos 2s) / 2s.
        let mut radiance = vec![[0.0; 3]; 16 * 8];
        radiance[2 * 16 + 3] = [100.0; 3];
        let tent = Environment { width: 16, height: 8, radiance, ..uniform };
        let (theta, s) = (2.5 * PI / 8.0, PI / 8.0);
        let truth = 50.0 * PI / 8.0 * (2.0 * theta).sin() / 2.0 * (1.0 - (2.0 * s).cos()) / (2.0 * s);
        assert!((sky_irradiance(&tent) / truth - 1.0).abs() < 1e-12);
    }

    #[test]
    fn lamps_have_the_values_of_the_list() {
        let list =
            [(2.0, 0.036738817), (1.0, 0.119728235), (0.5, 0.277063212), (0.1, 0.484169778), (0.01, 0.499836393)];
        for (height, truth) in list {
            let [corner, u, v] = above(height).map(|p| p.as_dvec3());
            let corners = [corner, corner + u, corner + u + v, corner + v];
            assert!((0.5 * form_factor(&corners) - truth).abs() < 1e-7 * truth.max(0.1), "{height}");
        }
    }

    #[test]
    fn narrow_and_standing_lamps() {
        // A strip of width w at height 1 from -1/2 to 1/2: w/π ∫ dx / (1 + x²)² = w/π (.4 + atan(1/2)).
        let strip = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, z)| DVec3::new(x, 1.0, z * 1e-6));
        let truth = 1e-6 * FRAC_1_PI * (0.4 + 0.5_f64.atan());
        assert!((form_factor(&strip) / truth - 1.0).abs() < 1e-6, "{} {truth}", form_factor(&strip));
        // All of the half space on one side fills half of what a level plane sees.
        let wall = [(-1e6, 0.0), (1e6, 0.0), (1e6, 1e6), (-1e6, 1e6)].map(|(x, y)| DVec3::new(x, y, -1e-3));
        assert!((form_factor(&wall) - 0.5).abs() < 1e-6);
    }
}
