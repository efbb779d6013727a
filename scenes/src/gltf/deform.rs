//! Meshes that do not keep their shape: morph targets, and skins.

use super::Loader;
use super::json::Json;
use super::schema::ComponentType;
use crate::error::warn;
use crate::{Error, Mesh};
use glam::{DAffine3, DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};
use std::rc::Rc;

/// What the node that shows a mesh does to its shape.
#[derive(Clone, Default)]
pub(super) struct Shape {
    /// Weights of the morph targets, one for each.
    pub weights: Vec<f32>,
    /// Skin by its index, with its joints: mesh to world.
    pub skin: Option<(usize, Rc<Vec<DAffine3>>)>,
}

/// Attributes of a morph target may also be normalised integers.
const FRACTIONS: [ComponentType; 4] = [ComponentType::I8, ComponentType::U8, ComponentType::I16, ComponentType::U16];

impl<'a> Loader<'a> {
    /// The shape in which a node shows a mesh.
    pub fn shape(&mut self, index: usize, node: &Json<'a>, reference: &Json<'a>) -> Result<Shape, Error> {
        let skin = node.get("skin").map(|at| self.skin(&at)).transpose()?;
        let (number, mesh) = reference.refer(&self.root, "meshes", "meshes")?;
        let targets = match self.targets.get(&number) {
            Some(&known) => known,
            None => count_targets(&mesh)?,
        };
        self.targets.insert(number, targets);
        if targets > 0 || skin.is_some() {
            // Many nodes may show one mesh, each in a shape of its own. A look at a primitive takes as long as reading so many bytes.
            self.spend(node, targets, 64)?;
            self.spend(node, mesh.len("primitives"), 1 << 14)?;
        }
        if targets == 0 {
            return Ok(Shape { weights: Vec::new(), skin });
        }
        let posed = self.poses.get(&index).and_then(|pose| pose.weights.clone());
        let place = if posed.is_some() || node.get("weights").is_some() { node } else { &mesh };
        let listed =
            || place.list("weights")?.iter().map(|w| Ok(w.number()? as f32)).collect::<Result<Vec<_>, Error>>();
        let mut weights = posed.map_or_else(listed, Ok)?;
        if weights.is_empty() {
            weights = vec![0.0; targets];
        }
        if weights.len() != targets {
            return Err(place.fault(format!("{} weights for {targets} morph targets", weights.len())));
        }
        Ok(Shape { weights, skin })
    }

    /// The skin that the index at `reference` points to.
    fn skin(&mut self, reference: &Json<'a>) -> Result<(usize, Rc<Vec<DAffine3>>), Error> {
        let (index, at) = reference.refer(&self.root, "skins", "skins")?;
        if let Some(known) = self.skins.get(&index) {
            return Ok((index, known.clone()));
        }
        let joints = at.list("joints")?;
        if joints.is_empty() {
            return Err(at.fault("a skin without joints"));
        }
        let inverse = at.get("inverseBindMatrices").map(|place| self.inverse_bind(&place, joints.len())).transpose()?;
        let mut matrices = Vec::with_capacity(joints.len());
        for (i, joint) in joints.iter().enumerate() {
            let (node, _) = joint.refer(&self.root, "nodes", "nodes")?;
            let world = self.world.get(&node).ok_or_else(|| joint.fault("the joint is not in the scene"))?;
            matrices.push(*world * inverse.as_ref().map_or(DAffine3::IDENTITY, |m| m[i]));
        }
        let matrices = Rc::new(matrices);
        self.skins.insert(index, matrices.clone());
        Ok((index, matrices))
    }

