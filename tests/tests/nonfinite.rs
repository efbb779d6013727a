//! No pixel is anything but a finite number, whatever a scene holds (T22): a sample that is not finite, or beyond the film's
//! range, is dropped and counted, and a valid scene has none.
//!
//! Extreme scenes are rendered by the path tracer, and the other tracers take turns with them; `JERBOA_ALL=1` lets each have all.

use glam::{DAffine3, DVec3};
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{
    Anisotropy, Clearcoat, DiffuseTransmission, Environment, Iridescence, Light, LightKind, Material, Model, Scene,
    Sheen, builtin,
};
use jerboa_tests::harness::bench::number;

/// The tracers beside the path tracer.
const OTHERS: [TracerKind; 8] = [
    TracerKind::Light,
    TracerKind::Bidirectional,
    TracerKind::Occlusion,
    TracerKind::AovNormal,
    TracerKind::AovPlace,
    TracerKind::Normals,
    TracerKind::Albedo,
    TracerKind::Depth,
];

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

/// The picture and the number of dropped samples; every pixel is finite and not negative.
fn render(what: &str, scene: &Scene, choices: Choices) -> (Image, u64) {
    render_by(TracerKind::Path, what, scene, choices)
}

/// The same by a tracer. Components of normals may be negative.
fn render_by(tracer: TracerKind, what: &str, scene: &Scene, choices: Choices) -> (Image, u64) {
    let what = format!("{what}, {}", tracer.kernel());
    let renderer = Renderer::new(scene, Options { choices, tracer, spp: 4, ..Options::default() })
        .unwrap_or_else(|e| panic!("{what}: {e}"));
    let mut film = Film::of_size([24, 16]);
    renderer.render(&scene.camera_or_default(), &mut film).unwrap_or_else(|e| panic!("{what}: {e}"));
    let image = film.mean();
    let is_good = |c: &f32| c.is_finite() && (*c >= 0.0 || tracer == TracerKind::AovNormal);
    let bad: Vec<_> = image.pixels.iter().filter(|p| !p.iter().all(is_good)).collect();
    assert!(bad.is_empty(), "{what}: {bad:?}");
    (image, film.dropped())
}

/// Whose turn it is among [`OTHERS`].
#[derive(Default)]
struct Turns(usize);

impl Turns {
    /// Samples that the tracers drop whose turn it is.
    fn dropped(&mut self, what: &str, scene: &Scene) -> u64 {
        let own = self.0 % OTHERS.len();
        self.0 += 1;
        let turn = if number("JERBOA_ALL", 0) > 0 { &OTHERS[..] } else { &OTHERS[own..=own] };
        let by = |tracer: &TracerKind| {
            let mut scene = scene.clone();
            if *tracer == TracerKind::Bidirectional {
                // It refuses lights with a size.
                let has_size = |kind: LightKind| {
                    matches!(kind, LightKind::Sphere { .. } | LightKind::Disk { .. } | LightKind::Sun { .. })
                };
                scene.lights.retain(|light| !has_size(light.kind));
            }
            render_by(*tracer, what, &scene, Choices::default()).1
        };
        turn.iter().map(by).sum()
    }

    /// A valid scene drops no sample, whoever renders it.
    fn none_dropped(&mut self, what: &str, scene: &Scene) {
        assert_eq!(dropped(what, scene) + self.dropped(what, scene), 0, "{what}");
    }
}

fn dropped(what: &str, scene: &Scene) -> u64 {
    render(what, scene, Choices::default()).1
}

fn is_black(image: &Image) -> bool {
    image.pixels.iter().all(|p| *p == [0.0; 3])
}

/// With consistent normals, the default, `scenes.rs` and `gallery.rs` see to it.
#[test]
fn no_built_in_scene_drops_a_sample_with_free_normals() {
    for name in builtin::list().iter().map(|b| b.name) {
        let (_, dropped) = render(name, &load(name), Choices { consistent_normals: false, ..Choices::default() });
        assert_eq!(dropped, 0, "{name}");
    }
}

