//! What T25 looks at: scenes with the choices of a render, a tracer and a device, whose residuals hold what they use and
//! nothing else.
//!
//! Every built-in scene as a path tracer sees it, on both devices of the CPU; and for what no built-in scene has, or no path
//! tracer, a scene or a choice made here.

use glam::{DAffine3, DVec3, Vec2};
use jerboa_ir::Program;
use jerboa_ir::lang::Fun;
use jerboa_lib_render::bsdf::models::{MODELS, Model as BsdfModel};
use jerboa_lib_render::components::{Components, Own, Parameter};
use jerboa_lib_render::core::color::gray;
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::host::device::{DeviceKind, Traversal};
use jerboa_lib_render::host::generate::{Keep, TracerKind, residual};
use jerboa_lib_render::host::library::Library;
use jerboa_lib_render::host::tables::{CameraKind, Choices, Known, SamplerKind, Tables};
use jerboa_lib_render::image::Texel;
use jerboa_lib_render::light::point::{make_point_light, sample_place};
use jerboa_lib_render::light::{Light, strength};
use jerboa_scenes::{
    Anisotropy, Clearcoat, DiffuseTransmission, Filter, Image, Instance, Iridescence, Lens, LightKind, Material, Mesh,
    Model, Scene, Sheen, Texture, TextureRef, TextureSource, Volume, Wrap, builtin,
};

/// A scene, and how it is rendered.
pub struct Subject {
    /// What it is, for messages.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// Choices of the render.
    pub choices: Choices,
    /// What is shown.
    pub tracer: TracerKind,
    /// By which device.
    pub device: DeviceKind,
    library: Library,
}

impl Subject {
    fn new(scene: &Scene, device: DeviceKind, tracer: TracerKind) -> Subject {
        let name = format!("{}, {device:?}, {}", scene.name, tracer.kernel());
        let (choices, library) = (Choices::default(), Library::standard().clone());
        Subject { name, scene: scene.clone(), choices, tracer, device, library }
    }

    /// A path tracer on the device that has all of it in one kernel.
    fn of(scene: &Scene) -> Subject {
        Subject::new(scene, DeviceKind::CpuScalar, TracerKind::Path)
    }

    fn choosing(self, what: &str, choices: Choices) -> Subject {
        Subject { name: format!("{}, {what}", self.name), choices, ..self }
    }

    /// The kind of the camera.
    pub fn camera(&self) -> CameraKind {
        self.choices.camera.unwrap_or_else(|| CameraKind::of_scene(&self.scene))
    }

    /// Does it show light that surfaces have scattered?
    pub fn shows_light(&self) -> bool {
        self.tracer == TracerKind::Path || self.tracer.is_splatting()
    }

    /// The residuals of all its kernels, with so much of the scene known: name and program.
    ///
    /// # Panics
    /// When there is none: a fault of Jerboa.
    pub fn residuals(&self, known: Known) -> Vec<(String, Program)> {
        let tables = Tables::of(&self.library, &self.scene, &self.choices, known, Traversal::Ir);
        let requests = self.device.requests(&tables, self.tracer);
        let program = |request| {
            residual(&tables, request, Keep::default()).unwrap_or_else(|e| panic!("{}: {e}", self.name)).program
        };
        requests.iter().map(|request| (request.name.clone(), program(request))).collect()
    }
}

