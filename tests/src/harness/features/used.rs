//! What a scene uses, asked of the scene.

use glam::Vec3;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::tables::sharing::MOST_COPIES;
use jerboa_scenes::{Clearcoat, Filter, LightKind, Material, Mesh, Scene, Texture, TextureRef, TextureSource, Wrap};

use crate::harness::subjects::Subject;

// ---- materials

pub fn any(subject: &Subject, is: impl Fn(&Material) -> bool) -> bool {
    subject.scene.materials.iter().any(is)
}

pub fn transmits(material: &Material) -> bool {
    material.transmission > 0.0
}

pub fn is_glossy(material: &Material) -> bool {
    material.specular > 0.0 || material.metallic > 0.0 || transmits(material) || has_lobes(material)
}

/// Whether a lobe of this roughness is rough anywhere, and whether it is smooth anywhere.
fn is_rough_or_smooth(roughness: f32, is_textured: bool) -> (bool, bool) {
    /// Width of the narrowest lobe that is not a mirror's.
    const NARROWEST: f32 = 1e-3;
    let is_rough = roughness * roughness >= NARROWEST;
    (is_rough, !is_rough || is_textured)
}

/// Those of its facets that glTF's code is for, without a coat's: rough ones, and smooth ones.
fn facets(m: &Material) -> (bool, bool) {
    let is_gltf = m.model.as_ref().is_none_or(|model| model.name == "dielectric");
    let is_facetted = m.specular > 0.0 || m.metallic > 0.0 || transmits(m) || m.model.is_some();
    let (rough, smooth) = is_rough_or_smooth(m.roughness, m.metallic_roughness_texture.is_some());
    let (rough, smooth) = if m.anisotropy.is_some() { (true, false) } else { (rough, smooth) };
    (is_gltf && is_facetted && rough, is_gltf && is_facetted && smooth)
}

pub fn has_smooth_facets(m: &Material) -> bool {
    facets(m).1
}

/// By glTF's model, another one or a coat.
pub fn has_rough_facets(m: &Material) -> bool {
    let is_glossy = m.model.as_ref().is_some_and(|model| ["plastic", "conductor"].contains(&&*model.name));
    let is_coated = |coat: &Clearcoat| is_rough_or_smooth(coat.roughness, coat.roughness_texture.is_some()).0;
    facets(m).0 || is_glossy && is_rough_or_smooth(m.roughness, false).0 || m.clearcoat.as_ref().is_some_and(is_coated)
}

/// Does light come through that has no inside to come to?
pub fn is_thin_wall(m: &Material) -> bool {
    let passes = transmits(m) || m.model.as_ref().is_some_and(|model| model.name == "dielectric");
    passes && m.volume.as_ref().is_none_or(|v| v.thickness == 0.0)
}

/// Has it a lobe or a layer of an extension?
pub fn has_lobes(m: &Material) -> bool {
    let stretched = m.anisotropy.is_some() || m.iridescence.is_some() || m.diffuse_transmission.is_some();
    stretched || m.sheen.is_some() || m.clearcoat.is_some()
}

/// glTF's diffuse part, or a model that may have one.
pub fn is_diffuse(m: &Material) -> bool {
    let all_metal = m.metallic == 1.0 && m.metallic_roughness_texture.is_none();
    let all_passes = m.transmission == 1.0 && m.transmission_texture.is_none();
    m.model.is_some() || (!all_metal && !all_passes)
}

pub fn has_model(subject: &Subject, name: &str) -> bool {
    any(subject, |m| m.model.as_ref().is_some_and(|model| model.name == name))
}

/// Glossy by glTF's model or by another one.
pub fn has_facets(subject: &Subject) -> bool {
    any(subject, |m| is_glossy(m) || m.model.is_some())
}

fn is_black(m: &Material) -> bool {
    m.base_color[..3].iter().all(|c| *c == 0.0)
}

/// Do paths scatter at a surface?
pub fn scatters(subject: &Subject) -> bool {
    let scatters = |m: &Material| is_glossy(m) || m.model.is_some() || !is_black(m) && !m.unlit;
    subject.shows_light() && has_surfaces(subject) && any(subject, scatters)
}

/// Do they into directions that are drawn, as no perfect mirror does?
pub fn scatters_widely(subject: &Subject) -> bool {
    let is_rough = |m: &Material| m.roughness > 0.01 || m.metallic_roughness_texture.is_some() || has_lobes(m);
    let widely = |m: &Material| m.model.is_some() || is_glossy(m) && is_rough(m) || is_diffuse(m) && !is_black(m);
    scatters(subject) && any(subject, widely)
}

/// Do rays leave surfaces?
pub fn leaves_surfaces(subject: &Subject) -> bool {
    scatters(subject) || subject.tracer == TracerKind::Occlusion
}

/// Is a material looked at?
pub fn shows_materials(subject: &Subject) -> bool {
    let is_there = |m: &Material| is_glossy(m) || m.model.is_some() || !is_black(m) || m.is_emissive();
    let light = subject.shows_light() && has_surfaces(subject) && any(subject, is_there);
    light || matches!(subject.tracer, TracerKind::Albedo | TracerKind::AovPlace)
}

// ---- textures

pub fn textures(scene: &Scene) -> impl Iterator<Item = &TextureRef> {
    scene.materials.iter().flat_map(Material::textures)
}

pub fn has_textures(subject: &Subject) -> bool {
    textures(&subject.scene).next().is_some()
}

pub fn has_source(subject: &Subject, is: impl Fn(TextureSource) -> bool) -> bool {
    textures(&subject.scene).any(|t| is(subject.scene.textures[t.texture].source))
}

pub fn has_images(subject: &Subject) -> bool {
    looks_up(subject, |_| true)
}

