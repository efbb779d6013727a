//! Pairs of scenes whose images are known to be related (accuracy.md, T11, T15): the same bits, or the same mean.
//!
//! A row of [`CHANGES`] adds a change to the test of every scene. The two changes that keep all bits are functions of an
//! exponent, [`scaled`] and [`brighter`].

use glam::{DAffine3, DMat3, DVec3, Vec3};
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::image_io::luminance;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::student::two_sided_quantile;
use jerboa_lib_render::host::tables::{Choices, Pass};
use jerboa_scenes::*;

use super::analytic::{place, rectangle};
use super::stats::{mean, sidak};

/// The scene, 2^k times as large, with lights that make it look the same: power per area is kept.
pub fn scaled(scene: &Scene, k: i32) -> Scene {
    let (s, mut scene) = (2.0_f64.powi(k), scene.clone());
    moved(&mut scene, DAffine3::from_scale(DVec3::splat(s)));
    for light in &mut scene.lights {
        if !matches!(light.kind, LightKind::Directional | LightKind::Sun { .. }) {
            light.intensity = light.intensity.map(|i| i * (s * s) as f32);
        }
        if let LightKind::Sphere { radius } | LightKind::Disk { radius, .. } = &mut light.kind {
            *radius *= s as f32;
        }
    }
    scene.materials.iter_mut().filter_map(|m| m.volume.as_mut()).for_each(|v| v.attenuation_distance *= s as f32);
    scene
}

/// The scene with 2^k times the light.
pub fn brighter(scene: &Scene, k: i32) -> Scene {
    let (s, mut scene) = (2.0_f32.powi(k), scene.clone());
    scene.materials.iter_mut().for_each(|m| m.emissive = m.emissive.map(|e| e * s));
    scene.lights.iter_mut().for_each(|l| l.intensity = l.intensity.map(|i| i * s));
    scene.environment.iter_mut().for_each(|e| e.intensity *= s);
    scene
}

/// Moves everything that has a place.
fn moved(scene: &mut Scene, by: DAffine3) {
    scene.instances.iter_mut().for_each(|i| i.to_world = by * i.to_world);
    scene.lights.iter_mut().for_each(|l| l.to_world = by * l.to_world);
    scene.cameras.iter_mut().for_each(|c| c.to_world = by * c.to_world);
}

/// A change of a scene that keeps the mean of its image.
pub struct Change {
    /// What tests call it.
    pub name: &'static str,
    /// The changed scene, or `None` where the change does not apply.
    pub make: fn(&Scene) -> Option<Scene>,
}

/// The changes that keep the mean.
pub const CHANGES: [Change; 6] = [
    Change { name: "each triangle split in two", make: |scene| Some(split(scene)) },
    Change { name: "objects, triangles and lights in reverse", make: |scene| Some(reversed(scene)) },
    Change { name: "turned by a quarter about y", make: |scene| Some(turned(scene)) },
    Change { name: "x, y, z in place of y, z, x", make: cycled },
    Change { name: "moved by 1e3", make: |scene| Some(translated(scene, 1e3)) },
    Change { name: "moved by 1e6", make: |scene| Some(translated(scene, 1e6)) },
];

/// The scene moved by so much along each axis.
pub fn translated(scene: &Scene, by: f64) -> Scene {
    let mut scene = scene.clone();
    moved(&mut scene, DAffine3::from_translation(DVec3::splat(by)));
    scene
}

fn turned(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    // x' = z, z' = -x, as a positive rotation of the environment turns it.
    moved(&mut scene, DAffine3::from_mat3(DMat3::from_cols(-DVec3::Z, DVec3::Y, DVec3::X)));
    scene.environment.iter_mut().for_each(|e| e.rotation_deg += 90.0);
    scene
}

/// Not where an environment tells the axes apart.
fn cycled(scene: &Scene) -> Option<Scene> {
    let uniform = |e: &Environment| e.radiance.iter().all(|r| *r == e.radiance[0]);
    let mut scene = scene.clone();
    moved(&mut scene, DAffine3::from_mat3(DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X)));
    scene.environment.as_ref().is_none_or(uniform).then_some(scene)
}

fn reversed(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let last = scene.meshes.len().saturating_sub(1);
    scene.meshes.reverse();
    scene.meshes.iter_mut().for_each(|m| m.triangles.reverse());
    scene.instances.reverse();
    scene.instances.iter_mut().for_each(|i| i.mesh = last - i.mesh);
    scene.lights.reverse();
    scene
}

