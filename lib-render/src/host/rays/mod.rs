//! Raw tracing: how many rays a second the traversal answers, for sets of rays as path tracers send them.
//!
//! From the scene's camera one ray goes through each pixel of a square film, in blocks of 4 × 4 pixels ([`Set::Primary`]).
//! Where it hits, a ray leaves in a direction chosen by the cosine about the face normal ([`Set::Bounce1`]), and where that
//! one hits another ([`Set::Bounce2`]); the latter once more in random order ([`Set::Shuffled`]). From the first hits a ray
//! goes to a random point of what emits, or of the scene's box where nothing does, and ends a thousandth before it
//! ([`Set::Shadow`]): that one asks for any hit, the others for the nearest.

use std::path::Path;
use std::time::{Duration, Instant};

use jerboa_backend_cranelift::{self as clif, Binding, Status};
use jerboa_scenes::{Camera, Scene};
use rayon::prelude::*;

use super::bvh::Triangle;
use super::clock::thread_time;
use super::device::Traversal;
use super::dispatch::tables_bound;
use super::error::Error;
use super::native::{Hit, Ray, Rays, Walkers, Wanted};
use super::tables::geometry::triangles;
use super::tables::{CameraKind, Choices, Known, Tables};
use crate::schema::NONE;

pub mod kernels;

/// A set of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// From the camera.
    Primary,
    /// Diffuse, from where those hit, in their order.
    Bounce1,
    /// Diffuse, from where those hit, in their order.
    Bounce2,
    /// The same in random order.
    Shuffled,
    /// From the first hits to lights.
    Shadow,
}

impl Set {
    /// All of them.
    pub const ALL: [Set; 5] = [Set::Primary, Set::Bounce1, Set::Bounce2, Set::Shuffled, Set::Shadow];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Set::Primary => "primary",
            Set::Bounce1 => "bounce1",
            Set::Bounce2 => "bounce2",
            Set::Shuffled => "shuffled",
            Set::Shadow => "shadow",
        }
    }

    /// The kernel that answers it.
    fn kernel(self) -> &'static str {
        if self == Set::Shadow { "any" } else { "nearest" }
    }

    /// What is asked of the native walk.
    fn wanted(self) -> Wanted {
        match self {
            Set::Primary => Wanted::NearestTogether,
            Set::Shadow => Wanted::Any,
            _ => Wanted::Nearest,
        }
    }
}

/// What tracing a set took.
#[derive(Clone, Debug)]
pub struct Speed {
    /// Which one.
    pub set: Set,
    /// Number of rays.
    pub rays: usize,
    /// How many of them hit.
    pub hits: usize,
    /// Wall time of each repetition, shortest first.
    pub times: Vec<Duration>,
    /// Time that the threads ran for in each repetition, together, shortest first: what a busy machine leaves alone.
    pub work: Vec<Duration>,
}

impl Speed {
    /// Rays per second of the median repetition.
    pub fn median(&self) -> f64 {
        self.rays as f64 / self.times[self.times.len() / 2].as_secs_f64()
    }

    /// Rays per second of the best repetition.
    pub fn best(&self) -> f64 {
        self.rays as f64 / self.times[0].as_secs_f64()
    }

    /// Rays per second that a thread ran for, of the median repetition.
    pub fn per_thread(&self) -> f64 {
        self.rays as f64 / self.work[self.work.len() / 2].as_secs_f64()
    }
}

/// Rays that a kernel is called with.
const CHUNK: usize = 4096;
/// Times that each set is traced.
const REPETITIONS: usize = 7;
/// Rays start so far from where the last one hit, along the normal, in lengths of the diagonal of the scene's box.
const START: f32 = 1e-5;
/// Share of the way that shadow rays leave out.
const BEFORE_LIGHT: f32 = 1e-3;

/// Origin, direction, end.
type PlainRay = ([f32; 3], [f32; 3], f32);

/// The kernels for a scene, and its rays.
pub struct RayBench {
    tables: Tables,
    code: clif::Code,
    sets: Vec<(Set, Vec<PlainRay>)>,
}

