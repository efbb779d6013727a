//! Lights: those [without a surface](super::punctual), emissive triangles (paired where two form a parallelogram) and the environment.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use jerboa_ir::lang::Buf;
use jerboa_scenes::{Environment, LightKind, Scene, TextureSource};

use super::geometry::Placed;
use super::light_tree::{self, Emission, TREE_FROM};
use super::media::{Absorption, Media};
use super::memory::{Memory, RowMut, Table};
use super::models::{Numbers, own_light};
use super::punctual::{self, Place};
use crate::components::Components;
use crate::host::alias::{log_slots, slots};
use crate::host::bvh::{Triangle, can_be_hit};
use crate::host::distribution::{Distribution1D, Distribution2D, Share};
use crate::host::image_io::{Image, luminance};
use crate::schema::Lights as L;
use crate::schema::*;

/// The tables of lights.
pub struct LightTables {
    /// [`Lights`].
    pub lights: Memory,
    /// [`LightChoice`].
    pub choice: Memory,
    /// Primitives that are lights, and which.
    pub marks: Vec<(u32, u32)>,
    /// [`LightTree`].
    pub tree: Memory,
    /// [`SeenLights`].
    pub seen: Memory,
    /// How many there are.
    pub counts: Counts,
}

/// Numbers of lights.
#[derive(Clone, Copy, Default, Debug, PartialEq, Eq)]
pub struct Counts {
    /// All.
    pub all: u32,
    /// In the tree; the others come after them. 0 where there is none.
    pub in_tree: u32,
    /// Spheres and disks.
    pub shapes: u32,
    /// Suns.
    pub suns: u32,
}

/// A light before its row is written: power decides how often it is chosen.
struct Candidate {
    /// W, up to a common factor.
    power: f64,
    kind: Kind,
}

enum Kind {
    Punctual(usize),
    Area { emitter: Emitter, other: Option<Quad> },
    Environment,
}

/// The second half of a parallelogram.
#[derive(Clone, Copy)]
struct Quad {
    primitive: u32,
    /// The corner of the first triangle that the two edges of the parallelogram leave from.
    corner: usize,
    /// The corner of the second triangle that is opposite.
    opposite: usize,
}

/// Relative deviation from a parallelogram up to which two triangles are paired: 4 units in the last place.
const PARALLELOGRAM: f32 = 4.0 * f32::EPSILON;

/// A triangle that shines.
struct Emitter {
    /// Its number among all triangles of the scene.
    primitive: u32,
    triangle: Triangle,
    instance: usize,
    material: usize,
}

