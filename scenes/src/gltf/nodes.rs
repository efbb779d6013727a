//! The node tree, walked without recursion: transforms composed in double precision, cycles and shared nodes refused. First
//! where every node is, then what the nodes carry: a skin's joints may come after the mesh they move.

use super::Loader;
use super::animation::Pose;
use super::json::Json;
use super::schema::ComponentType;
use crate::error::warn;
use crate::{Error, Instance};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use std::ops::Range;

/// A node still to visit.
struct Visit<'a> {
    index: usize,
    node: Json<'a>,
    parent: DAffine3,
    depth: usize,
    /// No node above has a transform that cannot be used.
    shown: bool,
}

impl<'a> Loader<'a> {
    /// Walks the trees under the roots of `scene`, or, without a scene, under every node that is no other's child.
    pub fn nodes(&mut self, scene: Option<&Json<'a>>) -> Result<(), Error> {
        let roots = match scene {
            Some(scene) => self.children(scene, "nodes")?,
            None => self.orphans()?,
        };
        let visit = |parent, depth, shown| move |(index, node)| Visit { index, node, parent, depth, shown };
        let mut visited = vec![false; self.root.len("nodes")];
        let mut stack: Vec<Visit> = roots.into_iter().rev().map(visit(DAffine3::IDENTITY, 1, true)).collect();
        let mut carriers = Vec::new();
        while let Some(Visit { index, node, parent, depth, mut shown }) = stack.pop() {
            if std::mem::replace(&mut visited[index], true) {
                return Err(node.fault("reached twice: it has two parents, or is its own ancestor"));
            }
            if depth > self.limits.node_depth {
                let limit = format!("{} (node_depth)", self.limits.node_depth);
                return Err(node.limit_fault(format!("a node tree of {depth} levels"), limit));
            }
            let to_world = parent * transform(&node, self.poses.get(&index))?;
            self.world.insert(index, to_world);
            if shown && !usable(&to_world) {
                let message =
                    "the transform is singular or leaves single precision: the node and all below it are left out";
                warn(&mut self.scene.warnings, &node.path, message);
                shown = false;
            }
            stack.extend(self.children(&node, "children")?.into_iter().rev().map(visit(to_world, depth + 1, shown)));
            if shown {
                carriers.push((index, node));
            }
        }
        for (index, node) in carriers {
            self.contents(index, &node, self.world[&index])?;
        }
        Ok(())
    }

    /// What a node carries: a mesh, a camera, a light.
    fn contents(&mut self, index: usize, node: &Json<'a>, to_world: DAffine3) -> Result<(), Error> {
        if let Some(reference) = node.get("mesh") {
            let shape = self.shape(index, node, &reference)?;
            let meshes = self.meshes(&reference, &shape)?;
            match node.extension("EXT_mesh_gpu_instancing")? {
                // Bent vertices are in the world, wherever the node is (glTF 2.0, section 3.7.3.3).
                _ if shape.skin.is_some() => self.instances(node, meshes, DAffine3::IDENTITY)?,
                Some(many) => self.repeat(&many, node, meshes, to_world)?,
                None => self.instances(node, meshes, to_world)?,
            }
        }
        if let Some(reference) = node.get("camera") {
            self.camera(&reference, node, to_world)?;
        }
        if let Some(light) = node.extension("KHR_lights_punctual")? {
            self.light(&light.need("light")?, to_world)?;
        }
        Ok(())
    }

    /// The instances of EXT_mesh_gpu_instancing: each has a transform of its own below the node's.
    fn repeat(
        &mut self,
        many: &Json<'a>,
        node: &Json<'a>,
        meshes: Range<usize>,
        to_world: DAffine3,
    ) -> Result<(), Error> {
        let attributes = many.need("attributes")?;
        let first = ["TRANSLATION", "ROTATION", "SCALE"].into_iter().find_map(|name| attributes.get(name));
        let first = first.ok_or_else(|| attributes.fault("neither TRANSLATION, ROTATION nor SCALE"))?;
        let count = self.accessor(&first)?.count;
        self.repeats_left = self.repeats_left.checked_sub(count).ok_or_else(|| {
            let limit = format!("{} (instances)", self.limits.instances);
            attributes.limit_fault(format!("the scene up to here, {count} instances more,"), limit)
        })?;
        let integers = [ComponentType::I8, ComponentType::I16];
        let translations = self.optional::<3>(&attributes, "TRANSLATION", count, &[], 0.0)?;
        let rotations = self.optional::<4>(&attributes, "ROTATION", count, &integers, 0.0)?;
        let scales = self.optional::<3>(&attributes, "SCALE", count, &[], 0.0)?;
        for i in 0..count {
            let get = |of: &Option<Vec<[f32; 3]>>, or| of.as_ref().map_or(or, |v| DVec3::from(v[i].map(f64::from)));
            let turned = rotations.as_ref().map_or(DQuat::IDENTITY, |v| DQuat::from_array(v[i].map(f64::from)));
            let (scale, moved) = (get(&scales, DVec3::ONE), get(&translations, DVec3::ZERO));
            let to_world = to_world * DAffine3::from_scale_rotation_translation(scale, turned.normalize(), moved);
            if !usable(&to_world) {
                let message = "an instance whose transform is singular or leaves single precision is left out";
                warn(&mut self.scene.warnings, &attributes.path, message);
                continue;
            }
            self.instances(node, meshes.clone(), to_world)?;
        }
        Ok(())
    }

