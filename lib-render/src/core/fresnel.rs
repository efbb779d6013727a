//! How much a smooth interface reflects.

use jerboa_ir::lang::F32;

use crate::core::color::Color;

/// Reflectance of a dielectric interface for unpolarised light, exact; 1 under total internal reflection, 0 at eta = 1.
///
/// `cos` ≥ 0 is the cosine on the side the light is on, `eta` the index behind the interface over the index there.
/// Source: Cook & Torrance 1982 in the form with g² = η² − 1 + c². Error ≤ 5e-7, or 1.5e-7 / √δ at a distance δ of the
/// cosine from the critical one, times 1/(2.25 η²) below η = 1/1.5 (N12): the usual form gives R = 1 for η = 1 at grazing
/// angles.
pub fn fresnel_dielectric(cos: F32, eta: F32) -> F32 {
    let c = cos;
    let g2 = (eta - 1.0) * (eta + 1.0) + c * c;
    let g = g2.max(0.0).sqrt();
    let (sum, difference) = (g + c, g - c);
    let a = difference / sum;
    let b = (c * sum - 1.0) / (c * difference + 1.0);
    let r = 0.5 * (a * a) * (1.0 + b * b);
    // η = 1 at c = 0 is 0/0; no light bends there.
    g2.le(0.0).select(eta.eq(1.0).select(F32::from(0.0), 1.0.into()), r)
}

/// What a dielectric interface lets through, 1 − [`fresnel_dielectric`] without the cancellation where that is nearly 1; 1 at
/// eta = 1. `beyond` is the cosine beyond the interface, 0 under total internal reflection ([`refracted_cos`]).
///
/// The same from both sides, with the cosines exchanged and 1/eta. Source: Fresnel 1823, the mean of the transmittances of
/// both polarisations, 4 η c c′ / (c + η c′)² and 4 η c c′ / (η c + c′)². Relative error ≤ 1e-6 for rounded cosines.
pub fn fresnel_passed(cos: F32, beyond: F32, eta: F32) -> F32 {
    let (s, p) = (cos + eta * beyond, eta * cos + beyond);
    let passed = 2.0 * eta * ((cos / s) * (beyond / s) + (cos / p) * (beyond / p));
    // As there, η = 1 at c = 0 is 0/0.
    (cos.gt(0.0) & beyond.gt(0.0)).select(passed, eta.eq(1.0).select(F32::from(1.0), 0.0.into()))
}

/// Reflectance at normal incidence.
pub fn fresnel_normal(eta: F32) -> F32 {
    let a = (eta - 1.0) / (eta + 1.0);
    a * a
}

/// Cosine beyond the interface; 0 under total internal reflection. Arguments as [`fresnel_dielectric`].
pub fn refracted_cos(cos: F32, eta: F32) -> F32 {
    // cos_t² = 1 − (1 − c²)/η² = (η² − 1 + c²)/η², without the cancellation.
    let g2 = (eta - 1.0) * (eta + 1.0) + cos * cos;
    g2.max(0.0).sqrt() / eta
}

/// Reflectance of a metal: Schlick 1994 with reflectance `f0` at normal and 1 at grazing incidence, as glTF 2.0, appendix
/// B.3.5, asks.
pub fn fresnel_schlick(f0: Color, cos: F32) -> Color {
    let m = (1.0 - cos).max(0.0);
    let m2 = m * m;
    let k = m2 * m2 * m;
    f0.map(|f| f + (1.0 - f) * k)
}