/// Every triangle cut from the middle of its longest side to the corner opposite.
fn split(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for mesh in &mut scene.meshes {
        let whole = std::mem::take(&mut mesh.triangles);
        for t in whole {
            let side = |i: usize| mesh.positions[t[i] as usize].distance(mesh.positions[t[(i + 1) % 3] as usize]);
            let longest = (0..3).fold(0, |best, i| if side(i) > side(best) { i } else { best });
            let [a, b, c] = [0, 1, 2].map(|i| t[(longest + i) % 3]);
            let middle = halve(mesh, a as usize, b as usize);
            mesh.triangles.extend([[a, middle, c], [middle, b, c]]);
        }
    }
    scene
}

/// A new vertex in the middle of two; gives its number. Attributes stay linear along the side.
fn halve(mesh: &mut Mesh, a: usize, b: usize) -> u32 {
    mesh.positions.push(mesh.positions[a].midpoint(mesh.positions[b]));
    let normals = mesh.normals.iter_mut();
    normals.for_each(|n| n.push((n[a] + n[b]) / 2.0));
    mesh.tangents.iter_mut().for_each(|t| t.push((t[a] + t[b]) / 2.0));
    mesh.uvs.iter_mut().flatten().for_each(|uv| uv.push((uv[a] + uv[b]) / 2.0));
    mesh.colors.iter_mut().for_each(|c| c.push((c[a] + c[b]) / 2.0));
    mesh.positions.len() as u32 - 1
}

/// A room with every kind of light, surface and lookup: area, point, spot and directional lights, a sphere, a disk and a sun, an
/// environment, metal, glass that absorbs, a texture and normal maps, each lobe and some models. One scene, so that a test needs to compile for one only.
pub fn medley() -> Scene {
    let load = |name: &str| Scene::load(format!("builtin:{name}")).expect("it is built in");
    let mut scene = load("cornell-box");
    let with = load("environment");
    scene.environment = with.environment;
    scene.environment.iter_mut().for_each(|e| e.intensity = 0.2);
    let (inner, outer) = (0.3, 0.6);
    let kinds = [
        LightKind::Point,
        LightKind::Spot { inner, outer },
        LightKind::Directional,
        LightKind::Sphere { radius: 0.1 },
        LightKind::Disk { inner, outer, radius: 0.1 },
        LightKind::Sun { angle: 0.1 },
    ];
    for (i, kind) in kinds.into_iter().enumerate() {
        let at = DVec3::new(0.4 * (i % 3) as f64 - 0.4, 1.5 - 0.3 * (i / 3) as f64, 0.6);
        let to_world = DAffine3::from_translation(at) * DAffine3::from_rotation_x(-1.2);
        scene.lights.push(Light { name: "light".into(), kind, intensity: [0.5; 3], to_world });
    }
    let bumps = |x: u32, y: u32| [100 + 14 * (x % 5) as u8, 90 + 18 * (y % 4) as u8, 240, 255];
    let stripes = |x: u32, y: u32| [40 * (x % 6) as u8, 200, 50 * (y % 5) as u8, 255];
    let [bumps, stripes] = [image(bumps), image(stripes)].map(|image| {
        scene.images.push(image);
        let source = TextureSource::Image(scene.images.len() - 1);
        let texture = Texture { wrap_t: Wrap::Mirror, ..Texture::repeating("texture", source, Filter::Bilinear) };
        scene.textures.push(texture);
        Some(TextureRef { texture: scene.textures.len() - 1, uv_set: 0, transform: None })
    });
    // The floor is bumpy. Not all that is white: the boxes have no texture coordinates, so no frame of their own.
    scene.materials.push(Material { normal_texture: bumps, ..scene.materials[0].clone() });
    scene.meshes[0].material = scene.materials.len() - 1;
    scene.materials[1].base_color_texture = stripes;
    with_lobes(&mut scene, bumps);
    let balls = load("environment").meshes.pop().expect("a ball");
    let metal = Material::metal("metal", [0.9, 0.6, 0.3], 0.4);
    let mut glass = Material::glass("glass", 1.5);
    glass.volume.iter_mut().for_each(|v| (v.attenuation_distance, v.attenuation_color) = (0.5, [0.9, 0.5, 0.3]));
    for (i, material) in [metal, glass].into_iter().enumerate() {
        scene.materials.push(material);
        scene.meshes.push(Mesh { material: scene.materials.len() - 1, ..balls.clone() });
        let to_world = DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.5),
            Default::default(),
            DVec3::new(0.5 - i as f64, 0.7 - 0.4 * i as f64, 0.5),
        );
        scene.instances.push(Instance { mesh: scene.meshes.len() - 1, to_world });
    }
    Scene { name: "medley".into(), ..scene }
}

