//! The BSDFs under test: one table, and every test of `tests/tests/scattering` runs over all its rows.
//!
//! To add a BSDF, the library's or that of the crate `examples/custom`, add a family of rows to [`rows`], with the parameters at
//! which it is extreme, set up by a way of [`Probe`]: [`Probe::model`] takes every model. A row is a name and the set-up; what it
//! does not claim stays as [`Row::new`] made it:
//! - [`Row::through`], if light comes through, with the index of the inside where it bends there;
//! - [`Row::returns`], the share of light that comes back in the green channel, by a calculation in f64 that shares
//!   nothing with the renderer; [`microfacets`] and [`phong_lobe`] are such calculations.
//!
//! ```
//! use jerboa_tests::harness::probe::{Probe, at_cos};
//! use jerboa_tests::harness::scattering::rows;
//!
//! let mut probe = Probe::default();
//! let lambert = &rows()[0];
//! (lambert.make)(&mut probe);
//! assert_eq!(lambert.returned.as_ref().unwrap()(0.3), 0.5);
//! assert_eq!(probe.sample(at_cos(0.3), 0).weight[1], 0.5);
//! ```

use std::f64::consts::PI;

use jerboa_example_custom::minnaert;
use jerboa_lib_render::schema::Materials;

use super::lobes::{film, sheen, stretched_microfacets};
use super::probe::Probe;
use super::quadrature::{gauss, rectangle};
use super::slopes;

/// Index of the dielectrics here.
pub(super) const INDEX: f64 = 1.5;

/// A BSDF, and what is claimed about it.
pub struct Row {
    /// Kind and parameter.
    pub name: String,
    /// How the probe is set up.
    pub make: Box<dyn Fn(&mut Probe)>,
    /// Does light come through?
    pub passes: bool,
    /// Index of the inside over the outside where light bends on its way in, else 1: f / index² is reciprocal.
    pub index: f64,
    /// Share of light from everywhere that is returned towards a cosine (negative: inside); green.
    pub returned: Option<Box<dyn Fn(f64) -> f64>>,
    /// Has all of it one normal? f is relative to the cosine of one, so it is reciprocal only then.
    pub has_one_normal: bool,
}

impl Row {
    /// An opaque BSDF of unknown energy.
    pub fn new(name: impl Into<String>, make: impl Fn(&mut Probe) -> &mut Probe + 'static) -> Row {
        let make = Box::new(move |probe: &mut Probe| _ = make(probe));
        Row { name: name.into(), make, passes: false, index: 1.0, returned: None, has_one_normal: true }
    }

    /// Light comes through, to an inside of this index, 1 where it does not bend.
    pub fn through(self, index: f64) -> Row {
        Row { passes: true, index, ..self }
    }

    /// The share of light returned.
    pub fn returns(self, share: impl Fn(f64) -> f64 + 'static) -> Row {
        Row { returned: Some(Box::new(share)), ..self }
    }
}

