//! glTF's material as numbers, and what its interfaces do with light at some angle.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32};

use crate::core::color::{Color, black};
use crate::core::fresnel::{fresnel_dielectric, fresnel_normal, fresnel_passed, fresnel_schlick, refracted_cos};
use crate::core::microfacet::Widths;
use crate::core::sampling::share_of;
use crate::core::thin_film::{Film, FilmFn, make_fresnel_film};
use crate::core::vec::{Vec3, vec3};

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
    /// Is the roughness another along `stretch` than across it?
    pub has_anisotropy: Bool,
    /// Does diffuse light come through?
    pub has_diffuse_transmission: Bool,
    /// Is there a thin film on layer and metal?
    pub has_film: Bool,
    /// Base colour.
    pub base: Color,
    /// Share of metal.
    pub metallic: F32,
    /// GGX's width; across `stretch`.
    pub alpha: F32,
    /// GGX's width along `stretch`.
    pub alpha_along: F32,
    /// Direction in which highlights are stretched, world, of any length.
    pub stretch: Vec3,
    /// Share of the diffuse light that comes through.
    pub diffuse_transmission: F32,
    /// Colour of the diffuse light that comes through.
    pub diffuse_transmission_color: Color,
    /// Share of the surface that the film covers.
    pub film_share: F32,
    /// The film.
    pub film: Film,
    /// Its factor.
    pub fresnel_film: FilmFn,
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
    has_anisotropy,
    has_diffuse_transmission,
    has_film,
    base,
    metallic,
    alpha,
    alpha_along,
    stretch,
    diffuse_transmission,
    diffuse_transmission_color,
    film_share,
    film,
    fresnel_film,
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
            has_anisotropy: no,
            has_diffuse_transmission: no,
            has_film: no,
            base: black(),
            metallic: zero,
            alpha: zero,
            alpha_along: zero,
            stretch: vec3(0.0, 0.0, 0.0),
            diffuse_transmission: zero,
            diffuse_transmission_color: black(),
            film_share: zero,
            film: Film { ior: zero, thickness: zero },
            fresnel_film: make_fresnel_film(),
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

    /// Does it scatter nothing at all, as a black emitter?
    pub fn is_nothing(self) -> Bool {
        !self.has_facets() & !self.has_diffuse
    }

    /// Share of the light that the diffuse part has, without the layer's influence.
    fn diffuse_share(self) -> F32 {
        (1.0 - self.metal_share()) * (1.0 - self.transmission_share())
    }

    /// Albedo of diffuse reflection without the layer's influence.
    pub(super) fn diffuse_albedo(self) -> Color {
        let share = self.diffuse_share();
        let share = self.has_diffuse_transmission.select(share * (1.0 - self.diffuse_transmission), share);
        self.has_diffuse.select(self.base * share, black())
    }

    /// Albedo of diffuse transmission without the layer's influence.
    pub(super) fn diffuse_transmittance(self) -> Color {
        let share = self.diffuse_share() * self.diffuse_transmission;
        let through = self.has_diffuse & self.has_diffuse_transmission;
        through.select(self.diffuse_transmission_color * share, black())
    }

    /// Diffuse light in all, for sampling, and the probability of letting it through.
    pub(super) fn diffuse_choice(self) -> (F32, F32) {
        let (reflected, through) = (self.diffuse_albedo().max_channel(), self.diffuse_transmittance().max_channel());
        let both = (reflected + through, share_of(through, reflected));
        self.has_diffuse_transmission.select(both, (reflected, 0.0.into()))
    }

    /// GGX's widths in the frame along `stretch`.
    pub(super) fn widths(self) -> Widths {
        let along = self.has_anisotropy.select(self.alpha_along, self.alpha);
        Widths { x: along, y: self.alpha, round: !self.has_anisotropy }
    }

    pub(super) fn metal_share(self) -> F32 {
        self.has_metal.select(self.metallic, 0.0.into())
    }

    pub(super) fn transmission_share(self) -> F32 {
        self.has_transmission.select(self.transmission, 0.0.into())
    }

    /// Fresnel's factor of the layer, coloured; `eta` is the index beyond over the index before it, `passed` the share that
    /// an interface without colour lets through at this angle, which has this cosine outside.
    fn layer(self, b: &mut Block, cos: F32, outside: F32, passed: F32, eta: F32) -> Layer {
        b.if_(
            self.has_specular,
            |b| {
                let f0 = fresnel_normal(self.ior);
                // How far from normal to grazing, and from grazing to normal: what remains when f0 is tinted.
                let k = ((fresnel_dielectric(cos, eta) - f0) / (1.0 - f0)).max(0.0);
                let k = f0.lt(1.0).select(k, 1.0.into());
                let rest = f0.lt(1.0).select((passed / (1.0 - f0)).min(1.0), 0.0.into());
                let f0 = self.specular_color.map(|tint| (f0 * tint).min(1.0));
                let reflected = f0.map(|f0| self.specular * (f0 + (1.0 - f0) * k));
                let passed = (1.0 - self.specular) + self.specular * ((1.0 - f0.max_channel()) * rest);
                b.if_(
                    self.has_film,
                    |b| {
                        let film = self.fresnel_film.call(b, (outside, self.film, f0));
                        // Apart, since what passes without a film is known without cancellation: reciprocity needs it.
                        let beside = passed * (1.0 - self.film_share);
                        let passed = beside + self.film_share * (1.0 - self.specular * film.max_channel());
                        Layer { reflected: reflected.lerp(film * self.specular, self.film_share), passed }
                    },
                    |_| Layer { reflected, passed },
                )
            },
            |_| Layer { reflected: black(), passed: 1.0.into() },
        )
    }

    /// What a microfacet does at this angle, given by the cosines on both sides.
    pub(super) fn split(self, b: &mut Block, cos: F32, beyond: F32, eta: F32) -> Split {
        let passed = fresnel_passed(cos, beyond, eta);
        // A film lies on the outside.
        let outside = eta.lt(1.0).select(beyond, cos);
        let layer = self.layer(b, cos, outside, passed, eta);
        let reflected = b.if_(
            self.has_metal,
            |b| {
                let metal = fresnel_schlick(self.base, cos);
                let film = |b: &mut Block| {
                    let film = self.fresnel_film.call(b, (outside, self.film, self.base));
                    metal.lerp(film, self.film_share)
                };
                let metal = b.if_(self.has_film, film, |_| metal);
                layer.reflected.lerp(metal, self.metallic)
            },
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

/// Share of light that passes the layer at this angle.
pub(super) fn passing(b: &mut Block, values: GltfValues, cos: F32, eta: F32) -> F32 {
    let beyond = refracted_cos(cos, eta);
    let passed = fresnel_passed(cos, beyond, eta);
    values.layer(b, cos, eta.lt(1.0).select(beyond, cos), passed, eta).passed
}