/// A room's floor coated, its ceiling of another model, its back of cloth, the right wall brushed and filmed, the boxes a leaf and a
/// model; `bumps` are the coat's.
fn with_lobes(scene: &mut Scene, bumps: Option<TextureRef>) {
    let floor = scene.meshes[0].material;
    let coat = Clearcoat { normal_texture: bumps, normal_scale: 0.5, ..Clearcoat::new(0.8, 0.4) };
    scene.materials[floor].clearcoat = Some(coat);
    let brushed = Material {
        anisotropy: Some(Anisotropy { rotation: 0.5, ..Anisotropy::new(0.6) }),
        iridescence: Some(Iridescence::new(0.8, 400.0)),
        ..Material::plastic("brushed", [0.14, 0.45, 0.09], 0.5)
    };
    let leaf = DiffuseTransmission::new(0.5, [0.6, 0.7, 0.2]);
    let of = |name: &str| Material { model: Some(Model::named(name)), ..Material::plastic(name, [0.7, 0.6, 0.5], 0.4) };
    for (mesh, material) in [
        (1, of("rough-diffuse")),
        (2, Material { sheen: Some(Sheen::new([0.4, 0.5, 0.6], 0.5)), ..Material::diffuse("cloth", [0.5, 0.3, 0.2]) }),
        (4, brushed),
        (6, Material { diffuse_transmission: Some(leaf), ..Material::plastic("leaf", [0.4, 0.6, 0.2], 0.5) }),
        (7, of("phong")),
    ] {
        scene.materials.push(material);
        scene.meshes[mesh].material = scene.materials.len() - 1;
    }
}

fn image(texel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
    let rgba = (0..64).map(|i| texel(i % 8, i / 8)).collect();
    Image { name: "image".into(), width: 8, height: 8, rgba }
}

