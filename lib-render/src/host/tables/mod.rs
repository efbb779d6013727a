//! From a scene to the tables that kernels read, and to the facts that the evaluator knows (Laws 1 and 2).
//!
//! A scene enters the program here and nowhere else: as memory, and as the classes of its rows. In reading order:
//!
//! * [`memory`]: typed rows over words,
//! * [`camera`]: the kinds of cameras, [`sampling`]: those of samplers,
//! * [`textures`], [`materials`], [`models`], [`geometry`], [`plane`], [`lights`], [`punctual`]: what each table holds,
//! * [`media`]: what a camera or a light lies in,
//! * [`sharing`], [`placing`]: instances that share the triangles of their mesh,
//! * `tree`: the tree over all triangles,
//! * [`classes`]: which rows are alike, as far as a level of knowledge tells.

pub mod camera;
pub mod sampling;
pub mod memory;
pub mod textures;
pub mod materials;
pub mod models;
mod lobes;
pub mod geometry;
pub mod plane;
pub mod placing;
pub mod sharing;
pub mod media;
pub mod lights;
pub mod punctual;
pub mod light_tree;
mod tree;
pub mod classes;

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;
use jerboa_ir::lang::Buf;
use jerboa_peval::Facts;
use jerboa_scenes::{Camera, Lens, Scene};

pub use camera::CameraKind;
pub use classes::Known;
use lights::Counts;
use media::{Absorption, Media};
use memory::{Memory, Table};
pub use sampling::SamplerKind;
use tree::SceneTree;

use crate::host::bvh::{Bounds, Dropped};
use crate::host::device::Traversal;
use crate::host::film::Window;
use crate::host::library::Library;
use crate::host::native::Native;
use crate::schema::{self, *};

/// The choices of a render that a kernel sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choices {
    /// Largest number of path edges; none for unlimited.
    pub max_depth: Option<u32>,
    /// Scattering from which on roulette may end a path; none for no roulette.
    pub rr_depth: Option<u32>,
    /// Largest survival probability, in (0, 1].
    pub rr_cap: f32,
    /// Roulette by what the first samples of a render teach about its light; these go by throughput. Only the path tracer learns: it
    /// does so on the CPU, whatever the device.
    pub learned_roulette: bool,
    /// Shading normals that never let a closed mesh leak, or those of the references.
    pub consistent_normals: bool,
    /// How far rays are moved off surfaces beside the bound on rounding: this times (1 m + the largest coordinate), as
    /// renderers with a fixed epsilon do; shadow rays end ten times that share before the light. 0 for exact, which only a
    /// comparison with such a renderer wants otherwise.
    pub ray_offset: f32,
    /// How far ambient occlusion looks, m; infinity for no end.
    pub occlusion_distance: f32,
    /// The kind of the camera; none for that of the scene's first one, else a pinhole. Which camera of that kind it is never
    /// matters.
    pub camera: Option<CameraKind>,
    /// Most triangles of a mesh's copies in the world before its instances share them; see [`sharing`].
    pub most_copies: u32,
    /// Sample lamps uniformly by solid angle, not by area: the same image on average, and less noise where a lamp is near and
    /// large.
    pub solid_angle: bool,
    /// How random numbers are drawn.
    pub sampler: SamplerKind,
    /// Do rays pass through a surface that they meet from behind, if its material is single-sided, opaque to light and glTF's
    /// own? So glTF has it for rasterisers; a surface then has another side for a ray than for the one back, so no path that
    /// starts at a light can be followed.
    pub cull_back_faces: bool,
    /// Draw the environment's texels by all of their light, not by what a BSDF's samples leave of it. The same image on average; a
    /// renderer of paths that start at lights chooses it, since nothing else finds their light.
    pub whole_sky: bool,
}

impl Default for Choices {
    fn default() -> Self {
        Choices {
            max_depth: None,
            rr_depth: Some(3),
            rr_cap: 1.0,
            learned_roulette: false,
            consistent_normals: true,
            ray_offset: 0.0,
            occlusion_distance: f32::INFINITY,
            camera: None,
            most_copies: sharing::MOST_COPIES,
            solid_angle: false,
            sampler: SamplerKind::default(),
            cull_back_faces: false,
            whole_sky: false,
        }
    }
}

