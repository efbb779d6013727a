//! What the lobes of glTF's extensions return, in f64, by formulas of their own.
//!
//! ```
//! use jerboa_tests::harness::lobes::{film, stretched_microfacets};
//!
//! // A film of no thickness is nearly none, and equal widths are one.
//! let bare = film(1.0, 1.3, 0.0, 0.04)[1];
//! assert!((bare - 0.04).abs() < 0.01, "{bare}");
//! assert!((stretched_microfacets([1.0; 2], 1.0) - (1.0 - 2f64.ln())).abs() < 1e-4);
//! ```

use std::f64::consts::{PI, TAU};

use super::quadrature::rectangle;

/// Share of light that single scattering by white GGX microfacets of these widths along x and y reflects towards the
/// direction of cosine `mu` and φ = 0.7.
///
/// As [`microfacets`](super::scattering::microfacets), with normals that are stretched from a disk.
pub fn stretched_microfacets([ax, ay]: [f64; 2], mu: f64) -> f64 {
    let sin = (1.0 - mu * mu).sqrt();
    let o = [sin * 0.7f64.cos(), sin * 0.7f64.sin(), mu];
    let seen = |w: [f64; 3]| 2.0 * w[2] / (w[2] + (w[0] * w[0] * ax * ax + w[1] * w[1] * ay * ay + w[2] * w[2]).sqrt());
    let density = |[s, phi]: [f64; 2]| {
        let tan = (s.powi(-4) - 1.0).sqrt();
        let h = [ax * tan * phi.cos(), ay * tan * phi.sin(), 1.0];
        let length = h.iter().map(|x| x * x).sum::<f64>().sqrt();
        let h = h.map(|x| x / length);
        let cos: f64 = (0..3).map(|i| o[i] * h[i]).sum();
        let i: [f64; 3] = std::array::from_fn(|k| 2.0 * cos * h[k] - o[k]);
        if cos > 0.0 && i[2] > 0.0 { seen(o) * seen(i) * cos / (mu * h[2]) * 4.0 * s.powi(3) } else { 0.0 }
    };
    // By quarters, which are alike at normal incidence: nodes of the whole turn would all see the same.
    let quarter = |k: f64| rectangle([0.0, k * PI / 2.0], [1.0, (k + 1.0) * PI / 2.0], 1e-5, density);
    [0.0, 1.0, 2.0, 3.0].map(quarter).iter().sum::<f64>() / TAU
}

/// Share of light that a white sheen of this roughness returns towards a cosine.
///
/// Source: Estevez & Kulla 2017, with the constants of KHR_materials_sheen.
pub fn sheen(roughness: f64, mu: f64) -> f64 {
    let alpha = roughness * roughness;
    let l = |x: f64| {
        let t = (1.0 - alpha).powi(2);
        let mix = |a: f64, b: f64| (1.0 - t) * a + t * b;
        let (a, b, c) = (mix(21.5473, 25.3245), mix(3.82987, 3.32435), mix(0.19823, 0.16801));
        a / (1.0 + b * x.powf(c)) + mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967)
    };
    let lambda = |c: f64| if c < 0.5 { l(c).exp() } else { (2.0 * l(0.5) - l(1.0 - c)).exp() };
    let sin = (1.0 - mu * mu).sqrt();
    // cos = t², since much of it comes from near the horizon.
    let density = |[t, phi]: [f64; 2]| {
        let cos = t * t;
        let s = (1.0 - cos * cos).sqrt();
        let h = [s * phi.cos() + sin, s * phi.sin(), cos + mu];
        let across = h[0] * h[0] + h[1] * h[1];
        let d = (2.0 + 1.0 / alpha) / TAU * (across / (across + h[2] * h[2])).powf(0.5 / alpha);
        d / ((1.0 + lambda(mu) + lambda(cos)) * 4.0 * mu) * 2.0 * t
    };
    2.0 * rectangle([1e-6, 0.0], [1.0, PI], 1e-6, density)
}

/// Reflectance of a film of this index and thickness (nanometres) on a base that reflects `f0`, at a cosine outside.
///
/// Source: KHR_materials_iridescence, after Belcour & Barla 2017.
pub fn film(cos: f64, ior: f64, thickness: f64, f0: f64) -> [f64; 3] {
    let t = (thickness / 0.03).min(1.0);
    let ior = 1.0 + (ior - 1.0) * t * t * (3.0 - 2.0 * t);
    let normal = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    let schlick = |f0: f64, c: f64| f0 + (1.0 - f0) * (1.0 - c).powi(5);
    let inside = (1.0 - (1.0 - cos * cos) / (ior * ior)).sqrt();
    let root = f0.clamp(0.0, 0.9999).sqrt();
    let base = (1.0 + root) / (1.0 - root);
    let (top, bottom) = (schlick(normal(ior, 1.0), cos), schlick(normal(base, ior), inside));
    let shift = if base < ior { TAU } else { PI };
    let both = (top * bottom).clamp(1e-5, 0.9999);
    let once = (1.0 - top).powi(2) * bottom / (1.0 - both);
    let mut sum = [top + once; 3];
    let path = 2.0 * ior * thickness * inside;
    for order in [1.0, 2.0] {
        let amplitude = (once - (1.0 - top)) * both.sqrt().powf(order);
        let phase = TAU * path * order * 1e-9;
        let wave = |height: f64, place: f64, variance: f64| {
            let carrier = (place * phase + shift * order).cos();
            height * (TAU * variance).sqrt() * carrier * (-phase * phase * variance).exp() / 1.0685e-7
        };
        let x = wave(5.4856e-13, 1.6810e6, 4.3278e9) + wave(9.7470e-14, 2.2399e6, 4.5282e9);
        let (y, z) = (wave(4.4201e-13, 1.7953e6, 9.3046e9), wave(5.2481e-13, 2.2084e6, 6.6121e9));
        let rgb = [
            3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
            -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
            0.0556434 * x - 0.2040259 * y + 1.0572252 * z,
        ];
        (0..3).for_each(|i| sum[i] += 2.0 * amplitude * rgb[i]);
    }
    sum.map(|x| x.clamp(0.0, 1.0))
}
