//! glTF's metallic-roughness material with KHR_materials_{specular, ior, transmission, volume}.
//!
//! f = (1 − metallic) · (layer + under the layer: (1 − transmission) · diffuse + transmission · refraction)
//!     + metallic · metal
//!
//! - Layer: GGX reflection with the exact dielectric Fresnel factor of `ior`, tinted at normal incidence by
//!   `specular_color` and scaled by `specular`. With `specular` 0 there is no layer: roughness 1 is exactly Lambert.
//! - Diffuse: base/π · (1 − F(cos wi)) (1 − F(cos wo)), F the layer's factor: reciprocal and never above 1 in all. (glTF's
//!   own 1 − F(wo·h) returns up to twice the light at grazing angles.)
//! - Refraction: GGX, base · (1 − F), F of the same microfacet by its cosines to wo and to wi: reciprocal also next to total
//!   reflection. An index within 1e-3 of 1 counts as 1.001 where the interface is rough. Thin walls (no volume) pass the
//!   mirror image of the reflection instead, unbent, and look alike from both sides.
//! - Metal: GGX reflection with Schlick's factor, F0 = base, F90 = 1. Single scattering, separable Smith masking.
//! - Reflection and refraction are perfectly smooth where `smooth`: then f and pdf hold the diffuse part alone.
//! - World frame. f is relative to the cosine of the shading normal; below the surface only refraction is not 0; with
//!   consistent normals the geometric normal tells below from above.
//! - Sampling: diffuse or microfacet by their shares at wo; visible normals; reflection or refraction by Fresnel's factor
//!   at the microfacet. `sample` calls the code of `pdf` and `eval` for the direction it found.
//! - Source: glTF 2.0, appendix B, and the extensions' texts; Shirley 1991, section 4.2, for the coupling of diffuse.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32};

use crate::bsdf::dielectric::{refract, refraction};
use crate::bsdf::diffuse::{diffuse_is_seen, diffuse_pdf, sample_diffuse};
use crate::bsdf::frame::{Side, bend_ratio, reflect, shading_cos};
use crate::bsdf::rough::{Facet, Rough, bending};
use crate::bsdf::{Bsdf, BsdfSample, EvalFn, PdfFn, SampleFn};
use crate::core::color::{Color, black};
use crate::core::fresnel::{fresnel_dielectric, fresnel_normal, fresnel_passed, fresnel_schlick, refracted_cos};
use crate::core::rng::Rng;
use crate::core::vec::{Vec3, vec2, vec3};
use crate::geometry::SurfaceElement;

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

/// f per steradian and pdf per steradian of one direction.
#[derive(Clone, Copy)]
struct Value {
    f: Color,
    pdf: F32,
}
impl_staged!(Value { f, pdf });

/// What the dielectric layer does with light at some angle.
#[derive(Clone, Copy)]
struct Layer {
    /// Share reflected.
    reflected: Color,
    /// Share that passes, the same in all channels, so that what lies under it keeps its colour: 1 less the largest
    /// channel of `reflected`, without cancellation.
    passed: F32,
}
impl_staged!(Layer { reflected, passed });

/// What a microfacet does with light at some angle.
#[derive(Clone, Copy)]
struct Split {
    /// Share reflected.
    reflected: Color,
    /// Share that passes the layer and refracts.
    refracted: Color,
    /// Probability of choosing reflection.
    choice: F32,
}
impl_staged!(Split { reflected, refracted, choice });

/// The material's BSDF.
pub fn make_gltf_bsdf(surf: SurfaceElement, values: GltfValues) -> Bsdf {
    // Perfectly specular, or nothing at all (a black emitter): light sampling is of no use.
    let nothing = !values.has_facets() & !values.has_diffuse;
    let only_smooth = nothing | (values.smooth & values.diffuse_albedo().is_black());
    Bsdf {
        eval: EvalFn::lam(|b, (wi, wo)| View::new(b, surf, values, wo).value(b, wi).f),
        pdf: PdfFn::lam(|b, (wi, wo)| View::new(b, surf, values, wo).value(b, wi).pdf),
        sample: SampleFn::lam(|b, (rng, wo)| View::new(b, surf, values, wo).sample(b, rng)),
        is_specular: only_smooth,
    }
}

impl GltfValues {
    fn has_facets(self) -> Bool {
        self.has_specular | self.has_metal | self.has_transmission
    }

    /// Albedo of the diffuse part without the layer's influence.
    fn diffuse_albedo(self) -> Color {
        let share = (1.0 - self.metal_share()) * (1.0 - self.transmission_share());
        self.has_diffuse.select(self.base * share, black())
    }

