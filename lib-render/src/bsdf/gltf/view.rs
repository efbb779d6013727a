//! glTF's material seen from a direction: value, density and samples.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32};

use super::smooth::sample_smooth;
use super::values::{GltfValues, Split, passing};
use crate::bsdf::BsdfSample;
use crate::bsdf::bent::bend_ratio;
use crate::bsdf::diffuse::{diffuse_comes_through, diffuse_is_seen, diffuse_pdf, sample_diffuse};
use crate::bsdf::frame::{Side, frame_along, shading_cos};
use crate::bsdf::rough::{Facet, Rough, bending};
use crate::bsdf::thin_wall::behind;
use crate::core::color::{Color, black};
use crate::core::fresnel::refracted_cos;
use crate::core::microfacet::Widths;
use crate::core::rng::Rng;
use crate::core::sampling::share_of;
use crate::core::vec::{Vec3, vec2};
use crate::geometry::{Frame3, SurfaceElement};

/// f per steradian and pdf per steradian of one direction.
#[derive(Clone, Copy)]
pub(super) struct Value {
    pub f: Color,
    pub pdf: F32,
}
impl_staged!(Value { f, pdf });

/// The material seen from wo.
#[derive(Clone, Copy)]
pub(super) struct View {
    surf: SurfaceElement,
    pub(super) values: GltfValues,
    pub(super) wo: Vec3,
    pub(super) side: Side,
    /// Bent shading normal: that of mirrors and microfacets.
    pub(super) normal: Vec3,
    /// Index beyond the interface over the index before it.
    pub(super) eta: F32,
    /// Indices before and beyond the interface of a solid.
    indices: (F32, F32),
    /// Probability of sampling a microfacet rather than diffuse reflection.
    pub(super) facets: F32,
    /// Share of light that passes the layer towards wo.
    passes: F32,
}

impl View {
    pub(super) fn new(b: &mut Block, surf: SurfaceElement, values: GltfValues, wo: Vec3) -> View {
        let side = Side::new(surf, wo);
        let normal = side.bent_normal(wo);
        let solid = values.is_solid();
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
                share_of(facets, values.diffuse_choice().0 * passes)
            },
            |_| values.has_facets().select(F32::from(1.0), 0.0.into()),
        );
        View { surf, values, wo, side, normal, eta, indices, facets, passes }
    }

    /// f and pdf of everything that is not perfectly specular.
    pub(super) fn value(self, b: &mut Block, wi: Vec3) -> Value {
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
        let reflected = diffuse_pdf(self.side, wi);
        let (_, through) = self.values.diffuse_choice();
        let both = reflected * (1.0 - through) + diffuse_pdf(self.side, -wi) * through;
        let pdf = self.values.has_diffuse_transmission.select(both, reflected);
        Value { f: albedo * F32::from(std::f32::consts::FRAC_1_PI), pdf: pdf * (1.0 - self.facets) }
    }

    /// π f of the diffuse part.
    fn diffuse_reflectance(self, b: &mut Block, wi: Vec3) -> Color {
        let passes = passing(b, self.values, self.side.normal.dot(wi).abs(), self.eta);
        let albedo = self.values.diffuse_albedo() * (passes * self.passes);
        let reflected = diffuse_is_seen(self.side, wi).select(albedo, black());
        b.if_(
            self.values.has_diffuse_transmission,
            |b| {
                let through = self.diffuse_transmittance(b, wi);
                diffuse_comes_through(self.side, wi).select(through, reflected)
            },
            |_| reflected,
        )
    }

    /// π f of the diffuse light that comes through from wi, which is on the other side.
    fn diffuse_transmittance(self, b: &mut Block, wi: Vec3) -> Color {
        // Into a solid light bends; radiance outside is spread over more directions than inside.
        let solid = self.values.is_solid();
        let beyond = solid.select(1.0 / self.eta, self.eta);
        let scale = (solid & self.side.outside).select(beyond * beyond, 1.0.into());
        let passes = passing(b, self.values, self.side.normal.dot(wi).abs(), beyond);
        self.values.diffuse_transmittance() * (passes * self.passes * scale)
    }

    /// A direction of the diffuse part. Draws three numbers.
    fn sample_diffuse(self, rng: Rng) -> Vec3 {
        let wi = sample_diffuse(rng, self.side);
        let (u, _) = rng.ahead(2).next();
        let n = self.side.normal;
        let through = self.values.has_diffuse_transmission & u.lt(self.values.diffuse_choice().1);
        through.select(wi - n * (2.0 * n.dot(wi)), wi)
    }

    fn rough(self) -> Rough {
        let Widths { x, y, round } = self.values.widths();
        let frame = round.select(Frame3::around(self.normal), frame_along(self.normal, self.values.stretch));
        Rough::along(frame, self.wo, Widths { x, y, round })
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
    pub(super) fn sample(self, b: &mut Block, rng: Rng) -> BsdfSample {
        let values = self.values;
        let (u, rng) = rng.next();
        let facet = values.has_facets() & (!values.has_diffuse | u.lt(self.facets));
        b.if_(
            facet & values.smooth,
            |b| sample_smooth(self, b, rng),
            |b| {
                let (wi, found) =
                    b.if_(facet, |b| self.sample_rough(b, rng), |_| (self.sample_diffuse(rng), Bool::from(true)));
                let sample = self.scattered(b, wi);
                found.select(sample, BsdfSample::scattered(wi, black(), 0.0.into()))
            },
        )
    }

    /// The sample that gives this direction.
    fn scattered(self, b: &mut Block, wi: Vec3) -> BsdfSample {
        let values = self.values;
        let sample = b.if_(
            values.has_facets() | values.has_diffuse_transmission,
            |b| {
                let Value { f, pdf } = self.value(b, wi);
                BsdfSample::scattered(wi, f * shading_cos(self.surf, wi), pdf)
            },
            // Diffuse reflection alone: density and cosine cancel.
            |b| {
                let weight = self.diffuse_reflectance(b, wi);
                BsdfSample { weight, ..BsdfSample::scattered(wi, black(), diffuse_pdf(self.side, wi)) }
            },
        );
        let bends = values.is_solid() & self.side.transmits(wi);
        let radiance_scale = bends.select(1.0 / (self.eta * self.eta), 1.0.into());
        BsdfSample { radiance_scale, ..sample }
    }

    /// A direction by way of a visible microfacet, world. Is it on the side where the microfacet was to send it? Else the
    /// sample failed: the density there is that of other microfacets.
    fn sample_rough(self, b: &mut Block, rng: Rng) -> (Vec3, Bool) {
        let (rough, values) = (self.rough(), self.values);
        let ([u, v], rng) = rng.pair();
        let (choice, _) = rng.next();
        let h = rough.sample_normal(vec2(u, v));
        let mirrored = rough.reflected(h);
        let (local, height) = b.if_(
            values.has_transmission,
            |b| {
                let split = values.split_at(b, rough.wo.dot(h), self.eta);
                let beyond = |b: &mut Block| {
                    let local = b.if_(values.thin, |_| behind(mirrored), |_| rough.refracted(h, self.eta));
                    (local, -local.z)
                };
                b.if_(choice.ge(split.choice), beyond, |_| (mirrored, mirrored.z))
            },
            |_| (mirrored, mirrored.z),
        );
        (rough.frame.to_world(local), height.gt(0.0))
    }
}

fn nothing() -> Value {
    Value { f: black(), pdf: 0.0.into() }
}