/// Three balls, of `material`, on a floor, in light of every kind.
fn balls(material: Material) -> Scene {
    let mut scene = load("material-balls");
    let ball = scene.materials.iter().position(|m| m.name == "rough plastic").expect("it is there");
    scene.instances = [0, ball, ball + 1, ball + 2].map(|i| scene.instances[i].clone()).to_vec();
    for mesh in scene.meshes.iter_mut().skip(1) {
        mesh.material = scene.materials.len();
    }
    scene.materials.push(material);
    let light = |kind, x: f64| Light {
        name: "light".into(),
        kind,
        intensity: [3.0; 3],
        to_world: DAffine3::from_translation(DVec3::new(x, 2.0, 1.0)) * DAffine3::from_rotation_x(-1.2),
    };
    scene.lights.push(light(LightKind::Point, -2.0));
    scene.lights.push(light(LightKind::Spot { inner: 0.3, outer: 0.6 }, 0.0));
    scene.lights.push(light(LightKind::Directional, 0.0));
    scene.lights.push(light(LightKind::Sphere { radius: 0.1 }, -1.0));
    scene
}

#[test]
fn extreme_surfaces_drop_nothing() {
    let mut turns = Turns::default();
    // GGX alpha 0, 1e-5, just below and above what counts as smooth, 1.
    for alpha in [0.0_f32, 1e-5, 0.999e-3, 1.001e-3, 1.0] {
        let roughness = alpha.sqrt();
        let rows = [
            Material::metal("metal", [1.0; 3], roughness),
            Material::plastic("plastic", [1.0; 3], roughness),
            Material { roughness, ..Material::glass("glass", 1.5) },
            Material { roughness, ..Material::glass("air", 1.0) },
            Material { roughness, ..Material::glass("heavy", 1e6) },
            Material { roughness, ior: 0.0, ..Material::plastic("ior 0", [0.5; 3], roughness) },
            Material {
                metallic: 0.5,
                transmission: 0.5,
                volume: None,
                ..Material::plastic("all", [0.5; 3], roughness)
            },
        ];
        for material in rows {
            let what = format!("{}, alpha {alpha}", material.name);
            turns.none_dropped(&what, &balls(material));
        }
    }
    for ns in [0.0, 1.0, 1e4, 1e6, 1e9, f32::MAX] {
        let model = Some(Model::named("phong").with("ks", &[0.5; 3]).with("ns", &[ns]));
        let what = format!("Phong's exponent {ns}");
        turns.none_dropped(&what, &balls(Material { model, ..Material::diffuse("phong", [0.5; 3]) }));
    }
}

