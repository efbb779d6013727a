//! Roulette by what the first samples of the render have taught about light.
//!
//! A path with throughput T that goes on from here will find light with second moment M² and take c rays more. Ended with
//! probability 1 − q it adds w T² M² / q to the weighted variance of its pixel and q c to the cost; the product of the error of
//! the whole image, E, and its cost a sample, C, is least at
//!
//! ```text
//! q = T · √(M² / c) · √(w C / E)
//! ```
//!
//! (Bolin and Meyer 1997; Rath, Grittmann, Herholz, Weier, Slusallek 2022, "EARS", without splitting.) The first root is
//! [`LearnedLight`], by the cell and the direction of the ray; the second, inverted, [`LearnedPixels`]. Whatever they hold, the image is
//! right on average, for q is above 0 wherever light was found.

use jerboa_ir::lang::{Block, Bool, Col, F32, Row, U32};

use crate::core::vec::Vec3;
use crate::schema::{CELLS, DIRECTIONS, LearnedGrid, LearnedLight, LearnedPixels, Settings};
use crate::tracer::settings;

/// Is roulette by what was learned? Not before the first samples are there.
pub(super) fn is_learned() -> Bool {
    settings().get(Settings::LEARNS) & grid().get(LearnedGrid::IS_LEARNED)
}

fn grid() -> Row<LearnedGrid> {
    Row::at(0u32)
}

/// What throughput is divided by for roulette in a pixel, given by its number on the film: 1 while nothing is learned.
pub(super) fn pixel_scale(b: &mut Block, pixel: U32) -> F32 {
    b.if_(is_learned(), |_| Row::<LearnedPixels>::at(pixel).get(LearnedPixels::SCALE), |_| F32::from(1.0))
}

/// What a path finds that leaves a point in a direction (unit; both world, the point relative to the origin).
pub(super) fn worth(point: Vec3, dir: Vec3) -> F32 {
    Row::<LearnedLight>::at(light_row(point, dir)).get(LearnedLight::WORTH)
}

/// The row of [`LearnedLight`] for a ray.
pub fn light_row(point: Vec3, dir: Vec3) -> U32 {
    let at = |x: F32, least: Col<LearnedGrid, F32>, per: Col<LearnedGrid, F32>| {
        let cell = (x - grid().get(least)) * grid().get(per);
        cell.max(0.0).min((CELLS - 1) as f32).to_u32()
    };
    let x = at(point.x, LearnedGrid::X, LearnedGrid::PER_X);
    let y = at(point.y, LearnedGrid::Y, LearnedGrid::PER_Y);
    let z = at(point.z, LearnedGrid::Z, LearnedGrid::PER_Z);
    let sign = |x: F32, bit: u32| x.gt(0.0).select(U32::from(bit), 0.into());
    let signs = sign(dir.x, 1) + sign(dir.y, 2) + sign(dir.z, 4);
    let a = dir.abs();
    let axis = (a.x.ge(a.y) & a.x.ge(a.z)).select(U32::from(0), a.y.ge(a.z).select(U32::from(1), 2.into()));
    ((z * CELLS + y) * CELLS + x) * DIRECTIONS + axis * 8u32 + signs
}