/// A scene in memory, by binding number. A copy shares the memory.
#[derive(Clone)]
pub struct Tables {
    /// Content of each buffer; empty for streams and for [`Frame`], which each pass brings.
    pub memory: Vec<Arc<Memory>>,
    /// What is known of it.
    pub facts: Facts,
    /// The tree of the native walk, if there is one; that of kernels has triangles that may have holes only then.
    pub native: Option<Arc<Native>>,
    /// Subtracted from world positions; see [`geometry::origin`].
    pub origin: DVec3,
    /// Triangles that no ray can hit.
    pub dropped: Dropped,
    /// The kind of camera that the scene is seen by.
    pub camera: CameraKind,
    /// Time spent on the tree.
    pub bvh_time: Duration,
    /// Radius of the sphere around all triangles, m.
    radius: f32,
    /// Who was asked for to walk the tree.
    traversal: Traversal,
    /// Has a surface of each material holes? Or had, when the trees were built.
    cutouts: Vec<bool>,
    /// Images whose texels are laid out, in their order.
    images: Vec<usize>,
    /// Rows of primitives that are lights, and which.
    marks: Vec<(u32, u32)>,
    /// How many lights there are.
    pub lights: Counts,
    /// Whose kernels read it.
    pub library: Library,
    /// Which instances were to share their triangles.
    shared: Vec<bool>,
    /// The solids of the scene.
    media: Arc<Media>,
}

/// How far a change of a scene reaches beyond materials, textures and settings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Change {
    /// Which lights there are, or what they emit.
    pub lights: bool,
    /// Texels of images.
    pub texels: bool,
}

impl Tables {
    /// Lay out a scene for kernels.
    pub fn new(scene: &Scene, choices: &Choices, known: Known) -> Tables {
        Tables::walked(scene, choices, known, Traversal::Ir)
    }

    /// Lay out a scene whose tree is walked so, if that can be.
    pub fn walked(scene: &Scene, choices: &Choices, known: Known, traversal: Traversal) -> Tables {
        Tables::of(Library::standard(), scene, choices, known, traversal)
    }

