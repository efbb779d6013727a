//! The scene: lists that refer to each other by index.

use crate::error::warn;
use crate::*;
use glam::DVec3;
use std::path::Path;

/// A scene in the host's memory. Every index is in range and every number finite (distances of absorption may be
/// infinite), whatever file it came from. Right-handed, +Y up, metres by convention.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The file's stem or the built-in's name.
    pub name: String,
    /// Triangles, one entry per material and mesh.
    pub meshes: Vec<Mesh>,
    /// Meshes in the world.
    pub instances: Vec<Instance>,
    /// Surfaces.
    pub materials: Vec<Material>,
    /// Textures that materials refer to.
    pub textures: Vec<Texture>,
    /// Images that textures refer to.
    pub images: Vec<Image>,
    /// Cameras, in the order of the node tree.
    pub cameras: Vec<Camera>,
    /// Lights without a surface.
    pub lights: Vec<Light>,
    /// What textures and lights of a user's crate are called, and the numbers they take. No file has them.
    pub own: Vec<Model>,
    /// Light from infinitely far.
    pub environment: Option<Environment>,
    /// What was repaired or left out while loading.
    pub warnings: Vec<Warning>,
}

impl Scene {
    /// Loads a .gltf, .glb or .obj file, or a built-in scene by `builtin:NAME`, within the default [`Limits`].
    pub fn load(path: impl AsRef<Path>) -> Result<Scene, Error> {
        Scene::load_within(path, &Limits::default())
    }

    /// Like [`Scene::load`], within limits of one's own.
    pub fn load_within(path: impl AsRef<Path>, limits: &Limits) -> Result<Scene, Error> {
        Scene::load_selected(path, &Selection::default(), limits)
    }

    /// Like [`Scene::load_within`], of a file that holds more than one scene, variant or moment. A built-in scene and
    /// an .obj file hold one of each.
    pub fn load_selected(path: impl AsRef<Path>, selection: &Selection, limits: &Limits) -> Result<Scene, Error> {
        let path = path.as_ref();
        let builtin = path.to_str().and_then(|p| p.strip_prefix("builtin:"));
        let is_obj = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
        if builtin.is_none() && !is_obj {
            return gltf::load(path, selection, limits);
        }
        let Selection { scene, variant, animation, .. } = selection;
        for (noun, asked) in [("scene", scene), ("variant", variant), ("animation", animation)] {
            if let Some(asked) = asked {
                selection::choose(noun, asked, std::iter::empty())?;
            }
        }
        builtin.map_or_else(|| obj::load(path, limits), builtin::build)
    }

    /// Replaces the environment by a lat-long .hdr or .exr image; texels that are not finite or negative become 0, with a
    /// warning. `intensity` multiplies it, `rotation_deg` turns it about +Y.
    pub fn set_environment(&mut self, file: impl AsRef<Path>, intensity: f32, rotation_deg: f32) -> Result<(), Error> {
        let (file, limits) = (file.as_ref(), Limits::default());
        let bad = |what: &str, x: f32| Error::Environment {
            file: file.into(),
            path: String::new(),
            reason: format!("{what} {x} is out of range"),
        };
        if !(intensity.is_finite() && intensity >= 0.0) {
            return Err(bad("strength", intensity));
        }
        if !rotation_deg.is_finite() {
            return Err(bad("rotation", rotation_deg));
        }
        let (environment, repaired) = environment::decode(file, "", &folder::read(file, &limits)?, &limits)?;
        if repaired > 0 {
            let message = format!("{repaired} texels of {} are not finite or negative: 0 is used", file.display());
            warn(&mut self.warnings, "", message);
        }
        self.environment = Some(Environment { intensity, rotation_deg, ..environment });
        Ok(())
    }

    /// The camera of a name, or of a number, from 0.
    pub fn camera_named(&self, name: &str) -> Result<&Camera, Error> {
        let names = self.cameras.iter().map(|c| c.name.as_str());
        Ok(&self.cameras[selection::choose("camera", name, names)?])
    }

    /// The first camera; without one, a camera that sees the whole scene from the front, a little from above.
    pub fn camera_or_default(&self) -> Camera {
        if let Some(first) = self.cameras.first() {
            return first.clone();
        }
        const YFOV: f64 = 0.7;
        let (low, high) = self.bounds().unwrap_or((DVec3::NEG_ONE, DVec3::ONE));
        let centre = (low + high) / 2.0;
        // The sphere around the box fills the film's height; a single point gets a distance of 1.
        let radius = ((high - low).length() / 2.0).max(f64::from(f32::MIN_POSITIVE));
        let distance = radius / (YFOV / 2.0).sin();
        let eye = centre + DVec3::new(0.0, 0.25, 1.0).normalize() * distance;
        Camera::look_at("default", eye, centre, YFOV)
    }

    /// The corners of the box around all triangles in the world; `None` without triangles.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let corners = self.instances.iter().flat_map(|instance| {
            let mesh = &self.meshes[instance.mesh];
            let vertices = mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]);
            vertices.map(|p| instance.to_world.transform_point3(p.as_dvec3()))
        });
        corners.map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Triangles in the world, counted with their instances.
    pub fn triangle_count(&self) -> usize {
        self.instances.iter().map(|i| self.meshes[i.mesh].triangles.len()).sum()
    }

    /// All warnings as of now: those of loading, and what the scene lacks for an image.
    pub fn all_warnings(&self) -> Vec<Warning> {
        let mut all = self.warnings.clone();
        if self.triangle_count() == 0 {
            warn(&mut all, "", "the scene has no triangles");
        }
        if self.cameras.is_empty() {
            warn(&mut all, "", "the scene has no camera: the whole scene is framed");
        }
        if !self.has_light() {
            warn(&mut all, "", "the scene has no light: the image will be black");
        }
        all
    }

    /// Whether anything can make a pixel bright.
    fn has_light(&self) -> bool {
        let shines = |i: &Instance| {
            let material = &self.materials[self.meshes[i.mesh].material];
            material.is_emissive() || material.unlit
        };
        self.lights.iter().any(|l| l.intensity.iter().any(|&c| c > 0.0))
            || self.environment.as_ref().is_some_and(|e| e.intensity > 0.0)
            || self.instances.iter().any(shines)
    }
}