/// The table. Widths of microfacets (α): 0 is smooth, 0.0016 is the least that glTF's roughness of 0.04 makes.
pub fn rows() -> Vec<Row> {
    let mut rows = vec![
        Row::new("lambert", |p| p.lambert()).returns(|_| 0.5),
        Row::new("no layer", |p| p.plastic(1.0).number(Materials::SPECULAR, 0.0).coloured()).returns(|_| 0.5),
    ];
    rows.extend([0.0, 0.0016, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0].map(metal));
    // Schlick's factor from the colour at normal incidence to 1 at grazing.
    rows.push(Row::new("gold", |p| p.metal(0.0).coloured()).returns(|cos| 0.5 + 0.5 * (1.0 - cos.abs()).powi(5)));
    rows.extend([0.0, 0.05, 0.25, 1.0].map(plastic));
    rows.extend([0.0, 0.05, 0.25, 1.0].map(glass));
    rows.extend([0.0, 0.05, 0.25, 1.0].map(thin));
    rows.extend([0.0, 0.05, 0.36].map(medley));
    rows.extend([0.1, 0.3, 0.5, 1.0].map(sheen_on_nothing));
    rows.push(Row::new("sheen on mirror", |p| p.metal(0.0).sheen(0.5)));
    rows.push(Row::new("sheen on medley", |p| p.medley(0.5).sheen(0.7)).through(INDEX));
    rows.extend([(0.0016, 0.5), (0.05, 0.397), (0.25, 1.0)].map(|(alpha, strength)| stretched_metal(alpha, strength)));
    rows.push(Row::new("stretched glass", |p| p.glass(0.05f32.sqrt(), false).anisotropy(0.4)).through(INDEX));
    rows.extend([0.3, 1.0].map(leaf));
    rows.extend([0.05, 1.0].map(glossy_leaf));
    rows.push(Row::new("leaf medley", |p| p.medley(0.5).diffuse_transmission(0.4)).through(INDEX));
    rows.extend([(0.0, 250.0), (0.25, 400.0), (0.05, 0.0), (0.25, 1e7)].map(|(alpha, nm)| film_on_metal(alpha, nm)));
    rows.extend([(0.0, 400.0), (0.25, 250.0)].map(|(alpha, nm)| film_on_plastic(INDEX, alpha, nm)));
    // The film is denser than what it lies on.
    rows.push(film_on_plastic(1.2, 0.0, 400.0));
    rows.push(Row::new("film on glass", |p| p.glass(0.5, false).film(0.7, 400.0)).through(INDEX));
    rows.push(Row::new("film on medley", |p| p.medley(0.5).film(1.0, 600.0)).through(INDEX));
    rows.extend([0.0, 0.0016, 0.05, 0.25, 1.0].map(|alpha| coat(1.0, alpha)));
    rows.extend([0.05, 1.0].map(|alpha| coat(0.5, alpha)));
    rows.extend([0.0, 0.05, 1.0].map(coated_mirror));
    rows.extend([0.0, 0.05].map(coated_medley));
    rows.extend([1.0, 10.0, 100.0, 1e3, 1e4, 1e6, 2e6].map(phong));
    rows.extend([0.0, 0.3, 1.0].map(rough_diffuse));
    rows.extend([0.0, 0.05, 0.5].map(conductor));
    rows.push(clear_metal(0.25));
    rows.extend([0.0, 0.25].map(dielectric));
    rows.extend([0.0, 0.05, 0.5].map(varnished));
    rows.extend([1.0, 1.5, 2.5].map(thin_glass));
    rows.push(Row::new("mirror", |p| p.model("mirror", &[]).coloured()).returns(|_| 0.5));
    rows.extend([(0.3, 0.0), (0.3, 0.25), (1.0, 0.5)].map(blend));
    rows.extend([1.0, 2.0, 8.0].map(minnaert_of));
    rows.extend(slopes::rows());
    rows
}

/// α as the material finds it, from the roughness that is set.
pub(super) fn widths(alpha: f64) -> (f32, f64) {
    let roughness = alpha.sqrt() as f32;
    (roughness, f64::from(roughness * roughness))
}

fn metal(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("metal {alpha:.3}"), move |p| p.metal(roughness));
    row.returns(move |cos| microfacets(alpha, Masking::Separable, cos.abs(), 1.0, |_| 1.0)[0])
}

/// White under a layer: what the layer reflects, and what passes it in and out again.
fn plastic(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("plastic {alpha:.3}"), move |p| p.plastic(roughness));
    let passing_out = gauss::<64>(0.0, 1.0, |c| (1.0 - fresnel(c, INDEX)) * 2.0 * c);
    row.returns(move |cos| {
        let cos = cos.abs();
        let layer = microfacets(alpha, Masking::Separable, cos, INDEX, |c| fresnel(c, INDEX))[0];
        layer + (1.0 - fresnel(cos, INDEX)) * passing_out
    })
}

fn glass(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("glass {alpha:.3}"), move |p| p.glass(roughness, false)).through(INDEX);
    row.returns(move |cos| {
        let eta = if cos > 0.0 { INDEX } else { INDEX.recip() };
        microfacets(alpha, Masking::Separable, cos.abs(), eta, |c| fresnel(c, eta)).iter().sum()
    })
}

