//! One colour all around the image.

use jerboa_ir::lang::{Bool, I32, Row, U32};

use super::beyond;
use crate::core::color::color;
use crate::image::Texel;
use crate::schema::{Textures, WRAP_BORDER};
use crate::texture::Lookup;

/// Is this its code?
pub fn is_chosen(wrap: U32) -> Bool {
    Lookup::Border.is_used() & wrap.eq(WRAP_BORDER)
}

/// Is there no texel in this column and row of an image of this size?
pub fn is_outside((x, y): (I32, I32), (width, height): (I32, I32)) -> Bool {
    let ((left, right), (above, below)) = (beyond(x, width), beyond(y, height));
    left | right | above | below
}

/// What is there.
pub fn texel(row: Row<Textures>) -> Texel {
    let [r, g, b, alpha] =
        [Textures::BORDER_R, Textures::BORDER_G, Textures::BORDER_B, Textures::BORDER_A].map(|column| row.get(column));
    Texel { color: color(r, g, b), alpha }
}