impl RayBench {
    /// Prepares a traversal for a scene and makes its sets of rays, of `side`² camera rays and what follows.
    ///
    /// # Errors
    /// When the evaluator or the code generator gives up: a fault of Jerboa, not of the scene.
    pub fn new(scene: &Scene, camera: &Camera, side: u32, traversal: Traversal) -> Result<RayBench, Error> {
        let tables = Tables::walked(scene, &Choices::default(), Known::Structure, traversal);
        let code = kernels::compile(&tables)?;
        let mut bench = RayBench { tables, code, sets: Vec::new() };
        bench.sets = bench.make_sets(scene, camera, side)?;
        Ok(bench)
    }

    /// Wall time of building the tree.
    pub fn bvh_time(&self) -> Duration {
        self.tables.bvh_time
    }

    /// Traces all sets in turn, several times, on rayon's current pool.
    ///
    /// # Errors
    /// When a kernel gives up: a fault of Jerboa.
    pub fn measure(&self) -> Result<Vec<Speed>, Error> {
        let start = |(set, rays): &(Set, Vec<PlainRay>)| (*set, rays.chunks(CHUNK).map(Chunk::new).collect::<Vec<_>>());
        let mut work: Vec<(Set, Vec<Chunk>)> = self.sets.iter().map(start).collect();
        let speed = |(set, rays): &(Set, Vec<PlainRay>)| Speed {
            set: *set,
            rays: rays.len(),
            hits: 0,
            times: vec![],
            work: vec![],
        };
        let mut speeds: Vec<Speed> = self.sets.iter().map(speed).collect();
        for _ in 0..REPETITIONS {
            for ((set, chunks), speed) in work.iter_mut().zip(&mut speeds) {
                let start = Instant::now();
                let trace = |chunk: &mut Chunk| {
                    let start = thread_time();
                    self.trace(*set, chunk)?;
                    Ok::<_, Error>(thread_time().saturating_sub(start))
                };
                let work = chunks.par_iter_mut().map(trace).collect::<Result<Vec<_>, _>>()?;
                speed.times.push(start.elapsed());
                speed.work.push(work.iter().sum());
                speed.hits = chunks.iter().flat_map(Chunk::hits).filter(|(primitive, _)| *primitive != NONE).count();
            }
        }
        for speed in &mut speeds {
            speed.times.sort();
            speed.work.sort();
        }
        Ok(speeds)
    }