/// Collect the lights of a scene. `origin` is subtracted from positions, `radius` is that of the bounding sphere, `media` are
/// those of the scene.
pub fn lights(scene: &Scene, origin: DVec3, radius: f32, components: &Components, media: &Media) -> LightTables {
    let place = Place { origin, radius };
    let mut numbers = Numbers::of_lights(scene, components);
    let lit = scene.lights.iter().enumerate().filter(|(_, l)| l.intensity.iter().any(|c| *c > 0.0));
    let candidate = |(i, l)| Candidate { power: punctual::power(l, place), kind: Kind::Punctual(i) };
    let mut candidates: Vec<Candidate> = lit.map(candidate).collect();
    candidates.extend(area(scene, origin));
    if scene.environment.as_ref().is_some_and(|e| e.intensity > 0.0) {
        // Half of the samples: what share of an environment reaches the inside of a scene is not known here.
        let others: f64 = candidates.iter().map(|c| c.power).sum();
        candidates.push(Candidate { power: if others > 0.0 { others } else { 1.0 }, kind: Kind::Environment });
    }
    // Light from infinitely far away behind the others, if those are in a tree.
    let has_place = |c: &Candidate| emission(scene, place, c);
    let mut places: Vec<Emission> = candidates.iter().filter_map(has_place).collect();
    if places.len() < TREE_FROM {
        places.clear();
    } else {
        candidates.sort_by_key(|c| has_place(c).is_none());
    }
    let (tree, trails) = light_tree::build(&places);
    let mut out = LightTables {
        lights: Memory::default(),
        choice: Memory::default(),
        tree,
        seen: Memory::default(),
        marks: Vec::new(),
        counts: Counts { all: candidates.len() as u32, in_tree: places.len() as u32, ..Counts::default() },
    };
    let (mut shapes, mut suns) = (Vec::new(), Vec::new());
    let mut table = Table::<L>::new();
    let mut choice = Table::<LightChoice>::new();
    if !candidates.is_empty() {
        let distribution = Distribution1D::new(&candidates.iter().map(|c| c.power).collect::<Vec<_>>());
        for (i, c) in candidates.iter().enumerate() {
            let mut row = table.push();
            row.set(L::PROBABILITY, distribution.probability(i)).set(L::SCENE_RADIUS, radius);
            row.set(L::PRIMITIVE, NONE).set(L::PRIMITIVE1, NONE).set(L::TRAIL, trails.get(i).copied().unwrap_or(0));
            row.set_all([L::ABSORPTION_R, L::ABSORPTION_G, L::ABSORPTION_B], around(scene, origin, &c.kind, media));
            write(&mut row, scene, place, &c.kind);
            if let Kind::Punctual(light) = &c.kind {
                match place.kind(&scene.lights[*light]) {
                    LightKind::Own(own) => {
                        let (kind, own) = own_light(scene, own, components).unwrap_or_default();
                        row.set(L::KIND, LIGHT_OWN + kind).set(L::NUMBERS, numbers.place(&own));
                    }
                    LightKind::Sphere { .. } | LightKind::Disk { .. } => shapes.push(i as u32),
                    LightKind::Sun { .. } => suns.push(i as u32),
                    LightKind::Point | LightKind::Spot { .. } | LightKind::Directional => {}
                }
            }
            if let Kind::Area { emitter, other } = &c.kind {
                out.marks.push((emitter.primitive, i as u32));
                out.marks.extend(other.map(|q| (q.primitive, i as u32)));
            }
        }
        distribution.cdf.iter().for_each(|p| {
            choice.push().set(LightChoice::CDF, *p);
        });
    }
    (out.counts.shapes, out.counts.suns) = (shapes.len() as u32, suns.len() as u32);
    let mut seen = Table::<SeenLights>::new();
    shapes.into_iter().chain(suns).for_each(|light| _ = seen.push().set(SeenLights::LIGHT, light));
    out.seen = seen.finish();
    out.lights = table.finish();
    out.choice = choice.finish();
    out
}

/// What absorbs where a light is.
fn around(scene: &Scene, origin: DVec3, kind: &Kind, media: &Media) -> Absorption {
    match kind {
        Kind::Punctual(i) if matches!(scene.lights[*i].kind, LightKind::Directional | LightKind::Sun { .. }) => {
            [0.0; 3]
        }
        Kind::Punctual(i) => media.at(scene.lights[*i].position() - origin, None),
        Kind::Area { emitter, .. } => {
            let corners = emitter.triangle.map(|p| Vec3::from(p).as_dvec3());
            media.at(corners.iter().sum::<DVec3>() / 3.0, Some(emitter.instance))
        }
        Kind::Environment => [0.0; 3],
    }
}

/// Where a light is and where it shines; none for one that is infinitely far away, or of a user's crate. Its power is in the
/// unit of candidates.
fn emission(scene: &Scene, place: Place, candidate: &Candidate) -> Option<Emission> {
    use std::f64::consts::{FRAC_PI_2, PI};
    let power = candidate.power;
    match &candidate.kind {
        Kind::Environment => None,
        Kind::Punctual(i) => punctual::emission(&scene.lights[*i], place, power),
        Kind::Area { emitter, other } => {
            let [p, e1, e2] = edges(&emitter.triangle, other.map_or(0, |q| q.corner)).map(|v| v.as_dvec3());
            let (lo, hi) = (p.min(p + e1).min(p + e2), p.max(p + e1).max(p + e2));
            let fourth = if other.is_some() { p + e1 + e2 } else { p };
            let both = scene.materials[emitter.material].double_sided;
            Some(Emission {
                lo: lo.min(fourth),
                hi: hi.max(fourth),
                axis: e1.cross(e2).normalize(),
                normals: if both { PI } else { 0.0 },
                light: FRAC_PI_2,
                power,
            })
        }
    }
}

/// Triangles of materials that emit, without a look at the others.
fn emitters(scene: &Scene, origin: DVec3) -> Vec<Emitter> {
    let mut first = 0;
    let mut emitters = Vec::new();
    for (number, instance) in scene.instances.iter().enumerate() {
        let mesh = &scene.meshes[instance.mesh];
        if scene.materials[mesh.material].is_emissive() {
            let placed = Placed::new(instance, mesh, origin);
            emitters.extend(placed.corners(mesh).zip(first..).map(|(corners, primitive)| Emitter {
                primitive,
                triangle: placed.triangle(corners),
                instance: number,
                material: mesh.material,
            }));
        }
        first += mesh.triangles.len() as u32;
    }
    emitters
}