    fn inverse_bind(&mut self, place: &Json<'a>, joints: usize) -> Result<Vec<DAffine3>, Error> {
        let accessor = self.accessor(place)?;
        if accessor.width != 16 || accessor.component != ComponentType::F32 || accessor.count < joints {
            return Err(place.fault(format!("not {joints} MAT4 of floats, one for each joint")));
        }
        let matrices = self.floats::<16>(&accessor, 0.0)?;
        if !matrices.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(place.fault("matrices must be finite"));
        }
        Ok(matrices.iter().map(|m| DAffine3::from_mat4(DMat4::from_cols_array(&m.map(f64::from)))).collect())
    }

    /// Moves the vertices of a primitive by its morph targets, then by its skin.
    pub fn deform(&mut self, at: &Json<'a>, mesh: &mut Mesh, shape: &Shape) -> Result<(), Error> {
        let targets = at.list("targets")?;
        for (target, weight) in targets.iter().zip(&shape.weights).filter(|(_, weight)| **weight != 0.0) {
            self.morph(target, mesh, *weight)?;
        }
        if let Some((_, joints)) = &shape.skin {
            self.bend(&at.need("attributes")?, mesh, joints)?;
        }
        if shape.weights.iter().any(|weight| *weight != 0.0) {
            mesh.normals.iter_mut().flatten().for_each(|n| *n = n.normalize_or_zero());
        }
        Ok(())
    }

    /// Adds a target's differences, times its weight.
    fn morph(&mut self, target: &Json<'a>, mesh: &mut Mesh, weight: f32) -> Result<(), Error> {
        let count = mesh.positions.len();
        if let Some(by) = self.optional::<3>(target, "POSITION", count, &[], 0.0)? {
            mesh.positions.iter_mut().zip(by).for_each(|(p, d)| *p += Vec3::from(d) * weight);
        }
        if let (Some(normals), Some(by)) = (&mut mesh.normals, self.optional::<3>(target, "NORMAL", count, &[], 0.0)?) {
            normals.iter_mut().zip(by).for_each(|(n, d)| *n += Vec3::from(d) * weight);
        }
        if let (Some(tangents), Some(by)) =
            (&mut mesh.tangents, self.optional::<3>(target, "TANGENT", count, &[], 0.0)?)
        {
            tangents.iter_mut().zip(by).for_each(|(t, d)| *t += Vec3::from(d).extend(0.0) * weight);
        }
        for (uvs, name) in mesh.uvs.iter_mut().zip(["TEXCOORD_0", "TEXCOORD_1"]) {
            if let (Some(uvs), Some(by)) = (uvs, self.optional::<2>(target, name, count, &FRACTIONS, 0.0)?) {
                uvs.iter_mut().zip(by).for_each(|(uv, d)| *uv += Vec2::from(d) * weight);
            }
        }
        if let (Some(colors), Some(by)) =
            (&mut mesh.colors, self.optional::<4>(target, "COLOR_0", count, &FRACTIONS, 0.0)?)
        {
            colors.iter_mut().zip(by).for_each(|(c, d)| *c += Vec4::from(d) * weight);
        }
        Ok(())
    }

    /// Moves each vertex by the mean of its joints' matrices. What comes out is in the world.
    fn bend(&mut self, attributes: &Json<'a>, mesh: &mut Mesh, joints: &[DAffine3]) -> Result<(), Error> {
        let count = mesh.positions.len();
        let mut sets = Vec::new();
        while let Some(place) = attributes.get(&format!("JOINTS_{}", sets.len())) {
            let accessor = self.accessor(&place)?;
            let integer = matches!(accessor.component, ComponentType::U8 | ComponentType::U16) && !accessor.normalized;
            if accessor.width != 4 || !integer || accessor.count != count {
                return Err(place.fault(format!("not {count} VEC4 of unsigned bytes or shorts")));
            }
            let numbers = self.floats::<4>(&accessor, 0.0)?;
            let fractions = [ComponentType::U8, ComponentType::U16];
            let name = format!("WEIGHTS_{}", sets.len());
            let weights = self.attribute::<4>(&attributes.need(&name)?, Some(count), &fractions, 0.0)?;
            sets.push((place, numbers, weights));
        }
        if sets.is_empty() {
            return Err(attributes.fault("the node has a skin, but the mesh no JOINTS_0"));
        }
        let mut loose = 0;
        for i in 0..count {
            let mut sum = (DMat3::ZERO, DVec3::ZERO, 0.0);
            for (place, numbers, weights) in &sets {
                for (joint, weight) in numbers[i].iter().zip(weights[i]).filter(|(_, weight)| *weight != 0.0) {
                    let Some(matrix) = joints.get(*joint as usize) else {
                        return Err(place.index_fault(*joint as u64, format!("{} joints", joints.len())));
                    };
                    let weight = f64::from(weight);
                    sum.0 += matrix.matrix3 * weight;
                    sum.1 += matrix.translation * weight;
                    sum.2 += weight;
                }
            }
            // Weights add up to 1, but for the rounding of integers.
            let mean = if sum.2 > 0.0 {
                DAffine3 { matrix3: sum.0 * sum.2.recip(), translation: sum.1 / sum.2 }
            } else {
                loose += 1;
                joints[0]
            };
            transform(mesh, i, &mean);
        }
        if loose > 0 {
            let message = format!("{loose} vertices have no weight: they follow the first joint");
            warn(&mut self.scene.warnings, &attributes.path, message);
        }
        Ok(())
    }
}

/// The number of morph targets of a mesh, the same for all of its primitives.
fn count_targets(mesh: &Json) -> Result<usize, Error> {
    let mut counts = mesh.list("primitives")?.into_iter().map(|p| (p.len("targets"), p));
    let first = counts.next().map_or(0, |(count, _)| count);
    match counts.find(|(count, _)| *count != first) {
        Some((count, p)) => Err(p.fault(format!("{count} morph targets, but the mesh's first primitive has {first}"))),
        None => Ok(first),
    }
}

/// Moves vertex `i`.
fn transform(mesh: &mut Mesh, i: usize, by: &DAffine3) {
    mesh.positions[i] = by.transform_point3(mesh.positions[i].as_dvec3()).as_vec3();
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = by.matrix3;
    let sign = by.matrix3.determinant().signum();
    // Normals transform by the inverse transpose, which is the cofactor matrix up to a factor.
    let cofactor = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign;
    if let Some(normals) = &mut mesh.normals {
        normals[i] = (cofactor * normals[i].as_dvec3()).normalize_or_zero().as_vec3();
    }
    if let Some(tangents) = &mut mesh.tangents {
        let t = tangents[i];
        let along = (by.matrix3 * t.truncate().as_dvec3()).normalize_or_zero().as_vec3();
        tangents[i] = along.extend(t.w * sign as f32);
    }
}
