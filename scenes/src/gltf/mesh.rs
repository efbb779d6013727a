//! Mesh primitives to triangles.

use super::Loader;
use super::deform::Shape;
use super::json::Json;
use super::schema::{ComponentType, Mode};
use crate::error::warn;
use crate::{Error, Mesh};
use glam::{Vec2, Vec3, Vec4};

impl<'a> Loader<'a> {
    /// The meshes of the scene for the glTF mesh that the index at `reference` points to: one per primitive that has
    /// triangles. Loaded once, however often it is instanced in this shape.
    pub fn meshes(&mut self, reference: &Json<'a>, shape: &Shape) -> Result<std::ops::Range<usize>, Error> {
        let (index, at) = reference.refer(&self.root, "meshes", "meshes")?;
        let weights = shape.weights.iter().map(|w| w.to_bits()).collect();
        let key = (index, shape.skin.as_ref().map(|(skin, _)| *skin), weights);
        if let Some(known) = self.meshes.get(&key) {
            return Ok(known.clone());
        }
        let first = self.scene.meshes.len();
        for primitive in at.list("primitives")? {
            if let Some(mesh) = self.primitive(&primitive, at.name(), shape)? {
                self.bounds.push(mesh.bounds());
                self.scene.meshes.push(mesh);
            }
        }
        let range = first..self.scene.meshes.len();
        self.meshes.insert(key, range.clone());
        Ok(range)
    }