/// What passes is the mirror image of what is reflected: together they are white metal.
fn thin(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("thin {alpha:.3}"), move |p| p.glass(roughness, true)).through(1.0);
    row.returns(move |cos| microfacets(alpha, Masking::Separable, cos.abs(), 1.0, |_| 1.0)[0])
}

fn medley(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    Row::new(format!("medley {alpha:.3}"), move |p| p.medley(roughness)).through(INDEX)
}

/// A sheen alone; below 0.26 its roughness is 0.26.
pub(super) fn sheen_on_nothing(roughness: f64) -> Row {
    let set = roughness as f32;
    let row =
        Row::new(format!("sheen {roughness}"), move |p| p.lambert().flag(Materials::HAS_DIFFUSE, false).sheen(set));
    row.returns(move |cos| sheen(f64::from(set.max(0.26)), cos.abs()))
}

/// White metal that is rougher along x.
fn stretched_metal(alpha: f64, strength: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let along = alpha + (1.0 - alpha) * strength * strength;
    let name = format!("stretched {along:.3} {alpha:.3}");
    let row = Row::new(name, move |p| p.metal(roughness).anisotropy(strength as f32));
    row.returns(move |cos| stretched_microfacets([along, alpha], cos.abs()))
}

/// Half of the green light goes on, whichever way.
fn leaf(share: f64) -> Row {
    let row = Row::new(format!("leaf {share}"), move |p| p.lambert().diffuse_transmission(share as f32));
    row.through(1.0).returns(|_| 0.5)
}

/// White under a layer on both sides, of which the green half of 0.6 comes through.
fn glossy_leaf(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let name = format!("glossy leaf {alpha:.3}");
    let row = Row::new(name, move |p| p.plastic(roughness).diffuse_transmission(0.6)).through(1.0);
    let passing_out = gauss::<64>(0.0, 1.0, |c| (1.0 - fresnel(c, INDEX)) * 2.0 * c);
    row.returns(move |cos| {
        let cos = cos.abs();
        let layer = microfacets(alpha, Masking::Separable, cos, INDEX, |c| fresnel(c, INDEX))[0];
        layer + (1.0 - fresnel(cos, INDEX)) * passing_out * 0.7
    })
}

pub(super) fn film_on_metal(alpha: f64, nanometres: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let name = format!("film on metal {alpha:.3} {nanometres}");
    let row = Row::new(name, move |p| p.metal(roughness).coloured().film(1.0, nanometres as f32));
    let reflected = move |c: f64| film(c, f64::from(1.3f32), nanometres, 0.5)[1];
    row.returns(move |cos| microfacets(alpha, Masking::Separable, cos.abs(), INDEX, reflected)[0])
}

/// White under a film: what passes has the colour of what is under it.
pub(super) fn film_on_plastic(index: f64, alpha: f64, nanometres: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let name = format!("film on plastic of {index} {alpha:.3} {nanometres}");
    let row =
        Row::new(name, move |p| p.plastic(roughness).number(Materials::IOR, index as f32).film(1.0, nanometres as f32));
    let at_normal = ((index - 1.0) / (index + 1.0)).powi(2);
    let reflected = move |c: f64| film(c, f64::from(1.3f32), nanometres, at_normal);
    let passed = move |c: f64| 1.0 - reflected(c).into_iter().fold(0.0, f64::max);
    let passing_out = gauss::<64>(0.0, 1.0, |c| passed(c) * 2.0 * c);
    row.returns(move |cos| {
        let cos = cos.abs();
        let layer = microfacets(alpha, Masking::Separable, cos, index, |c| reflected(c)[1])[0];
        layer + passed(cos) * passing_out
    })
}

/// A coat of this strength over Lambert's surface: what it reflects, and what passes it in and out again.
pub(super) fn coat(strength: f64, alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("coat {strength} {alpha:.3}"), move |p| p.lambert().coat(strength as f32, roughness));
    let passing_out = gauss::<64>(0.0, 1.0, |c| (1.0 - strength * fresnel(c, INDEX)) * 2.0 * c);
    row.returns(move |cos| {
        let cos = cos.abs();
        let own = microfacets(alpha, Masking::Separable, cos, INDEX, |c| fresnel(c, INDEX))[0];
        strength * own + (1.0 - strength * fresnel(cos, INDEX)) * passing_out * 0.5
    })
}

