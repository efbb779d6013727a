//! Smooth noise: clouds between two colours.

use jerboa_ir::lang::F32;

use crate::core::color::Color;
use crate::core::rng::{hash, uniform};
use crate::core::vec::{Vec2, vec2};
use crate::image::Texel;
use crate::texture::Texture;

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