    fn primitive(&mut self, at: &Json<'a>, name: String, shape: &Shape) -> Result<Option<Mesh>, Error> {
        let mode = at.word_or("mode", Mode::Triangles)?;
        let attributes = at.need("attributes")?;
        let has_triangles = matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan);
        if !has_triangles || attributes.get("POSITION").is_none() {
            warn(&mut self.scene.warnings, &at.path, "a primitive of points, of lines or without POSITION is left out");
            return Ok(None);
        }
        self.decoded.clear();
        self.decompress(at, mode)?;
        let mut mesh = Mesh { name, ..self.vertices(&attributes)? };
        self.deform(at, &mut mesh, shape)?;
        let corners = self.corners(at, mesh.positions.len())?;
        self.spend(at, corners.len(), 12)?;
        mesh.triangles = self.triangles(at, mode, &corners);
        let material = self.chosen_material(at)?;
        mesh.material = self.material(material)?;
        self.repair(at, &mut mesh);
        self.check_uv_sets(at, &mesh);
        Ok((!mesh.triangles.is_empty()).then_some(mesh))
    }

    /// The material of a primitive: the chosen variant's, else its own.
    fn chosen_material(&mut self, at: &Json<'a>) -> Result<Option<Json<'a>>, Error> {
        if let (Some(chosen), Some(ext)) = (self.variant, at.extension("KHR_materials_variants")?) {
            for mapping in ext.list("mappings")? {
                self.spend(&mapping, 1 + mapping.len("variants"), 64)?;
                for variant in mapping.list("variants")? {
                    if variant.integer()? == chosen as u64 {
                        return Ok(Some(mapping.need("material")?));
                    }
                }
            }
        }
        Ok(at.get("material"))
    }

    /// A mesh of vertices, without triangles yet.
    fn vertices(&mut self, attributes: &Json<'a>) -> Result<Mesh, Error> {
        let positions = self.attribute::<3>(&attributes.need("POSITION")?, None, &[], 0.0)?;
        let count = positions.len();
        let fractions = &[ComponentType::U8, ComponentType::U16];
        let normals = self.optional::<3>(attributes, "NORMAL", count, &[], 0.0)?;
        // Without normals the shading is flat and tangents mean nothing (glTF 2.0, section 3.7.2.1).
        let tangents = match normals {
            Some(_) => self.optional::<4>(attributes, "TANGENT", count, &[], 0.0)?,
            None => None,
        };
        let mut uv = |set| self.optional::<2>(attributes, set, count, fractions, 0.0);
        let uvs = [uv("TEXCOORD_0")?, uv("TEXCOORD_1")?];
        let colors = self.optional::<4>(attributes, "COLOR_0", count, fractions, 1.0)?;
        Ok(Mesh {
            positions: vectors(positions),
            normals: normals.map(vectors),
            tangents: tangents.map(vectors),
            uvs: uvs.map(|uv| uv.map(vectors)),
            colors: colors.map(vectors),
            ..Mesh::default()
        })
    }

    /// The vertices of the primitive's corners, in order.
    fn corners(&mut self, at: &Json<'a>, vertices: usize) -> Result<Vec<u32>, Error> {
        match at.get("indices") {
            Some(reference) => {
                let accessor = self.accessor(&reference)?;
                self.indices(&accessor, vertices)
            }
            None => {
                self.spend(at, vertices, 4)?;
                Ok((0..vertices as u32).collect())
            }
        }
    }

    /// An attribute that need not be there.
    pub fn optional<const N: usize>(
        &mut self,
        attributes: &Json<'a>,
        name: &str,
        count: usize,
        fractions: &[ComponentType],
        fill: f32,
    ) -> Result<Option<Vec<[f32; N]>>, Error> {
        attributes.get(name).map(|reference| self.attribute(&reference, Some(count), fractions, fill)).transpose()
    }

    /// A vertex attribute of `N` components (a COLOR_0 may have 3 of its 4, and the last is `fill`). Floats are always allowed;
    /// `fractions` lists the normalised integers that glTF's core allows; KHR_mesh_quantization allows every 8- and 16-bit
    /// integer.
    pub fn attribute<const N: usize>(
        &mut self,
        reference: &Json<'a>,
        count: Option<usize>,
        fractions: &[ComponentType],
        fill: f32,
    ) -> Result<Vec<[f32; N]>, Error> {
        let accessor = self.accessor(reference)?;
        let color = reference.path.ends_with("COLOR_0");
        if accessor.width != N && !(color && accessor.width == 3) {
            return Err(reference.fault(format!("an accessor of {} components, not {N}", accessor.width)));
        }
        let integer = accessor.component != ComponentType::U32 && self.quantized && !color;
        let fraction = accessor.normalized && fractions.contains(&accessor.component);
        if accessor.component != ComponentType::F32 && !integer && !fraction {
            return Err(reference.fault("this component type needs KHR_mesh_quantization in extensionsUsed"));
        }
        if let Some(count) = count.filter(|&c| c != accessor.count) {
            return Err(reference.fault(format!("{} elements, where others have {count}", accessor.count)));
        }
        self.floats(&accessor, fill)
    }

    /// Corners to triangles of the same winding (glTF 2.0, section 3.7.2.1).
    fn triangles(&mut self, at: &Json, mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
        match mode {
            Mode::TriangleStrip => corners
                .windows(3)
                .enumerate()
                .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
                .collect(),
            Mode::TriangleFan => corners.windows(2).skip(1).map(|w| [w[0], w[1], corners[0]]).collect(),
            _ => {
                if !corners.len().is_multiple_of(3) {
                    warn(
                        &mut self.scene.warnings,
                        &at.path,
                        "the number of corners is no multiple of 3: the rest is left out",
                    );
                }
                corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
            }
        }
    }

    /// Leaves only finite numbers: triangles with a non-finite corner are dropped, other attributes get a neutral value.
    fn repair(&mut self, at: &Json, mesh: &mut Mesh) {
        let before = mesh.triangles.len();
        let positions = &mesh.positions;
        mesh.triangles.retain(|t| t.iter().all(|&i| positions[i as usize].is_finite()));
        let dropped = before - mesh.triangles.len();
        if dropped > 0 {
            let message = format!("{dropped} of {before} triangles have a non-finite corner and are left out");
            warn(&mut self.scene.warnings, &at.path, message);
        }
        neutralise(&mut mesh.positions, Vec3::is_finite, Vec3::ZERO);
        let mut neutral = mesh.normals.as_mut().map_or(0, |v| neutralise(v, Vec3::is_finite, Vec3::ZERO));
        neutral += mesh.tangents.as_mut().map_or(0, |v| neutralise(v, Vec4::is_finite, Vec4::ZERO));
        neutral += mesh.colors.as_mut().map_or(0, |v| neutralise(v, Vec4::is_finite, Vec4::ONE));
        for uv in mesh.uvs.iter_mut().flatten() {
            neutral += neutralise(uv, Vec2::is_finite, Vec2::ZERO);
        }
        let unit = |c: Vec4| c.clamp(Vec4::ZERO, Vec4::ONE);
        if mesh.colors.as_ref().is_some_and(|colors| colors.iter().any(|c| unit(*c) != *c)) {
            warn(&mut self.scene.warnings, &at.path, "vertex colours outside 0..=1 are clamped");
        }
        mesh.colors.iter_mut().flatten().for_each(|c| *c = unit(*c));
        if neutral > 0 {
            let message =
                format!("{neutral} normals, tangents, colours or texture coordinates are not finite and are replaced");
            warn(&mut self.scene.warnings, &at.path, message);
        }
    }

    fn check_uv_sets(&mut self, at: &Json, mesh: &Mesh) {
        let lacking = |set: usize| mesh.uvs[set].is_none();
        if self.scene.materials[mesh.material].textures().any(|t| lacking(t.uv_set)) {
            let message = "the material's textures use coordinates that the mesh lacks: they are looked up at (0, 0)";
            warn(&mut self.scene.warnings, &at.path, message);
        }
    }
}

fn vectors<const N: usize, V: From<[f32; N]>>(floats: Vec<[f32; N]>) -> Vec<V> {
    floats.into_iter().map(V::from).collect()
}

/// Replaces what is not finite and says how many.
fn neutralise<T: Copy>(values: &mut [T], finite: fn(T) -> bool, neutral: T) -> usize {
    let mut replaced = 0;
    for v in values.iter_mut().filter(|v| !finite(**v)) {
        *v = neutral;
        replaced += 1;
    }
    replaced
}
