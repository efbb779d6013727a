//! Textures: values over texture coordinates (paper, section 4.1). One file per pattern; [`image`](crate::image) has what is made
//! of texels.

use jerboa_ir::lang::{Block, Bool, Fun, Row};

use crate::components::{Components, Numbers};
use crate::core::color::color;
use crate::core::vec::Vec2;
use crate::image::{Texel, make_image, make_image_filter};
use crate::lobes::Lobe;
use crate::schema::{Models, TEXTURE_CHECKERBOARD, TEXTURE_NOISE, TEXTURE_OWN, Textures};
use crate::texture::checkerboard::make_checkerboard_texture;
use crate::texture::noise::make_noise_texture;
use crate::texture::transform::transform;

pub mod checkerboard;
pub mod noise;
pub mod transform;

/// Texture coordinates → value.
pub type Texture = Fun<Vec2, Texel>;

/// What few textures ask for, in the order of the rows in [`Models`], after those of lobes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Lookup {
    /// A border of one colour.
    Border,
    /// The bicubic filter.
    Bicubic,
    /// Noise.
    Noise,
}

impl Lookup {
    /// All of them.
    pub const ALL: [Lookup; 3] = [Lookup::Border, Lookup::Bicubic, Lookup::Noise];

    /// The row in [`Models`], below which there are so many models.
    pub fn row(self, models: usize) -> usize {
        models + Lobe::ALL.len() + self as usize
    }

    /// Does any texture of the scene ask for it?
    pub(crate) fn is_used(self) -> Bool {
        let row = self.row(Components::current().models().len());
        Row::<Models>::at(row as u32).get(Models::USED)
    }
}

/// The texture that a row describes.
pub fn make_texture(row: Row<Textures>) -> Texture {
    let get = |column| row.get(column);
    let even = color(get(Textures::EVEN_R), get(Textures::EVEN_G), get(Textures::EVEN_B));
    let odd = color(get(Textures::ODD_R), get(Textures::ODD_G), get(Textures::ODD_B));
    let (checkerboard, noise) = (make_checkerboard_texture(even, odd), make_noise_texture(even, odd));
    let (image, filter) = (make_image(row), make_image_filter(row));
    Texture::lam(|b, uv| {
        let uv = transform(b, row, uv);
        let kind = row.get(Textures::KIND);
        let is_noise = Lookup::Noise.is_used() & kind.eq(TEXTURE_NOISE);
        let image_or_noise = |b: &mut Block| b.if_(is_noise, |b| noise.call(b, uv), |b| filter.call(b, (image, uv)));
        let looked_up =
            |b: &mut Block| b.if_(kind.eq(TEXTURE_CHECKERBOARD), |b| checkerboard.call(b, uv), image_or_noise);
        own_or(b, row, uv, 0, looked_up)
    })
}

/// What the texture of a user's crate gives whose row it is, from this one on, or else the other.
fn own_or(b: &mut Block, row: Row<Textures>, uv: Vec2, own: u32, other: impl FnOnce(&mut Block) -> Texel) -> Texel {
    let Some(texture) = Components::current().textures().get(own as usize).copied() else {
        return other(b);
    };
    b.if_(
        row.get(Textures::KIND).eq(TEXTURE_OWN + own),
        |b| (texture.make)(Numbers(row.get(Textures::NUMBERS))).call(b, uv),
        |b| own_or(b, row, uv, own + 1, other),
    )
}

/// What the texture gives at a surface with these two sets of coordinates.
pub fn look_up(b: &mut Block, row: Row<Textures>, uv: [Vec2; 2]) -> Texel {
    let set = row.get(Textures::UV_SET).eq(0u32).select(uv[0], uv[1]);
    // It is long, and materials look up a texture at some fifty places.
    let texture = Fun::<(Row<Textures>, Vec2), Texel>::shared("texture", || {
        Fun::lam(|b, (row, uv): (Row<Textures>, Vec2)| make_texture(row).call(b, uv))
    });
    texture.call(b, (row, set))
}
