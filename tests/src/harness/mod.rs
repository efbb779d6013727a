//! The verification harness: how a staged component is asked questions from outside, and how its answers are judged.
//!
//! - [`analytic`]: scenes whose radiance has a closed form, rendered and compared.
//! - [`mod@bench`]: tables in memory, and kernels made of a few entries; specialised with nothing known, compiled, and also
//!   interpreted.
//! - [`clock`]: time on a machine that others use too.
//! - [`sweep`]: kernels that loop, for millions of questions to one function.
//! - [`lights`]: lights of a whole scene, asked for choices, samples and densities; and the table of them.
//! - [`functions`]: the math library, one row a function; exhaustive sweeps and special values.
//! - [`probe`]: a material on one surface, asked for f, pdf and samples.
//! - [`scattering`]: the table of BSDFs under test, and [`slopes`], those of its rows whose normals a map tilts.
//! - [`chi2`]: samples against the density stated for them, over the sphere, the square or the line.
//! - [`quadrature`]: integrals in f64.
//! - [`streams`]: random numbers, asked for in bulk, and what is counted in them.
//! - [`points`]: the points of the Sobol sampler.
//! - [`hostile`]: triangles that are hard on the builder of trees.
//! - [`many`]: scenes with any number of materials, shaders, lights and textures.
//! - [`metamorphic`]: changes of scenes that keep the image, or scale it.
//! - [`rays`]: closed shapes, ways to aim at them, trees; [`naive`], what they are measured against; and [`native`], the walk
//!   by hand.
//! - [`stats`]: tests of hypotheses with a stated rate of false alarms.
//! - [`subjects`]: scenes, tracers and devices that between them use everything; and [`features`], what each may leave in a residual.
//! - [`warps`]: the table of warps of uniform numbers.

pub mod analytic;
pub mod bench;
pub mod clock;
pub mod hostile;
pub mod many;
pub mod metamorphic;
pub mod brute;
pub mod naive;
pub mod native;
pub mod lights;
pub mod functions;
pub mod probe;
pub mod scattering;
pub mod slopes;
pub mod lobes;
pub mod chi2;
pub mod quadrature;
pub mod rays;
pub mod stats;
pub mod streams;
pub mod points;
pub mod subjects;
pub mod features;
pub mod sweep;
pub mod warps;