    fn instances(&mut self, node: &Json<'a>, mut meshes: Range<usize>, to_world: DAffine3) -> Result<(), Error> {
        meshes.try_for_each(|mesh| self.instance(node, mesh, to_world))
    }

    fn instance(&mut self, node: &Json<'a>, mesh: usize, to_world: DAffine3) -> Result<(), Error> {
        let (low, high) = self.bounds[mesh];
        let corner = |i: u32| {
            let pick = |axis: usize| f64::from(if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
            to_world.transform_point3(DVec3::from_array([0, 1, 2].map(pick)))
        };
        if !(0..8).all(|i| corner(i).as_vec3().is_finite()) {
            warn(&mut self.scene.warnings, &node.path, "the mesh leaves single precision in the world and is left out");
            return Ok(());
        }
        if self.scene.instances.len() == self.limits.instances {
            let limit = format!("{} (instances)", self.limits.instances);
            return Err(node.limit_fault("one more instance".into(), limit));
        }
        let triangles = self.scene.meshes[mesh].triangles.len() as u64;
        self.triangles_left = self.triangles_left.checked_sub(triangles).ok_or_else(|| {
            let limit = format!("{} in the world (triangles)", self.limits.triangles);
            node.limit_fault(format!("the scene up to here, {triangles} triangles more,"), limit)
        })?;
        if self.scene.materials[self.scene.meshes[mesh].material].is_emissive() {
            self.count_lights(node, triangles)?;
        }
        self.scene.instances.push(Instance { mesh, to_world });
        Ok(())
    }

    fn children(&self, at: &Json<'a>, key: &str) -> Result<Vec<(usize, Json<'a>)>, Error> {
        at.list(key)?.iter().map(|child| child.refer(&self.root, "nodes", "nodes")).collect()
    }

    fn orphans(&self) -> Result<Vec<(usize, Json<'a>)>, Error> {
        let nodes = self.root.list("nodes")?;
        let mut has_parent = vec![false; nodes.len()];
        for node in &nodes {
            for (child, _) in self.children(node, "children")? {
                has_parent[child] = true;
            }
        }
        Ok(nodes.into_iter().enumerate().filter(|(i, _)| !has_parent[*i]).collect())
    }
}

/// A node's transform to its parent: `matrix`, or translation · rotation · scale, which animations may have set.
fn transform(node: &Json, pose: Option<&Pose>) -> Result<DAffine3, Error> {
    let moves = |p: &&Pose| p.translation.is_some() || p.rotation.is_some() || p.scale.is_some();
    let pose = pose.filter(moves);
    if let Some(place) = node.get("matrix") {
        if pose.is_some() {
            return Err(place.fault("the node is animated, which a matrix cannot be"));
        }
        let matrix = DMat4::from_cols_array(&place.numbers::<16>()?);
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            return Err(place.fault("the last row is not 0, 0, 0, 1"));
        }
        return Ok(DAffine3::from_mat4(matrix));
    }
    let rotation = DQuat::from_array(node.numbers_or("rotation", [0.0, 0.0, 0.0, 1.0])?);
    if rotation.length_squared() < 1e-12 {
        return Err(node.need("rotation")?.fault("a quaternion of length 0"));
    }
    let scale = DVec3::from_array(node.numbers_or("scale", [1.0; 3])?);
    let translation = DVec3::from_array(node.numbers_or("translation", [0.0; 3])?);
    let (rotation, none) = (rotation.normalize(), Pose::default());
    let pose = pose.unwrap_or(&none);
    Ok(DAffine3::from_scale_rotation_translation(
        pose.scale.unwrap_or(scale),
        pose.rotation.unwrap_or(rotation),
        pose.translation.unwrap_or(translation),
    ))
}

/// Finite, and with axes that are neither flat nor too short, also once rounded to single precision.
fn usable(to_world: &DAffine3) -> bool {
    let finite = to_world.to_cols_array().iter().all(|x| (*x as f32).is_finite());
    let axes = [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis];
    let long = axes.iter().all(|a| a.length() >= f64::from(f32::MIN_POSITIVE));
    // The determinant itself could underflow at scales that are sound.
    let [x, y, z] = axes.map(|a| a.normalize_or_zero());
    finite && long && x.cross(y).dot(z) != 0.0 && to_world.inverse().is_finite()
}
