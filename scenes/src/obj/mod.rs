//! Wavefront OBJ and MTL to a [`Scene`]: the format of the paper's own scenes.
//!
//! Read by our own few lines, since the library for it (tobj 4.0.5) can be made to panic by a file (`Kd 1 2`), and names no
//! line. Triangles of one material are one [`Mesh`]: groups and objects only name things. A polygon is a fan from its first
//! corner. A file has neither camera nor sky: the caller gives them, or the scene is framed.

mod lines;
mod material;

use crate::error::warn;
use crate::folder::{self, Resolved, beside};
use crate::{Error, Instance, Limits, Mesh, Scene};
use glam::{DAffine3, Vec2, Vec3};
use lines::{Line, lines};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Statements that shape nothing a path tracer sees: names, smoothing (normals are in the file or the surface is flat),
/// display.
const SILENT: [&str; 6] = ["o", "g", "s", "mg", "bevel", "lod"];

/// A scene under construction.
struct Loader<'a> {
    file: &'a Path,
    limits: &'a Limits,
    scene: Scene,
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    /// Libraries so far: each is read once, however often it is named.
    libraries: HashSet<PathBuf>,
    /// Their materials, by name.
    materials: HashMap<String, usize>,
    /// Of each file of a texture, what became of it; `None` where the image cannot be had.
    images: HashMap<String, Option<usize>>,
    images_left: u64,
    /// Meshes under construction, by material.
    meshes: HashMap<usize, Building>,
    /// The material of the faces that come.
    current: Option<usize>,
    triangles: u64,
}

/// A mesh, and the vertices it has by the indices that name them.
#[derive(Default)]
struct Building {
    mesh: Mesh,
    vertices: HashMap<Corner, u32>,
}

/// The indices of a corner of a face: position, texture coordinates, normal.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Corner {
    position: usize,
    uv: Option<usize>,
    normal: Option<usize>,
}

/// Loads an .obj file with the .mtl files that it names.
pub(crate) fn load(file: &Path, limits: &Limits) -> Result<Scene, Error> {
    let bytes = folder::read(file, limits)?;
    let text = String::from_utf8_lossy(&bytes);
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into();
    let mut loader = Loader {
        file,
        limits,
        scene: Scene { name, ..Scene::default() },
        positions: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        libraries: HashSet::new(),
        materials: HashMap::new(),
        images: HashMap::new(),
        images_left: limits.images_bytes,
        meshes: HashMap::new(),
        current: None,
        triangles: 0,
    };
    for line in lines(file, &text) {
        loader.statement(&line)?;
    }
    loader.finish()
}