    /// Writes each set to `NAME.rays` in a folder: per ray the words origin, 0, direction, end, all f32.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        for (set, rays) in &self.sets {
            let floats = rays.iter().flat_map(|(o, d, end)| [o[0], o[1], o[2], 0.0, d[0], d[1], d[2], *end]);
            let path = folder.join(format!("{}.rays", set.name()));
            std::fs::write(&path, floats.flat_map(f32::to_le_bytes).collect::<Vec<u8>>())
                .map_err(|e| Error::new(format!("{}: {e}", path.display())))?;
        }
        Ok(())
    }

    /// Answers the rays of a chunk.
    fn trace(&self, set: Set, chunk: &mut Chunk) -> Result<(), Error> {
        let native = self.tables.native.as_ref();
        // Triangles with holes are in the kernels' tree.
        let begun = native.is_none_or(|native| !native.is_all());
        if begun {
            self.trace_by_kernel(set, chunk)?;
        }
        if let Some(native) = native {
            native.trace(&mut Walkers::default(), set.wanted(), &mut Asked { chunk, begun, next: 0 });
        }
        Ok(())
    }

    /// Answers the rays of a chunk, among the triangles in the kernels' tree.
    fn trace_by_kernel(&self, set: Set, chunk: &mut Chunk) -> Result<(), Error> {
        let mut bindings = tables_bound(&self.tables);
        bindings.push(Binding::new(&mut chunk.rays, chunk.count));
        bindings.push(Binding::new(&mut chunk.found, chunk.count));
        let kernel = self.code.kernel(set.kernel()).expect("it was compiled under this name");
        // SAFETY: as `Renderer`'s: each binding holds as many rows as it says, of the columns that are declared; only the last
        // one is written, and it is this call's own; unchecked indices come from the tree, which is in range by construction.
        match unsafe { kernel.call(&bindings, &[chunk.count], &mut []) } {
            Status::Done => Ok(()),
            Status::Limit => Err(Error::new("the traversal recursed beyond its limit: a fault of Jerboa")),
        }
    }

    /// What these rays hit.
    fn hits(&self, rays: &[PlainRay]) -> Result<Vec<(u32, f32)>, Error> {
        let mut hits = Vec::with_capacity(rays.len());
        for part in rays.chunks(CHUNK) {
            let mut chunk = Chunk::new(part);
            self.trace(Set::Primary, &mut chunk)?;
            hits.extend(chunk.hits());
        }
        Ok(hits)
    }

    fn make_sets(&self, scene: &Scene, camera: &Camera, side: u32) -> Result<Vec<(Set, Vec<PlainRay>)>, Error> {
        if CameraKind::of(camera) != CameraKind::Pinhole {
            return Err(Error::new(format!("camera \"{}\" is no pinhole, which rays are traced from", camera.name)));
        }
        let triangles = triangles(scene, self.tables.origin);
        let mut random = Random(0x5eed);
        let primary = from_camera(camera, self.tables.origin, side);
        let (bounce1, on) = self.bounce(&mut random, &primary, &triangles)?;
        let lights = Lights::new(scene, &triangles);
        let shadow = on.iter().filter_map(|p| lights.ray(&mut random, *p)).collect();
        let (bounce2, _) = self.bounce(&mut random, &bounce1, &triangles)?;
        let mut shuffled = bounce2.clone();
        (1..shuffled.len()).rev().for_each(|i| shuffled.swap(i, random.below(i + 1)));
        Ok(Set::ALL.into_iter().zip([primary, bounce1, bounce2, shuffled, shadow]).collect())
    }

    /// Diffuse rays from where `rays` hit, and their origins.
    fn bounce(
        &self,
        random: &mut Random,
        rays: &[PlainRay],
        triangles: &[Triangle],
    ) -> Result<(Vec<PlainRay>, Vec<[f32; 3]>), Error> {
        let [lo, hi] = box_of(triangles);
        let step = START * length(sub(hi, lo));
        let mut out = Vec::new();
        for ((org, dir, _), (primitive, t)) in rays.iter().zip(self.hits(rays)?) {
            if primitive == NONE {
                continue;
            }
            let normal = normal_of(&triangles[primitive as usize]);
            let normal = if dot(normal, *dir) > 0.0 { normal.map(|x| -x) } else { normal };
            let start = [0, 1, 2].map(|k| org[k] + t * dir[k] + step * normal[k]);
            let to = unit([0, 1, 2].map({
                let on_sphere = random.on_sphere();
                move |k| normal[k] + on_sphere[k]
            }));
            if to.iter().all(|x| x.is_finite()) {
                out.push((start, to, f32::INFINITY));
            }
        }
        let origins = out.iter().map(|r| r.0).collect();
        Ok((out, origins))
    }
}

/// Rays of one call, and what they hit: two streams.
struct Chunk {
    count: u32,
    rays: Vec<u32>,
    found: Vec<u32>,
}

impl Chunk {
    fn new(rays: &[PlainRay]) -> Chunk {
        let column = |f: fn(&PlainRay) -> f32| rays.iter().map(move |r| f(r).to_bits());
        let org = column(|r| r.0[0]).chain(column(|r| r.0[1])).chain(column(|r| r.0[2]));
        let dir = column(|r| r.1[0]).chain(column(|r| r.1[1])).chain(column(|r| r.1[2]));
        Chunk {
            count: rays.len() as u32,
            rays: org.chain(dir).chain(column(|r| r.2)).collect(),
            found: vec![0; 2 * rays.len()],
        }
    }

    /// Primitive and distance of each ray's hit.
    fn hits(&self) -> impl Iterator<Item = (u32, f32)> + '_ {
        let (primitives, ts) = self.found.split_at(self.count as usize);
        primitives.iter().zip(ts).map(|(p, t)| (*p, f32::from_bits(*t)))
    }
}

/// A chunk whose rays are walked natively.
struct Asked<'a> {
    chunk: &'a mut Chunk,
    /// Has the kernel found hits before?
    begun: bool,
    next: u32,
}

