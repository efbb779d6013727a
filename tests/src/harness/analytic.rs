//! Scenes whose radiance has a closed form, and how renders of them are judged.
//!
//! A [`Closed`] scene says where to look and what is to be seen there; [`enclosures`], [`bodies`], [`plates`], [`seen`] and
//! [`direct`] are the tables of them. [`estimate`] traces paths there, and [`Estimate::fault`] compares. Curved surfaces are made of triangles: how far
//! that moves the truth is bounded for each scene (`facets`), from the mesh itself.
//!
//! *Closed enclosures.* Inside a closed surface of albedo ρ every point sees walls only. So if each wall point has direct
//! radiance D (its own emission, or what a light in the middle gives it), light that was reflected k times adds ρ^k D, and
//! the radiance is D / (1 − ρ) everywhere and in every direction.
//!
//! ```
//! use jerboa_tests::harness::analytic::{Closed, SEED, enclosures, estimate};
//! let scenes = enclosures();
//! let glowing_box: &Closed = scenes.iter().find(|c| c.name == "glowing box, albedo 0.5").unwrap();
//! let renderer = glowing_box.renderer();
//! let (look, truth) = &glowing_box.looks[0];
//! let found = estimate(&renderer, look, 4096, SEED);
//! assert_eq!(found.fault(*truth, glowing_box.facets, 0.08), None);
//! assert!(found.fault(1.1 * truth, glowing_box.facets, 0.08).is_some());
//! ```

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::{Choices, Pass};
use jerboa_scenes::{Camera, Mesh, Scene};

use super::stats::mean;
use crate::sources::root;

mod bodies;
mod direct;
mod enclosures;
mod painted;
mod plates;
mod seen;

pub use bodies::bodies;
pub use direct::{ALBEDO, direct, form_factor, maps, sky_irradiance};
pub use enclosures::{enclosures, glowing_box};
pub use plates::plates;
pub use seen::seen;

/// Seed of the first render of each scene.
pub const SEED: u32 = 20_260;
/// Paths of one pass: their samples take 5 words each.
const PASS: usize = 1 << 16;

/// A scene whose radiance is known at some places.
pub struct Closed {
    /// What it is, for messages.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// Where to look, and the radiance to be found.
    pub looks: Vec<(Look, f64)>,
    /// Bound on the relative error of the truth that comes from triangles in place of curved surfaces.
    pub facets: f64,
    /// What the render asks for.
    pub choices: Choices,
    /// Is it so close to a light with extent that light sampling alone has no usable variance?
    pub is_near: bool,
    /// How many times the usual number of paths it takes: where a sample's variance is large.
    pub effort: usize,
}

impl Closed {
    /// A renderer of it, specialised for structure.
    ///
    /// # Panics
    /// When there is none: a fault of Jerboa.
    pub fn renderer(&self) -> Renderer {
        renderer(&self.scene, self.choices)
    }

    /// The same, with every emitter (not a light without a surface) shown as an unlit surface, which no light sampling
    /// knows of: an estimate by BSDF sampling alone.
    pub fn by_bsdf_only(&self) -> Renderer {
        let mut scene = self.scene.clone();
        for m in scene.materials.iter_mut().filter(|m| m.is_emissive()) {
            let [r, g, b] = m.emissive;
            (m.base_color, m.emissive, m.unlit) = ([r, g, b, 1.0], [0.0; 3], true);
            m.base_color_texture = m.emissive_texture.take();
        }
        renderer(&scene, self.choices)
    }
}