/// A room around zero whose numbers are all multiples of 1/64: instances of a pyramid, turned and mirrored, enough lamps and points
/// of light for a tree, a spot and a sun; lobes on all of it, and a card of another model.
pub fn dyadic() -> Scene {
    let mut scene = Scene { name: "dyadic".into(), ..Scene::default() };
    let room = rectangle(Vec3::new(-2.0, -2.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    let coat = Some(Clearcoat::new(0.75, 0.25));
    let floor = Material { clearcoat: coat, ..Material::diffuse("floor", [0.75, 0.5, 0.25]) };
    place(&mut scene, room, floor, 1.0, DVec3::ZERO);
    let wall_mesh = rectangle(Vec3::new(-2.0, -2.0, -2.0), Vec3::X * 4.0, Vec3::Y * 4.0);
    let (sheen, iridescence) = (Some(Sheen::new([0.25; 3], 0.5)), Some(Iridescence::new(0.75, 400.0)));
    let wall = Material { sheen, iridescence, ..Material::plastic("wall", [0.25, 0.5, 0.75], 0.5) };
    place(&mut scene, wall_mesh, wall, 1.0, DVec3::ZERO);
    let card = rectangle(Vec3::new(-1.5, -1.5, 0.0), Vec3::X, Vec3::Y);
    let leaf = Some(DiffuseTransmission::new(0.5, [0.5; 3]));
    let leaf = Material { diffuse_transmission: leaf, ..Material::diffuse("leaf", [0.25, 0.5, 0.25]) };
    place(&mut scene, card.clone(), leaf, 1.0, DVec3::ZERO);
    let phong = Material { model: Some(Model::named("phong")), ..Material::diffuse("phong", [0.25, 0.5, 0.25]) };
    place(&mut scene, card, phong, 1.0, DVec3::new(2.0, 0.0, -0.5));
    let lamp = rectangle(Vec3::new(-0.5, 2.0, -0.5), Vec3::X, Vec3::Z);
    place(&mut scene, lamp, Material::emitter("lamp", [4.0; 3]), 1.0, DVec3::ZERO);
    // It reaches as far to the front as the room does to the back, and so the middle is zero.
    let corners = [[0.0, 0.5, 0.0], [-0.5, -0.25, -0.5], [0.5, -0.25, -0.5], [0.0, -0.25, 0.5]].map(Vec3::from);
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    let pyramid = Mesh { positions: corners.to_vec(), triangles, ..Mesh::default() };
    let brushed = Material { anisotropy: Some(Anisotropy::new(0.75)), ..Material::metal("pyramid", [0.75; 3], 0.5) };
    place(&mut scene, pyramid, brushed, 1.0, DVec3::new(0.0, -1.0, 1.5));
    let mesh = scene.meshes.len() - 1;
    for (at, axes) in [
        (DVec3::new(-1.0, 0.5, -1.0), DMat3::from_cols(DVec3::Z, DVec3::Y, -DVec3::X)),
        (DVec3::new(1.0, 0.25, -0.5), DMat3::from_cols(-DVec3::X, DVec3::Y, DVec3::Z)),
        (DVec3::new(0.5, -1.5, 0.0), DMat3::from_diagonal(DVec3::new(0.5, 1.0, 2.0) * 0.5)),
    ] {
        let to_world = DAffine3 { matrix3: axes, translation: at };
        scene.instances.push(Instance { mesh, to_world });
    }
    let down = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
    let spot = LightKind::Spot { inner: 0.25, outer: 0.5 };
    let kinds = [spot, LightKind::Directional].into_iter().chain([LightKind::Point; 20]);
    for (i, kind) in kinds.enumerate() {
        let at = DVec3::new((i % 5) as f64 * 0.75 - 1.5, 1.5, (i / 5) as f64 * 0.5 - 1.0);
        let to_world = DAffine3 { matrix3: down, translation: at };
        scene.lights.push(Light { name: "light".into(), kind, intensity: [0.25; 3], to_world });
    }
    let to_world = DAffine3::from_translation(DVec3::new(0.25, -0.25, 1.75));
    let lens = Lens::Pinhole { yfov: 0.75 };
    scene.cameras = vec![Camera { name: "camera".into(), to_world, lens, aspect: None, film: None }];
    scene
}

/// The words of all samples of a small film.
pub fn words(scene: &Scene, side: u32, samples: u32) -> Vec<u32> {
    words_by(scene, Choices::default(), side, samples)
}

/// Those of a render that asks for this.
pub fn words_by(scene: &Scene, choices: Choices, side: u32, samples: u32) -> Vec<u32> {
    let options = Options { choices, ..Options::default() };
    let renderer = Renderer::new(scene, options).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    render(&renderer, &scene.camera_or_default(), side, samples, 0)
}

fn render(renderer: &Renderer, camera: &Camera, side: u32, samples: u32, seed: u32) -> Vec<u32> {
    let window = Window { x: 0, y: 0, width: side, height: side };
    let pass = Pass { size: [side; 2], window, sample: 0, samples, seed };
    renderer.samples(camera, &pass).unwrap_or_else(|e| panic!("{e}"))
}

/// Renders of a scene with a seed each: means of blocks of pixels, by block and render.
pub struct Renders {
    blocks: Vec<Vec<f64>>,
}

/// Blocks along a side of the film.
const BLOCKS: u32 = 4;
/// Side of a block in pixels.
const BLOCK: u32 = 15;
/// Renders of each scene: with 31 on both sides Student's t has 60 degrees of freedom.
const RENDERS: u32 = 31;

impl Renders {
    /// Renders a scene; seeds begin with `seed`.
    pub fn new(scene: &Scene, samples: u32, seed: u32) -> Renders {
        let renderer = Renderer::new(scene, Options::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        let camera = scene.camera_or_default();
        let side = BLOCKS * BLOCK;
        let mut blocks = vec![vec![0.0; RENDERS as usize]; (BLOCKS * BLOCKS) as usize];
        for k in 0..RENDERS {
            let words = render(&renderer, &camera, side, samples, seed + k);
            let items = (side * side * samples) as usize;
            for i in 0..items {
                let pixel = i as u32 / samples;
                let block = pixel / side / BLOCK * BLOCKS + pixel % side / BLOCK;
                let rgb = [0, 1, 2].map(|c| f32::from_bits(words[c * items + i]));
                blocks[block as usize][k as usize] += luminance(rgb) / f64::from(BLOCK * BLOCK * samples);
            }
        }
        Renders { blocks }
    }

    /// The largest |t| over the blocks and over the whole, and the value that it exceeds with probability `family` where
    /// both have the same mean (Šidák; Student's t with 60 degrees of freedom).
    pub fn distance(&self, other: &Renders, family: f64) -> (f64, f64) {
        let whole = |r: &Renders| (0..RENDERS as usize).map(|k| r.blocks.iter().map(|b| b[k]).sum::<f64>()).collect();
        let pairs = self.blocks.iter().cloned().zip(other.blocks.iter().cloned());
        let t = pairs.chain([(whole(self), whole(other))]).map(|(a, b): (Vec<f64>, Vec<f64>)| {
            let ((a, ea), (b, eb)) = (mean(a), mean(b));
            // Equal values without any spread agree.
            if a == b { 0.0 } else { (a - b).abs() / ea.hypot(eb) }
        });
        let most = t.fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a });
        (most, two_sided_quantile(2 * RENDERS - 2, 1.0 - sidak(family, self.blocks.len() + 1)))
    }

    /// The renders, darker by this share.
    pub fn darker(mut self, share: f64) -> Renders {
        self.blocks.iter_mut().flatten().for_each(|x| *x *= 1.0 - share);
        self
    }
}