impl Rays for Asked<'_> {
    #[inline(always)]
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        let (i, count) = (self.next, self.chunk.count);
        if i == count {
            return None;
        }
        self.next += 1;
        let word = |column: u32| f32::from_bits(self.chunk.rays[(column * count + i) as usize]);
        let ray =
            Ray { org: [word(0), word(1), word(2)], dir: [word(3), word(4), word(5)], tmax: word(6), skip: [NONE; 3] };
        let found = |column: u32| self.chunk.found[(column * count + i) as usize];
        let before = Hit::miss(if self.begun { f32::from_bits(found(1)) } else { ray.tmax });
        Some((i, ray, if self.begun { Hit { primitive: found(0), ..before } } else { before }))
    }

    #[inline(always)]
    fn done(&mut self, number: u32, hit: Hit) {
        self.chunk.found[number as usize] = hit.primitive;
        self.chunk.found[(self.chunk.count + number) as usize] = hit.t.to_bits();
    }
}

/// A ray through the middle of each pixel of a square film, block by block.
fn from_camera(camera: &Camera, origin: glam::DVec3, side: u32) -> Vec<PlainRay> {
    let side = side.next_multiple_of(4);
    let tan = camera.half_height();
    let blocks = (0..side / 4).flat_map(|y| (0..side / 4).map(move |x| (4 * x, 4 * y)));
    let pixels = blocks.flat_map(|(x, y)| (0..16).map(move |k| (x + k % 4, y + k / 4)));
    let at = |i: u32| ((f64::from(i) + 0.5) / f64::from(side) * 2.0 - 1.0) * tan;
    let ray = |(x, y)| {
        let dir = camera.forward() + camera.right() * at(x) - camera.up() * at(y);
        ((camera.position() - origin).as_vec3().to_array(), dir.normalize().as_vec3().to_array(), f32::INFINITY)
    };
    pixels.map(ray).collect()
}

/// Where shadow rays go.
struct Lights {
    triangles: Vec<Triangle>,
    bounds: [[f32; 3]; 2],
}

impl Lights {
    fn new(scene: &Scene, triangles: &[Triangle]) -> Lights {
        let meshes = scene.instances.iter().map(|i| &scene.meshes[i.mesh]);
        let emits = meshes.flat_map(|m| m.triangles.iter().map(|_| scene.materials[m.material].is_emissive()));
        let lit = triangles.iter().zip(emits).filter(|(_, emits)| *emits);
        Lights { triangles: lit.map(|(t, _)| *t).collect(), bounds: box_of(triangles) }
    }

    /// A ray from `org` to a random point, unless they nearly coincide.
    fn ray(&self, random: &mut Random, org: [f32; 3]) -> Option<PlainRay> {
        let [u, v, w] = [0; 3].map(|_| random.uniform());
        let end = match self.triangles.len() {
            0 => {
                let [lo, hi] = self.bounds;
                [lo[0] + u * (hi[0] - lo[0]), lo[1] + v * (hi[1] - lo[1]), lo[2] + w * (hi[2] - lo[2])]
            }
            n => {
                let [a, b, c] = self.triangles[(w * n as f32) as usize % n];
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]))
            }
        };
        let way = sub(end, org);
        let far = length(way);
        (far > 1e-3 * length(sub(self.bounds[1], self.bounds[0])))
            .then(|| (org, way.map(|x| x / far), far * (1.0 - BEFORE_LIGHT)))
    }
}

/// Corners of the box of all triangles.
fn box_of(triangles: &[Triangle]) -> [[f32; 3]; 2] {
    let corners = triangles.iter().flatten();
    corners.fold([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]], |[lo, hi], p| {
        [[0, 1, 2].map(|k| lo[k].min(p[k])), [0, 1, 2].map(|k| hi[k].max(p[k]))]
    })
}

fn normal_of([a, b, c]: &Triangle) -> [f32; 3] {
    let (e, f) = (sub(*b, *a), sub(*c, *a));
    unit([e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]])
}

fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f32; 3]) -> f32 {
    dot(a, a).sqrt()
}

fn unit(a: [f32; 3]) -> [f32; 3] {
    a.map(|x| x / length(a))
}

/// SplitMix64 (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn uniform(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// A unit vector.
    fn on_sphere(&mut self) -> [f32; 3] {
        let (z, turn) = (2.0 * self.uniform() - 1.0, std::f32::consts::TAU * self.uniform());
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * turn.cos(), r * turn.sin(), z]
    }
}
