//! The host half of the renderer: plain data and plain Rust, no staged code.
//!
//! What is here lays out a scene for the kernels, keeps what they produce and measures it. No component file
//! (those that build IR) imports anything from here; the arrow points the other way only through tables.
//! In reading order:
//!
//! * [`error`]: what a user is told when something of his cannot be used,
//! * [`film`]: the exact, order-free sum of samples,
//! * [`image_io`]: linear images in memory and on disk,
//! * [`variance`]: how far off a render is, told from itself,
//! * [`exr`], [`aov`]: files of any channels, and the layers that denoisers and compositors ask for,
//! * [`part`], [`origin`]: films on disk that can be added up, and what may be added to what,
//! * [`bvh`]: the tree of boxes over a scene's triangles,
//! * [`native`]: the walk of the device of streams by hand, for processors that have AVX-512,
//! * [`distribution`]: what to sample how often, as tables for light and environment choice,
//! * [`alias`]: the same as a table that is looked at once,
//! * [`compare`]: how far an image is from a reference, and whether noise explains it,
//! * [`student`]: the quantiles that this takes,
//! * [`stability`]: the gallery of hard cases, rendered and compared with what is right,
//! * [`sheet`]: pictures in rows, with their names,
//! * [`renderer`], [`edit`], [`session`]: a scene made into kernels and rendered, changed, changed while it is rendered,
//! * [`learn`]: what the first samples teach about light,
//! * [`library`]: components, a user's among them, and their generic programs,
//! * [`gpu`]: the devices on a GPU,
//! * [`rays`]: raw tracing, in rays per second,
//! * [`ahead`]: memory asked for what kernels will read,
//! * [`clock`], [`stages`]: time that a thread ran for, and on what,
//! * [`effort`]: how much there is to write and to read,
//! * [`figures`]: the other experiments of the paper.

pub mod tables;
pub mod generate;
pub mod library;
pub mod code_cache;
pub mod device;
mod dispatch;
mod scalar;
mod splats;
pub mod gpu;
pub mod clock;
pub mod stages;
pub mod wave;
pub mod ahead;
pub mod work;
pub mod learn;
pub mod renderer;
pub mod edit;
pub mod session;
pub mod replay;
pub mod bvh;
pub mod native;
pub mod compare;
pub mod stability;
pub mod sheet;
pub mod rays;
pub mod effort;
pub mod figures;
pub mod efficiency;
pub mod distribution;
pub mod alias;
pub mod error;
pub mod film;
pub mod image_io;
pub mod exr;
pub mod aov;
pub mod variance;
pub mod origin;
pub mod part;
#[cfg(test)]
mod random;
pub mod student;
