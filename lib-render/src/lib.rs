//! The rendering library: every component written once, specialised for the scene it is given.
//!
//! A *component* (texture, BSDF, light, geometry, shader, tracer, device) is a Rust function that builds a piece of a
//! program and is gone afterwards. The functions of that program are what the partial evaluator sees. Together the
//! components are one *generic program*, the same for every scene: an interpreter of scenes. A scene is data, tables with a
//! binding time; specialising the interpreter to it gives a renderer for it (the first Futamura projection).
//!
//! ```text
//! component (Rust)  →  generic program  →  residual program  →  machine code
//!   this crate            jerboa-ir           jerboa-peval       jerboa-backend-cranelift, for GPUs jerboa-backend-spirv
//! ```
//!
//! | paper | file | main type |
//! |---|---|---|
//! | 4.1 Images, textures | [`image`], [`texture`] | [`image::Image`], [`texture::Texture`] |
//! | 4.2 Materials, BSDFs | [`bsdf`], [`material`] | [`bsdf::Bsdf`], [`material::Material`] |
//! | 4.3 Lights | [`light`] | [`light::Light`] |
//! | 4.4 Geometry | [`geometry`], [`traverse`] | [`geometry::Geometry`] |
//! | 4.5 Shaders | [`shader`] | [`shader::Shader`] |
//! | 4.6 Renderers | [`tracer`] | [`tracer::Tracer`] |
//! | 4.7 Devices | [`device`] | [`device::Device`] |
//!
//! [`components`] lists what scenes may name, a user's crate's own too; [`schema`] declares the tables. [`host`] is what runs before and after: it lays scenes out, specialises, compiles, keeps
//! the film. Component files import the embedded language and each other, never the host: so no component can look at a
//! scene while the program is built, and what a scene does not use is not in its residual.
//!
//! Two rules of the components. A function value never depends on what is unknown: a component chooses *inside* its
//! functions (`b.if_(row.get(Materials::HAS_METAL), …)`), not between functions. And a fact of the scene is read from a
//! row, never passed by the host: where it is known the branch folds, where it is not the branch stays, and the image is the
//! same to the bit.
//!
//! # A render in this process
//! ```
//! use jerboa_lib_render::host::film::Film;
//! use jerboa_lib_render::host::renderer::{Options, Renderer};
//! use jerboa_scenes::Scene;
//!
//! let scene = Scene::load("builtin:cornell-box")?;
//! let renderer = Renderer::new(&scene, Options { spp: 4, ..Options::default() })?;
//! let mut film = Film::of_size([64, 64]);
//! let stats = renderer.render(&scene.camera_or_default(), &mut film)?;
//! assert_eq!(stats.spp, 4);
//! let image = film.mean();
//! assert!(image.pixels.iter().flatten().sum::<f32>() > 0.0, "the box is lit");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod schema;
pub mod components;
pub mod core;
pub mod sampler;
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
pub mod lobes;
pub mod shader;
pub mod cutout;
pub mod culling;
pub mod mis;
pub mod tracer;
pub mod device;
pub mod host;
pub mod cli;