    /// Likewise, for kernels of this library, which has all that the scene names ([`Library::check`]).
    pub fn of(library: &Library, scene: &Scene, choices: &Choices, known: Known, traversal: Traversal) -> Tables {
        let components = library.components();
        let mut memory = vec![Arc::default(); schema::BUFFERS.len()];
        let mut put = |binding: usize, m: Memory| memory[binding] = Arc::new(m);

        // The tree first: building it takes more memory than anything else, and what is here by then comes on top.
        let origin = geometry::origin(scene);
        let mut sharing = sharing::sharing(scene, origin, choices.most_copies);
        let shared = are_some(&sharing);
        let cutouts = tree::cutouts(scene, choices);
        let mut start = Instant::now();
        let instanced = if shared.contains(&true) { sharing::tree(scene, origin, &sharing) } else { None };
        let tree = instanced.map(SceneTree::from).unwrap_or_else(|| {
            sharing.fill(None);
            let triangles = geometry::triangles(scene, origin);
            start = Instant::now();
            SceneTree::new(scene, &triangles, &cutouts, traversal)
        });
        let bvh_time = start.elapsed();
        let SceneTree { words, native, bounds, dropped } = tree;
        put(binding::<Tree>(), words);

        // Materials and what they look up.
        let mut textures = textures::Textures::new(scene, components);
        put(
            binding::<Materials>(),
            materials::materials(scene, &mut textures, components.models(), choices.cull_back_faces),
        );
        put(binding::<Parameters>(), std::mem::take(&mut textures.numbers).finish());
        let images = textures.images().to_vec();
        put(binding::<Texels>(), textures.texels());
        put(binding::<Textures>(), textures.finish());
        put(binding::<SrgbCurve>(), textures::srgb_curve());

        // Triangles.
        let geometry = geometry::Geometry::new(scene, origin, &sharing);
        let instance_count = geometry.instance_count();
        let [primitives, geometries, vertices, normals, uvs, tangents, colors, instances] = geometry.finish();
        put(binding::<Primitives>(), primitives);
        put(binding::<Geometries>(), geometries);
        put(binding::<Vertices>(), vertices);
        put(binding::<Normals>(), normals);
        put(binding::<Uvs>(), uvs);
        put(binding::<Tangents>(), tangents);
        put(binding::<Colors>(), colors);

        // Lights.
        let radius = radius(&bounds);
        let media = Media::new(scene, origin);
        let mut lights = lights::lights(scene, origin, radius, components, &media);
        geometry::to_rows(&instances, &mut lights.marks);
        put(binding::<Instances>(), instances);
        put(binding::<Lights>(), lights.lights);
        put(binding::<LightChoice>(), lights.choice);
        put(binding::<LightTree>(), lights.tree);
        put(binding::<SeenLights>(), lights.seen);
        put(binding::<Models>(), models::list(scene, components.models(), lights.counts));
        let [row, texels, columns, rows] = lights::environment(scene.environment.as_ref(), choices.whole_sky);
        put(binding::<Environment>(), row);
        put(binding::<EnvironmentTexels>(), texels);
        put(binding::<EnvironmentColumns>(), columns);
        put(binding::<EnvironmentRows>(), rows);

        let camera = choices.camera.unwrap_or_else(|| CameraKind::of_scene(scene));
        put(binding::<Settings>(), settings(scene, choices, camera, lights.counts, instance_count));
        put(binding::<Sampling>(), choices.sampler.row());
        put(binding::<LearnedGrid>(), Table::<LearnedGrid>::new().finish());
        put(binding::<LearnedLight>(), Table::<LearnedLight>::new().finish());
        put(binding::<LearnedPixels>(), Table::<LearnedPixels>::new().finish());
        // A pass brings its own; until then the table has its one row.
        put(binding::<Frame>(), Table::<Frame>::new().finish());

        lights::mark(&mut memory[binding::<Primitives>()], &[], &lights.marks);

        let facts = classes::classify(&mut memory, known, &Facts::none());
        let (marks, lights) = (lights.marks, lights.counts);
        Tables {
            memory,
            facts,
            native,
            origin,
            dropped,
            camera,
            bvh_time,
            radius,
            traversal,
            cutouts,
            images,
            marks,
            lights,
            shared,
            media: Arc::new(media),
            library: library.clone(),
        }
    }

    /// The same with these in place of others, given by binding, of which no fact is known: bulk alone.
    pub fn with(&self, others: impl IntoIterator<Item = (usize, Memory)>) -> Tables {
        let mut tables = self.clone();
        for (binding, memory) in others {
            tables.memory[binding] = Arc::new(memory);
        }
        tables
    }

