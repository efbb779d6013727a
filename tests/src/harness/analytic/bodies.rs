//! Convex bodies in a uniform sky, and rooms that glow, of every lobe and model whose light has a closed form, and of instances.

use glam::{DAffine3, DVec3};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, DiffuseTransmission, Instance, Material, Model, Scene};

use super::enclosures::{cube, inside, outside, uniform_sky};
use super::{Closed, Look, inside_out, place, sphere};

/// Share of light that is left where some is lost.
const ALBEDO: f32 = 0.8;

/// What keeps all light cannot be seen in a uniform sky; a mirror, and what it is blended with, keep the share that is their
/// colour; a leaf gives back what it reflects and lets out what came in.
pub fn bodies() -> Vec<Closed> {
    let named = |name: &str, colour: f32| {
        let model = Some(Model::named(name));
        Material { model, roughness: 0.0, ..Material::diffuse(name, [colour; 3]) }
    };
    let mut all: Vec<Closed> =
        ["mirror", "dielectric", "plastic", "thin-glass"].map(|name| under_sky(named(name, 1.0))).into();
    all.push(under_sky(Material { roughness: 0.6, ..named("rough-diffuse", 1.0) }));
    let mirror = named("mirror", ALBEDO);
    all.push(glowing("mirrors", mirror.clone(), None));
    let blend = Model::named("blend").with("share", &[0.3]).of([0, 1]);
    let blend = Material { model: Some(blend), ..Material::diffuse("blend", [1.0; 3]) };
    all.push(glowing("blends", blend, Some([mirror, Material::diffuse("paint", [ALBEDO; 3])])));
    all.push(leaf(0.4));
    all.push(leaf(1.0));
    all.push(instances());
    all
}

/// A ball of what keeps all light.
fn under_sky(material: Material) -> Closed {
    let name = material.name.clone();
    let mut scene = Scene { environment: Some(uniform_sky()), ..Scene::default() };
    place(&mut scene, sphere(4), material, 1.0, DVec3::ZERO);
    outside(&format!("ball of {name}"), 1.0, scene)
}

/// A room whose walls give 1 − [`ALBEDO`] and keep [`ALBEDO`]; the first materials of the scene may be parts of theirs.
fn glowing(what: &str, wall: Material, parts: Option<[Material; 2]>) -> Closed {
    let mut scene = Scene { materials: parts.map_or(Vec::new(), Vec::from), ..Scene::default() };
    let emissive = [1.0 - ALBEDO; 3];
    place(&mut scene, inside_out(cube()), Material { emissive, ..wall }, 1.0, DVec3::ZERO);
    inside(&format!("glowing {what}"), ALBEDO, scene, 0.0)
}

/// A hollow box whose walls let this share of the diffuse light through. Within, each wall gives back a share of what it gets from the
/// others, and what comes through: L = ρ ((1 − s) L + s).
fn leaf(share: f32) -> Closed {
    let mut scene = Scene { environment: Some(uniform_sky()), ..Scene::default() };
    let diffuse_transmission = Some(DiffuseTransmission::new(share, [ALBEDO; 3]));
    let leaf = Material { diffuse_transmission, ..Material::diffuse("leaf", [ALBEDO; 3]) };
    place(&mut scene, cube(), leaf, 1.0, DVec3::ZERO);
    let [rho, s] = [ALBEDO, share].map(f64::from);
    let within = rho * s / (1.0 - rho * (1.0 - s));
    let leaf = outside(&format!("leaf of share {share}"), ALBEDO, scene);
    let truth = rho * (1.0 - s) + rho * s * within;
    let mut looks: Vec<_> = leaf.looks.into_iter().map(|(look, _)| (look, truth)).collect();
    let camera = Camera::look_at("within", DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.0, 0.0, -1.0), 1.2);
    looks.push((Look::whole(camera), within));
    Closed { looks, ..leaf }
}

/// Instances of one ball that share its triangles: squeezed and turned, mirrored, small; so far from each other that what one
/// takes of another's sky is a millionth.
fn instances() -> Closed {
    let mut scene = Scene { environment: Some(uniform_sky()), ..Scene::default() };
    place(&mut scene, sphere(4), Material::diffuse("body", [ALBEDO; 3]), 1.0, DVec3::ZERO);
    let squeezed = DAffine3::from_rotation_x(0.7) * DAffine3::from_scale(DVec3::new(0.5, 1.0, 2.0));
    let mirrored = DAffine3::from_translation(DVec3::X * 1e3) * DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let small = DAffine3::from_translation(DVec3::Z * -1e3) * DAffine3::from_scale(DVec3::splat(0.1));
    scene.instances = [squeezed, mirrored, small].map(|to_world| Instance { mesh: 0, to_world }).into();
    let looks = scene.instances.iter().map(|instance| {
        let (middle, size) = (instance.to_world.translation, instance.to_world.matrix3.x_axis.length());
        let eye = middle + DVec3::new(0.3, 0.2, 4.0) * size;
        (Look::whole(Camera::look_at("outside", eye, middle, 0.1)), f64::from(ALBEDO))
    });
    let looks = looks.collect();
    let choices = Choices { most_copies: 0, ..Choices::default() };
    Closed { looks, choices, ..outside("instances", ALBEDO, scene.clone()) }
}
