//! Which instances share the triangles of their mesh, and the trees of those meshes.
//!
//! A mesh that is there several times is laid out once, in a frame of its own, if that saves enough; all else is laid out in
//! the world. Meshes that emit are too: light is drawn from triangles of the world. So is an instance whose transform would
//! lose too much ([`Placing`]).

use std::collections::HashMap;

use glam::{DAffine3, DVec3};
use jerboa_scenes::{Instance, Mesh, Scene};
use rayon::prelude::*;

use super::geometry::Placed;
use super::placing::Placing;
use crate::host::bvh::{Bounds, Instanced, MeshTree, Placement, Triangle};

/// Most triangles that a mesh's copies, all its instances but one, may have in the world before they share. One in the
/// world takes 310 bytes of a render's peak (tests/runs/instances.txt), so this is 80 MB. What
/// sharing costs in time has not been measured.
pub const MOST_COPIES: u32 = 1 << 18;

/// How each instance shares, in their order; none where it does not.
pub type Sharing = Vec<Option<Placing>>;

/// Who shares, if copies may have so many triangles. `origin` is subtracted from world positions.
pub fn sharing(scene: &Scene, origin: DVec3, most_copies: u32) -> Sharing {
    let mut users = vec![0_u64; scene.meshes.len()];
    scene.instances.iter().for_each(|instance| users[instance.mesh] += 1);
    let saves = |mesh: usize, users: u64| {
        users.saturating_sub(1) * scene.meshes[mesh].triangles.len() as u64 > u64::from(most_copies)
    };
    let may = |mesh: usize| saves(mesh, users[mesh]) && !scene.materials[scene.meshes[mesh].material].is_emissive();
    let zeros: Vec<Option<DVec3>> =
        scene.meshes.iter().enumerate().map(|(number, mesh)| may(number).then(|| zero(mesh))).collect();
    let placing = |instance: &Instance| {
        let to_world = instance.to_world * DAffine3::from_translation(zeros[instance.mesh]?);
        Placing::new(DAffine3 { translation: to_world.translation - origin, ..to_world })
    };
    let mut sharing: Sharing = scene.instances.par_iter().map(placing).collect();
    let mut sharers = vec![0; scene.meshes.len()];
    let both = || scene.instances.iter().zip(&sharing);
    both().filter(|(_, placing)| placing.is_some()).for_each(|(instance, _)| sharers[instance.mesh] += 1);
    for (instance, placing) in scene.instances.iter().zip(&mut sharing) {
        placing.take_if(|_| !saves(instance.mesh, sharers[instance.mesh]));
    }
    sharing
}

/// A mesh in its frame.
pub(super) fn in_frame(number: usize, mesh: &Mesh) -> Instance {
    Instance { mesh: number, to_world: DAffine3::from_translation(-zero(mesh)) }
}

/// What becomes zero of its frame: the point nearest to it in the mesh's box, so that zero is where the mesh is.
fn zero(mesh: &Mesh) -> DVec3 {
    let corners = mesh.positions.iter().map(|p| (p.as_dvec3(), p.as_dvec3()));
    let (low, high) = corners.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default();
    DVec3::ZERO.clamp(low, high)
}

/// The tree over a scene whose instances share; none if a walk could not hold what waits there, or no reference reach it.
pub(super) fn tree(scene: &Scene, origin: DVec3, sharing: &Sharing) -> Option<Instanced> {
    let (mut in_world, mut placements, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
    let mut rows: HashMap<usize, usize> = HashMap::new();
    let mut first = 0;
    for (instance, placing) in scene.instances.iter().zip(sharing) {
        let mesh = &scene.meshes[instance.mesh];
        match placing {
            Some(placing) => {
                let tree = *rows.entry(instance.mesh).or_insert_with(|| {
                    meshes.push(instance.mesh);
                    meshes.len() - 1
                });
                let Placing { zero, to_frame, .. } = *placing;
                placements.push((placing, Placement { tree, first, zero, to_frame, bounds: Bounds::EMPTY }));
            }
            None => in_world.extend((first..).zip(placed_triangles(instance, mesh, origin))),
        }
        first += mesh.triangles.len() as u32;
    }
    let mesh_tree = |number: &usize| {
        let mesh = &scene.meshes[*number];
        MeshTree::build(placed_triangles(&in_frame(*number, mesh), mesh, DVec3::ZERO))
    };
    let trees: Vec<MeshTree> = meshes.par_iter().map(mesh_tree).collect();
    let parts: Vec<_> = trees.iter().map(MeshTree::parts).collect();
    let bounded = |(placing, placement): (&Placing, Placement)| Placement {
        bounds: placing.bounds(&parts[placement.tree]),
        ..placement
    };
    let placements: Vec<Placement> = placements.into_par_iter().map(bounded).collect();
    Instanced::build(&in_world, &trees, &placements)
}

fn placed_triangles(instance: &Instance, mesh: &Mesh, origin: DVec3) -> Vec<Triangle> {
    let placed = Placed::new(instance, mesh, origin);
    placed.corners(mesh).map(|corners| placed.triangle(corners)).collect()
}