    /// The same scene after a change of materials, textures or lights. What has not changed is shared.
    pub fn changed(&self, scene: &Scene, choices: &Choices, known: Known, change: Change) -> Tables {
        // What begins or ceases to emit is laid out in another way.
        if are_some(&sharing::sharing(scene, self.origin, choices.most_copies)) != self.shared {
            let choices = Choices { camera: Some(self.camera), ..*choices };
            return Tables::of(&self.library, scene, &choices, known, self.traversal);
        }
        let mut new = self.clone();
        let components = self.library.components();
        let mut put = |binding: usize, m: Memory| new.memory[binding] = Arc::new(m);
        let mut textures = textures::Textures::new(scene, components);
        put(
            binding::<Materials>(),
            materials::materials(scene, &mut textures, components.models(), choices.cull_back_faces),
        );
        put(binding::<Parameters>(), std::mem::take(&mut textures.numbers).finish());
        if change.texels || textures.images() != self.images {
            put(binding::<Texels>(), textures.texels());
        }
        new.images = textures.images().to_vec();
        put(binding::<Textures>(), textures.finish());
        // A triangle without holes may stay where kernels walk, but not the other way round.
        let cutouts = tree::cutouts(scene, choices);
        if self.native.is_some() && cutouts.iter().zip(&self.cutouts).any(|(now, before)| *now && !*before) {
            let triangles = geometry::triangles(scene, self.origin);
            let tree = SceneTree::new(scene, &triangles, &cutouts, self.traversal);
            put(binding::<Tree>(), tree.words);
            (new.native, new.cutouts) = (tree.native, cutouts);
        }
        let former = &self.memory[binding::<Settings>()].words;
        let instance_count = former[Settings::INSTANCE_COUNT.0 as usize];
        let mut counts = self.lights;
        let same_media = self.media.are_of(scene);
        if !same_media {
            new.media = Arc::new(Media::new(scene, self.origin));
        }
        if change.lights || !same_media {
            let mut lights = lights::lights(scene, self.origin, self.radius, components, &new.media);
            geometry::to_rows(&self.memory[binding::<Instances>()], &mut lights.marks);
            put(binding::<Lights>(), lights.lights);
            put(binding::<LightChoice>(), lights.choice);
            put(binding::<LightTree>(), lights.tree);
            put(binding::<SeenLights>(), lights.seen);
            lights::mark(&mut new.memory[binding::<Primitives>()], &self.marks, &lights.marks);
            (counts, new.marks) = (lights.counts, lights.marks);
        }
        new.lights = counts;
        new.memory[binding::<Models>()] = Arc::new(models::list(scene, components.models(), counts));
        new.memory[binding::<Settings>()] = Arc::new(settings(scene, choices, self.camera, counts, instance_count));
        new.memory[binding::<Sampling>()] = Arc::new(choices.sampler.row());
        new.facts = classes::classify(&mut new.memory, known, &self.facts);
        new
    }

    /// Where a camera stands.
    pub fn place(&self, camera: &Camera) -> Place {
        Place { origin: self.origin, absorption: self.media.at(camera.position() - self.origin, None) }
    }

    /// What the first light of a user's crate is called, if one shines.
    pub fn own_light(&self) -> Option<&'static str> {
        let rows = self.memory[binding::<Lights>()].words.chunks(Lights::COLUMNS.len()).take(self.lights.all as usize);
        let own = |row: &[u32]| row[Lights::KIND.0 as usize].checked_sub(LIGHT_OWN);
        let light = rows.filter_map(own).next()?;
        self.library.components().lights().get(light as usize).map(|light| light.name)
    }

    /// Does this material emit?
    pub fn is_emissive(&self, material: usize) -> bool {
        let row = self.memory[binding::<Materials>()].words.chunks(Materials::COLUMNS.len()).nth(material);
        row.is_some_and(|row| row[Materials::EMISSIVE.0 as usize] != 0)
    }
}

/// Radius of the sphere around the box of all triangles, m; 0 without triangles.
fn radius(bounds: &Bounds) -> f32 {
    let (lo, hi) = (DVec3::from(bounds.lo.map(f64::from)), DVec3::from(bounds.hi.map(f64::from)));
    if *bounds == Bounds::EMPTY { 0.0 } else { ((hi - lo).length() / 2.0) as f32 }
}

/// Which instances share?
fn are_some(sharing: &sharing::Sharing) -> Vec<bool> {
    sharing.iter().map(Option::is_some).collect()
}

/// `instances`: how many share triangles.
fn settings(scene: &Scene, choices: &Choices, camera: CameraKind, lights: Counts, instances: u32) -> Memory {
    use Settings as S;
    let mut table = Table::<S>::new();
    table
        .push()
        .set(S::ROULETTE, choices.rr_depth.is_some())
        .set(S::LEARNS, choices.rr_depth.is_some() && choices.learned_roulette)
        .set(S::RR_DEPTH, choices.rr_depth.unwrap_or(u32::MAX))
        .set(S::RR_CAP, choices.rr_cap)
        .set(S::DEPTH_LIMITED, choices.max_depth.is_some())
        .set(S::MAX_DEPTH, choices.max_depth.unwrap_or(u32::MAX))
        .set(S::CONSISTENT_NORMALS, choices.consistent_normals)
        .set(S::HAS_RAY_OFFSET, choices.ray_offset > 0.0)
        .set(S::RAY_OFFSET, choices.ray_offset)
        .set(S::OCCLUSION_DISTANCE, choices.occlusion_distance)
        .set(S::BY_SOLID_ANGLE, choices.solid_angle)
        .set(S::HAS_ENVIRONMENT, scene.environment.is_some())
        .set(S::HAS_LIGHTS, lights.all > 0)
        .set(S::HAS_ONE_LIGHT, lights.all == 1)
        .set(S::LIGHT_COUNT, lights.all)
        .set(S::HAS_LIGHT_TREE, lights.in_tree > 0)
        .set(S::TREE_LIGHTS, lights.in_tree)
        .set(S::SHAPES, lights.shapes)
        .set(S::SUNS, lights.suns)
        .set(S::HAS_CUTOUTS, tree::cutouts(scene, choices).contains(&true))
        .set(S::HAS_INSTANCES, instances > 0)
        .set(S::INSTANCE_COUNT, instances)
        .set(S::HAS_VOLUMES, scene.materials.iter().any(materials::absorbs))
        .set(S::CAMERA, camera.row());
    table.finish()
}

