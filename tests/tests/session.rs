//! A render that goes on while its scene is edited: what is shown is always the image of one state of the scene, to the bit,
//! and an edit makes anew what saw a fact that changed, and nothing else.
//!
//! Alone in its process, since kernels that other tests compile would be in the cache.

use jerboa_lib_render::host::edit::Edit;
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::{Handle, Options, Render, Renderer};
use jerboa_lib_render::host::session::{Picture, Session};
use jerboa_scenes::{Lens, Material, Scene, TextureSource, Volume};

const SIZE: [u32; 2] = [40, 32];

/// Samples per pixel of a session: more than any test waits for.
const LONG: u32 = 1 << 20;

fn load(name: &str) -> Scene {
    Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"))
}

fn options(spp: u32) -> Options {
    Options { spp, seed: 3, ..Options::default() }
}

fn start(scene: &Scene, spp: u32) -> Session {
    let renderer = Renderer::new(scene, options(spp)).unwrap_or_else(|e| panic!("{e}"));
    Session::start(renderer, scene.clone(), scene.camera_or_default(), SIZE).unwrap_or_else(|e| panic!("{e}"))
}

/// What a renderer that is made for this scene shows after so many samples.
fn fresh(scene: &Scene, spp: u32) -> Image {
    let mut film = Film::of_size(SIZE);
    let renderer = Renderer::new(scene, options(spp)).unwrap_or_else(|e| panic!("{e}"));
    let job = Render { sample: 0, spp, seed: 3 };
    renderer.render_with(&scene.camera_or_default(), &mut film, job, &Handle::default()).expect("it renders");
    film.mean()
}

/// Edits a material and waits for a picture of it. Gives it and what the edit took.
fn set(session: &Session, scene: &mut Scene, number: usize, change: impl FnOnce(&mut Material)) -> Edit {
    change(&mut scene.materials[number]);
    let edit = session.set_material(number, scene.materials[number].clone());
    let picture = session.wait(edit, 2).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(picture.revision, edit);
    assert!(picture.image == fresh(scene, picture.spp), "{}, {} spp", scene.materials[number].name, picture.spp);
    session.outcome(edit).expect("it is live").expect("it was taken")
}

const NOTHING: [&str; 0] = [];

#[test]
fn an_edit_makes_what_saw_the_fact() {
    let mut scene = load("cornell-box");
    let session = start(&scene, LONG);
    let plain = scene.materials[0].clone();
    let metal = |m: &mut Material| (m.metallic, m.roughness) = (1.0, 0.3);

    let edit = set(&session, &mut scene, 1, |m| m.base_color = [0.1, 0.7, 0.3, 1.0]);
    assert_eq!((edit.kernels, edit.compiled), (NOTHING.map(String::from).to_vec(), Vec::new()), "a value");

    // There are classes 0 to 2 so far.
    let edit = set(&session, &mut scene, 1, metal);
    assert_eq!(
        (&edit.kernels[..], &edit.compiled[..]),
        (&["shade.3".into()][..], &["shade.3".into()][..]),
        "a new class"
    );

    let edit = set(&session, &mut scene, 2, metal);
    assert_eq!(edit.kernels, NOTHING, "a class that is there");

    let edit = set(&session, &mut scene, 1, |m| *m = Material { name: m.name.clone(), ..plain.clone() });
    assert_eq!(edit.kernels, NOTHING, "back to a class that is there");

    let edit = set(&session, &mut scene, 2, |m| *m = Material { name: m.name.clone(), ..plain });
    assert_eq!(edit.compiled, NOTHING, "the last of a class is gone: {:?}", edit.kernels);
}

/// Absorption inside of glass is a fact of the whole scene: every kernel that follows a path through matter sees it.
#[test]
fn a_fact_of_the_whole_scene_makes_what_reads_it() {
    let mut scene = load("cornell-box");
    let session = start(&scene, LONG);
    let edit = set(&session, &mut scene, 1, |m| {
        m.transmission = 1.0;
        m.volume = Some(Volume {
            thickness: 1.0,
            thickness_texture: None,
            attenuation_color: [0.9, 0.5, 0.5],
            attenuation_distance: 0.1,
        });
    });
    let fits = |name: &String| name.starts_with("shade") || name == "miss" || name == "generate";
    assert!(edit.kernels.iter().all(fits), "no ray is traced otherwise: {:?}", edit.kernels);
    assert!(
        ["shade.0", "shade.1", "shade.2"].iter().all(|k| edit.kernels.iter().any(|e| e == k)),
        "{:?}",
        edit.kernels
    );
}

