//! BSDFs on a slope: a normal map tilts them, or the coat over them, or what the coat covers.
//!
//! ```
//! use jerboa_tests::harness::probe::Probe;
//! use jerboa_tests::harness::slopes::{rows, slope};
//!
//! let mut probe = Probe::default();
//! (rows()[0].make)(&mut probe);
//! let (found, expected) = (probe.shading_normal(), slope());
//! assert!((0..3).all(|i| (f64::from(found[i]) - expected[i]).abs() < 1e-6));
//! ```

use std::f64::consts::PI;

use super::probe::at_cos;
use super::quadrature::rectangle;
use super::scattering::{
    INDEX, Masking, Row, coat, film_on_metal, film_on_plastic, fresnel, microfacets, sheen_on_nothing, widths,
};

/// The texel of the maps.
const TEXEL: [u8; 3] = [190, 90, 220];

/// The normal that it gives to a surface in the plane z = 0: 38 degrees off.
pub fn slope() -> [f64; 3] {
    let n = TEXEL.map(|code| f64::from(code) / 127.5 - 1.0);
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    n.map(|x| x / length)
}

/// The direction of a cosine to z that the table's rows are asked for, and its cosine to the slope.
fn seen(cos: f64) -> ([f64; 3], f64) {
    let (wo, n) = (at_cos(cos).map(f64::from), slope());
    (wo, (0..3).map(|i| wo[i] * n[i]).sum())
}

/// Layers on a slope, over a slope, and on a slope over what is level.
pub fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> = [
        sheen_on_nothing(0.5),
        film_on_metal(0.25, 400.0),
        film_on_plastic(INDEX, 0.0, 400.0),
        Row::new("film on medley", |p| p.medley(0.5).film(1.0, 600.0)).through(INDEX),
    ]
    .map(on_a_slope)
    .into();
    // Both maps alike: one normal again.
    let whole = coat(1.0, 0.25);
    let make = move |p: &mut super::probe::Probe| {
        (whole.make)(p);
        p.coat_normal_map(TEXEL);
    };
    rows.push(on_a_slope(Row { make: Box::new(make), ..coat(1.0, 0.25) }));
    rows.extend([(1.0, 0.0), (0.5, 0.25)].map(|(strength, alpha)| coat_over_a_slope(strength, alpha)));
    rows.extend([(1.0, 0.0), (0.5, 0.25)].map(|(strength, alpha)| coat_on_a_slope(strength, alpha)));
    rows.push(coat_over_a_tilted_mirror(0.05));
    let leaf =
        Row::new("coat over a tilted leaf", |p| p.lambert().diffuse_transmission(0.6).coat(1.0, 0.5).normal_map(TEXEL));
    let medley = Row::new("coat over a tilted medley", |p| p.medley(0.5).coat(0.8, 0.5).normal_map(TEXEL));
    let tilted =
        Row::new("tilted coat on sheen on medley", |p| p.medley(0.5).sheen(0.7).coat(0.8, 0.3).coat_normal_map(TEXEL));
    let rest = [leaf.through(1.0), medley.through(INDEX), tilted.through(INDEX)];
    rows.extend(rest.map(|row| Row { has_one_normal: false, ..row }));
    rows
}

/// All of it tilted: what it returns is known by the cosine to the slope.
fn on_a_slope(row: Row) -> Row {
    let Row { name, make, returned, passes, index, has_one_normal } = row;
    let tilted = move |p: &mut super::probe::Probe| {
        make(p);
        p.normal_map(TEXEL);
    };
    let returned = returned.map(|share| -> Box<dyn Fn(f64) -> f64> { Box::new(move |cos| share(seen(cos).1)) });
    Row { name: format!("{name} on a slope"), make: Box::new(tilted), returned, passes, index, has_one_normal }
}

/// Share of the light of Lambert's surface that gets out of a coat whose normal is the slope's off its own.
fn passing_out(strength: f64) -> f64 {
    let (cos, sin) = (slope()[2], (1.0 - slope()[2].powi(2)).sqrt());
    // c = cos² to its own normal, half of the turn.
    let density = |[c, phi]: [f64; 2]| {
        let to_coat = c.sqrt() * cos + (1.0 - c).sqrt() * sin * phi.cos();
        1.0 - strength * fresnel(to_coat.abs(), INDEX)
    };
    rectangle([0.0; 2], [1.0, PI], 1e-5, density) / PI
}

/// What a coat of this normal's cosine returns over Lambert's surface with the other normal.
fn coated(strength: f64, alpha: f64) -> impl Fn(f64) -> f64 {
    let passing_out = passing_out(strength);
    move |cos: f64| {
        let own = microfacets(alpha, Masking::Separable, cos.abs(), INDEX, |c| fresnel(c, INDEX))[0];
        strength * own + (1.0 - strength * fresnel(cos.abs(), INDEX)) * passing_out * 0.5
    }
}

/// A level coat over a surface that the material's own map tilts.
fn coat_over_a_slope(strength: f64, alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let name = format!("coat {strength} {alpha:.3} over a slope");
    let row = Row::new(name, move |p| p.lambert().coat(strength as f32, roughness).normal_map(TEXEL));
    Row { has_one_normal: false, ..row.returns(coated(strength, alpha)) }
}

/// A coat that its own map tilts over a level surface.
fn coat_on_a_slope(strength: f64, alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let name = format!("coat {strength} {alpha:.3} on a slope");
    let row = Row::new(name, move |p| p.lambert().coat(strength as f32, roughness).coat_normal_map(TEXEL));
    let returned = coated(strength, alpha);
    Row { has_one_normal: false, ..row.returns(move |cos| returned(seen(cos).1)) }
}

/// A level coat over a mirror that is tilted: each sends the light somewhere else.
fn coat_over_a_tilted_mirror(alpha: f64) -> Row {
    let (roughness, alpha) = widths(alpha);
    let name = format!("coat {alpha:.3} over a tilted mirror");
    let row = Row::new(name, move |p| p.metal(0.0).coat(1.0, roughness).normal_map(TEXEL));
    let returned = move |cos: f64| {
        let own = microfacets(alpha, Masking::Separable, cos.abs(), INDEX, |c| fresnel(c, INDEX))[0];
        let (wo, to_slope) = seen(cos);
        let mirrored = 2.0 * to_slope * slope()[2] - wo[2];
        own + (1.0 - fresnel(cos.abs(), INDEX)) * (1.0 - fresnel(mirrored.abs(), INDEX))
    };
    Row { has_one_normal: false, ..row.returns(returned) }
}