    fn metal_share(self) -> F32 {
        self.has_metal.select(self.metallic, 0.0.into())
    }

    fn transmission_share(self) -> F32 {
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
    fn split(self, b: &mut Block, cos: F32, beyond: F32, eta: F32) -> Split {
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
    fn split_at(self, b: &mut Block, cos: F32, eta: F32) -> Split {
        self.split(b, cos, refracted_cos(cos, eta), eta)
    }
}

/// a / (a + b), and 1 where both are 0.
fn share_of(a: F32, b: F32) -> F32 {
    let sum = a + b;
    sum.gt(0.0).select(a / sum, 1.0.into())
}

/// The material seen from wo.
#[derive(Clone, Copy)]
struct View {
    surf: SurfaceElement,
    values: GltfValues,
    wo: Vec3,
    side: Side,
    /// Bent shading normal: that of mirrors and microfacets.
    normal: Vec3,
    /// Index beyond the interface over the index before it.
    eta: F32,
    /// Indices before and beyond the interface of a solid.
    indices: (F32, F32),
    /// Probability of sampling a microfacet rather than diffuse reflection.
    facets: F32,
    /// Share of light that passes the layer towards wo.
    passes: F32,
}

impl View {
    fn new(b: &mut Block, surf: SurfaceElement, values: GltfValues, wo: Vec3) -> View {
        let side = Side::new(surf, wo);
        let normal = side.bent_normal(wo);
        let solid = values.has_transmission & !values.thin;
        // Fresnel's factor and the way light is bent are those of one index.
        let ior = (solid & !values.smooth).select(bending(values.ior), values.ior);
        let eta = solid.select(side.eta(ior), ior);
        let indices = side.outside.select((F32::from(1.0), ior), (ior, 1.0.into()));
        let passes = passing(b, values, side.normal.dot(wo).abs(), eta);
        let facets = b.if_(
            values.has_facets() & values.has_diffuse,
            |b| {
                let Split { reflected, refracted, .. } = values.split_at(b, normal.dot(wo), eta);
                // A tenth of the largest possible reflection: f may be above 0 where this angle reflects nothing.
                let most = values.has_specular.select(values.specular, 0.0.into()).max(values.metal_share());
                let facets = reflected.max_channel() * 0.9 + most * 0.1 + refracted.max_channel();
                share_of(facets, values.diffuse_albedo().max_channel() * passes)
            },
            |_| values.has_facets().select(F32::from(1.0), 0.0.into()),
        );
        View { surf, values, wo, side, normal, eta, indices, facets, passes }
    }

    /// f and pdf of everything that is not perfectly specular.
    fn value(self, b: &mut Block, wi: Vec3) -> Value {
        let diffuse = b.if_(self.values.has_diffuse, |b| self.diffuse(b, wi), |_| nothing());
        b.if_(
            self.values.has_facets() & !self.values.smooth,
            |b| {
                let facets = self.facets(b, wi);
                Value { f: diffuse.f + facets.f, pdf: diffuse.pdf + facets.pdf }
            },
            |_| diffuse,
        )
    }

    /// The diffuse part; its density includes the probability of choosing it.
    fn diffuse(self, b: &mut Block, wi: Vec3) -> Value {
        let albedo = self.diffuse_reflectance(b, wi);
        Value {
            f: albedo * F32::from(std::f32::consts::FRAC_1_PI),
            pdf: diffuse_pdf(self.side, wi) * (1.0 - self.facets),
        }
    }

    /// π f of the diffuse part.
    fn diffuse_reflectance(self, b: &mut Block, wi: Vec3) -> Color {
        let passes = passing(b, self.values, self.side.normal.dot(wi).abs(), self.eta);
        let albedo = self.values.diffuse_albedo() * (passes * self.passes);
        diffuse_is_seen(self.side, wi).select(albedo, black())
    }

    fn rough(self) -> Rough {
        Rough::new(self.normal, self.wo, self.values.alpha)
    }

    /// The microfacets' part; its density includes the probability of choosing it.
    fn facets(self, b: &mut Block, wi: Vec3) -> Value {
        let (rough, values) = (self.rough(), self.values);
        let local = rough.frame.to_local(wi);
        // f is relative to the shading normal, the lobe to the bent one.
        let ratio = bend_ratio(local.z, shading_cos(self.surf, wi));
        let reflection = |b: &mut Block| {
            let Facet { cos, f, pdf } = rough.reflection(local);
            let split = values.split_at(b, cos, self.eta);
            let f = self.side.reflects(wi).select(split.reflected * (f * ratio), black());
            Value { f, pdf: pdf * split.choice * self.facets }
        };
        let refraction = |b: &mut Block| {
            let passage = |_: &mut Block| {
                let facet = rough.passage(local);
                (facet, refracted_cos(facet.cos, self.eta))
            };
            let (facet, beyond) = b.if_(values.thin, passage, |_| rough.refraction(local, self.indices));
            let Facet { cos, f, pdf } = facet;
            let split = values.split(b, cos, beyond, self.eta);
            let f = self.side.transmits(wi).select(split.refracted * (f * ratio), black());
            Value { f, pdf: pdf * (1.0 - split.choice) * self.facets }
        };
        b.if_(values.has_transmission & local.z.lt(0.0), refraction, reflection)
    }

    /// A direction. Draws four numbers.
    fn sample(self, b: &mut Block, rng: Rng) -> BsdfSample {
        let values = self.values;
        let (u, rng) = rng.next();
        let facet = values.has_facets() & (!values.has_diffuse | u.lt(self.facets));
        b.if_(
            facet & values.smooth,
            |b| self.sample_smooth(b, rng),
            |b| {
                let (wi, found) =
                    b.if_(facet, |b| self.sample_rough(b, rng), |_| (sample_diffuse(rng, self.side), Bool::from(true)));
                let sample = self.scattered(b, wi);
                found.select(sample, BsdfSample::scattered(wi, black(), 0.0.into()))
            },
        )
    }

    /// The sample that gives this direction.
    fn scattered(self, b: &mut Block, wi: Vec3) -> BsdfSample {
        let values = self.values;
        let sample = b.if_(
            values.has_facets(),
            |b| {
                let Value { f, pdf } = self.value(b, wi);
                BsdfSample::scattered(wi, f * shading_cos(self.surf, wi), pdf)
            },
            // Diffuse alone: density and cosine cancel.
            |b| {
                let weight = self.diffuse_reflectance(b, wi);
                BsdfSample { weight, ..BsdfSample::scattered(wi, black(), diffuse_pdf(self.side, wi)) }
            },
        );
        let bends = values.has_transmission & !values.thin & self.side.transmits(wi);
        let radiance_scale = bends.select(1.0 / (self.eta * self.eta), 1.0.into());
        BsdfSample { radiance_scale, ..sample }
    }

    /// Perfect reflection or refraction.
    fn sample_smooth(self, b: &mut Block, rng: Rng) -> BsdfSample {
        let (values, side) = (self.values, self.side);
        let (u, _) = rng.next();
        let split = values.split_at(b, self.normal.dot(self.wo), self.eta);
        b.if_(
            values.has_transmission & u.ge(split.choice),
            |b| {
                let weight = split.refracted / ((1.0 - split.choice) * self.facets);
                b.if_(
                    values.thin,
                    |_| BsdfSample::specular(-self.wo, side.transmits(-self.wo).select(weight, black())),
                    |_| refraction(side, refract(self.wo, self.normal, self.eta), self.eta, weight),
                )
            },
            |_| {
                let wi = reflect(self.wo, self.normal);
                let weight = split.reflected / (split.choice * self.facets);
                BsdfSample::specular(wi, side.reflects(wi).select(weight, black()))
            },
        )
    }

    /// A direction by way of a visible microfacet, world. Is it on the side where the microfacet was to send it? Else the
    /// sample failed: the density there is that of other microfacets.
    fn sample_rough(self, b: &mut Block, rng: Rng) -> (Vec3, Bool) {
        let (rough, values) = (self.rough(), self.values);
        let (u, rng) = rng.next();
        let (v, rng) = rng.next();
        let (choice, _) = rng.next();
        let h = rough.sample_normal(vec2(u, v));
        let mirrored = rough.reflected(h);
        let (local, height) = b.if_(
            values.has_transmission,
            |b| {
                let split = values.split_at(b, rough.wo.dot(h), self.eta);
                let behind = |b: &mut Block| {
                    let through = vec3(mirrored.x, mirrored.y, -mirrored.z);
                    let local = b.if_(values.thin, |_| through, |_| rough.refracted(h, self.eta));
                    (local, -local.z)
                };
                b.if_(choice.ge(split.choice), behind, |_| (mirrored, mirrored.z))
            },
            |_| (mirrored, mirrored.z),
        );
        (rough.frame.to_world(local), height.gt(0.0))
    }
}

/// Share of light that passes the layer at this angle.
fn passing(b: &mut Block, values: GltfValues, cos: F32, eta: F32) -> F32 {
    let passed = fresnel_passed(cos, refracted_cos(cos, eta), eta);
    values.layer(b, cos, passed, eta).passed
}

fn nothing() -> Value {
    Value { f: black(), pdf: 0.0.into() }
}
