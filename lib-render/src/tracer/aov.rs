//! What denoisers and compositors ask for beside a picture: the surface that each of its samples sees first.
//!
//! The rays are the picture's own, number by number, so that what is shown here lines up with it. `host::aov` makes layers of
//! a file of it; the albedo is that of [`super::debug`].

use jerboa_ir::lang::Row;

use crate::camera::CameraFn;
use crate::core::color::{Color, color};
use crate::core::vec::vec3;
use crate::geometry::triangle::Triangle;
use crate::schema::{Frame, Geometries};
use crate::tracer::debug::make_first_hit_tracer;
use crate::tracer::{Tracer, side_seen};

/// What a sample shows of the surface it sees first. All are 0 where nothing is hit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Aov {
    /// Shading normal on the side that is seen, world: its three coordinates.
    Normal,
    /// Depth along the viewing direction, m; number of the material, from 1 on; nothing. A mean of either says nothing: they
    /// are for single samples.
    Place,
}

/// A tracer that shows this.
pub fn make_aov_tracer(camera: CameraFn, aov: Aov) -> Tracer {
    make_first_hit_tracer(camera, move |b, (ray, hit, surf, mat)| -> Color {
        match aov {
            Aov::Normal => {
                let normal = side_seen(surf, mat, ray).normal;
                color(normal.x, normal.y, normal.z)
            }
            Aov::Place => {
                let frame = Row::<Frame>::at(0u32);
                let [x, y, z] = [Frame::FORWARD_X, Frame::FORWARD_Y, Frame::FORWARD_Z].map(|c| frame.get(c));
                let material = Triangle::of(b, hit).geometry().get(Geometries::MATERIAL).index() + 1u32;
                color(hit.t * ray.dir.dot(vec3(x, y, z)), material.to_f32(), 0.0)
            }
        }
    })
}
