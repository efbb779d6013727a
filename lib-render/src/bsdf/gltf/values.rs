//! glTF's material as numbers, and what its interfaces do with light at some angle.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32};

use crate::core::color::{Color, black};
use crate::core::fresnel::{fresnel_dielectric, fresnel_normal, fresnel_passed, fresnel_schlick, refracted_cos};

/// The material at a point. A lobe whose flag is off is not looked at.
#[derive(Clone, Copy)]
pub struct GltfValues {
    /// Is there diffuse reflection?
    pub has_diffuse: Bool,
    /// Is there a dielectric layer?
    pub has_specular: Bool,
    /// Is there metal?
    pub has_metal: Bool,
    /// Is there transmission?
    pub has_transmission: Bool,
    /// No inside: light passes unbent.
    pub thin: Bool,
    /// Perfectly smooth reflection and refraction.
    pub smooth: Bool,
    /// Base colour.
    pub base: Color,
    /// Share of metal.
    pub metallic: F32,
    /// GGX's width.
    pub alpha: F32,
    /// Index of the inside over the outside; 0 reflects everything.
    pub ior: F32,
    /// Strength of the layer.
    pub specular: F32,
    /// Tint of the layer at normal incidence.
    pub specular_color: Color,
    /// Share of refraction under the layer.
    pub transmission: F32,
}
impl_staged!(GltfValues {
    has_diffuse,
    has_specular,
    has_metal,
    has_transmission,
    thin,
    smooth,
    base,
    metallic,
    alpha,
    ior,
    specular,
    specular_color,
    transmission
});

impl GltfValues {
    /// Every lobe off: black.
    pub fn none() -> GltfValues {
        let (no, zero) = (Bool::from(false), F32::from(0.0));
        GltfValues {
            has_diffuse: no,
            has_specular: no,
            has_metal: no,
            has_transmission: no,
            thin: no,
            smooth: no,
            base: black(),
            metallic: zero,
            alpha: zero,
            ior: zero,
            specular: zero,
            specular_color: black(),
            transmission: zero,
        }
    }
}

/// What the dielectric layer does with light at some angle.
#[derive(Clone, Copy)]
pub(super) struct Layer {
    /// Share reflected.
    pub reflected: Color,
    /// Share that passes, the same in all channels, so that what lies under it keeps its colour: 1 less the largest
    /// channel of `reflected`, without cancellation.
    pub passed: F32,
}
impl_staged!(Layer { reflected, passed });

/// What a microfacet does with light at some angle.
#[derive(Clone, Copy)]
pub(super) struct Split {
    /// Share reflected.
    pub reflected: Color,
    /// Share that passes the layer and refracts.
    pub refracted: Color,
    /// Probability of choosing reflection.
    pub choice: F32,
}
impl_staged!(Split { reflected, refracted, choice });

impl GltfValues {
    /// Does light enter an inside?
    pub fn is_solid(self) -> Bool {
        self.has_transmission & !self.thin
    }

    pub(super) fn has_facets(self) -> Bool {
        self.has_specular | self.has_metal | self.has_transmission
    }

    /// Albedo of the diffuse part without the layer's influence.
    pub(super) fn diffuse_albedo(self) -> Color {
        let share = (1.0 - self.metal_share()) * (1.0 - self.transmission_share());
        self.has_diffuse.select(self.base * share, black())
    }

    pub(super) fn metal_share(self) -> F32 {
        self.has_metal.select(self.metallic, 0.0.into())
    }

    pub(super) fn transmission_share(self) -> F32 {
        self.has_transmission.select(self.transmission, 0.0.into())
    }

    /// Fresnel's factor of the layer, coloured; `eta` is the index beyond over the index before it, `passed` the share that
    /// an interface without colour lets through at this angle.
    fn layer(self, b: &mut Block, cos: F32, passed: F32, eta: F32) -> Layer {
        b.if_(
            self.has_specular,
            |_| {
                let f0 = fresnel_normal(self.ior);
                // How far from normal to grazing, and from grazing to normal: what remains when f0 is tinted.
                let k = ((fresnel_dielectric(cos, eta) - f0) / (1.0 - f0)).max(0.0);
                let k = f0.lt(1.0).select(k, 1.0.into());
                let rest = f0.lt(1.0).select((passed / (1.0 - f0)).min(1.0), 0.0.into());
                let f0 = self.specular_color.map(|tint| (f0 * tint).min(1.0));
                Layer {
                    reflected: f0.map(|f0| self.specular * (f0 + (1.0 - f0) * k)),
                    passed: (1.0 - self.specular) + self.specular * ((1.0 - f0.max_channel()) * rest),
                }
            },
            |_| Layer { reflected: black(), passed: 1.0.into() },
        )
    }

    /// What a microfacet does at this angle, given by the cosines on both sides.
    pub(super) fn split(self, b: &mut Block, cos: F32, beyond: F32, eta: F32) -> Split {
        let passed = fresnel_passed(cos, beyond, eta);
        let layer = self.layer(b, cos, passed, eta);
        let reflected = b.if_(
            self.has_metal,
            |_| layer.reflected.lerp(fresnel_schlick(self.base, cos), self.metallic),
            |_| layer.reflected,
        );
        let (refracted, choice) = b.if_(
            self.has_transmission,
            |_| {
                let share = layer.passed * (1.0 - self.metal_share()) * self.transmission;
                // A weak layer does not take all of what is totally reflected; the rest has nowhere to go.
                let refracted = passed.gt(0.0).select(self.base * share, black());
                (refracted, share_of(reflected.max_channel(), refracted.max_channel()))
            },
            |_| (black(), F32::from(1.0)),
        );
        Split { reflected, refracted, choice }
    }

    /// [`GltfValues::split`] where one cosine is known.
    pub(super) fn split_at(self, b: &mut Block, cos: F32, eta: F32) -> Split {
        self.split(b, cos, refracted_cos(cos, eta), eta)
    }
}

/// a / (a + b), and 1 where both are 0.
pub(super) fn share_of(a: F32, b: F32) -> F32 {
    let sum = a + b;
    sum.gt(0.0).select(a / sum, 1.0.into())
}

/// Share of light that passes the layer at this angle.
pub(super) fn passing(b: &mut Block, values: GltfValues, cos: F32, eta: F32) -> F32 {
    let passed = fresnel_passed(cos, refracted_cos(cos, eta), eta);
    values.layer(b, cos, passed, eta).passed
}