/// What a pass brings: camera, film, samples.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pass {
    /// Film size in pixels.
    pub size: [u32; 2],
    /// The pixels of this pass.
    pub window: Window,
    /// First sample.
    pub sample: u32,
    /// Number of samples per pixel.
    pub samples: u32,
    /// Seed of the render.
    pub seed: u32,
}

/// Where a camera stands among [`Tables`].
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Subtracted from world positions.
    pub origin: DVec3,
    /// What absorbs there.
    pub absorption: Absorption,
}

/// The largest power of two that is no more than a number.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (0x7ff << 52))
}

/// The [`Frame`] table of a pass.
pub fn frame(camera: &Camera, Place { origin, absorption }: Place, pass: &Pass) -> Memory {
    use Frame as F;
    let half = camera.half_height();
    let aspect = f64::from(pass.size[0]) / f64::from(pass.size[1]);
    let mut table = Table::<F>::new();
    let mut row = table.push();
    row.set(F::WIDTH, pass.size[0]).set(F::HEIGHT, pass.size[1]);
    row.set(F::CROP_X, pass.window.x).set(F::CROP_Y, pass.window.y).set(F::CROP_WIDTH, pass.window.width);
    row.set(F::SAMPLE, pass.sample).set(F::SAMPLES, pass.samples).set(F::SEED, pass.seed);
    let axis = |v: DVec3| v.as_vec3().to_array();
    row.set_all([F::EYE_X, F::EYE_Y, F::EYE_Z], axis(camera.position() - origin));
    row.set_all([F::RIGHT_X, F::RIGHT_Y, F::RIGHT_Z], axis(camera.right() * half * aspect));
    row.set_all([F::UP_X, F::UP_Y, F::UP_Z], axis(camera.up() * half));
    row.set_all([F::FORWARD_X, F::FORWARD_Y, F::FORWARD_Z], axis(camera.forward()));
    row.set_all([F::ABSORPTION_R, F::ABSORPTION_G, F::ABSORPTION_B], absorption);
    if let Lens::Thin { aperture, focus, .. } = camera.lens {
        let radius = aperture / 2.0;
        let [size, unit] = [radius, radius.max(focus)].map(power_of_two_below);
        let lens = [radius / size / (half * aspect), radius / size / half, size].map(|x| x as f32);
        row.set_all([F::LENS_RIGHT, F::LENS_UP, F::LENS_SIZE], lens);
        // A lower depth shows nowhere but in the middle of the lens: what random numbers draw beside it is 2^-24 of the radius away.
        let focus = (focus / unit).max(f64::exp2(-60.0));
        row.set_all([F::FOCUS, F::LENS_SHARE], [focus, size / unit].map(|x| x as f32));
    }
    table.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_table_has_a_row() {
        let scene = Scene::load("builtin:cornell-box").expect("a built-in loads");
        let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
        for (spec, memory) in schema::BUFFERS.iter().zip(&tables.memory) {
            let stream = spec.1 == jerboa_ir::BufKind::Stream;
            assert!(stream || memory.rows >= 1, "{} is empty", spec.0);
            assert_eq!(memory.words.len(), memory.rows as usize * spec.3.len(), "{}", spec.0);
        }
    }
}