/// A renderer of a scene, specialised for structure.
///
/// # Panics
/// When there is none: a fault of Jerboa.
pub fn renderer(scene: &Scene, choices: Choices) -> Renderer {
    Renderer::new(scene, Options { choices, ..Options::default() }).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Pixels of a film.
#[derive(Clone)]
pub struct Look {
    /// From where.
    pub camera: Camera,
    /// Size of the film.
    pub size: [u32; 2],
    /// Which pixels of it.
    pub window: Window,
}

impl Look {
    /// The whole of a film of 16 x 16.
    pub fn whole(camera: Camera) -> Look {
        Look { camera, size: [16; 2], window: Window { x: 0, y: 0, width: 16, height: 16 } }
    }

    /// One pixel of a square film.
    pub fn pixel(camera: Camera, side: u32, x: u32, y: u32) -> Look {
        Look { camera, size: [side; 2], window: Window { x, y, width: 1, height: 1 } }
    }

    /// Where the ray through a point of the window, both coordinates in [0, 1], meets the plane y = 0.
    pub fn on_floor(&self, x: f64, y: f64) -> DVec3 {
        let Window { x: left, y: top, width, height } = self.window;
        let across = 2.0 * (f64::from(left) + x * f64::from(width)) / f64::from(self.size[0]) - 1.0;
        let down = 2.0 * (f64::from(top) + y * f64::from(height)) / f64::from(self.size[1]) - 1.0;
        let half = self.camera.half_height();
        let dir = self.camera.forward() + (self.camera.right() * across - self.camera.up() * down) * half;
        self.camera.position() - dir * (self.camera.position().y / dir.y)
    }

    /// Mean over the window of a function of the floor, by the middles of 64 x 64 cells.
    pub fn mean_on_floor(&self, radiance: impl Fn(DVec3) -> f64) -> f64 {
        const CELLS: u32 = 64;
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(CELLS);
        let at = |i: u32| radiance(self.on_floor(middle(i % CELLS), middle(i / CELLS)));
        (0..CELLS * CELLS).map(at).sum::<f64>() / f64::from(CELLS * CELLS)
    }

    /// Radiance of each of at least so many samples, in passes.
    pub fn samples(&self, renderer: &Renderer, paths: usize, seed: u32) -> impl Iterator<Item = [f64; 3]> {
        let area = self.window.area();
        let (each, most) = (paths.div_ceil(area), PASS.div_ceil(area));
        (0..each).step_by(most).flat_map(move |first| {
            let samples = most.min(each - first) as u32;
            let pass = Pass { size: self.size, window: self.window, sample: first as u32, samples, seed };
            let words = renderer.samples(&self.camera, &pass).unwrap_or_else(|e| panic!("{e}"));
            let items = area * samples as usize;
            (0..items).map(move |i| [0, 1, 2].map(|c| f64::from(f32::from_bits(words[c * items + i]))))
        })
    }
}

/// What independent samples say about their mean.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// Mean.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
    /// How many.
    pub paths: usize,
}

impl Estimate {
    /// From samples.
    pub fn of(values: &[f64]) -> Estimate {
        let (mean, error) = mean(values.iter().copied());
        Estimate { mean, error, paths: values.len() }
    }

    /// Variance of one sample, relative to the square of the mean.
    pub fn relative_variance(&self) -> f64 {
        (self.error / self.mean).powi(2) * self.paths as f64
    }

    /// What is wrong, where the mean should be `truth`: it is off by more than 4 standard errors (or 1e-4 of the truth)
    /// and the facets, or by more than `most` of the truth at all; or four standard errors are more than `most`, so that
    /// the comparison says too little. With fewer than 10^6 paths `most` grows by the root of their number.
    pub fn fault(&self, truth: f64, facets: f64, most: f64) -> Option<String> {
        // Not if it is NaN.
        let within = |limit: f64| (self.mean - truth).abs() - facets * truth <= limit;
        let says = |what: &str| Some(format!("{:.6} ± {:.6} instead of {truth:.6}: {what}", self.mean, self.error));
        if 4.0 * self.error > most * truth {
            says("the error is too large to tell")
        } else if !within((4.0 * self.error).max(1e-4 * truth)) {
            says("more than 4 standard errors")
        } else if !within(most * truth) {
            says("more than the bound")
        } else {
            None
        }
    }
}

/// The bound of a comparison with so many paths, where the acceptance list has `most` for a million: grown by the root.
pub fn bound(most: f64, paths: usize) -> f64 {
    most * (1e6 / paths as f64).sqrt().max(1.0)
}

/// Traces paths and sums their green; the scene is grey.
///
/// # Panics
/// When a sample is not grey.
pub fn estimate(renderer: &Renderer, look: &Look, paths: usize, seed: u32) -> Estimate {
    let grey = |[r, g, b]: [f64; 3]| {
        assert!(r == g && g == b, "{r} {g} {b} is not grey");
        g
    };
    Estimate::of(&look.samples(renderer, paths, seed).map(grey).collect::<Vec<_>>())
}

/// Traces paths and sums their green, whatever the other channels.
pub fn estimate_green(renderer: &Renderer, look: &Look, paths: usize, seed: u32) -> Estimate {
    Estimate::of(&look.samples(renderer, paths, seed).map(|[_, g, _]| g).collect::<Vec<_>>())
}

