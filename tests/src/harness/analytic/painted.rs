//! Direct light of lamps whose radiance is a texture: each square of it is a lamp of its own, whose form factor is known.

use std::f64::consts::TAU;

use glam::{DVec3, Vec2, Vec3};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Filter, Image, Material, Mesh, Scene, Texture, TextureRef, TextureSource, UvTransform};

use super::direct::{ALBEDO, closed, floor, form_factor, origin};
use super::{Closed, place, rectangle};

/// Radiance of a checkerboard's squares, `even` and `odd`.
const SQUARES: [f32; 2] = [1.0, 0.25];
/// sRGB codes of an image of three by two texels, the upper row first.
const CODES: [u8; 6] = [255, 128, 60, 0, 188, 220];

/// Lamps above and beside the origin, so that no two of their squares are alike.
pub(super) fn painted() -> Vec<Closed> {
    let corner = Vec3::new(-0.8, 1.0, -0.3);
    let down = [corner, Vec3::X, Vec3::Z * 0.9];
    let mut all = vec![
        checkered("checkered lamp", down, [2, 1], |_, _| ()),
        checkered("checkered lamp of many squares", down, [5, 4], |_, _| ()),
        checkered("checkered lamp in two halves", down, [2, 3], |scene, mesh| {
            mesh.triangles.truncate(1);
            let half = Mesh { triangles: vec![[0, 2, 3]], ..mesh.clone() };
            let material = scene.materials[1].clone();
            place(scene, half, material, 1.0, DVec3::ZERO);
        }),
        checkered("checkered lamp by its back", [corner, Vec3::Z * 0.9, Vec3::X], [3, 2], |scene, _| {
            scene.materials[1].double_sided = true;
        }),
        // The coordinates of the texture are twice and three times those of the mesh.
        checkered("checkered lamp of larger coordinates", down, [2, 3], |scene, mesh| {
            let scale = [2.0, 3.0];
            mesh.uvs[0].iter_mut().flatten().for_each(|uv| *uv /= Vec2::from(scale));
            let transform = Some(UvTransform { offset: [0.0; 2], rotation: 0.0, scale });
            scene.materials[1].emissive_texture.iter_mut().for_each(|texture| texture.transform = transform);
        }),
        pictured(down),
        disk(),
    ];
    let near = [Vec3::new(-0.8, 0.1, -0.3), Vec3::X, Vec3::Z * 0.9];
    // The texel above the origin sends most of the light: who looks for it elsewhere on the lamp finds another one. Where two
    // triangles share their shortest side, neither begins at a corner of the lamp.
    for (how, across) in [("narrow", 1.0), ("wide", 1.3)] {
        let lamp = pictured([Vec3::new(-0.3, 0.1, -0.45), Vec3::X * across, Vec3::new(-0.6, 0.0, 0.9)]);
        let (name, choices) =
            (format!("lamp with a {how} slanted picture"), Choices { solid_angle: true, ..lamp.choices });
        all.push(Closed { name, choices, is_near: true, effort: 9, ..lamp });
    }
    for (how, solid_angle) in [("by area", false), ("by solid angle", true)] {
        let lamp = checkered(&format!("checkered lamp at height 0.1, {how}"), near, [2, 1], |_, _| ());
        let choices = Choices { solid_angle, ..lamp.choices };
        all.push(Closed { choices, is_near: true, effort: 9, ..lamp });
    }
    all
}

/// A lamp of radiance 1, times the texture 0 by the first coordinates.
fn emitter() -> Material {
    let emissive_texture = Some(TextureRef { texture: 0, uv_set: 0, transform: None });
    Material { emissive_texture, ..Material::emitter("lamp", [1.0; 3]) }
}

/// The origin of a floor under a mesh that shines by a texture; polygons of it and what they shine with.
fn lamp(name: &str, mesh: Mesh, source: TextureSource, parts: &[(Vec<DVec3>, f64)]) -> Closed {
    let mut scene = floor(8.0, ALBEDO);
    scene.textures.push(Texture::repeating("paint", source, Filter::Nearest));
    place(&mut scene, mesh, emitter(), 1.0, DVec3::ZERO);
    let light: f64 = parts.iter().map(|(corners, radiance)| radiance * form_factor(corners)).sum();
    // From below the lamp, and from the side.
    let looks = vec![(origin(DVec3::new(0.0, 0.04, 0.5)), f64::from(ALBEDO) * light)];
    Closed { effort: 4, ..closed(name.into(), scene, looks) }
}

