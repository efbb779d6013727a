//! The `gltf` crate's own reading of the shared scenes, which are sound, beside ours: both must see the same nodes,
//! materials, textures, lights and cameras.

use crate::shared::files;
use glam::{DMat4, Mat4};
use gltf::camera::Projection;
use gltf::json::deserialize::from_slice;
use gltf::khr_lights_punctual::Kind;
use gltf::material::AlphaMode as TheirAlpha;
use gltf::mesh::{Mode, Semantic};
use gltf::texture::{Info, MagFilter, WrappingMode};
use gltf::{Document, Node};
use jerboa_scenes::*;
use std::path::Path;

/// Its JSON read by the crate, without its files, its GLB splitter and its validation.
fn document(file: &Path) -> Document {
    let bytes = std::fs::read(file).unwrap();
    let json = match bytes.as_slice() {
        [b'g', b'l', b'T', b'F', ..] => {
            let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap());
            &bytes[20..][..length as usize]
        }
        _ => &bytes,
    };
    Document::from_json_without_validation(from_slice(json).unwrap_or_else(|e| panic!("{}: {e}", file.display())))
}

/// All nodes, a parent before its children, with their transforms to the world.
fn visit<'a>(node: Node<'a>, parent: DMat4, visited: &mut Vec<(Node<'a>, DMat4)>) {
    let to_world = parent * Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
    visited.push((node.clone(), to_world));
    node.children().for_each(|child| visit(child, to_world, visited));
}

/// Equal up to single precision, which the crate has, over a chain of nodes.
fn same_place(ours: impl Into<DMat4>, theirs: DMat4) -> bool {
    ours.into().abs_diff_eq(theirs, 1e-5 * theirs.to_cols_array().into_iter().fold(1.0, |m, x| x.abs().max(m)))
}

fn same_texture(scene: &Scene, ours: Option<TextureRef>, theirs: Option<Info>) {
    let (Some(ours), Some(theirs)) = (ours, &theirs) else {
        return assert_eq!(ours.is_some(), theirs.is_some());
    };
    let transform = theirs.texture_transform();
    let set = transform.as_ref().and_then(|t| t.tex_coord()).unwrap_or(theirs.tex_coord());
    assert_eq!(ours.uv_set, set as usize);
    let same = |t: gltf::texture::TextureTransform| UvTransform {
        offset: t.offset(),
        rotation: t.rotation(),
        scale: t.scale(),
    };
    assert_eq!(ours.transform, transform.map(same));
    let (ours, sampler) = (&scene.textures[ours.texture], theirs.texture().sampler());
    let wrap = |mode| match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::ClampToEdge => Wrap::Clamp,
    };
    assert_eq!((ours.wrap_s, ours.wrap_t), (wrap(sampler.wrap_s()), wrap(sampler.wrap_t())));
    assert_eq!(ours.filter == Filter::Nearest, sampler.mag_filter() == Some(MagFilter::Nearest));
    let TextureSource::Image(image) = ours.source else { panic!("{ours:?}") };
    assert_eq!(scene.images[image].name, theirs.texture().source().name().unwrap_or_default());
}

fn same_material(scene: &Scene, ours: &Material, theirs: &gltf::Material) {
    let pbr = theirs.pbr_metallic_roughness();
    assert_eq!(ours.name, theirs.name().unwrap_or_default());
    assert_eq!(ours.base_color, pbr.base_color_factor());
    assert_eq!((ours.metallic, ours.roughness), (pbr.metallic_factor(), pbr.roughness_factor()));
    let strength = theirs.emissive_strength().unwrap_or(1.0);
    assert_eq!(ours.emissive, theirs.emissive_factor().map(|c| c * strength));
    let alpha = match theirs.alpha_mode() {
        TheirAlpha::Opaque => AlphaMode::Opaque,
        TheirAlpha::Mask => AlphaMode::Mask(theirs.alpha_cutoff().unwrap_or(0.5)),
        TheirAlpha::Blend => AlphaMode::Blend,
    };
    assert_eq!(ours.alpha_mode, alpha);
    assert_eq!((ours.double_sided, ours.unlit), (theirs.double_sided(), theirs.unlit()));
    assert_eq!(ours.normal_scale, theirs.normal_texture().map_or(1.0, |t| t.scale()));
    assert_eq!(ours.ior, theirs.ior().unwrap_or(1.5));
    same_texture(scene, ours.base_color_texture, pbr.base_color_texture());
    same_texture(scene, ours.metallic_roughness_texture, pbr.metallic_roughness_texture());
    same_texture(scene, ours.emissive_texture, theirs.emissive_texture());
    let transmission = theirs.transmission();
    assert_eq!(ours.transmission, transmission.as_ref().map_or(0.0, |t| t.transmission_factor()));
    same_texture(scene, ours.transmission_texture, transmission.and_then(|t| t.transmission_texture()));
    let specular = theirs.specular();
    assert_eq!(ours.specular, specular.as_ref().map_or(1.0, |s| s.specular_factor()));
    assert_eq!(ours.specular_color, specular.as_ref().map_or([1.0; 3], |s| s.specular_color_factor()));
    same_texture(scene, ours.specular_texture, specular.as_ref().and_then(|s| s.specular_texture()));
    same_texture(scene, ours.specular_color_texture, specular.and_then(|s| s.specular_color_texture()));
    let volume = theirs.volume();
    assert_eq!(ours.volume.is_some(), volume.is_some());
    if let (Some(ours), Some(theirs)) = (&ours.volume, volume) {
        assert_eq!(ours.thickness, theirs.thickness_factor());
        same_texture(scene, ours.thickness_texture, theirs.thickness_texture());
        assert_eq!(ours.attenuation_distance, theirs.attenuation_distance());
        assert_eq!(ours.attenuation_color, theirs.attenuation_color());
    }
}

