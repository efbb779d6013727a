//! The tree over the triangles of a scene, for whoever walks it: one only is in memory.

use std::sync::Arc;

use jerboa_scenes::Scene;

use super::memory::Memory;
use crate::host::bvh::{Bounds, Bvh, Dropped, Triangle};
use crate::host::device::Traversal;
use crate::host::native::Native;

/// The tree.
pub(super) struct SceneTree {
    /// For kernels; where they do not walk it, the scene's box and an empty tree.
    pub words: Memory,
    /// For the native walk.
    pub native: Option<Arc<Native>>,
    /// Around all triangles.
    pub bounds: Bounds,
    /// Triangles that are not in it.
    pub dropped: Dropped,
}

/// Does the native walk trace a scene? It must be asked for and there, and it knows no cut-outs.
pub(super) fn is_native(scene: &Scene, traversal: Traversal) -> bool {
    traversal == Traversal::Native && Native::is_there() && !super::has_cutouts(scene)
}

impl SceneTree {
    /// The tree over the triangles of a scene.
    pub fn new(scene: &Scene, triangles: &[Triangle], traversal: Traversal) -> SceneTree {
        let (bvh, native, of) = if is_native(scene, traversal) {
            let (native, dropped) = Native::new(triangles);
            let empty = Bvh { bounds: native.bounds(), dropped, ..Bvh::build(&[]) };
            (empty, Some(Arc::new(native)), &[][..])
        } else {
            (Bvh::build(triangles), None, triangles)
        };
        let words = bvh.words(of);
        let words = Memory { rows: words.len() as u32, words };
        SceneTree { words, native, bounds: bvh.bounds, dropped: bvh.dropped }
    }
}
