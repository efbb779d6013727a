//! glTF 2.0 (.gltf and .glb) to a [`Scene`], trusting nothing in the file.
//!
//! The JSON is read as a tree of values by readers that know the path they stand at, so that every fault names its
//! place, and node transforms keep JSON's double precision; the words of glTF's schema come from the `gltf` crate. Only what the chosen scene reaches is read: a broken image
//! that no material uses costs nothing and complains about nothing.

mod accessor;
mod animation;
mod buffer;
mod camera;
mod container;
mod deform;
mod draco;
mod environment;
mod folder;
mod json;
mod light;
mod lobes;
mod material;
mod mesh;
mod model;
mod nodes;
mod schema;
mod texture;

use crate::error::warn;
use crate::selection::choose;
use crate::{Error, Limits, Scene, Selection};
use animation::Pose;
use buffer::Bytes;
use glam::{DAffine3, Vec3};
use json::Json;
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;
use std::rc::Rc;

/// The extensions that are read. Any other is an error where the file requires it, else a warning.
const EXTENSIONS: [&str; 18] = [
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// A scene under construction. The maps go from an index in the file to what it became here.
struct Loader<'a> {
    root: Json<'a>,
    bin: Option<&'a [u8]>,
    limits: &'a Limits,
    /// KHR_mesh_quantization is in use.
    quantized: bool,
    scene: Scene,
    buffers: HashMap<usize, Bytes<'a>>,
    /// Bytes of the accessors of the primitive at work that were in a Draco stream.
    decoded: HashMap<usize, Bytes<'a>>,
    /// The chosen variant of materials.
    variant: Option<usize>,
    /// What animations set, by node.
    poses: HashMap<usize, Pose>,
    /// Of the nodes in the scene.
    world: HashMap<usize, DAffine3>,
    skins: HashMap<usize, Rc<Vec<DAffine3>>>,
    /// Numbers of morph targets of meshes.
    targets: HashMap<usize, usize>,
    /// By mesh, skin, and the bits of the weights of morph targets.
    meshes: HashMap<(usize, Option<usize>, Vec<u32>), Range<usize>>,
    /// `None` is glTF's default material.
    materials: HashMap<Option<usize>, usize>,
    /// `None` where the image cannot be had.
    textures: HashMap<usize, Option<usize>>,
    images: HashMap<usize, Option<usize>>,
    /// Of each of the scene's meshes, for the nodes that repeat it.
    bounds: Vec<(Vec3, Vec3)>,
    /// Of EXT_mesh_gpu_instancing, those that cannot be shown too.
    repeats_left: usize,
    triangles_left: u64,
    lights_left: u64,
    geometry_left: u64,
    images_left: u64,
}

/// Loads what is selected of a .gltf or .glb file.
pub(crate) fn load(file: &Path, selection: &Selection, limits: &Limits) -> Result<Scene, Error> {
    let bytes = crate::folder::read(file, limits)?;
    let (json, bin) = container::split(file, &bytes)?;
    let value = container::parse(file, json, limits)?;
    let root = Json::root(file, &value);
    let mut scene = Scene { name: file.file_stem().unwrap_or_default().to_string_lossy().into(), ..Scene::default() };
    check_version(&root)?;
    let quantized = check_extensions(&root, &mut scene)?;
    let chosen = chosen_scene(&root, selection)?;
    let variant = chosen_variant(&root, selection)?;
    let mut loader = Loader {
        root,
        bin,
        limits,
        quantized,
        scene,
        variant,
        buffers: HashMap::new(),
        decoded: HashMap::new(),
        poses: HashMap::new(),
        world: HashMap::new(),
        skins: HashMap::new(),
        targets: HashMap::new(),
        meshes: HashMap::new(),
        materials: HashMap::new(),
        textures: HashMap::new(),
        images: HashMap::new(),
        bounds: Vec::new(),
        repeats_left: limits.instances,
        triangles_left: limits.triangles,
        lights_left: limits.lights,
        geometry_left: limits.geometry_bytes,
        images_left: limits.images_bytes,
    };
    loader.animate(selection)?;
    loader.nodes(chosen.as_ref())?;
    if let Some(chosen) = &chosen {
        loader.environment(chosen)?;
    }
    Ok(loader.scene)
}

fn check_version(root: &Json) -> Result<(), Error> {
    let asset = root.need("asset")?;
    let version = asset.get("minVersion").map_or_else(|| asset.need("version"), Ok)?;
    match version.text()?.split('.').next() {
        Some("2") => Ok(()),
        _ => Err(version.fault(format!("glTF version {}, not 2", version.text()?))),
    }
}

/// Returns whether KHR_mesh_quantization is in use.
fn check_extensions(root: &Json, scene: &mut Scene) -> Result<bool, Error> {
    for required in root.list("extensionsRequired")? {
        let name = required.text()?;
        if !EXTENSIONS.contains(&name) {
            return Err(Error::Extension { file: root.file.into(), name: name.into() });
        }
    }
    let mut quantized = false;
    for used in root.list("extensionsUsed")? {
        let name = used.text()?;
        quantized |= name == "KHR_mesh_quantization";
        if !EXTENSIONS.contains(&name) {
            let what = match name {
                "KHR_materials_dispersion" => "is left out: light of every colour is refracted by the same index",
                _ => "is unknown and ignored",
            };
            warn(&mut scene.warnings, &used.path, format!("{name} {what}"));
        }
    }
    Ok(quantized)
}

/// The scene that is asked for, else the one that `scene` names, else the first, else none.
fn chosen_scene<'a>(root: &Json<'a>, selection: &Selection) -> Result<Option<Json<'a>>, Error> {
    if let Some(asked) = &selection.scene {
        let scenes = root.list("scenes")?;
        return Ok(Some(scenes[chosen("scene", asked, &scenes)?].clone()));
    }
    match root.get("scene") {
        Some(index) => Ok(Some(index.refer(root, "scenes", "scenes")?.1)),
        None => Ok(root.list("scenes")?.into_iter().next()),
    }
}

/// The variant of KHR_materials_variants that is asked for.
fn chosen_variant(root: &Json, selection: &Selection) -> Result<Option<usize>, Error> {
    let Some(asked) = &selection.variant else {
        return Ok(None);
    };
    let variants = root.extension("KHR_materials_variants")?.map_or(Ok(Vec::new()), |ext| ext.list("variants"))?;
    chosen("variant", asked, &variants).map(Some)
}

/// Which of these objects has the name, or the number, that is asked for.
fn chosen(noun: &'static str, asked: &str, among: &[Json]) -> Result<usize, Error> {
    let names: Vec<String> = among.iter().map(Json::name).collect();
    choose(noun, asked, names.iter().map(String::as_str))
}