/// All of them.
pub fn subjects() -> Vec<Subject> {
    let built_in: Vec<Scene> = builtin::list().iter().map(|b| load(b.name)).collect();
    let everywhere = |scene| DeviceKind::CPU.map(|device| Subject::new(scene, device, TracerKind::Path));
    let mut all: Vec<Subject> = built_in.iter().flat_map(everywhere).collect();
    all.extend([painted(), every_texture()].iter().map(Subject::of));
    all.extend(MODELS.iter().skip(1).map(|model| Subject::of(&alone(model))));
    all.push(own());
    let room = load("cornell-box");
    all.extend([DeviceKind::GpuMegakernel, DeviceKind::GpuWavefront].map(|d| Subject::new(&room, d, TracerKind::Path)));
    for lens in LENSES {
        let mut scene = room.clone();
        scene.cameras[0].lens = lens;
        all.push(Subject { name: format!("{lens:?}"), ..Subject::of(&scene) });
    }
    all.extend(pictures().iter().map(Subject::of));
    all.push(Subject::of(&unlit()));
    all.extend([TracerKind::Path, TracerKind::Light].map(|t| Subject::new(&shining(), DeviceKind::CpuScalar, t)));
    let plain = Choices::default;
    for (what, choices) in [
        ("of 5 edges", Choices { max_depth: Some(5), ..plain() }),
        ("without roulette", Choices { rr_depth: None, ..plain() }),
        ("with an offset of rays", Choices { ray_offset: 1e-4, ..plain() }),
        ("with free normals", Choices { consistent_normals: false, ..plain() }),
        ("lamps by solid angle", Choices { solid_angle: true, ..plain() }),
        ("without back faces", Choices { cull_back_faces: true, ..plain() }),
        ("by Sobol points", Choices { sampler: SamplerKind::SOBOL, ..plain() }),
    ] {
        all.push(Subject::of(&room).choosing(what, choices));
    }
    let learning = Choices { learned_roulette: true, ..plain() };
    all.push(Subject::new(&room, DeviceKind::Cpu, TracerKind::Path).choosing("with learned roulette", learning));
    let fixed = Choices { consistent_normals: false, sampler: SamplerKind::SOBOL, ..plain() };
    all.extend(
        ["alpha", "layered"].map(|name| Subject::of(&load(name)).choosing("with free normals, by Sobol points", fixed)),
    );
    let scenes = ["cornell-box", "layered", "models", "environment", "glass"].map(load);
    let tracers = TracerKind::ALL.into_iter().filter(|tracer| *tracer != TracerKind::Path);
    for tracer in tracers {
        all.extend(scenes.iter().map(|scene| Subject::new(scene, DeviceKind::CpuScalar, tracer)));
    }
    all
}

/// Lenses that no built-in scene has.
const LENSES: [Lens; 3] = [
    Lens::Thin { yfov: 0.7, aperture: 0.1, focus: 5.0 },
    Lens::Orthographic { ymag: 1.0 },
    Lens::Fisheye { angle: 3.0 },
];

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

/// The Cornell box whose walls scatter by this model, and nothing else by any other than glTF's.
fn alone(model: &BsdfModel) -> Scene {
    let mut scene = load("cornell-box");
    let named = Model::named(model.name);
    scene.materials[0].model = Some(if model.has_parts { named.of([1, 2]) } else { named });
    Scene { name: format!("{} alone", model.name), ..scene }
}

/// The Cornell box with colours of vertices.
fn painted() -> Scene {
    let mut scene = load("cornell-box");
    let mesh = &mut scene.meshes[0];
    mesh.colors = Some(vec![glam::Vec4::new(0.5, 0.6, 0.7, 1.0); mesh.positions.len()]);
    Scene { name: "painted".into(), ..scene }
}

/// A square of one material in which each number has a texture that can have one, and a lamp with one.
fn every_texture() -> Scene {
    let mut scene = Scene { name: "every texture".into(), ..load("quad-light") };
    scene.images.push(grey());
    scene.textures.push(texture(TextureSource::Image(0)));
    let texture = Some(TextureRef { texture: 0, uv_set: 0, transform: None });
    let all = Material {
        base_color_texture: texture,
        metallic: 0.5,
        roughness: 0.5,
        metallic_roughness_texture: texture,
        normal_texture: texture,
        specular_texture: texture,
        specular_color_texture: texture,
        transmission: 0.5,
        transmission_texture: texture,
        anisotropy: Some(Anisotropy { texture, ..Anisotropy::new(0.5) }),
        diffuse_transmission: Some(DiffuseTransmission {
            texture,
            color_texture: texture,
            ..DiffuseTransmission::new(0.5, [0.5; 3])
        }),
        iridescence: Some(Iridescence { texture, thickness_texture: texture, ..Iridescence::new(0.5, 400.0) }),
        sheen: Some(Sheen { color_texture: texture, roughness_texture: texture, ..Sheen::new([0.5; 3], 0.5) }),
        clearcoat: Some(Clearcoat {
            texture,
            roughness_texture: texture,
            normal_texture: texture,
            ..Clearcoat::new(0.5, 0.5)
        }),
        ..Material::plastic("all", [0.5; 3], 0.5)
    };
    let lamps = scene.materials.iter_mut().filter(|m| m.is_emissive());
    lamps.for_each(|m| m.emissive_texture = texture);
    scene.materials.push(all);
    for mesh in &mut scene.meshes {
        mesh.uvs[0] = Some(mesh.positions.iter().map(|p| Vec2::new(p.x, p.z)).collect());
    }
    let mesh = Mesh { material: scene.materials.len() - 1, ..scene.meshes[0].clone() };
    scene.meshes.push(mesh);
    let to_world = DAffine3::from_translation(DVec3::Y * 0.25);
    scene.instances.push(Instance { mesh: scene.meshes.len() - 1, to_world });
    scene
}

