//! Textures: values over texture coordinates (paper, section 4.1).

use jerboa_ir::lang::{Block, Bool, F32, Fun, Row};

use crate::components::{Components, Numbers};
use crate::core::color::{Color, color};
use crate::core::rng::{hash, uniform};
use crate::core::vec::{Vec2, vec2};
use crate::image::{Texel, make_image, make_image_filter};
use crate::lobes::Lobe;
use crate::schema::{Models, TEXTURE_CHECKERBOARD, TEXTURE_NOISE, TEXTURE_OWN, Textures};

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

/// Unit squares, `even` where ⌊u⌋ + ⌊v⌋ is even, `odd` elsewhere; opaque.
pub fn make_checkerboard_texture(even: Color, odd: Color) -> Texture {
    Texture::lam(|_, uv| {
        let parity = (uv.x.floor().to_i32() + uv.y.floor().to_i32()) & 1;
        Texel { color: parity.eq(0).select(even, odd), alpha: 1.0.into() }
    })
}

/// Octaves of [`make_noise_texture`].
const OCTAVES: u32 = 4;

/// Clouds from `low` to `high`: value noise of four octaves, each twice as fine as the one before and half as strong; opaque.
///
/// An octave has a number in [0, 1) at each point of a lattice, interpolated by 6t⁵ − 15t⁴ + 10t³: smooth to the second
/// derivative, and nowhere beyond `low` or `high`. From 2^24 on coordinates are points of the lattice, or none.
///
/// Source: Perlin 2002, "Improving noise", for the interpolation.
pub fn make_noise_texture(low: Color, high: Color) -> Texture {
    Texture::lam(|_, uv| {
        let (mut sum, mut most) = (F32::from(0.0), 0.0);
        for octave in 0..OCTAVES {
            let (scale, strength) = ((1 << octave) as f32, 1.0 / (1 << octave) as f32);
            sum = sum + lattice_noise(octave, vec2(uv.x * scale, uv.y * scale)) * strength;
            most += strength;
        }
        Texel { color: low.lerp(high, sum / most), alpha: 1.0.into() }
    })
}

/// One octave, in [0, 1].
fn lattice_noise(octave: u32, at: Vec2) -> F32 {
    let smooth = |t: F32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    // 0 for what is no number: infinity − infinity.
    let weight = |x: F32| smooth((x - x.floor()).max(0.0)).min(1.0);
    let (kx, ky) = (weight(at.x), weight(at.y));
    let (i, j) = (at.x.floor().to_i32(), at.y.floor().to_i32());
    let number = |dx: i32, dy: i32| uniform(hash(hash((i + dx).bits() ^ hash(octave.into())) ^ (j + dy).bits()));
    let mix = |a: F32, b: F32, k: F32| a * (1.0 - k) + b * k;
    mix(mix(number(0, 0), number(1, 0), kx), mix(number(0, 1), number(1, 1), kx), ky)
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

/// KHR_texture_transform.
fn transform(b: &mut Block, row: Row<Textures>, uv: Vec2) -> Vec2 {
    let get = |column| row.get(column);
    let line = |m0, m1, m2| get(m0) * uv.x + get(m1) * uv.y + get(m2);
    b.if_(
        row.get(Textures::TRANSFORMED),
        |_| vec2(line(Textures::M00, Textures::M01, Textures::M02), line(Textures::M10, Textures::M11, Textures::M12)),
        |_| uv,
    )
}
