//! Editing: a renderer that takes over a change gives the very samples of one that is made for the changed scene, and makes only
//! those kernels anew whose facts changed.

use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::{Film, Window};
use jerboa_lib_render::host::gpu;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::{Known, Pass};
use jerboa_scenes::{AlphaMode, Scene, TextureSource};

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

fn renderer(scene: &Scene, options: Options) -> Renderer {
    Renderer::new(scene, options).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

fn samples(renderer: &Renderer, scene: &Scene) -> Vec<u32> {
    let window = Window { x: 0, y: 0, width: 24, height: 20 };
    let pass = Pass { size: [24, 20], window, sample: 0, samples: 2, seed: 5 };
    renderer.samples(&scene.camera_or_default(), &pass).unwrap_or_else(|e| panic!("{e}"))
}

/// A change, and which kernels it may make anew at level `Structure`: none, or those that start with this word.
type Change = (&'static str, Option<&'static str>, fn(&mut Scene, &mut Renderer) -> Vec<String>);

/// Change a material and take it over.
fn material(scene: &mut Scene, renderer: &mut Renderer, change: fn(&mut jerboa_scenes::Material)) -> Vec<String> {
    change(&mut scene.materials[1]);
    renderer.set_material(scene, 1).unwrap_or_else(|e| panic!("{e}")).kernels
}

const CHANGES: [Change; 6] = [
    ("another colour", None, |s, r| material(s, r, |m| m.base_color = [0.1, 0.7, 0.3, 1.0])),
    ("a metal", Some("shade"), |s, r| material(s, r, |m| (m.metallic, m.roughness) = (1.0, 0.3))),
    ("another metal", None, |s, r| material(s, r, |m| m.roughness = 0.4)),
    ("a lamp", Some(""), |s, r| material(s, r, |m| m.emissive = [2.0; 3])),
    ("no lamp", Some(""), |s, r| material(s, r, |m| m.emissive = [0.0; 3])),
    ("a hole", Some(""), |s, r| {
        material(s, r, |m| {
            m.base_color[3] = 0.5;
            m.alpha_mode = AlphaMode::Blend;
        })
    }),
];

#[test]
fn a_changed_material_is_as_if_it_had_been_so() {
    for known in [Known::Nothing, Known::Structure, Known::All] {
        for device in DeviceKind::CPU {
            let options = Options { known, device, ..Options::default() };
            let mut scene = load("cornell-box");
            let mut edited = renderer(&scene, options);
            let mut before = samples(&edited, &scene);
            for (what, may, change) in CHANGES {
                let anew = change(&mut scene, &mut edited);
                let found = samples(&edited, &scene);
                assert!(found == samples(&renderer(&scene, options), &scene), "{what}, {known:?}, {device:?}");
                assert!(found != before, "{what} is seen");
                before = found;
                if known == Known::Structure && device == DeviceKind::Cpu {
                    let fits = |name: &String| may.is_some_and(|word| name.starts_with(word));
                    assert!(anew.iter().all(fits) && anew.is_empty() == may.is_none(), "{what}: {anew:?}");
                }
                if known == Known::Nothing {
                    assert!(anew.is_empty(), "{what}: {anew:?}");
                }
            }
        }
    }
}

#[test]
fn changed_lights_and_textures_need_no_compilation() {
    let mut scene = load("spot");
    let mut edited = renderer(&scene, Options::default());
    scene.lights[0].intensity[1] *= 0.25;
    let edit = edited.set_light(&scene, 0).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(edit.kernels, [""; 0]);
    assert!(samples(&edited, &scene) == samples(&renderer(&scene, Options::default()), &scene));

    let mut scene = load("textures");
    let mut edited = renderer(&scene, Options::default());
    let image = |s: &Scene| {
        let found = s.textures.iter().enumerate().find_map(|(i, t)| match t.source {
            TextureSource::Image(image) => Some((i, image)),
            _ => None,
        });
        found.expect("it has an image")
    };
    let (texture, image) = image(&scene);
    scene.images[image].rgba.iter_mut().for_each(|texel| texel.swap(0, 2));
    let edit = edited.set_texture(&scene, texture).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(edit.kernels, [""; 0]);
    assert!(samples(&edited, &scene) == samples(&renderer(&scene, Options::default()), &scene));
}

#[test]
fn what_is_not_there_cannot_be_changed() {
    let scene = load("cornell-box");
    let mut edited = renderer(&scene, Options::default());
    let count = scene.materials.len();
    let error = edited.set_material(&scene, count).expect_err("there is no such material");
    assert_eq!(error.to_string(), format!("there is no material {count}: the scene has {count}"));
    assert!(edited.set_light(&scene, 0).is_err() && edited.set_texture(&scene, 9).is_err());
}

/// On a GPU everything is made anew, and the film is still that of the CPU.
#[test]
fn a_change_on_a_gpu_is_as_if_it_had_been_so() {
    if !gpu::has_driver() {
        assert_ne!(std::env::var("CI").as_deref(), Ok("true"), "no adapter is here: install mesa-vulkan-drivers");
        println!("skipped: a_change_on_a_gpu_is_as_if_it_had_been_so (no adapter)");
        return;
    }
    let film = |renderer: &Renderer, scene: &Scene| {
        let mut film = Film::of_size([12, 10]);
        renderer.render(&scene.camera_or_default(), &mut film).unwrap_or_else(|e| panic!("{e}"));
        film
    };
    let of = |device| Options { device, spp: 2, ..Options::default() };
    let mut scene = load("cornell-box");
    let mut edited = renderer(&scene, of(DeviceKind::GpuMegakernel));
    let before = film(&edited, &scene);
    assert!(before == film(&renderer(&scene, of(DeviceKind::Cpu)), &scene));
    let anew = material(&mut scene, &mut edited, |m| (m.metallic, m.roughness) = (1.0, 0.3));
    assert_eq!(anew, ["megakernel"]);
    let after = film(&edited, &scene);
    assert!(after != before && after == film(&renderer(&scene, of(DeviceKind::Cpu)), &scene));
}
