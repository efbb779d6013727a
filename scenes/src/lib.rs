//! Scenes as plain host data: from a glTF 2.0 or OBJ file, or made by code, to lists that refer to each other by index.
//!
//! This crate knows nothing of rendering. It answers two questions: *what is in the file*, and *is it sound*. A
//! [`Scene`] that it returns can be walked without a check: every index is in range, every number finite, every transform
//! invertible. How the lists become tables, and which of their columns a specialised renderer knows, is decided elsewhere.
//!
//! ```
//! use jerboa_scenes::{Scene, builtin};
//!
//! let scene = Scene::load("builtin:cornell-box")?; // or the path of a .glb, .gltf or .obj
//! for warning in scene.all_warnings() {
//!     eprintln!("warning: {warning}");
//! }
//! for instance in &scene.instances {
//!     let mesh = &scene.meshes[instance.mesh];
//!     let material = &scene.materials[mesh.material];
//!     println!("{}: {} triangles at {}", material.name, mesh.triangles.len(), instance.to_world.translation);
//! }
//! let camera = scene.camera_or_default();
//! assert_eq!(camera.film_or_default(), (512, 512));
//!
//! // Errors are one line: what, where, why, and what to do.
//! let error = Scene::load("builtin:cornel-box").unwrap_err().to_string();
//! assert!(error.starts_with("builtin:cornel-box: no such built-in scene; there are cornell-box, "));
//! # Ok::<(), jerboa_scenes::Error>(())
//! ```
//!
//! # What is read
//!
//! - **Geometry**: triangles, strips and fans; positions, normals, tangents, two sets of texture coordinates, vertex
//!   colours; every component type, normalised integers, sparse and interleaved accessors. One [`Mesh`] per primitive, placed
//!   by [`Instance`]s whose transforms were composed in double precision.
//! - **Materials**: metallic-roughness with its textures, normal map, emission, alpha modes, doubleSided, and the
//!   extensions KHR_materials_anisotropy, clearcoat, diffuse_transmission, emissive_strength, ior, iridescence, sheen,
//!   specular, transmission, unlit, volume, KHR_texture_transform.
//!   Another model of scattering by the material's own `extras.bsdf: {"model": NAME, …}`, see [`Model`].
//! - **Images**: PNG, JPEG, WebP (EXT_texture_webp), kept at eight bits; wrap modes and the magnification filter.
//!   From the sampler's `extras`: `{filter: "bicubic"}`, and `{border: [r, g, b, a]}`, linear, for all outside of the image.
//! - **Light**: KHR_lights_punctual, with a size by the light's own `extras`, see [`LightKind`]: `{radius}` makes a point a sphere
//!   and a spot a disk, `{angle}` a directional light a sun. And an environment named by the scene's own
//!   `extras.environment: {uri, intensity, rotation_deg}` (.hdr, .exr; or `sky` in place of `uri`, with the numbers of a
//!   [`Sky`]) or given later by [`Scene::set_environment`].
//! - **Shapes**: morph targets and skins, at rest or at a moment of the file's animations (steps, lines and cubic splines
//!   of translation, rotation, scale and weights); EXT_mesh_gpu_instancing.
//! - **Choices** ([`Selection`]): any of the file's scenes, and of its KHR_materials_variants.
//! - **Cameras**: perspective and orthographic; from the camera's `extras` the film's size `{width, height}`, a thin lens
//!   `{aperture, focus}` and the angle of a `{fisheye}`: see [`Lens`].
//! - **Wavefront OBJ**: polygons with texture coordinates and normals; MTL with diffuse, Phong, mirror, glass and light, and
//!   metalness and roughness where a library has them.
//! - KHR_mesh_quantization, KHR_draco_mesh_compression. Any other extension is an error where the file *requires* it, else a
//!   warning.
//!
//! # What is ignored, and why
//!
//! Animations where no moment is asked for, points and lines, texture coordinate sets above 1: each with
//! a warning. Silently: near and far planes and a light's `range` (hints for
//! rasterisers), occlusion textures (they stand for ambient light, which a path tracer computes), minification filters
//! (many samples per pixel replace mipmaps), `min`/`max` of accessors, colour profiles in images (glTF says so).
//!
//! MikkTSpace, by which glTF wants the tangents that a mesh lacks: the frame of a normal map follows each triangle's own
//! texture coordinates. Its means over vertices differ where those bend; Khronos's models for tangents show no difference.
//!
//! # Defaults that surprise
//!
//! A material without metallicFactor and roughnessFactor is a rough *metal*; without a sampler a texture repeats and is
//! bilinear; `alphaCutoff` is 0.5; `ior` is 1.5; a missing texture image is white (a normal map: flat); without a camera the
//! whole scene is framed; without light the image is black; the last two are warnings.
//!
//! # Trust
//!
//! A file is hostile until shown otherwise. All JSON is read as a tree of values by code that knows the path it stands
//! at. The words of glTF's schema (component types, modes, kinds) are those of the `gltf` crate; its readers are left to the
//! tests, where they give a second opinion on sound files: they round `matrix` to single precision, cannot say where a
//! fault is, and trust what they read. Lengths, offsets and strides are checked in 64 bits before a byte is read; the node tree is walked without recursion, and must be a tree; a URI must be
//! `data:` or lead to a regular file in the scene's folder, symbolic links resolved; an image's header must pass the
//! [`Limits`] before it is decoded; what cannot be repaired is an [`Error`], the rest is a counted [`Warning`]. Only what the
//! chosen scene reaches is read at all.

mod camera;
mod environment;
mod error;
mod folder;
mod gltf;
mod light;
mod limits;
mod lobes;
mod material;
mod mesh;
mod model;
mod obj;
mod scene;
mod selection;
mod sky;
mod texture;

pub mod builtin;

pub use camera::{Camera, Lens};
pub use environment::Environment;
pub use error::{Error, Warning};
pub use light::{Light, LightKind};
pub use limits::Limits;
pub use lobes::{Anisotropy, Clearcoat, DiffuseTransmission, Iridescence, Sheen};
pub use material::{AlphaMode, Material, TextureRef, UvTransform, Volume};
pub use mesh::{Instance, Mesh};
pub use model::Model;
pub use scene::Scene;
pub use selection::Selection;
pub use sky::Sky;
pub use texture::{Filter, Image, Texture, TextureSource, Wrap};
