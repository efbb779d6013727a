//! A tracer that shows how squarely surfaces face the camera: the cosine between view and shading normal.

use jerboa_lib_render::camera::CameraFn;
use jerboa_lib_render::core::color::gray;
use jerboa_lib_render::tracer::Tracer;
use jerboa_lib_render::tracer::debug::make_first_hit_tracer;

/// What [`TracerKind::Own`](jerboa_lib_render::host::generate::TracerKind::Own) calls it.
pub const NAME: &str = "facing";

/// Black where nothing is hit.
pub fn make_facing_tracer(camera: CameraFn) -> Tracer {
    make_first_hit_tracer(camera, |_, (ray, _, _, material)| gray(material.normal.dot(ray.dir).abs()))
}