impl Loader<'_> {
    fn statement(&mut self, line: &Line) -> Result<(), Error> {
        match line.keyword() {
            "v" => self.positions.push(line.numbers()?.into()),
            // v = 0 is the bottom row of an image.
            "vt" => {
                let [u, v] = line.numbers()?;
                self.uvs.push(Vec2::new(u, 1.0 - v));
            }
            "vn" => self.normals.push(Vec3::from(line.numbers()?).normalize_or_zero()),
            "f" => self.face(line)?,
            "mtllib" => self.library(line)?,
            "usemtl" => self.current = Some(self.material(line)),
            silent if SILENT.contains(&silent) => {}
            other => {
                warn(&mut self.scene.warnings, &line.place(), format!("`{other}` is not read: only polygons are"));
            }
        }
        Ok(())
    }

    /// The material that a `usemtl` names.
    fn material(&mut self, line: &Line) -> usize {
        if let Some(known) = self.materials.get(line.rest()) {
            return *known;
        }
        let message = format!("material \"{}\" is in no library: grey is used", line.rest());
        warn(&mut self.scene.warnings, &line.place(), message);
        let grey = self.grey(line.rest());
        self.materials.insert(line.rest().into(), grey);
        grey
    }

    /// A new material for faces without one.
    fn grey(&mut self, name: &str) -> usize {
        self.scene.materials.push(crate::Material::diffuse(name, [0.5; 3]));
        self.scene.materials.len() - 1
    }

    /// A polygon, as a fan of triangles.
    fn face(&mut self, line: &Line) -> Result<(), Error> {
        let corners = line.words().map(|word| self.corner(line, word)).collect::<Result<Vec<_>, _>>()?;
        if corners.len() < 3 {
            return Err(line.fault(format!("a face of {} corners", corners.len())));
        }
        self.triangles += corners.len() as u64 - 2;
        if self.triangles > self.limits.triangles {
            let limit = format!("{} (triangles)", self.limits.triangles);
            return Err(self.too_large(line, format!("{} triangles up to here", self.triangles), limit));
        }
        let material = match self.current {
            Some(material) => material,
            None => {
                let grey = self.grey("");
                *self.current.insert(grey)
            }
        };
        let building = self.meshes.entry(material).or_default();
        let mesh = &mut building.mesh;
        let mut indices = Vec::with_capacity(corners.len());
        for corner in corners {
            let next = mesh.positions.len() as u32;
            indices.push(*building.vertices.entry(corner).or_insert(next));
            if indices.last() == Some(&next) {
                mesh.positions.push(self.positions[corner.position]);
                // Where a mesh has some, a vertex without is at the origin of the image, or takes the face's normal.
                extend(&mut mesh.uvs[0], next, corner.uv.map(|i| self.uvs[i]));
                extend(&mut mesh.normals, next, corner.normal.map(|i| self.normals[i]));
            }
        }
        mesh.triangles.extend(indices[1..].windows(2).map(|pair| [indices[0], pair[0], pair[1]]));
        Ok(())
    }

    /// A corner of a face: `position`, `position/uv`, `position//normal` or `position/uv/normal`.
    fn corner(&self, line: &Line, word: &str) -> Result<Corner, Error> {
        let mut parts = word.split('/');
        let mut next = |count: usize, of: &str| match parts.next() {
            None | Some("") => Ok(None),
            Some(part) => index(line, part, count, of).map(Some),
        };
        let position = next(self.positions.len(), "positions")?;
        let uv = next(self.uvs.len(), "texture coordinates")?;
        let normal = next(self.normals.len(), "normals")?;
        let position = position.filter(|_| parts.next().is_none());
        let position = position.ok_or_else(|| line.fault(format!("\"{word}\" is not the corner of a face")))?;
        Ok(Corner { position, uv, normal })
    }

    /// The bytes of a file that a line names; none, with a warning, where there is no such file.
    fn named(&mut self, line: &Line, name: &str) -> Result<Option<Vec<u8>>, Error> {
        let name = name.replace('\\', "/");
        match beside(self.file, &name, self.limits)? {
            Ok(Resolved::Bytes(bytes)) => Ok(Some(bytes)),
            Ok(Resolved::Missing(reason)) => {
                warn(&mut self.scene.warnings, &line.place(), format!("\"{name}\" {reason}: it is left out"));
                Ok(None)
            }
            Err(reason) => Err(Error::Uri {
                file: self.file.into(),
                path: line.place(),
                uri: name.chars().take(80).collect(),
                reason: reason.into(),
            }),
        }
    }

    fn too_large(&self, line: &Line, what: String, limit: String) -> Error {
        Error::Limit { file: self.file.into(), path: line.place(), what, limit }
    }

    /// The scene, with one mesh for each material that has triangles, in order of materials.
    fn finish(mut self) -> Result<Scene, Error> {
        let mut meshes: Vec<(usize, Building)> = self.meshes.into_iter().collect();
        meshes.sort_by_key(|(material, _)| *material);
        let mut shining = 0;
        for (material, Building { mesh, .. }) in meshes {
            let of = &self.scene.materials[material];
            shining += if of.is_emissive() { mesh.triangles.len() as u64 } else { 0 };
            let mesh = Mesh { name: of.name.clone(), material, ..mesh };
            self.scene.instances.push(Instance { mesh: self.scene.meshes.len(), to_world: DAffine3::IDENTITY });
            self.scene.meshes.push(mesh);
        }
        if shining > self.limits.lights {
            return Err(Error::Limit {
                file: self.file.into(),
                path: String::new(),
                what: format!("{shining} triangles that shine"),
                limit: format!("{} (lights)", self.limits.lights),
            });
        }
        Ok(self.scene)
    }
}

/// Adds an attribute of a vertex of this number; vertices before the first that has one get zeros.
fn extend<T: Clone + Default>(list: &mut Option<Vec<T>>, vertex: u32, value: Option<T>) {
    if list.is_none() && value.is_some() {
        *list = Some(vec![T::default(); vertex as usize]);
    }
    if let Some(list) = list {
        list.push(value.unwrap_or_default());
    }
}

/// An index from 1, or from the end of what is there so far where it is negative, as one from 0.
fn index(line: &Line, part: &str, count: usize, of: &str) -> Result<usize, Error> {
    let given: i64 = part.parse().map_err(|_| line.fault(format!("\"{part}\" is not an index")))?;
    let index = if given > 0 { given - 1 } else { (count as i64).saturating_add(given) };
    let valid = usize::try_from(index).ok().filter(|i| given != 0 && *i < count);
    valid.ok_or_else(|| line.fault(format!("index {given}, but there are {count} {of} up to here")))
}