fn same_light(ours: &Light, theirs: &gltf::khr_lights_punctual::Light) {
    let kind = match theirs.kind() {
        Kind::Directional => LightKind::Directional,
        Kind::Point => LightKind::Point,
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            LightKind::Spot { inner: inner_cone_angle, outer: outer_cone_angle }
        }
    };
    assert_eq!(ours.kind, kind);
    let intensity = theirs.color().map(|c| c * theirs.intensity());
    // The product is rounded once here, twice there.
    assert!(ours.intensity.iter().zip(intensity).all(|(a, b)| (a - b).abs() <= 1e-6 * b), "{ours:?}, {intensity:?}");
}

#[test]
fn the_crate_reads_the_same() {
    for file in files().unwrap_or_default() {
        println!("{}", file.display());
        let (scene, document) = (Scene::load(&file).unwrap(), document(&file));
        let mut nodes = Vec::new();
        let root = document.default_scene().or(document.scenes().next()).unwrap();
        root.nodes().for_each(|node| visit(node, DMat4::IDENTITY, &mut nodes));
        let (mut instances, mut cameras, mut lights) =
            (scene.instances.iter(), scene.cameras.iter(), scene.lights.iter());
        for (node, to_world) in &nodes {
            for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
                let instance = instances.next().unwrap();
                assert!(same_place(instance.to_world, *to_world), "{}", instance.to_world);
                let mesh = &scene.meshes[instance.mesh];
                assert_eq!(primitive.mode(), Mode::Triangles);
                let corners = primitive.indices().map_or(mesh.positions.len(), |accessor| accessor.count());
                assert_eq!(mesh.triangles.len(), corners / 3);
                let semantics =
                    [Semantic::Normals, Semantic::TexCoords(0), Semantic::TexCoords(1), Semantic::Colors(0)];
                let theirs = semantics.map(|semantic| primitive.get(&semantic).is_some());
                let [first, second] = [0, 1].map(|set| mesh.uvs[set].is_some());
                assert_eq!([mesh.normals.is_some(), first, second, mesh.colors.is_some()], theirs);
                same_material(&scene, &scene.materials[mesh.material], &primitive.material());
            }
            let seen = node.camera();
            if let Some(projection) = seen.as_ref().map(|camera| camera.projection()) {
                let camera = cameras.next().unwrap();
                assert!(same_place(camera.to_world, *to_world));
                let aspect = camera.aspect.map(|a| a as f32);
                match (camera.lens, projection) {
                    (Lens::Pinhole { yfov }, Projection::Perspective(lens)) => {
                        assert_eq!((yfov as f32, aspect), (lens.yfov(), lens.aspect_ratio()));
                    }
                    (Lens::Orthographic { ymag }, Projection::Orthographic(lens)) => {
                        assert_eq!((ymag as f32, aspect), (lens.ymag(), Some(lens.xmag() / lens.ymag())));
                    }
                    (lens, _) => panic!("{lens:?}"),
                }
            }
            if let Some(theirs) = node.light() {
                let light = lights.next().unwrap();
                assert!(same_place(light.to_world, *to_world));
                same_light(light, &theirs);
            }
        }
        assert_eq!((instances.count(), cameras.count(), lights.count()), (0, 0, 0));
    }
}