fn checkerboard() -> TextureSource {
    let [even, odd] = SQUARES.map(|x| [x; 3]);
    TextureSource::Checkerboard { even, odd }
}

/// Squares of a parallelogram, `across` along u and `down` along v, each with its radiance by column and row.
fn squares(
    [corner, u, v]: [Vec3; 3],
    [across, down]: [u32; 2],
    of: impl Fn(u32, u32) -> f64,
) -> Vec<(Vec<DVec3>, f64)> {
    let at = |i: u32, j: u32| {
        let [i, j] = [i as f32 / across as f32, j as f32 / down as f32].map(f64::from);
        corner.as_dvec3() + u.as_dvec3() * i + v.as_dvec3() * j
    };
    let square = |i: u32, j: u32| (vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], of(i, j));
    (0..across).flat_map(|i| (0..down).map(move |j| (i, j))).map(|(i, j)| square(i, j)).collect()
}

/// A parallelogram whose coordinates go from 0 to these numbers along its edges.
fn sheet([corner, u, v]: [Vec3; 3], [across, down]: [u32; 2]) -> Mesh {
    let mut mesh = rectangle(corner, u, v);
    let (across, down) = (across as f32, down as f32);
    mesh.uvs[0] = Some([(0.0, 0.0), (across, 0.0), (across, down), (0.0, down)].map(Vec2::from).to_vec());
    mesh
}

/// A parallelogram of so many squares of the checkerboard, and a change that keeps what it sends.
fn checkered(name: &str, place: [Vec3; 3], size: [u32; 2], change: impl Fn(&mut Scene, &mut Mesh)) -> Closed {
    let parts = squares(place, size, |i, j| f64::from(SQUARES[(i + j) as usize % 2]));
    let mut closed = lamp(name, sheet(place, size), checkerboard(), &parts);
    let mut mesh = std::mem::take(&mut closed.scene.meshes[1]);
    change(&mut closed.scene, &mut mesh);
    closed.scene.meshes[1] = mesh;
    closed
}

/// An image in sRGB, its upper row where v is 0.
fn pictured(place: [Vec3; 3]) -> Closed {
    let linear = |code: u8| {
        let s = f64::from(code) / 255.0;
        if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
    };
    let parts = squares(place, [3, 2], |i, j| linear(CODES[(3 * j + i) as usize]));
    let mut closed = lamp("lamp with a picture", sheet(place, [1, 1]), TextureSource::Image(0), &parts);
    let rgba = CODES.map(|code| [code, code, code, 255]).to_vec();
    closed.scene.images.push(Image { name: "picture".into(), width: 3, height: 2, rgba });
    closed
}

/// A round lamp of 24 triangles, which are lights of a tree; its left half is dimmer than the right.
fn disk() -> Closed {
    const CORNERS: usize = 24;
    let middle = Vec3::new(-0.4, 0.7, 0.2);
    let at = |k: usize| {
        let (sin, cos) = (k as f64 / CORNERS as f64 * TAU).sin_cos();
        // 0 to the bit where the halves meet.
        middle + Vec3::new(if k % (CORNERS / 2) == CORNERS / 4 { 0.0 } else { cos as f32 }, 0.0, sin as f32) * 0.6
    };
    let positions: Vec<Vec3> = std::iter::once(middle).chain((0..CORNERS).map(at)).collect();
    let triangles = (0..CORNERS as u32).map(|k| [0, 1 + k, 1 + (k + 1) % CORNERS as u32]).collect();
    let uvs = [Some(positions.iter().map(|p| Vec2::new(p.x - middle.x, 0.5)).collect()), None];
    let half = |first: usize| (0..=CORNERS / 2).map(|k| at((first + k) % CORNERS).as_dvec3()).collect();
    // u is from 0 to 1 at the right, from -1 to 0 at the left.
    let [even, odd] = SQUARES.map(f64::from);
    let parts = [(half(3 * CORNERS / 4), even), (half(CORNERS / 4), odd)];
    lamp("round checkered lamp", Mesh { positions, triangles, uvs, ..Mesh::default() }, checkerboard(), &parts)
}