fn texture(source: TextureSource) -> Texture {
    let (wrap_s, wrap_t) = (Wrap::Repeat, Wrap::Repeat);
    Texture { name: "texture".into(), source, wrap_s, wrap_t, filter: Filter::Bilinear, border: None }
}

/// The square of `quad-light` with one texture each: every filter with every border, each pattern, and the second set of
/// coordinates.
fn pictures() -> Vec<Scene> {
    let borders = [(Wrap::Repeat, None), (Wrap::Mirror, None), (Wrap::Clamp, None), (Wrap::Repeat, Some([0.5; 4]))];
    let filters = [Filter::Nearest, Filter::Bilinear, Filter::Bicubic];
    let mut all = Vec::new();
    for (filter, (wrap, border)) in filters.into_iter().flat_map(|filter| borders.map(|border| (filter, border))) {
        let image = texture(TextureSource::Image(0));
        let texture = Texture { filter, wrap_s: wrap, wrap_t: wrap, border, ..image };
        all.push(picture(format!("{filter:?}, {wrap:?}, border {border:?}"), texture, 0));
    }
    let (even, odd) = ([0.2; 3], [0.8; 3]);
    let checkerboard = texture(TextureSource::Checkerboard { even, odd });
    all.push(picture("a checkerboard".into(), checkerboard.clone(), 0));
    all.push(picture("noise".into(), texture(TextureSource::Noise { low: even, high: odd }), 0));
    all.push(picture("a checkerboard by the second set".into(), checkerboard, 1));
    all
}

/// The square of `quad-light` under a texture by a set of coordinates. Its meshes have both.
fn picture(name: String, texture: Texture, uv_set: usize) -> Scene {
    let mut scene = Scene { name, ..load("quad-light") };
    scene.images.push(grey());
    scene.textures.push(texture);
    scene.materials[0].base_color_texture = Some(TextureRef { texture: 0, uv_set, transform: None });
    for mesh in &mut scene.meshes {
        let uvs: Vec<Vec2> = mesh.positions.iter().map(|p| Vec2::new(p.x, p.z)).collect();
        mesh.uvs = [Some(uvs.clone()), Some(uvs)];
    }
    scene
}

/// An image of one texel.
fn grey() -> Image {
    Image { name: "grey".into(), width: 1, height: 1, rgba: vec![[128; 4]] }
}

/// The Cornell box with unlit walls.
fn unlit() -> Scene {
    let mut scene = load("cornell-box");
    scene.materials[0].unlit = true;
    Scene { name: "unlit".into(), ..scene }
}

/// The Cornell box with a lamp that shines on both sides, within walls of what absorbs.
fn shining() -> Scene {
    let mut scene = load("cornell-box");
    scene.materials.iter_mut().filter(|m| m.is_emissive()).for_each(|m| m.double_sided = true);
    let volume =
        Volume { thickness: 1.0, thickness_texture: None, attenuation_distance: 1.0, attenuation_color: [0.5; 3] };
    scene.materials[0].volume = Some(volume);
    Scene { name: "shining on both sides".into(), ..scene }
}

/// A texture and a light of a user's crate: one grey, and a point light, each by a number.
fn own() -> Subject {
    const NUMBER: &[Parameter] = &[Parameter { name: "number", default: &[0.5], range: (0.0, 1.0) }];
    let components = Components::new()
        .texture(Own {
            name: "grey",
            parameters: NUMBER,
            make: |numbers| Fun::lam(move |_, _| Texel { color: gray(numbers.number(0)), alpha: 1.0.into() }),
        })
        .light(Own {
            name: "weak",
            parameters: NUMBER,
            make: |row, numbers| {
                let intensity = move |_| strength(row) * numbers.number(0);
                let sample_direct = Fun::lam(move |_, (_, point): (Rng, Vec3)| sample_place(row, point, intensity));
                Light { sample_direct, ..make_point_light(row) }
            },
        });
    let mut scene = load("point-light");
    scene.own = vec![Model::named("grey"), Model::named("weak")];
    scene.textures.push(texture(TextureSource::Own(0)));
    scene.materials[0].base_color_texture = Some(TextureRef { texture: 0, uv_set: 0, transform: None });
    scene.lights[0].kind = LightKind::Own(1);
    let subject = Subject::of(&Scene { name: "own".into(), ..scene });
    Subject { library: Library::new(components), ..subject }
}
