//! Every scene of the shared folder loads. The folder is `$JERBOA_SHARED`, else `shared` beside the checkout.

use crate::common::check;
use jerboa_scenes::{Lens, Scene};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// All .gltf and .glb files below the shared scenes, sorted; `None`, said by name, where they are not at hand.
pub fn files() -> Option<Vec<PathBuf>> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let folder = std::env::var_os("JERBOA_SHARED").map_or_else(beside, PathBuf::from).join("scenes");
    if !folder.is_dir() {
        println!("skipped: shared scenes not found in {}", folder.display());
        return None;
    }
    let (mut files, mut folders) = (Vec::new(), vec![folder]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
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

#[test]
fn every_shared_scene_loads() {
    let Some(files) = files() else { return };
    assert!(files.len() >= 39, "{} files", files.len());
    for file in files {
        let scene = Scene::load(&file).unwrap_or_else(|e| panic!("{e}"));
        assert!(scene.triangle_count() > 0, "{}", file.display());
        let name = file.file_name().unwrap().to_string_lossy();
        println!("{name}: {} triangles, {} materials", scene.triangle_count(), scene.materials.len());
        for warning in &scene.warnings {
            println!("    {warning}");
        }
    }
}

/// The matched scenes against the facts written beside them.
#[test]
fn matched_scenes_are_what_their_json_says() {
    let Some(files) = files() else { return };
    let matched = files.iter().filter(|f| f.to_string_lossy().ends_with(".matched.glb"));
    for file in matched {
        let scene = Scene::load(file).unwrap();
        check(&scene);
        assert!(scene.all_warnings().is_empty(), "{:?}", scene.all_warnings());
        let name = file.file_name().unwrap().to_string_lossy().replace(".matched.glb", ".json");
        let facts: Value = serde_json::from_slice(&std::fs::read(file.with_file_name(name)).unwrap()).unwrap();
        assert_eq!(scene.triangle_count() as u64, facts["triangles"].as_u64().unwrap());
        assert_eq!(scene.materials.len() as u64, facts["materials"].as_u64().unwrap());
        assert_eq!(scene.images.len() as u64, facts["images"].as_u64().unwrap());
        let camera = &scene.cameras[0];
        assert_eq!(camera.lens, Lens::Pinhole { yfov: facts["yfov"].as_f64().unwrap() });
        let film = [&facts["width"], &facts["height"]].map(|n| n.as_u64().unwrap() as u32);
        assert_eq!(camera.film, Some((film[0], film[1])));
        assert_eq!(scene.environment.is_some(), facts["environment"].is_object());
    }
}
