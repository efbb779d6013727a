//! What each kind of camera sees: a glowing ball in the dark, whose image has a known area; a floor that fills the film; and, from
//! within a room that glows, 1 everywhere.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec4};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Lens, Material, Mesh, Scene};

use super::direct::{four_square, sun_on};
use super::enclosures::glowing_box;
use super::{Closed, Look, inradius, place, sphere};

/// Kinds of cameras, each with its scenes.
pub fn seen() -> Vec<Closed> {
    let mut all = vec![
        ball(Lens::Pinhole { yfov: 1.3 }, |angle, half| angle.tan() / half),
        ball(Lens::Fisheye { angle: 1.3 }, |angle, half| angle / half),
        // As wide as the ball, whatever its distance.
        ball(Lens::Orthographic { ymag: 1.3 }, |_, half| 1.0 / half),
    ];
    // Points of the floor, in focus from everywhere on the lens.
    let yfov = 2.0 * (1.0_f64 / 3.0).atan();
    for lens in [Lens::Thin { yfov, aperture: 0.5, focus: 3.0 }, Lens::Orthographic { ymag: 1.0 }] {
        all.push(with_lens(lens, four_square()));
        all.push(with_lens(lens, painted()));
    }
    for lens in [
        Lens::Thin { yfov: 1.2, aperture: 0.3, focus: 0.5 },
        Lens::Orthographic { ymag: 0.3 },
        Lens::Fisheye { angle: TAU },
    ] {
        all.push(with_lens(lens, glowing_box(0.8)));
    }
    all
}

/// The same scene by this lens, which a renderer is made for by the scene's first camera.
fn with_lens(lens: Lens, closed: Closed) -> Closed {
    let Closed { name, mut scene, mut looks, .. } = closed;
    looks.truncate(1);
    looks.iter_mut().for_each(|(look, _)| look.camera.lens = lens);
    scene.cameras = vec![looks[0].0.camera.clone()];
    Closed { name: format!("{name}, {lens:?}"), scene, looks, ..closed }
}

/// A ball of radius 1 from a distance of 2, all of it on the film. `radius` is that of its image, by the angle that the ball takes from
/// its middle and by half the height of the film.
fn ball(lens: Lens, radius: fn(f64, f64) -> f64) -> Closed {
    let mut scene = Scene::default();
    let mesh = sphere(5);
    // The image of a body between two balls lies between theirs; that of a tangent is least precise.
    let facets = 2.0 * (1.0 - inradius(&mesh).powi(2));
    place(&mut scene, mesh, Material::emitter("ball", [1.0; 3]), 1.0, DVec3::ZERO);
    let camera = Camera { lens, ..Camera::look_at("camera", DVec3::new(1.2, 1.6, 0.0), DVec3::ZERO, 1.0) };
    let truth = PI / 4.0 * radius(0.5_f64.asin(), camera.half_height()).powi(2);
    scene.cameras = vec![camera.clone()];
    let looks = vec![(Look::whole(camera), truth)];
    let choices = Choices::default();
    Closed { name: format!("ball, {lens:?}"), scene, looks, facets, choices, is_near: false, effort: 4 }
}

/// All of a square in the sun whose vertices have colours: a triangle's mean is that of its corners.
fn painted() -> Closed {
    let mut painted = sun_on(2.0);
    let Mesh { triangles, colors, .. } = &mut painted.scene.meshes[0];
    let shades = [0.1_f32, 0.9, 0.4, 0.7];
    *colors = Some(shades.map(|c| Vec4::new(c, c, c, 1.0)).to_vec());
    let mean = |t: &[u32; 3]| t.iter().map(|i| f64::from(shades[*i as usize])).sum::<f64>() / 3.0;
    let mean = triangles.iter().map(mean).sum::<f64>() / triangles.len() as f64;
    let eye = Camera::look_at("above", DVec3::Y * 3.0, DVec3::ZERO, 2.0 * (1.0_f64 / 3.0).atan());
    let truth = painted.looks[0].1 * mean;
    Closed { name: "painted square".into(), looks: vec![(Look::whole(eye), truth)], ..painted }
}
