//! What surfaces can do: materials, a procedural texture.

use super::shapes::{floor, panel, quad, sky, sphere};
use crate::{
    Anisotropy, Clearcoat, DiffuseTransmission, Filter, Iridescence, Material, Mesh, Model, Scene, Sheen, Texture,
    TextureRef, TextureSource, UvTransform,
};
use glam::{Vec3, vec3};

/// A row of balls on a checkerboard under a soft sky: diffuse, plastics, metals from rough to mirror, glass.
pub(super) fn material_balls() -> Scene {
    let mut scene = on_checkerboard();
    let gold = [1.0, 0.78, 0.34];
    let row = [
        Material::diffuse("diffuse", [0.6, 0.2, 0.15]),
        Material::plastic("rough plastic", [0.1, 0.3, 0.6], 0.6),
        Material::plastic("smooth plastic", [0.1, 0.3, 0.6], 0.1),
        Material::metal("rough gold", gold, 0.7),
        Material::metal("brushed gold", gold, 0.35),
        Material::metal("polished gold", gold, 0.1),
        Material::metal("mirror", [1.0; 3], 0.0),
        Material::glass("glass", 1.5),
    ];
    for (i, material) in row.into_iter().enumerate() {
        let material = scene.paint(material);
        scene.place(sphere(vec3(i as f32 * 1.1 - 3.85, 0.5, 0.0), 0.5, 5), material);
    }
    scene.view([0.0, 2.0, 9.0], [0.0, 0.4, 0.0], 0.55, (960, 320));
    scene
}

/// A row of Phong balls, from dull to a highlight a tenth of a degree wide.
pub(super) fn phong() -> Scene {
    let mut scene = on_checkerboard();
    for (i, ns) in [1.0, 10.0, 100.0, 1e4, 1e6].into_iter().enumerate() {
        let model = Some(Model::named("phong").with("ks", &[0.4; 3]).with("ns", &[ns]));
        let material = scene.paint(Material { model, ..Material::diffuse("phong", [0.4, 0.1, 0.1]) });
        scene.place(sphere(vec3(i as f32 * 1.1 - 2.2, 0.5, 0.0), 0.5, 5), material);
    }
    let lamp = scene.paint(Material::emitter("lamp", [30.0; 3]));
    scene.place(panel(vec3(0.0, 3.0, 1.0), 0.5, 0.5), lamp);
    scene.view([0.0, 1.5, 6.0], [0.0, 0.4, 0.0], 0.55, (640, 320));
    scene
}

/// A row of balls, one for each model of scattering that is not glTF's; a board that is gold and plastic by squares, and a
/// window before a part of them.
pub(super) fn models() -> Scene {
    let mut scene = on_checkerboard();
    let of = |name: &str, roughness, rgb: [f32; 3]| {
        let model = Some(Model::named(name));
        Material { model, roughness, ..Material::diffuse(name, rgb) }
    };
    let silver = Model::named("conductor").with("eta", &[0.16, 0.14, 0.13]).with("k", &[4.1, 3.2, 2.4]);
    let row = [
        of("rough-diffuse", 0.8, [0.8, 0.6, 0.4]),
        of("conductor", 0.3, [1.0; 3]),
        Material { model: Some(silver), ..of("silver", 0.0, [1.0; 3]) },
        of("dielectric", 0.3, [0.9, 1.0, 0.9]),
        of("plastic", 0.0, [0.7, 0.1, 0.1]),
        of("plastic", 0.4, [0.1, 0.1, 0.7]),
        of("mirror", 0.0, [0.8, 0.9, 0.8]),
    ];
    let painted: Vec<usize> = row.into_iter().map(|material| scene.paint(material)).collect();
    let squares = UvTransform { offset: [0.0; 2], rotation: 0.0, scale: [4.0; 2] };
    let mask = Some(TextureRef { texture: 0, uv_set: 0, transform: Some(squares) });
    let blend = Model::named("blend").with("share", &[1.0]).of([painted[1], painted[5]]);
    let blend = Material { model: Some(blend), base_color_texture: mask, ..Material::diffuse("blend", [1.0; 3]) };
    let board = scene.paint(blend);
    for (i, material) in painted.into_iter().enumerate() {
        scene.place(sphere(vec3(i as f32 * 1.1 - 3.85, 0.5, 0.0), 0.5, 5), material);
    }
    scene.place(quad(vec3(3.4, 0.0, 0.0), Vec3::X, Vec3::Y), board);
    let window = scene.paint(of("thin-glass", 0.0, [0.8, 1.0, 0.9]));
    scene.place(quad(vec3(-2.2, 0.0, 1.0), Vec3::X * 2.2, Vec3::Y * 0.8), window);
    scene.view([0.0, 2.0, 9.0], [0.0, 0.4, 0.0], 0.55, (960, 320));
    scene
}