/// Does a use of an image look it up so?
pub fn looks_up(subject: &Subject, is: impl Fn(&Texture) -> bool) -> bool {
    let mut used = textures(&subject.scene).map(|t| &subject.scene.textures[t.texture]);
    used.any(|t| matches!(t.source, TextureSource::Image(_)) && is(t))
}

pub fn has_filter(subject: &Subject, filter: Filter) -> bool {
    looks_up(subject, |t| t.filter == filter)
}

pub fn has_wrap(subject: &Subject, wrap: Wrap) -> bool {
    looks_up(subject, |t| t.border.is_none() && (t.wrap_s == wrap || t.wrap_t == wrap))
}

/// Is an image used as a colour, hence decoded?
pub fn has_coloured_images(subject: &Subject) -> bool {
    let is_image = |t: &TextureRef| matches!(subject.scene.textures[t.texture].source, TextureSource::Image(_));
    any(subject, |m| {
        let own = [&m.base_color_texture, &m.emissive_texture, &m.specular_color_texture].into_iter().flatten();
        let sheen = m.sheen.iter().filter_map(|sheen| sheen.color_texture.as_ref());
        let through = m.diffuse_transmission.iter().filter_map(|lobe| lobe.color_texture.as_ref());
        own.chain(sheen).chain(through).any(is_image)
    })
}

// ---- lights

pub fn has_light(subject: &Subject, is: impl Fn(LightKind) -> bool) -> bool {
    subject.scene.lights.iter().any(|light| is(light.kind))
}

/// Is there any light?
pub fn is_lit(scene: &Scene) -> bool {
    let has_lamps = scene.materials.iter().any(Material::is_emissive);
    !scene.lights.is_empty() || scene.environment.is_some() || has_lamps
}

pub fn has_seen_lights(subject: &Subject) -> bool {
    let is_seen = |kind| matches!(kind, LightKind::Sphere { .. } | LightKind::Disk { .. } | LightKind::Sun { .. });
    has_light(subject, is_seen)
}

/// Triangles that shine. (Two of them may be one light.)
fn shining_triangles(scene: &Scene) -> usize {
    let shining = |mesh: &Mesh| scene.materials[mesh.material].is_emissive();
    let meshes = scene.instances.iter().map(|i| &scene.meshes[i.mesh]).filter(|mesh| shining(mesh));
    meshes.map(|mesh| mesh.triangles.len()).sum()
}

/// Lights and triangles that shine, and the environment.
pub fn light_shapes(subject: &Subject) -> usize {
    let scene = &subject.scene;
    shining_triangles(scene) + scene.lights.len() + usize::from(scene.environment.is_some())
}

/// How many triangles shine by themselves, and how many pairs of neighbours do as one parallelogram.
fn lamps(mesh: &Mesh) -> [usize; 2] {
    let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
    let [mut alone, mut pairs] = [0; 2];
    let mut rest = &mesh.triangles[..];
    while let [first, others @ ..] = rest {
        let is_pair = others.first().is_some_and(|second| form_parallelogram(corners(first), corners(second)));
        *(if is_pair { &mut pairs } else { &mut alone }) += 1;
        rest = &others[usize::from(is_pair)..];
    }
    [alone, pairs]
}

/// Do both go through one edge, each the other way, and are the corners opposite to it where those of a parallelogram are?
fn form_parallelogram(t: [Vec3; 3], s: [Vec3; 3]) -> bool {
    let at = |t: [Vec3; 3], i: usize| t[i % 3];
    let fits = |i: usize, j: usize| {
        let shares = at(t, i + 1) == at(s, j + 2) && at(t, i + 2) == at(s, j + 1);
        let middles = (at(t, i + 1) + at(t, i + 2)).distance(at(t, i) + at(s, j));
        shares && middles <= 1e-5 * at(t, i).distance(at(s, j))
    };
    (0..9).any(|k| fits(k / 3, k % 3))
}

fn shines(subject: &Subject, is: impl Fn([usize; 2]) -> bool) -> bool {
    let scene = &subject.scene;
    let shining = |mesh: &&Mesh| scene.materials[mesh.material].is_emissive();
    scene.instances.iter().map(|i| &scene.meshes[i.mesh]).filter(shining).any(|mesh| is(lamps(mesh)))
}

/// Does a triangle shine by itself?
pub fn has_triangle_lights(subject: &Subject) -> bool {
    shines(subject, |[alone, _]| alone > 0)
}

/// Do two triangles shine as one parallelogram?
pub fn has_quad_lights(subject: &Subject) -> bool {
    shines(subject, |[_, pairs]| pairs > 0)
}

/// Those of them that have a place.
pub fn placed_lights(subject: &Subject) -> usize {
    let is_far = |kind| matches!(kind, LightKind::Directional | LightKind::Sun { .. });
    let placed = subject.scene.lights.iter().filter(|light| !is_far(light.kind));
    shining_triangles(&subject.scene) + placed.count()
}

// ---- triangles

/// Is there anything to hit?
pub fn has_surfaces(subject: &Subject) -> bool {
    !subject.scene.instances.is_empty()
}

/// Has a mesh this?
pub fn has_mesh(subject: &Subject, is: impl Fn(&Mesh) -> bool) -> bool {
    subject.scene.meshes.iter().any(is)
}

/// Would copies of some mesh in the world be many, and does it not emit?
pub fn shares(subject: &Subject) -> bool {
    let scene = &subject.scene;
    let users = |mesh: usize| scene.instances.iter().filter(|instance| instance.mesh == mesh).count();
    scene.meshes.iter().enumerate().any(|(number, mesh)| {
        let copies = users(number).saturating_sub(1) * mesh.triangles.len();
        copies > MOST_COPIES as usize && !scene.materials[mesh.material].is_emissive()
    })
}
