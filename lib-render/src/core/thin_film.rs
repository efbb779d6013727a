//! Interference at a thin film, as colours.

use std::f32::consts::{PI, TAU};

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{F32, Fun};

use crate::core::color::{Color, color};
use crate::core::fresnel::fresnel_normal;
use crate::core::math::{exp, sincos};

/// A film between air and a base.
#[derive(Clone, Copy)]
pub struct Film {
    /// Index of refraction, at least 1.
    pub ior: F32,
    /// Thickness in nanometres, at least 0.
    pub thickness: F32,
}
impl_staged!(Film { ior, thickness });

/// (cosine outside, film, what the base reflects at normal incidence) → [`fresnel_film`].
pub type FilmFn = Fun<(F32, Film, Color), Color>;

/// The factor as a function of the program: it is long, and materials ask for it at many places.
pub fn make_fresnel_film() -> FilmFn {
    FilmFn::lam(|_, (cos, film, f0)| fresnel_film(cos, film, f0))
}

/// Reflectance, each channel in [0, 1], of a film on a base that reflects `f0` at normal incidence, for light at this cosine
/// outside.
///
/// Source: Belcour & Barla 2017, "A practical extension to microfacet theory for the modeling of varying iridescence", with
/// the approximations and constants of KHR_materials_iridescence: Schlick's factor at both interfaces, the sum over
/// reflections cut off after the second, Gaussians for the eye's sensitivities. What the cut makes larger than 1 or
/// negative is clipped; by how much at most has not been measured.
pub fn fresnel_film(cos: F32, film: Film, f0: Color) -> Color {
    // A film of no thickness is air.
    let t = (film.thickness * (1.0 / 0.03)).min(1.0);
    let ior = 1.0 + (film.ior - 1.0) * (t * t * (3.0 - 2.0 * t));
    let cos2 = (1.0 - (1.0 - cos * cos) / (ior * ior)).max(0.0).sqrt();
    let r12 = schlick(fresnel_normal(ior), cos);
    let t121 = 1.0 - r12;
    let way = 2.0 * ior * film.thickness * cos2;
    let channel = |f0: F32| {
        // The base's index, as if it were clear, and what it reflects from within the film.
        let root = f0.max(0.0).min(0.9999).sqrt();
        let base = (1.0 + root) / (1.0 - root);
        let r23 = schlick(fresnel_normal(base / ior), cos2);
        // Reflection from the denser side turns the phase; within the film it always does at the top.
        let phase = PI + base.lt(ior).select(F32::from(PI), 0.0.into());
        let r123 = (r12 * r23).max(1e-5).min(0.9999);
        let rs = t121 * t121 * r23 / (1.0 - r123);
        (phase, r123.sqrt(), r12 + rs, rs - t121)
    };
    let [r, g, b] = [f0.r, f0.g, f0.b].map(channel);
    let mut sum = color(r.2, g.2, b.2);
    let roots = color(r.1, g.1, b.1);
    let mut rest = color(r.3, g.3, b.3);
    for order in [1.0, 2.0] {
        rest = rest * roots;
        let waves = sensitivity(way * order, [r.0, g.0, b.0].map(|phase| phase * order));
        sum = sum + rest * (waves * F32::from(2.0));
    }
    sum.map(|x| x.max(0.0).min(1.0))
}

fn schlick(f0: F32, cos: F32) -> F32 {
    let m = (1.0 - cos).max(0.0);
    let m2 = m * m;
    f0 + (1.0 - f0) * (m2 * m2 * m)
}

/// What the eye makes of light that has gone this much further (nanometres), with a shift of phase for each channel.
fn sensitivity(way: F32, shifts: [F32; 3]) -> Color {
    /// Height, place and variance of the Gaussians, of X (two), Y and Z, after Belcour and Barla.
    const X: [f32; 3] = [5.4856e-13, 1.6810e6, 4.3278e9];
    const X_BLUE: [f32; 3] = [9.7470e-14, 2.2399e6, 4.5282e9];
    const Y: [f32; 3] = [4.4201e-13, 1.7953e6, 9.3046e9];
    const Z: [f32; 3] = [5.2481e-13, 2.2084e6, 6.6121e9];
    /// Of a white light, in all.
    const WHITE: f32 = 1.0685e-7;
    // Further on all waves have cancelled: the least of the Gaussians is e^-68 there.
    let phase = way.min(2e4) * (TAU * 1e-9);
    let wave = |[height, place, variance]: [f32; 3], shift: F32| {
        let scale = height / WHITE * (TAU * variance).sqrt();
        scale * sincos(place * phase + shift).1 * exp(-(variance * (phase * phase)))
    };
    let (x, y, z) = (wave(X, shifts[0]) + wave(X_BLUE, shifts[0]), wave(Y, shifts[1]), wave(Z, shifts[2]));
    // To Rec. 709's primaries.
    color(
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    )
}
