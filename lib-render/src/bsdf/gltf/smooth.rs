//! glTF's material where it is perfectly smooth: a mirror, or glass.

use jerboa_ir::lang::Block;

use super::view::View;
use crate::bsdf::BsdfSample;
use crate::bsdf::dielectric::{refract, refraction};
use crate::bsdf::frame::reflect;
use crate::bsdf::thin_wall::straight;
use crate::core::color::black;
use crate::core::rng::Rng;

/// Perfect reflection or refraction. Draws one number.
pub(super) fn sample_smooth(view: View, b: &mut Block, rng: Rng) -> BsdfSample {
    let View { values, wo, side, normal, eta, facets, .. } = view;
    let (u, _) = rng.next();
    let split = values.split_at(b, normal.dot(wo), eta);
    b.if_(
        values.has_transmission & u.ge(split.choice),
        |b| {
            let weight = split.refracted / ((1.0 - split.choice) * facets);
            b.if_(
                values.thin,
                |_| {
                    let wi = straight(wo);
                    BsdfSample::specular(wi, side.transmits(wi).select(weight, black()))
                },
                |_| refraction(side, refract(wo, normal, eta), eta, weight),
            )
        },
        |_| {
            let wi = reflect(wo, normal);
            let weight = split.reflected / (split.choice * facets);
            BsdfSample::specular(wi, side.reflects(wi).select(weight, black()))
        },
    )
}