/// Emissive triangles with an area. Neighbours in the list that form a parallelogram become one light: apart, the seam
/// between them would double the variance.
fn area(scene: &Scene, origin: DVec3) -> impl Iterator<Item = Candidate> {
    // Looked at once for each material: an image may have millions of texels, a mesh millions of triangles.
    let means: Vec<f64> =
        scene.materials.iter().map(|m| if m.is_emissive() { texture_mean(scene, m) } else { 0.0 }).collect();
    let mut emitters = emitters(scene, origin).into_iter().peekable();
    std::iter::from_fn(move || {
        loop {
            let emitter = emitters.next()?;
            let area = f64::from(area_of(&emitter.triangle));
            // Edges rounded to single precision may have an area where the triangle has none, and none where it has one.
            if area <= 0.0 || !can_be_hit(&emitter.triangle) {
                continue;
            }
            let m = &scene.materials[emitter.material];
            let second = emitters.peek().filter(|e| e.instance == emitter.instance);
            let other = second.and_then(|e| {
                let [corner, opposite] = parallelogram(&emitter.triangle, &e.triangle)?;
                Some(Quad { primitive: e.primitive, corner, opposite })
            });
            if other.is_some() {
                emitters.next();
            }
            let sides = if m.double_sided { 2.0 } else { 1.0 };
            let halves = if other.is_some() { 2.0 } else { 1.0 };
            let power = luminance(m.emissive) * means[emitter.material] * area * halves * sides * std::f64::consts::PI;
            return Some(Candidate { power, kind: Kind::Area { emitter, other } });
        }
    })
}

/// Tell each primitive that is a light which one it is. `former` says which were before.
pub fn mark(primitives: &mut Arc<Memory>, former: &[(u32, u32)], marks: &[(u32, u32)]) {
    // Most changes of lights keep this, and a copy is large.
    if former == marks {
        return;
    }
    let words = &mut Arc::make_mut(primitives).words;
    let mut set = |primitive: u32, light: u32| {
        words[primitive as usize * Primitives::COLUMNS.len() + Primitives::LIGHT.0 as usize] = light;
    };
    former.iter().for_each(|(primitive, _)| set(*primitive, NONE));
    marks.iter().for_each(|(primitive, light)| set(*primitive, *light));
}

/// Mean luminance of the emission's texture, by codes; never below 1/255, so that no lit texel goes unsampled.
fn texture_mean(scene: &Scene, m: &jerboa_scenes::Material) -> f64 {
    let Some(source) = m.emissive_texture.map(|t| scene.textures[t.texture].source) else { return 1.0 };
    match source {
        TextureSource::Image(i) => {
            let image = &scene.images[i];
            let code = |p: &[u8; 4]| luminance([p[0], p[1], p[2]].map(|c| f32::from(c) / 255.0));
            (image.rgba.iter().map(code).sum::<f64>() / image.rgba.len() as f64).max(1.0 / 255.0)
        }
        TextureSource::Checkerboard { even, odd } => (luminance(even) + luminance(odd)) / 2.0,
        TextureSource::Noise { low, high } => (luminance(low) + luminance(high)) / 2.0,
        // What it gives is not known here.
        TextureSource::Own(_) => 1.0,
    }
}

fn edges(t: &Triangle, corner: usize) -> [Vec3; 3] {
    let [p, a, b] = [0, 1, 2].map(|i| Vec3::from(t[(corner + i) % 3]));
    [p, a - p, b - p]
}

fn area_of(t: &Triangle) -> f32 {
    let [_, e1, e2] = edges(t, 0);
    (e1.as_dvec3().cross(e2.as_dvec3()).length() / 2.0) as f32
}

/// The corner of `t` from which both edges of the parallelogram `t` ∪ `s` leave, if they form one with the same front, and the
/// corner of `s` that is opposite.
fn parallelogram(t: &Triangle, s: &Triangle) -> Option<[usize; 2]> {
    let opposite = |corner: usize| {
        let [p, e1, e2] = edges(t, corner);
        let fourth = p + e1 + e2;
        let size = e1.abs().max(e2.abs()).max_element().max(p.abs().max_element());
        let near = |x: [f32; 3], y: Vec3| (Vec3::from(x) - y).abs().max_element() <= PARALLELOGRAM * size;
        // The other half runs through the shared edge the other way round.
        (0..3).find(|i| {
            near(s[*i], fourth) && s[(i + 1) % 3] == t[(corner + 2) % 3] && s[(i + 2) % 3] == t[(corner + 1) % 3]
        })
    };
    (0..3).find_map(|corner| Some([corner, opposite(corner)?]))
}