/// A coat over what keeps all light.
fn coated_mirror(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("coated mirror {alpha:.3}"), move |p| p.metal(0.0).coat(1.0, roughness));
    row.returns(move |cos| {
        let cos = cos.abs();
        let own = microfacets(alpha, Masking::Separable, cos, INDEX, |c| fresnel(c, INDEX))[0];
        own + (1.0 - fresnel(cos, INDEX)).powi(2)
    })
}

/// A coat on the outside of a solid.
fn coated_medley(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("coated medley {alpha:.3}"), move |p| p.medley(0.5).coat(0.8, roughness));
    row.through(INDEX)
}

/// Phong's lobe on Lambert's, mixed by luminance.
fn phong(ns: f64) -> Row {
    let row = Row::new(format!("phong {ns}"), move |p| p.phong(ns as f32));
    // Luminance by Rec. 709 of the albedo that `Probe::coloured` sets.
    let share = 1.0 / (1.0 + 0.2126 * 0.8 + 0.7152 * 0.5 + 0.0722 * 0.2);
    // As a mirror, where the model takes it for one.
    let lobe = move |cos: f64| if ns > 1e6 { 1.0 } else { phong_lobe(ns, cos.abs()) };
    row.returns(move |cos| share * lobe(cos) + (1.0 - share) * 0.5)
}

/// E of the facets' single scattering and what its loss is scattered to again, both by quadrature of f (EON; ρ = 1/2).
fn rough_diffuse(r: f64) -> Row {
    let row =
        Row::new(format!("rough diffuse {r}"), move |p| p.model("rough-diffuse", &[]).coloured().roughness(r as f32));
    let a = 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
    let single = move |mu: f64| {
        let sin = (1.0 - mu * mu).sqrt();
        // Half a turn; s changes sign at a right angle, t where the cosines are equal.
        let part = |lo: f64, hi: f64, from: f64, to: f64| {
            gauss::<48>(lo, hi, |c| {
                let of = |phi: f64| {
                    let s = sin * (1.0 - c * c).sqrt() * phi.cos();
                    1.0 + r * if s > 0.0 { s / mu.max(c) } else { s }
                };
                a * 2.0 * c / PI * gauss::<16>(from, to, of)
            })
        };
        let (right, half) = (PI / 2.0, PI);
        part(0.0, mu, 0.0, right) + part(mu, 1.0, 0.0, right) + part(0.0, mu, right, half) + part(mu, 1.0, right, half)
    };
    let average = gauss::<32>(0.0, 1.0, |c| single(c) * 2.0 * c);
    let rho = 0.5;
    let again = rho * rho * average / (1.0 - rho * (1.0 - average));
    row.returns(move |cos| rho * single(cos.abs()) + again * (1.0 - single(cos.abs())))
}

/// Gold in green light, tinted by one half.
fn conductor(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let numbers = [0.155, 0.424, 1.382, 3.6, 2.472, 1.915];
    let row = Row::new(format!("conductor {alpha:.3}"), move |p| {
        p.model("conductor", &numbers).coloured().roughness(roughness)
    });
    let f = |c: f64| 0.5 * fresnel_metal(c, 0.424, 2.472);
    row.returns(move |cos| microfacets(alpha, Masking::Separable, cos.abs(), 1.0, f)[0])
}

/// A metal that absorbs nothing is glass that nothing enters.
fn clear_metal(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let index = INDEX as f32;
    let numbers = [index, index, index, 0.0, 0.0, 0.0];
    let row = Row::new(format!("clear metal {alpha:.3}"), move |p| p.model("conductor", &numbers).roughness(roughness));
    row.returns(move |cos| microfacets(alpha, Masking::Separable, cos.abs(), INDEX, |c| fresnel(c, INDEX))[0])
}

