//! A thin lens: rays go through a disk, those of a point of the film to one point in focus.
//!
//! Source: Cook, Porter & Carpenter 1984, "Distributed ray tracing", section 4.

use jerboa_ir::lang::Row;

use crate::camera::View;
use crate::core::rng::Rng;
use crate::core::sampling::concentric_disk;
use crate::core::vec::{Vec3, vec2};
use crate::schema::Frame;

/// Origin and direction: from a point of the lens, uniform over its disk, to eye + focus · (forward + p). Draws two numbers.
pub fn thin_lens_ray(view: View, rng: Rng) -> (Vec3, Vec3) {
    let frame = Row::<Frame>::at(0u32);
    let ([u, v], _) = rng.pair();
    let disk = concentric_disk(vec2(u, v));
    let lens = view.right * (disk.x * frame.get(Frame::LENS_RIGHT)) + view.up * (disk.y * frame.get(Frame::LENS_UP));
    let org = view.eye + lens * frame.get(Frame::LENS_SIZE);
    // In a unit in which squares neither overflow nor vanish.
    let lens = lens * frame.get(Frame::LENS_SHARE);
    let sharp = view.ahead() * frame.get(Frame::FOCUS);
    (org, (sharp - lens).normalize())
}