/// Does what a material emits vary over it, or what its coat lets through?
fn is_textured(m: &jerboa_scenes::Material) -> bool {
    m.emissive_texture.is_some() || m.clearcoat.as_ref().is_some_and(|coat| coat.texture.is_some())
}

fn write(row: &mut RowMut<L>, scene: &Scene, place: Place, kind: &Kind) {
    match kind {
        Kind::Punctual(i) => punctual::row(row, &scene.lights[*i], place),
        Kind::Area { emitter, other } => {
            let m = &scene.materials[emitter.material];
            let [p, e1, e2] = edges(&emitter.triangle, other.map_or(0, |q| q.corner));
            let whole = if other.is_some() { 1.0 } else { 0.5 };
            let area = e1.as_dvec3().cross(e2.as_dvec3()).length() * whole;
            row.set(L::KIND, if other.is_some() { LIGHT_QUAD } else { LIGHT_TRIANGLE });
            row.set(L::DOUBLE_SIDED, m.double_sided).set(L::TEXTURED, is_textured(m));
            row.set(L::MATERIAL, emitter.material as u32).set(L::PRIMITIVE, emitter.primitive);
            row.set(L::PRIMITIVE1, other.map_or(NONE, |q| q.primitive)).set(L::AREA, area as f32);
            let [turn, turn1] = other.map_or([0; 2], |q| [q.corner as u32, q.opposite as u32]);
            row.set(L::TURN, turn).set(L::TURN1, turn1);
            row.set_all([L::P_X, L::P_Y, L::P_Z], p.to_array()).set_all([L::E1_X, L::E1_Y, L::E1_Z], e1.to_array());
            row.set_all([L::E2_X, L::E2_Y, L::E2_Z], e2.to_array()).set_all([L::R, L::G, L::B], m.emissive);
        }
        Kind::Environment => {
            row.set(L::KIND, LIGHT_ENVIRONMENT);
        }
    }
}

/// The environment's tables: the row, texels, and what draws one of them; see
/// [`Choices::whole_sky`](super::Choices::whole_sky).
pub fn environment(environment: Option<&Environment>, whole_sky: bool) -> [Memory; 4] {
    use crate::schema::Environment as E;
    let mut row = Table::<E>::new();
    let mut texels = Table::<EnvironmentTexels>::new();
    let (mut columns, mut rows) = (Table::<EnvironmentColumns>::new(), Table::<EnvironmentRows>::new());
    if let Some(e) = environment {
        let (sin, cos) = f64::from(e.rotation_deg).to_radians().sin_cos();
        let [width, height] = [e.width, e.height].map(|n| n as usize);
        let [log_columns, log_rows] = [width, height].map(log_slots);
        row.push()
            .set(E::WIDTH, e.width)
            .set(E::HEIGHT, e.height)
            .set(E::LOG_COLUMN_SLOTS, log_columns)
            .set(E::LOG_ROW_SLOTS, log_rows)
            .set(E::INTENSITY, e.intensity)
            .set_all([E::ROTATION_COS, E::ROTATION_SIN], [cos as f32, sin as f32]);
        let image = Image { width: e.width, height: e.height, pixels: e.radiance.clone() };
        let distribution = Distribution2D::environment(&image, if whole_sky { Share::Whole } else { Share::Uncovered });
        // du dv = dω / (2π² sin θ).
        let jacobian = width as f64 * height as f64 / (2.0 * std::f64::consts::PI.powi(2));
        texels = Table::with_rows(width * height);
        for (i, c) in e.radiance.iter().enumerate() {
            let density = f64::from(distribution.probability([i % width, i / width])) * jacobian;
            texels
                .push()
                .set_all([EnvironmentTexels::R, EnvironmentTexels::G, EnvironmentTexels::B], *c)
                .set(EnvironmentTexels::DENSITY, density as f32);
        }
        columns = Table::with_rows(height << log_columns);
        for slot in distribution.columns.iter().flat_map(slots) {
            columns.push().set(EnvironmentColumns::SLOT, slot);
        }
        for slot in slots(&distribution.rows) {
            rows.push().set(EnvironmentRows::SLOT, slot);
        }
    }
    [row.finish(), texels.finish(), columns.finish(), rows.finish()]
}