/// As glass, by its own name.
fn dielectric(alpha: f64) -> Row {
    let row = glass(alpha);
    let (roughness, alpha) = widths(alpha);
    let make = move |p: &mut Probe| _ = p.model("dielectric", &[]).roughness(roughness);
    Row { name: format!("dielectric {alpha:.3}"), make: Box::new(make), ..row }
}

/// The varnish, and what passes it, is thrown to and fro, and passes it again.
fn varnished(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row =
        Row::new(format!("varnished {alpha:.3}"), move |p| p.model("plastic", &[]).coloured().roughness(roughness));
    let passing = gauss::<64>(0.0, 1.0, |c| (1.0 - fresnel(c, INDEX)) * 2.0 * c);
    let critical = (1.0 - INDEX.powi(-2)).sqrt();
    // Totally reflected below the critical cosine; above, it begins with a square root.
    let thrown_back = critical * critical
        + gauss::<64>(0.0, 1.0, |t| {
            let c = critical + (1.0 - critical) * t * t;
            fresnel(c, INDEX.recip()) * 2.0 * c * (1.0 - critical) * 2.0 * t
        });
    let ground = 0.5 / (1.0 - 0.5 * thrown_back) / (INDEX * INDEX);
    row.returns(move |cos| {
        let cos = cos.abs();
        let varnish = microfacets(alpha, Masking::Separable, cos, INDEX, |c| fresnel(c, INDEX))[0];
        varnish + (1.0 - fresnel(cos, INDEX)) * passing * ground
    })
}

/// A clear sheet keeps all light.
fn thin_glass(index: f64) -> Row {
    let make = move |p: &mut Probe| _ = p.model("thin-glass", &[]).number(Materials::IOR, index as f32);
    Row { make: Box::new(make), ..Row::new(format!("sheet {index}"), |p| p).through(1.0).returns(|_| 1.0) }
}

/// Of a user's crate: ρ (k + 1)/2π ∫ (cos wi cos wo)^(k−1) cos wi is a power of one cosine.
fn minnaert_of(k: f64) -> Row {
    let row = Row::new(format!("minnaert {k}"), move |p| p.model(minnaert::NAME, &[k as f32]).coloured());
    row.returns(move |cos| 0.5 * cos.abs().powf(k - 1.0))
}

/// Both parts by their shares.
fn blend((share, alpha): (f64, f64)) -> Row {
    let (roughness, alpha) = widths(alpha);
    let row = Row::new(format!("blend {share} {alpha:.3}"), move |p| p.blend(share as f32, roughness));
    let share = f64::from(share as f32);
    let metal = move |cos: f64| microfacets(alpha, Masking::Separable, cos.abs(), 1.0, |_| 1.0)[0];
    row.returns(move |cos| (1.0 - share) * 0.5 + share * metal(cos))
}

/// Reflectance of a metal by its two polarisations, f64, in complex numbers (Fresnel 1823).
pub fn fresnel_metal(cos: f64, eta: f64, k: f64) -> f64 {
    type C = (f64, f64);
    let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let size2 = |a: C| a.0 * a.0 + a.1 * a.1;
    let n = (eta, k);
    let n2 = mul(n, n);
    // n cos beyond the surface, the root of n² − sin².
    let under = (n2.0 - (1.0 - cos * cos), n2.1);
    let size = size2(under).sqrt();
    let beyond = (((size + under.0) / 2.0).max(0.0).sqrt(), ((size - under.0) / 2.0).max(0.0).sqrt());
    let s = size2((cos - beyond.0, -beyond.1)) / size2((cos + beyond.0, beyond.1));
    let (a, b) = ((n2.0 * cos, n2.1 * cos), beyond);
    let p = size2((a.0 - b.0, a.1 - b.1)) / size2((a.0 + b.0, a.1 + b.1));
    (s + p) / 2.0
}

/// Reflectance of a dielectric by its two polarisations (Fresnel 1823), f64. `cos` is the cosine where the light is, `eta`
/// the index beyond over the index there.
pub fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos * cos) / (eta * eta);
    if eta == 1.0 {
        return 0.0;
    }
    if sin2 >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sin2).sqrt();
    let (s, p) = ((cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t));
    (s * s + p * p) / 2.0
}

