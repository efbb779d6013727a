//! Every scene of the shared folder loads. The folder is `$JERBOA_SHARED`, else `shared` beside the checkout.

use jerboa_scenes::Scene;
use std::path::{Path, PathBuf};

/// All .gltf and .glb files below the shared scenes, sorted; `None`, said by name, where they are not at hand.
fn files() -> Option<Vec<PathBuf>> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let folder = std::env::var_os("JERBOA_SHARED")
        .map_or_else(beside, PathBuf::from)
        .join("scenes");
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
        println!(
            "{name}: {} triangles, {} materials",
            scene.triangle_count(),
            scene.materials.len()
        );
        for warning in &scene.warnings {
            println!("    {warning}");
        }
    }
}