#[test]
fn the_old_picture_goes_on_until_the_new_one() {
    let mut scene = load("cornell-box");
    let unedited = scene.clone();
    let session = start(&scene, LONG);
    session.wait(0, 1).expect("it renders");
    // A structure that no other test makes, so that there is something to compile.
    scene.materials[1].unlit = true;
    let edit = session.set_material(1, scene.materials[1].clone());
    let mut seen: Vec<std::sync::Arc<Picture>> = Vec::new();
    while seen.last().is_none_or(|p| p.revision != edit || p.spp < 3) {
        seen.extend(session.picture());
        std::thread::yield_now();
    }
    seen.dedup_by_key(|p| (p.revision, p.spp));
    assert!(seen.is_sorted_by_key(|p| (p.revision, p.spp)), "it only gets better");
    for picture in &seen {
        let scene = if picture.revision == edit { &scene } else { &unedited };
        assert!(picture.image == fresh(scene, picture.spp), "edit {}, {} spp", picture.revision, picture.spp);
    }
    assert!(seen.iter().any(|p| p.revision == 0));
}

#[test]
fn edits_of_every_part_are_as_if_it_had_been_so() {
    let mut scene = load("spot");
    let session = start(&scene, LONG);
    scene.lights[0].intensity[1] *= 0.25;
    let edit = session.set_light(0, scene.lights[0].clone());
    let mut camera = scene.camera_or_default();
    camera.lens = Lens::Pinhole { yfov: 1.6 * camera.half_height().atan() };
    scene.cameras = vec![camera.clone()];
    let both = session.set_camera(camera);
    let picture = session.wait(both, 2).unwrap_or_else(|e| panic!("{e}"));
    assert!(picture.image == fresh(&scene, picture.spp));
    assert_eq!(session.outcome(edit).expect("it is live").expect("it was taken").kernels, NOTHING);

    let mut scene = load("textures");
    let session = start(&scene, LONG);
    let image = |i: usize| match scene.textures[i].source {
        TextureSource::Image(image) => Some((i, image)),
        _ => None,
    };
    let (number, image) = (0..scene.textures.len()).find_map(image).expect("it has an image");
    scene.images[image].rgba.iter_mut().for_each(|texel| texel.swap(0, 2));
    let edit = session.set_texture(number, scene.textures[number].clone(), Some(scene.images[image].clone()));
    let picture = session.wait(edit, 2).unwrap_or_else(|e| panic!("{e}"));
    assert!(picture.image == fresh(&scene, picture.spp));
}

#[test]
fn what_is_refused_changes_nothing() {
    let mut scene = load("cornell-box");
    let session = start(&scene, 4);
    let (count, mut odd) = (scene.materials.len(), scene.materials[0].clone());
    let error = session.wait(session.set_material(count, odd.clone()), 1).expect_err("there is no such material");
    assert_eq!(error.to_string(), format!("there is no material {count}: the scene has {count}"));
    odd.base_color_texture = Some(jerboa_scenes::TextureRef { texture: 7, uv_set: 0, transform: None });
    let error = session.wait(session.set_material(0, odd), 1).expect_err("there is no such texture");
    assert_eq!(error.to_string(), "there is no texture 7: the scene has 0");
    // A session that has all its samples waits for edits.
    assert_eq!(session.wait(0, LONG).expect("it renders").spp, 4);
    set(&session, &mut scene, 0, |m| m.base_color = [0.5; 4]);
    let renderer = Renderer::new(&scene, options(0)).expect("it is specialised");
    assert!(Session::start(renderer, scene.clone(), scene.camera_or_default(), SIZE).is_err(), "no samples");
    let renderer = Renderer::new(&scene, options(1)).expect("it is specialised");
    let error = Session::start(renderer, scene.clone(), scene.camera_or_default(), [u32::MAX; 2]).err();
    let why = "no memory for a film of 4294967295x4294967295: render parts by --crop";
    assert_eq!(error.expect("it is too large").to_string(), why);
}