/// Smith's joint masking of two directions.
#[derive(Clone, Copy)]
pub enum Masking {
    /// The product of both, as glTF has it.
    Separable,
    /// Height-correlated (Heitz 2014), for tables of other renderers.
    Correlated,
}

/// Shares of light that single scattering by GGX microfacets reflects and transmits towards a cosine `mu` > 0, without the
/// scale of radiance; `reflectance` of the cosine at the microfacet. α = 0 is a smooth surface.
///
/// The integral over directions is taken over the normals h that connect them: dω cos D = da dφ / 2π where
/// tan² = α² a / (1 − a) (Walter, Marschner, Li, Torrance 2007, equation 35), and what remains is
/// F G (o·h) / (mu h.z).
pub fn microfacets(alpha: f64, masking: Masking, mu: f64, eta: f64, reflectance: impl Fn(f64) -> f64) -> [f64; 2] {
    if alpha == 0.0 {
        return [reflectance(mu), 1.0 - reflectance(mu)];
    }
    let lambda = |c: f64| ((1.0 + alpha * alpha * (1.0 - c * c).max(0.0) / (c * c)).sqrt() - 1.0) / 2.0;
    let seen = |c: f64| match masking {
        Masking::Separable => 1.0 / ((1.0 + lambda(mu)) * (1.0 + lambda(c))),
        Masking::Correlated => 1.0 / (1.0 + lambda(mu) + lambda(c)),
    };
    let sin = (1.0 - mu * mu).sqrt();
    let share = |transmits: bool| {
        // 1 − a = s⁴, since a narrow lobe has its tail where a is nearly 1.
        let density = |[s, phi]: [f64; 2]| {
            let tan2 = alpha * alpha * (s.powi(-4) - 1.0);
            let z = (1.0 + tan2).recip().sqrt();
            let cos = sin * (1.0 - z * z).max(0.0).sqrt() * phi.cos() + mu * z;
            let f = reflectance(cos.clamp(0.0, 1.0));
            let bent2 = 1.0 - (1.0 - cos * cos) / (eta * eta);
            let height =
                if transmits { mu / eta - (cos / eta - bent2.max(0.0).sqrt()) * z } else { 2.0 * cos * z - mu };
            let share = if transmits { 1.0 - f } else { f };
            if cos > 0.0 && height > 0.0 && share > 0.0 {
                share * seen(height.min(1.0)) * cos / (mu * z) * 4.0 * s.powi(3)
            } else {
                0.0
            }
        };
        rectangle([0.0; 2], [1.0, PI], 1e-5, density) / PI
    };
    [share(false), share(true)]
}

