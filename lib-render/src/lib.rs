//! The rendering library: every component written once, as a constructor over staged values.
//!
//! (The page of theory grows with the crate; until then read the modules in this order.)

pub mod schema;
pub mod core;
pub mod ray;
pub mod image;
pub mod texture;
pub mod bsdf;
pub mod material;
pub mod light;
pub mod geometry;
pub mod traverse;
pub mod camera;
pub mod normal_map;
pub mod shader;
pub mod cutout;
pub mod tracer;
pub mod host;
pub mod cli;