/// The lobes of glTF's extensions and the other models, at the ends of what their numbers may be.
#[test]
fn extreme_lobes_and_models_drop_nothing() {
    let mut turns = Turns::default();
    type Change = (&'static str, fn(&mut Material));
    let lobes: [Change; 11] = [
        ("a coat", |m| m.clearcoat = Some(Clearcoat::new(1.0, 0.0))),
        ("a rough coat", |m| m.clearcoat = Some(Clearcoat::new(1.0, 1.0))),
        ("a smooth sheen", |m| m.sheen = Some(Sheen::new([1.0; 3], 0.0))),
        ("a sheen", |m| m.sheen = Some(Sheen::new([1.0; 3], 1.0))),
        ("a black sheen under a coat", |m| {
            (m.sheen, m.clearcoat) = (Some(Sheen::new([0.0, 0.0, 1e-30], 0.0)), Some(Clearcoat::new(1e-30, 0.0)));
        }),
        ("anisotropy", |m| m.anisotropy = Some(Anisotropy { rotation: 1e4, ..Anisotropy::new(1.0) })),
        ("diffuse transmission", |m| m.diffuse_transmission = Some(DiffuseTransmission::new(1.0, [1.0; 3]))),
        ("a film of nothing", |m| m.iridescence = Some(Iridescence { ior: 1.0, ..Iridescence::new(1.0, 0.0) })),
        ("a film of 1e4", |m| m.iridescence = Some(Iridescence::new(1.0, 1e4))),
        ("a dense film", |m| m.iridescence = Some(Iridescence { ior: 1e3, ..Iridescence::new(1.0, f32::MAX) })),
        ("all of them", |m| {
            m.clearcoat = Some(Clearcoat::new(1.0, 0.5));
            m.sheen = Some(Sheen::new([1.0; 3], 0.5));
            m.anisotropy = Some(Anisotropy::new(1.0));
            m.diffuse_transmission = Some(DiffuseTransmission::new(0.5, [1.0; 3]));
            m.iridescence = Some(Iridescence::new(1.0, 400.0));
        }),
    ];
    let grounds: [(&str, Material); 4] = [
        ("smooth plastic", Material::plastic("plastic", [1.0; 3], 0.0)),
        ("metal in rough plastic", Material { metallic: 0.5, ..Material::plastic("plastic", [1.0; 3], 1.0) }),
        ("smooth glass", Material::glass("glass", 1.5)),
        ("rough glass of index 1", Material { roughness: 1.0, ..Material::glass("glass", 1.0) }),
    ];
    for ((lobe, change), (ground, material)) in lobes.iter().flat_map(|lobe| grounds.iter().map(move |g| (lobe, g))) {
        let (what, mut material) = (format!("{lobe} on {ground}"), material.clone());
        change(&mut material);
        turns.none_dropped(&what, &balls(material));
    }
    // Name, numbers, and glTF's index of refraction.
    type Row = (&'static str, &'static [(&'static str, f32)], f32);
    let models: [Row; 14] = [
        ("rough-diffuse", &[], 1.5),
        ("conductor", &[("eta", 0.01), ("k", 0.0)], 1.5),
        ("conductor", &[("eta", 0.01), ("k", 20.0)], 1.5),
        ("conductor", &[("eta", 1.0), ("k", 0.0)], 1.5),
        ("conductor", &[("eta", 20.0), ("k", 20.0)], 1.5),
        ("dielectric", &[], 1.0),
        ("dielectric", &[], 1e3),
        ("dielectric", &[], 0.0),
        ("plastic", &[], 1.0),
        ("plastic", &[], 1e3),
        ("plastic", &[], 0.0),
        ("thin-glass", &[], 1.0),
        ("thin-glass", &[], 1e3),
        ("mirror", &[], 1.5),
    ];
    for ((name, numbers, ior), roughness) in models.iter().flat_map(|m| [0.0, 1.0].map(|r| (m, r))) {
        let model = numbers.iter().fold(Model::named(name), |model, (name, x)| model.with(name, &[*x]));
        let material = Material { model: Some(model), ior: *ior, roughness, ..Material::diffuse(name, [1.0; 3]) };
        let what = format!("{name} {numbers:?}, index {ior}, roughness {roughness}");
        turns.none_dropped(&what, &balls(material));
    }
}

/// Lights of 1e-30 are valid, if below what the film can tell from 0; of 1e30, their samples are beyond its range.
#[test]
fn extreme_power_is_finite_and_what_is_beyond_the_film_is_counted() {
    type Change = fn(&mut Scene, f32);
    let lit: [(&str, &str, Change); 6] = [
        ("a point light", "point-light", |s, x| s.lights[0].intensity = [x; 3]),
        ("a spot", "spot", |s, x| s.lights[0].intensity = [x; 3]),
        ("a sun", "sun", |s, x| s.lights[0].intensity = [x; 3]),
        ("a lamp", "quad-light", |s, x| {
            s.materials.iter_mut().filter(|m| m.is_emissive()).for_each(|m| m.emissive = [x; 3])
        }),
        ("an environment", "white-furnace", |s, x| s.environment.iter_mut().for_each(|e| e.intensity = x)),
        ("texels", "white-furnace", |s, x| s.environment.iter_mut().for_each(|e| e.radiance.fill([x; 3]))),
    ];
    let mut turns = Turns::default();
    for (what, name, change) in lit {
        for power in [1e-30_f32, f32::from_bits(1), 1e-10, 1e30, f32::MAX] {
            let mut scene = load(name);
            change(&mut scene, power);
            let (image, dropped) = render(what, &scene, Choices::default());
            let what = format!("{what} of {power:e}");
            assert_eq!(dropped > 0, power > 1.0, "{what}: {dropped} dropped");
            let by_others = turns.dropped(&what, &scene);
            assert!(by_others == 0 || power > 1.0, "{what}: {by_others} dropped");
            // The film's step is 2^-64.
            assert!(power > 1.0 || is_black(&image) == (power < 1e-20), "{what}");
        }
    }
}

/// Lights of all sizes: of none that can be seen, larger than the scene, around the camera, half in the floor and in its plane.
#[test]
fn extreme_sizes_drop_nothing() {
    let (mut scene, mut turns) = (load("point-light"), Turns::default());
    let mut check = |kind: LightKind, height: f64| {
        scene.lights[0].kind = kind;
        scene.lights[0].to_world.translation.y = height;
        turns.none_dropped(&format!("{kind:?} at {height}"), &scene);
    };
    for height in [1.0, 0.0, -1e-7] {
        for radius in [f32::from_bits(1), 1e-30, 1e-15, 1e-9, 1e-3, 1.0, 30.0, 1e15, 1e19, f32::MAX] {
            check(LightKind::Sphere { radius }, height);
            check(LightKind::Disk { inner: 0.0, outer: std::f32::consts::FRAC_PI_2, radius }, height);
        }
    }
    for angle in [f32::from_bits(1), 1e-7, 1e-6, 1e-3, 1.0, std::f32::consts::PI] {
        check(LightKind::Sun { angle }, 1.0);
    }
}

/// What a program may put into a scene against its word is counted where it is seen.
#[test]
fn texels_that_are_not_numbers_are_counted() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for texel in [0, 7, 40, 127] {
            let mut scene = load("white-furnace");
            let environment = scene.environment.as_mut().expect("it has one");
            environment.radiance[texel] = [bad; 3];
            let what = format!("texel {texel} of {bad}");
            let all = 4 * 24 * 16;
            let dropped = dropped(&what, &scene);
            assert!(dropped < all / 2, "{what}: {dropped} of {all} samples");
        }
        let mut scene = load("white-furnace");
        scene.environment.as_mut().expect("it has one").radiance.fill([bad; 3]);
        assert_eq!(dropped("all texels", &scene), 4 * 24 * 16);
    }
}

/// In a file they are set to zero, with a warning.
#[test]
fn a_file_with_texels_that_are_not_numbers_is_repaired() {
    let folder = std::env::temp_dir().join(format!("jerboa-nonfinite-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let file = folder.join("sky.exr");
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0];
    let sky = Image::from_fn(8, 4, |x, y| if y == 1 && x < 4 { [bad[x as usize]; 3] } else { [1.0; 3] });
    sky.write(&file, 0.0).expect("written");
    let mut scene = load("white-furnace");
    scene.set_environment(&file, 1.0, 0.0).unwrap_or_else(|e| panic!("{e}"));
    let warnings: Vec<String> = scene.all_warnings().iter().map(ToString::to_string).collect();
    assert!(warnings.iter().any(|w| w.contains('4')), "{warnings:?}");
    assert_eq!(dropped("a repaired sky", &scene), 0);
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// Lamps without area are no lamps.
#[test]
fn degenerate_lamps_give_no_light() {
    let mut scene = load("crumbs");
    let spark = scene.materials.iter().position(|m| m.name == "spark").expect("it is there");
    scene.materials.iter_mut().enumerate().filter(|(i, _)| *i != spark).for_each(|(_, m)| m.emissive = [0.0; 3]);
    assert!(scene.materials[spark].is_emissive());
    let (image, dropped) = render("sparks alone", &scene, Choices::default());
    assert!(is_black(&image) && dropped == 0);
    // An environment of intensity 0 and a black one are none either.
    for (radiance, intensity) in [(1.0, 0.0), (0.0, 1.0)] {
        let sky = Environment { width: 2, height: 1, radiance: vec![[radiance; 3]; 2], intensity, rotation_deg: 0.0 };
        let (image, dropped) =
            render("a dark sky", &Scene { environment: Some(sky), ..load("white-furnace") }, Choices::default());
        assert!(is_black(&image) && dropped == 0);
    }
}