/// Share of light that Phong's corrected lobe, (ns + 2)/2π cosⁿˢ, returns towards a cosine, clipped by the horizon.
pub fn phong_lobe(ns: f64, mu: f64) -> f64 {
    let sin = (1.0 - mu * mu).sqrt();
    // Around the lobe's axis the height over the horizon is x + y cos φ; half the turn of what is above 0.
    let above = |a: f64| {
        let cos = a.powf(1.0 / (ns + 1.0));
        let (x, y) = (mu * cos, sin * (1.0 - cos * cos).max(0.0).sqrt());
        let turn = if x >= y { PI } else { (-x / y).acos() };
        x * turn + y * turn.sin()
    };
    // a = cos^(ns+1) makes the lobe flat; the horizon begins to cut at cos = sin.
    let cut = sin.powf(ns + 1.0);
    let sum = gauss::<96>(0.0, 1.0, |t| above(cut * t * t) * cut * 2.0 * t) + gauss::<96>(cut, 1.0, above);
    sum / PI * (ns + 2.0) / (ns + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MU: [f64; 7] = [1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.01];

    /// The table of GGX with height-correlated masking and F = 1, as other renderers have it.
    #[test]
    fn quadrature_of_microfacets_agrees_with_the_table() {
        let table = [
            (0.01, [1.0, 0.99999, 0.99997, 0.99978, 0.99940, 0.99417, 0.89205]),
            (0.05, [0.99738, 0.99701, 0.99572, 0.99261, 0.98151, 0.91128, 0.95975]),
            (0.1, [0.98833, 0.98674, 0.98143, 0.96919, 0.93627, 0.88347, 0.97657]),
            (0.25, [0.91581, 0.90738, 0.88534, 0.85726, 0.83791, 0.89162, 0.98198]),
            (0.5, [0.68785, 0.68396, 0.68295, 0.69825, 0.74527, 0.86010, 0.97441]),
            (0.75, [0.46392, 0.47669, 0.51149, 0.56462, 0.65028, 0.81071, 0.96425]),
            (1.0, [0.30685, 0.32751, 0.37889, 0.45069, 0.56010, 0.76021, 0.95385]),
        ];
        for (alpha, row) in table {
            for (mu, expected) in MU.iter().zip(row) {
                let [found, through] = microfacets(alpha, Masking::Correlated, *mu, 1.0, |_| 1.0);
                // The table's narrow lobes lack digits: at α = 0.01 one normal in 10,001 is beyond 45 degrees, and it has
                // 1.00000 at normal incidence.
                let error = if alpha < 0.2 { 2e-4 } else { 2e-5 };
                assert!((found - expected).abs() < error && through == 0.0, "{alpha} {mu}: {found}, not {expected}");
            }
        }
    }

    /// At normal incidence one dimension is left: ∫ G1(2z² − 1) over the normals within 45 degrees, whatever the masking.
    #[test]
    fn quadrature_of_microfacets_agrees_with_one_dimension() {
        for alpha in [0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0] {
            let most = 1.0 / (1.0 + alpha * alpha);
            let expected = gauss::<128>(0.0, 1.0, |t| {
                let a = most * (1.0 - t.powi(6));
                let c = 2.0 / (1.0 + alpha * alpha * a / (1.0 - a)) - 1.0;
                let seen = 2.0 * c / (c + (alpha * alpha + (1.0 - alpha * alpha) * c * c).sqrt());
                seen * most * 6.0 * t.powi(5)
            });
            for masking in [Masking::Separable, Masking::Correlated] {
                let [found, _] = microfacets(alpha, masking, 1.0, 1.0, |_| 1.0);
                assert!((found - expected).abs() < 5e-6, "{alpha}: {found}, not {expected}");
            }
            assert!(alpha < 1.0 || (expected - (1.0 - 2f64.ln())).abs() < 1e-9, "{expected}");
        }
    }

    #[test]
    fn quadrature_of_phong_agrees_with_the_table() {
        let table = [
            (1.0, [1.0, 0.90954, 0.75009, 0.60900, 0.48274, 0.36990, 0.32333]),
            (10.0, [1.0, 0.90001, 0.70031, 0.50474, 0.32527, 0.17916, 0.12811]),
            (100.0, [1.0, 0.9, 0.7, 0.5, 0.30003, 0.10821, 0.04499]),
            (1e3, [1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.01824]),
            (1e4, [1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.01083]),
        ];
        for (ns, row) in table {
            for (mu, expected) in MU.iter().zip(row) {
                let found = phong_lobe(ns, *mu);
                assert!((found - expected).abs() < 2e-5, "{ns} {mu}: {found}, not {expected}");
            }
        }
    }

    #[test]
    fn averages_of_fresnel_are_known() {
        let average = |eta: f64| {
            let critical = (1.0 - (eta * eta).min(1.0)).sqrt();
            // A square root begins at the critical angle: c = critical + (1 - critical) t².
            let above = gauss::<64>(0.0, 1.0, |t| {
                let c = critical + (1.0 - critical) * t * t;
                fresnel(c, eta) * 2.0 * c * (1.0 - critical) * 2.0 * t
            });
            above + critical * critical
        };
        // Walsh's closed form (1926), and what follows from it for the other side.
        assert!((average(1.5) - 0.091_777_959_3).abs() < 1e-9, "{}", average(1.5));
        assert!((average(1.0 / 1.5) - 0.596_345_759_7).abs() < 1e-9, "{}", average(1.0 / 1.5));
    }
}
