//! A tree over triangles and instances, which are trees themselves.
//!
//! ```text
//! the tree over all, as in `layout`: a leaf has triangles, or it is one instance (bit 0 of the reference)
//! for each mesh     its box in 8 words, then its tree from the root on; numbers are those of its triangles
//!
//! instance, 40 words    its box as in a node, four times; rows of the matrix to its frame; where zero comes to;
//!                       where its mesh begins; the number of its first primitive; two unused
//! ```

use super::layout::{self, BLOCK, INSTANCE, LaidOut, block};
use super::{Bounds, Bvh, Dropped, MAX_WAITING, Triangle, first_that_fits, prefilter};

/// The tree of a mesh, in its frame.
pub struct MeshTree {
    bvh: Bvh,
    triangles: Vec<Triangle>,
}

impl MeshTree {
    /// Over these triangles.
    pub fn build(triangles: Vec<Triangle>) -> MeshTree {
        MeshTree { bvh: Bvh::build(&triangles), triangles }
    }

    /// Boxes around all of it; see [`Bvh::parts`].
    pub fn parts(&self) -> Vec<Bounds> {
        self.bvh.parts()
    }
}

/// An instance of a mesh.
pub struct Placement {
    /// Which of the trees.
    pub tree: usize,
    /// The number of its first primitive.
    pub first: u32,
    /// Its box in the world.
    pub bounds: Bounds,
    /// Where zero of its frame comes to in the world.
    pub zero: [f32; 3],
    /// Rows of the matrix that takes a direction of the world to its frame.
    pub to_frame: [[f32; 3]; 3],
}

/// A tree of trees in memory.
pub struct Instanced {
    /// What kernels read.
    pub words: Vec<u32>,
    /// Around all of it.
    pub bounds: Bounds,
    /// Triangles that no ray can hit, those of each instance counted.
    pub dropped: Dropped,
}

impl Instanced {
    /// Over triangles of the world, which have these numbers, and instances. None if more would wait than a walk can hold, or
    /// if it is too large for references.
    pub fn build(triangles: &[(u32, Triangle)], trees: &[MeshTree], instances: &[Placement]) -> Option<Instanced> {
        Instanced::within(MAX_WAITING, triangles, trees, instances)
    }

    pub(super) fn within(
        most_waiting: usize,
        triangles: &[(u32, Triangle)],
        trees: &[MeshTree],
        instances: &[Placement],
    ) -> Option<Instanced> {
        let corners: Vec<Triangle> = triangles.iter().map(|(_, triangle)| *triangle).collect();
        let usable = prefilter::usable(&corners);
        let mut dropped = usable.dropped;
        for mesh in instances.iter().map(|instance| trees[instance.tree].bvh.dropped) {
            dropped.non_finite += mesh.non_finite;
            dropped.zero_area += mesh.zero_area;
        }
        let is_somewhere = |bounds: &Bounds| [bounds.lo, bounds.hi].as_flattened().iter().all(|x| x.is_finite());
        let instances: Vec<&Placement> = instances.iter().filter(|i| is_somewhere(&i.bounds)).collect();

        // One tree over the boxes of all, the instances last.
        let first = usable.bounds.len() as u32;
        let mut boxes = usable.bounds;
        boxes.extend(instances.iter().map(|instance| instance.bounds));
        // The way back from an instance waits too.
        let in_mesh = instances.iter().map(|i| trees[i.tree].bvh.waiting + 1).max().unwrap_or(0);
        let fits = |tree: &LaidOut| tree.fits() && tree.waiting + in_mesh <= most_waiting;
        let lay_out = |tree: &super::tree::Tree| layout::lay_out(&tree.set_apart(first, &boxes));
        let whole = Some(first_that_fits(&boxes, lay_out, fits)).filter(fits)?;

        let mut end = whole.size();
        let begins = |mesh: &MeshTree| {
            // There is one empty block for all.
            let begin = end;
            end += mesh.bvh.size() - BLOCK;
            begin
        };
        let begins: Vec<usize> = trees.iter().map(begins).collect();
        if end > layout::MAX_WORDS {
            return None;
        }
        let bounds = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
        // Where zero comes to is part of what a ray's errors are measured by.
        let around = instances.iter().fold(bounds, |all, i| all.union(&Bounds::of(&[i.zero])));
        let mut words = layout::begin(&around, end);
        layout::push_tree(&mut words, &whole.nodes, &whole.order, |members| match members {
            [one] if *one >= first => {
                let instance = instances[(*one - first) as usize];
                (INSTANCE, instance.block(begins[instance.tree]))
            }
            triangles_of_it => {
                let corner = |slot: &u32| &triangles[usable.numbers[*slot as usize] as usize];
                (0, block(triangles_of_it.iter().map(corner).map(|(number, triangle)| (*number, triangle))))
            }
        });
        for MeshTree { bvh, triangles } in trees {
            layout::push_bounds(&mut words, &bvh.bounds);
            layout::push_tree(&mut words, &bvh.nodes, &bvh.order, layout::of_triangles(triangles));
        }
        Some(Instanced { words, bounds, dropped })
    }
}

impl Placement {
    /// What a walk reads of it, where its mesh begins at this word.
    fn block(&self, mesh: usize) -> [u32; BLOCK] {
        let planes = (0..3).flat_map(|k| [self.bounds.lo[k], self.bounds.hi[k]]).flat_map(|plane| [plane; 4]);
        let frame = self.to_frame.iter().flatten().chain(&self.zero).copied();
        let floats = planes.chain(frame).map(f32::to_bits);
        let words: Vec<u32> = floats.chain([mesh as u32, self.first]).collect();
        std::array::from_fn(|at| words.get(at).copied().unwrap_or(0))
    }
}