/// A row of balls, one for each lobe that glTF's extensions add: lacquered, of cloth, brushed, translucent, iridescent.
pub(super) fn layered() -> Scene {
    let mut scene = on_checkerboard();
    let row = [
        Material {
            clearcoat: Some(Clearcoat::new(1.0, 0.0)),
            metallic: 0.5,
            ..Material::plastic("lacquer", [0.5, 0.03, 0.02], 0.5)
        },
        Material { sheen: Some(Sheen::new([0.5, 0.6, 0.9], 0.4)), ..Material::diffuse("cloth", [0.05, 0.06, 0.15]) },
        Material { anisotropy: Some(Anisotropy::new(0.7)), ..Material::metal("brushed", [0.9, 0.85, 0.8], 0.3) },
        Material {
            diffuse_transmission: Some(DiffuseTransmission::new(0.7, [0.9, 0.5, 0.1])),
            ..Material::plastic("wax", [0.8, 0.75, 0.6], 0.3)
        },
        Material { iridescence: Some(Iridescence::new(1.0, 400.0)), ..Material::metal("soap", [0.3; 3], 0.1) },
    ];
    for (i, material) in row.into_iter().enumerate() {
        let material = scene.paint(material);
        let centre = vec3(i as f32 * 1.1 - 2.2, 0.5, 0.0);
        scene.place(along_parallels(sphere(centre, 0.5, 5), centre), material);
    }
    let lamp = scene.paint(Material { double_sided: true, ..Material::emitter("lamp", [30.0; 3]) });
    scene.place(panel(vec3(0.0, 3.0, 1.0), 0.5, 0.5), lamp);
    scene.place(panel(vec3(1.5, 2.0, -2.0), 0.5, 0.5), lamp);
    scene.view([0.0, 1.5, 6.0], [0.0, 0.4, 0.0], 0.55, (640, 320));
    scene
}

/// A ball whose tangents follow the parallels about the vertical.
fn along_parallels(ball: Mesh, centre: Vec3) -> Mesh {
    let tangent = |p: &Vec3| Vec3::Y.cross(p - centre).normalize_or(Vec3::X).extend(1.0);
    let tangents = Some(ball.positions.iter().map(tangent).collect());
    Mesh { tangents, ..ball }
}

/// White metal balls of roughness 0 and from there on: alpha = roughness² of .0009986 still counts as a mirror,
/// .0010005 (drawn and weighed as a density of 1e6 and more) no longer, then .0025 and .01.
pub(super) fn near_smooth() -> Scene {
    let mut scene = on_checkerboard();
    for (i, roughness) in [0.0, 0.0316, 0.03163, 0.05, 0.1].into_iter().enumerate() {
        let metal = scene.paint(Material::metal("metal", [1.0; 3], roughness));
        scene.place(sphere(vec3(i as f32 * 1.1 - 2.2, 0.5, 0.0), 0.5, 5), metal);
    }
    let lamp = scene.paint(Material::emitter("lamp", [30.0; 3]));
    scene.place(panel(vec3(0.0, 3.0, 1.0), 0.5, 0.5), lamp);
    scene.view([0.0, 1.5, 6.0], [0.0, 0.4, 0.0], 0.55, (640, 320));
    scene
}

/// White, mirroring and glass balls that reflect or pass all light, in light that is 1 from everywhere: they cannot be seen.
pub(super) fn white_furnace() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let row =
        [Material::diffuse("white", [1.0; 3]), Material::metal("mirror", [1.0; 3], 0.0), Material::glass("glass", 1.5)];
    for (i, material) in row.into_iter().enumerate() {
        let material = scene.paint(material);
        scene.place(sphere(vec3(i as f32 * 1.1 - 1.1, 0.0, 0.0), 0.5, 4), material);
    }
    scene.view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 0.4, (384, 192));
    scene
}

/// A floor of squares under a sky, nothing else: the texture's antialiasing towards the horizon.
pub(super) fn checkerboard() -> Scene {
    let mut scene = on_checkerboard();
    scene.view([0.0, 1.0, 6.0], [0.0, 0.5, 0.0], 0.8, (512, 384));
    scene
}

/// A floor of squares under a soft sky.
pub(super) fn on_checkerboard() -> Scene {
    let mut scene = Scene { environment: Some(sky(64, soft_sky)), ..Scene::default() };
    let squares = TextureSource::Checkerboard { even: [0.7; 3], odd: [0.15; 3] };
    scene.textures.push(Texture::repeating("squares", squares, Filter::Nearest));
    let squares = UvTransform { offset: [0.0; 2], rotation: 0.0, scale: [40.0; 2] };
    let texture = TextureRef { texture: 0, uv_set: 0, transform: Some(squares) };
    let board = Material { base_color_texture: Some(texture), ..Material::diffuse("board", [1.0; 3]) };
    let board = scene.paint(board);
    scene.place(floor(Vec3::ZERO, 20.0, 20.0), board);
    scene
}

fn soft_sky(d: Vec3) -> [f32; 3] {
    let t = d.y.max(0.0);
    [1.0 - 0.6 * t, 1.0 - 0.4 * t, 1.0]
}
