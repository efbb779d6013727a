//! What is no feature's: every picture needs it.

/// Columns, or beginnings of their names, and sources of the library: each is in the residuals of every subject.
pub const EVERYWHERE: &[&str] = &[
    "Frame.",
    "Tree.",
    "camera.rs",
    "core/rng.rs",
    "traverse/bvh.rs",
    "traverse/lanes.rs",
    "traverse/line.rs",
    "traverse/memory.rs",
    "traverse/stack.rs",
    "traverse/triangle.rs",
    "traverse/walk.rs",
];
