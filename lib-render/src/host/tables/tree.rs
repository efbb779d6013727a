//! The tree over the triangles of a scene, for whoever walks it: each triangle is in one tree only.

use std::borrow::Cow;
use std::sync::Arc;

use jerboa_scenes::{AlphaMode, Material, Scene};

use super::memory::Memory;
use super::{Choices, materials};
use crate::host::bvh::{Bounds, Bvh, Dropped, Instanced, Triangle};
use crate::host::device::Traversal;
use crate::host::native::Native;

/// The trees of a scene.
pub(super) struct SceneTree {
    /// For kernels. Where the native walk is there, of triangles that may have holes only.
    pub words: Memory,
    /// For the native walk, of the others.
    pub native: Option<Arc<Native>>,
    /// Around all triangles.
    pub bounds: Bounds,
    /// Triangles that are in none.
    pub dropped: Dropped,
}

/// Has a surface of each material holes, or is it none from behind?
pub(super) fn cutouts(scene: &Scene, choices: &Choices) -> Vec<bool> {
    let culls = |m: &Material| choices.cull_back_faces && materials::can_be_culled(m);
    scene.materials.iter().map(|m| m.alpha_mode != AlphaMode::Opaque || culls(m)).collect()
}

/// No triangle: a tree drops it, and the others keep their numbers.
const NOWHERE: Triangle = [[f32::NAN; 3]; 3];

impl From<Instanced> for SceneTree {
    fn from(Instanced { words, bounds, dropped }: Instanced) -> SceneTree {
        SceneTree { words: memory(words), native: None, bounds, dropped }
    }
}

fn memory(words: Vec<u32>) -> Memory {
    Memory { rows: words.len() as u32, words }
}

impl SceneTree {
    /// The trees over the triangles of a scene, where surfaces of these materials have holes.
    pub fn new(scene: &Scene, triangles: &[Triangle], cutouts: &[bool], traversal: Traversal) -> SceneTree {
        if traversal == Traversal::Ir || !Native::is_there() {
            let bvh = Bvh::build(triangles);
            return SceneTree::of(&bvh, triangles, None, bvh.dropped);
        }
        let (with_holes, whole) = if cutouts.contains(&true) {
            let meshes = || scene.instances.iter().map(|instance| &scene.meshes[instance.mesh]);
            let have_holes = || meshes().flat_map(|mesh| mesh.triangles.iter().map(|_| cutouts[mesh.material]));
            let part = |holes: bool| -> Vec<Triangle> {
                let of = triangles.iter().zip(have_holes());
                of.map(|(t, has_holes)| if has_holes == holes { *t } else { NOWHERE }).collect()
            };
            (part(true), Cow::from(part(false)))
        } else {
            (Vec::new(), Cow::from(triangles))
        };
        let bvh = Bvh::build(&with_holes);
        let (native, of_whole) = Native::new(&whole, &bvh.parts());
        let nowhere = with_holes.len() + whole.len() - triangles.len();
        let dropped = Dropped {
            non_finite: bvh.dropped.non_finite + of_whole.non_finite - nowhere,
            zero_area: bvh.dropped.zero_area + of_whole.zero_area,
        };
        let bvh = Bvh { bounds: native.bounds(), ..bvh };
        SceneTree::of(&bvh, &with_holes, Some(Arc::new(native)), dropped)
    }

    fn of(bvh: &Bvh, triangles: &[Triangle], native: Option<Arc<Native>>, dropped: Dropped) -> SceneTree {
        SceneTree { words: memory(bvh.words(triangles)), native, bounds: bvh.bounds, dropped }
    }
}