/// The scene of a file in `tests/files/wavefront`.
///
/// # Panics
/// When it cannot be read.
fn wavefront(name: &str) -> Scene {
    let file = root().join("tests/files/wavefront").join(name).with_extension("obj");
    let scene = Scene::load(file).unwrap_or_else(|e| panic!("{e}"));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene
}

/// A rectangle from a corner along two edges; its front is the side of `u × v`.
pub fn rectangle(corner: Vec3, u: Vec3, v: Vec3) -> Mesh {
    Mesh {
        positions: vec![corner, corner + u, corner + u + v, corner + v],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// The unit sphere about the origin in 20·4^`level` flat triangles, front outside: each triangle of the icosahedron is
/// split into four, `level` times.
pub fn sphere(level: u32) -> Mesh {
    let golden = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        positions.extend([Vec3::new(a, b, 0.0), Vec3::new(0.0, a, b), Vec3::new(b, 0.0, a)].map(Vec3::normalize));
    }
    // Neighbours are 63.4 degrees apart, all others more than 90.
    let near = |i: usize, j: usize| positions[i].dot(positions[j]) > 0.0;
    let mut triangles = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        if near(i, j) && near(j, k) && near(k, i) {
            let front = (positions[j] - positions[i]).cross(positions[k] - positions[i]).dot(positions[i]) > 0.0;
            triangles.push(if front { [i as u32, j as u32, k as u32] } else { [i as u32, k as u32, j as u32] });
        }
    }
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    Mesh { positions, triangles, ..Mesh::default() }
}

/// Distance from the origin of the nearest plane of a mesh's triangles.
pub fn inradius(mesh: &Mesh) -> f64 {
    let plane = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        (b - a).cross(c - a).normalize().dot(a).abs()
    };
    mesh.triangles.iter().map(plane).fold(f64::INFINITY, f64::min)
}

/// The same surface with its front on the other side.
pub fn inside_out(mut mesh: Mesh) -> Mesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// Adds a mesh of a material of its own, as modelled, scaled and moved.
pub fn place(scene: &mut Scene, mesh: Mesh, material: jerboa_scenes::Material, scale: f64, at: DVec3) {
    scene.materials.push(material);
    scene.meshes.push(Mesh { material: scene.materials.len() - 1, ..mesh });
    let to_world = glam::DAffine3::from_translation(at) * glam::DAffine3::from_scale(DVec3::splat(scale));
    scene.instances.push(jerboa_scenes::Instance { mesh: scene.meshes.len() - 1, to_world });
}

/// A light without a surface, straight above the origin and shining down.
pub fn light(kind: jerboa_scenes::LightKind, intensity: f32, height: f64) -> jerboa_scenes::Light {
    let down = glam::DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let to_world = glam::DAffine3::from_translation(DVec3::Y * height) * down;
    jerboa_scenes::Light { name: "light".into(), kind, intensity: [intensity; 3], to_world }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_closed_and_nearly_round() {
        for level in [0, 2, 4] {
            let mesh = sphere(level);
            assert_eq!(mesh.triangles.len(), 20 * 4_usize.pow(level));
            // Euler: corners − edges + faces = 2, and each triangle has three halves of edges.
            assert_eq!(mesh.positions.len() + mesh.triangles.len() - mesh.triangles.len() * 3 / 2, 2);
            let outward = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                (b - a).cross(c - a).dot(a) > 0.0
            };
            assert!(mesh.triangles.iter().all(outward));
        }
        // The icosahedron's: (3 √3 + √15) / 12 of an edge, an edge 4 / √(10 + 2 √5).
        let edge = 4.0 / (10.0 + 2.0 * 5_f64.sqrt()).sqrt();
        assert!((inradius(&sphere(0)) - edge * (3.0 * 3_f64.sqrt() + 15_f64.sqrt()) / 12.0).abs() < 1e-6);
        assert!(inradius(&sphere(4)) > 0.9988);
    }

    #[test]
    fn an_estimate_is_refused_for_each_reason() {
        let estimate = |mean, error| Estimate { mean, error, paths: 1_000_000 };
        let fault = |mean, error| estimate(mean, error).fault(1.0, 1e-3, 5e-3);
        assert_eq!(fault(1.004, 1e-3), None);
        assert!(fault(1.006, 1e-3).is_some_and(|f| f.contains("4 standard errors")));
        assert!(fault(1.0, 2e-3).is_some_and(|f| f.contains("too large")));
        assert!(fault(f64::NAN, 1e-3).is_some());
        assert_eq!(estimate(1.01, 4e-3).fault(1.0, 0.0, bound(5e-3, 10_000)), None);
    }
}
