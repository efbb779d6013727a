//! T13 on the pieces of the library beside those of [`agreement`](crate::agreement): lobes, models, holes, lights of a tree, a
//! lamp with a texture. As there, a right renderer fails a comparison for another seed with a probability of 1 in 800.

use glam::{DVec3, Vec2, Vec3};
use jerboa_scenes::{
    AlphaMode, Anisotropy, Camera, Clearcoat, DiffuseTransmission, Filter, Image, Iridescence, LightKind, Material,
    Mesh, Model, Scene, Sheen, Texture, TextureRef, TextureSource,
};
use jerboa_tests::harness::analytic::{light, place, rectangle};

use crate::agreement::{Case, smooth_ball, under_lamp};
use crate::{LIGHT_SIDES, load};

/// Four balls in place of the one.
fn balls(materials: [Material; 4]) -> Scene {
    let mut scene = under_lamp(smooth_ball(1), Material::default());
    scene.instances.pop();
    for (material, (x, z)) in materials.into_iter().zip([(-0.45, 0.3), (0.45, 0.35), (-0.4, -0.55), (0.5, -0.5)]) {
        place(&mut scene, smooth_ball(1), material, 0.4, DVec3::new(x, 0.45, z));
    }
    scene
}

/// A rectangle with coordinates from 0 to 1 along both edges.
fn sheet(corner: Vec3, u: Vec3, v: Vec3) -> Mesh {
    let uvs = [Some([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(Vec2::from).to_vec()), None];
    Mesh { uvs, ..rectangle(corner, u, v) }
}

/// The texture of this number, by the first coordinates.
fn texture(texture: usize) -> Option<TextureRef> {
    Some(TextureRef { texture, uv_set: 0, transform: None })
}

/// Each lobe on a strip of the ceiling, which alone lights the floor that is seen: the lamp lies in the floor's plane. So all of it
/// came by a lobe, of which paths from the lamp draw a direction and paths from the camera a place on the lamp.
#[test]
fn they_agree_on_lobes() {
    // Dark, so that the layers count.
    let paint = || Material::diffuse("paint", [0.1, 0.07, 0.05]);
    let film = Iridescence::new(0.8, 400.0);
    let mut scene = Scene::default();
    let floor = rectangle(Vec3::new(-1.0, 0.0, 0.0), Vec3::Z * 1.5, Vec3::X * 2.0);
    place(&mut scene, floor, Material::diffuse("floor", [0.7, 0.6, 0.5]), 1.0, DVec3::ZERO);
    let lamp = rectangle(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 0.8, Vec3::X * 2.0);
    place(&mut scene, lamp, Material::emitter("lamp", [10.0; 3]), 1.0, DVec3::ZERO);
    let strips = [
        Material { clearcoat: Some(Clearcoat::new(1.0, 0.5)), ..paint() },
        Material { sheen: Some(Sheen::new([0.9, 0.95, 1.0], 0.5)), ..paint() },
        Material { iridescence: Some(film), ..Material::plastic("film", [0.05, 0.07, 0.1], 0.5) },
        Material { anisotropy: Some(Anisotropy::new(0.8)), ..Material::metal("brushed", [0.2, 0.18, 0.15], 0.4) },
    ];
    for (material, x) in strips.into_iter().zip([-0.7, -0.35, 0.0, 0.35]) {
        let strip = rectangle(Vec3::new(x, 0.7, -1.0), Vec3::X * 0.35, Vec3::Z * 2.5);
        place(&mut scene, strip, material, 1.0, DVec3::ZERO);
    }
    scene.cameras = vec![Camera::look_at("below", DVec3::new(0.0, 0.66, 0.9), DVec3::new(0.0, 0.0, 0.7), 1.3)];
    Case { effort: 2, ..Case::of("lobes", &scene) }.agree(&LIGHT_SIDES);
}

/// A coat that does not have the normal map of what it covers: f is not the same with its directions exchanged. All that is seen
/// is the coat.
#[test]
fn they_agree_on_a_coat_over_a_normal_map() {
    let mut scene = load("mirrored-maps");
    let card = &mut scene.materials[0];
    (card.base_color, card.specular) = ([0.0, 0.0, 0.0, 1.0], 0.0);
    card.clearcoat = Some(Clearcoat::new(1.0, 0.5));
    scene.cameras = vec![Camera::look_at("card", DVec3::Z * 5.0, DVec3::new(-0.85, -0.05, -0.25), 0.15)];
    Case::of("coated normal map", &scene).agree(&LIGHT_SIDES);
}

/// What is under the ball and within it is lit through it.
#[test]
fn they_agree_on_a_leaf() {
    let leaf = DiffuseTransmission::new(0.6, [0.5, 0.8, 0.3]);
    let leaf = Material { diffuse_transmission: Some(leaf), ..Material::plastic("leaf", [0.4, 0.7, 0.2], 0.5) };
    Case { effort: 2, ..Case::of("leaf", &under_lamp(smooth_ball(2), leaf)) }.agree(&LIGHT_SIDES);
}

#[test]
fn they_agree_on_models() {
    let of = |model: Model, roughness: f32| {
        let material = Material { roughness, ..Material::diffuse("model", [0.7, 0.5, 0.4]) };
        Material { model: Some(model), ..material }
    };
    let phong = Model::named("phong").with("ks", &[0.5; 3]).with("ns", &[20.0]);
    let scene = balls([
        of(phong, 1.0),
        of(Model::named("plastic"), 0.5),
        of(Model::named("conductor"), 0.5),
        of(Model::named("rough-diffuse"), 0.7),
    ]);
    Case::of("models", &scene).agree(&LIGHT_SIDES);
    // A sheet between lamp and floor, above the camera: what is smooth is seen by no path from a light. The lamp is large, since paths
    // from the camera find it by chance.
    let mut scene = under_lamp(smooth_ball(1), of(Model::named("rough-diffuse"), 0.7));
    let lamp = rectangle(Vec3::new(-2.0, 2.5, -2.0), Vec3::X * 4.0, Vec3::Z * 4.0);
    scene.meshes[1] = Mesh { material: scene.meshes[1].material, ..lamp };
    let window = Material { ior: 2.0, ..of(Model::named("thin-glass"), 0.0) };
    let sheet = rectangle(Vec3::new(-1.2, 2.0, -0.9), Vec3::X * 1.6, Vec3::Z * 1.8);
    place(&mut scene, sheet, window, 1.0, DVec3::ZERO);
    scene.cameras = vec![Camera::look_at("below", DVec3::new(0.3, 1.2, 2.4), DVec3::new(0.0, 0.3, 0.0), 0.5)];
    Case::of("thin glass", &scene).agree(&LIGHT_SIDES);
}

/// Cards with holes and cards that fade, in the light and seen.
#[test]
fn they_agree_on_holes() {
    let mut scene = under_lamp(smooth_ball(1), Material::plastic("ball", [0.3, 0.7, 0.8], 0.5));
    let rgba = (0..16).map(|i| [255, 255, 255, if (i + i / 4) % 2 == 0 { 230 } else { 40 }]).collect();
    scene.images.push(Image { name: "holes".into(), width: 4, height: 4, rgba });
    scene.textures.push(Texture::repeating("holes", TextureSource::Image(0), Filter::Nearest));
    let card = |alpha_mode: AlphaMode| {
        let card = Material { alpha_mode, double_sided: true, ..Material::diffuse("card", [0.8, 0.5, 0.3]) };
        Material { base_color_texture: texture(0), ..card }
    };
    for (x, mode) in [(-0.9, AlphaMode::Mask(0.5)), (0.1, AlphaMode::Blend)] {
        let sheet = sheet(Vec3::new(x, 1.3, -0.4), Vec3::Z * 0.8, Vec3::X * 0.8);
        place(&mut scene, sheet, card(mode), 1.0, DVec3::ZERO);
    }
    Case::of("holes", &scene).agree(&LIGHT_SIDES);
}

/// So many lights that paths from the camera choose among them by a tree, and paths from lights by power.
#[test]
fn they_agree_on_lights_of_a_tree() {
    let mut scene = under_lamp(smooth_ball(1), Material::plastic("ball", [0.3, 0.7, 0.8], 0.5));
    scene.materials[1].emissive = [0.0; 3];
    for i in 0..15u8 {
        let [x, y, z] = [i % 5, i / 5, i / 5].map(f32::from);
        let corner = Vec3::new(0.7 * x - 1.5, 1.4 + 0.3 * y, 0.8 * z - 0.9);
        let lamp = rectangle(corner, Vec3::X * 0.2, Vec3::Z * 0.2);
        place(&mut scene, lamp, Material::emitter("lamp", [2.0 + f32::from(i); 3]), 1.0, DVec3::ZERO);
    }
    for (i, kind) in
        [LightKind::Point, LightKind::Spot { inner: 0.3, outer: 0.6 }, LightKind::Point].into_iter().enumerate()
    {
        let mut light = light(kind, 0.5, 1.2);
        light.to_world.translation.x = 0.6 * i as f64 - 0.6;
        scene.lights.push(light);
    }
    Case::of("lights of a tree", &scene).agree(&LIGHT_SIDES);
}

/// A lamp that is dark in places and bright in others.
#[test]
fn they_agree_on_a_lamp_with_a_texture() {
    let mut scene = under_lamp(smooth_ball(1), Material::plastic("ball", [0.3, 0.7, 0.8], 0.5));
    let rgba = vec![[255, 255, 255, 255], [40, 40, 40, 255], [0, 0, 0, 255], [90, 160, 230, 255]];
    scene.images.push(Image { name: "picture".into(), width: 2, height: 2, rgba });
    scene.textures.push(Texture::repeating("picture", TextureSource::Image(0), Filter::Bilinear));
    scene.materials[1].emissive_texture = texture(0);
    // Low, so that what is on it tells on the floor.
    let lamp = sheet(Vec3::new(-0.9, 1.4, -0.9), Vec3::X * 1.8, Vec3::Z * 1.8);
    scene.meshes[1] = Mesh { material: scene.meshes[1].material, ..lamp };
    scene.cameras = vec![Camera::look_at("below", DVec3::new(0.3, 1.2, 2.4), DVec3::new(0.0, 0.3, 0.0), 0.5)];
    Case::of("lamp with a texture", &scene).agree(&LIGHT_SIDES);
}
