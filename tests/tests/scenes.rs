//! Every shared scene renders: no panic, no sample that is not a number, no black image of a lit scene. And scenes that lack
//! what a scene usually has (T31).

use std::path::PathBuf;

use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::image_io::Image;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_scenes::{Scene, builtin};
use jerboa_tests::sources::shared_scenes;

const SIZE: [u32; 2] = [24, 16];

/// Scenes with more triangles are rendered as paths only: most of the time goes into their trees.
const LARGE: usize = 100_000;

/// All .gltf and .glb files below the shared scenes, sorted; `None` where they are not at hand.
fn files() -> Option<Vec<PathBuf>> {
    let (mut files, mut folders) = (Vec::new(), vec![shared_scenes()?]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder of scenes") {
            let path = entry.expect("an entry").path();
            match path.extension().and_then(|e| e.to_str()) {
                Some("glb" | "gltf") => files.push(path),
                _ if path.is_dir() => folders.push(path),
                _ => {}
            }
        }
    }
    files.sort();
    Some(files)
}

fn render(scene: &Scene, tracer: TracerKind) -> Image {
    let name = &scene.name;
    let renderer = Renderer::new(scene, Options { tracer, spp: 1, ..Options::default() })
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    let mut film = Film::of_size(SIZE);
    renderer.render(&scene.camera_or_default(), &mut film).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(film.dropped(), 0, "{name}, {}", tracer.kernel());
    let image = film.mean();
    assert!(image.pixels.iter().flatten().all(|c| *c >= 0.0), "{name}, {}: a negative pixel", tracer.kernel());
    image
}

/// Is a pixel of the image not black?
fn shows(image: &Image) -> bool {
    image.pixels.iter().flatten().any(|c| *c > 0.0)
}

fn is_unlit(scene: &Scene) -> bool {
    scene.all_warnings().iter().any(|w| w.to_string().contains("no light"))
}

#[test]
fn every_shared_scene_renders() {
    let Some(files) = files() else {
        println!("skipped: every_shared_scene_renders (no shared scenes)");
        return;
    };
    assert!(files.len() >= 39, "{} files", files.len());
    for file in files {
        let mut scene = Scene::load(&file).unwrap_or_else(|e| panic!("{e}"));
        scene.name = file.display().to_string();
        let shown = render(&scene, TracerKind::Path);
        assert!(shows(&shown) != is_unlit(&scene), "{}: lit, but black, or the other way round", scene.name);
        if scene.triangle_count() < LARGE {
            assert!(shows(&render(&scene, TracerKind::Normals)), "{}: no surface in sight", scene.name);
        }
    }
}

#[test]
fn every_built_in_scene_renders() {
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{e}"));
        let shown = render(&scene, TracerKind::Path);
        // The black rooms let nothing in.
        let may_be_black = ["black-box", "black-sphere", "empty"].contains(&name);
        assert!(shows(&shown) != may_be_black, "{name}");
        assert_eq!(shows(&render(&scene, TracerKind::Normals)), name != "empty", "{name}");
    }
}

/// A triangle in glTF: corners (0,0,0), (1,0,0), (0,1,0), of this material.
fn triangle(material: &str) -> String {
    // The bytes of the nine floats, in base 64.
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{data}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}],
        "images": [{{"uri": "missing.png"}}], "textures": [{{"source": 0}}], "materials": [{material}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "material": 0}}]}}]}}"#
    )
}

#[test]
fn what_a_scene_lacks_is_a_warning_and_an_image() {
    let folder = std::env::temp_dir().join(format!("jerboa-scenes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let load = |material: &str| {
        let file = folder.join("triangle.gltf");
        std::fs::write(&file, triangle(material)).expect("written");
        let scene = Scene::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let warnings = scene.all_warnings().iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        (scene, warnings)
    };
    let (dark, warnings) = load(r#"{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}"#);
    for lacks in ["missing.png", "no camera", "no light"] {
        assert!(warnings.contains(lacks), "{warnings}");
    }
    assert!(!shows(&render(&dark, TracerKind::Path)));
    // The framing camera sees the triangle; white stands in for the texture.
    let albedo = render(&dark, TracerKind::Albedo);
    assert!(albedo.pixels.contains(&[1.0; 3]), "{:?}", albedo.pixels);

    let (glowing, warnings) = load(r#"{"emissiveFactor": [0.5, 0.25, 1]}"#);
    assert!(!warnings.contains("no light"), "{warnings}");
    assert!(render(&glowing, TracerKind::Path).pixels.contains(&[0.5, 0.25, 1.0]));
    std::fs::remove_dir_all(&folder).expect("removed");
}
