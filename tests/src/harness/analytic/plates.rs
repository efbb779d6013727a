//! Level squares in a uniform sky, seen at a slant: a square sees the sky and nothing else, so its radiance is the share of light
//! that its BSDF returns in that direction, which a row of the table of BSDFs knows from quadrature in f64.

use glam::{DVec3, Vec2, Vec3};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Anisotropy, Camera, Clearcoat, Iridescence, Material, Model, Scene, Sheen};

use super::enclosures::uniform_sky;
use super::{Closed, Look, place, rectangle, wavefront};
use crate::harness::scattering::{Row, rows};

/// Cosines at which a square is looked at.
const SLANTS: [f64; 3] = [0.95, 0.6, 0.2];
/// The colour of the table's rows.
const COLOUR: [f32; 3] = [0.8, 0.5, 0.2];

/// A row of the table of BSDFs, and a material of a scene that is to be the same.
fn materials() -> Vec<(&'static str, Material)> {
    // Roughness, whose square is the width of the row's name.
    let narrow = 0.05_f32.sqrt();
    let metal = |roughness: f32| Material::metal("metal", [1.0; 3], roughness);
    let paint = Material::diffuse("paint", COLOUR);
    let named = |model: Model, roughness: f32| Material { model: Some(model), roughness, ..paint.clone() };
    let phong = |ns: f32| named(Model::named("phong").with("ks", &[1.0; 3]).with("ns", &[ns]), 1.0);
    let coated = |factor: f32, roughness: f32, under: Material| {
        let clearcoat = Some(Clearcoat::new(factor, roughness));
        Material { clearcoat, ..under }
    };
    let filmed = |nanometres: f32, under: Material| {
        let iridescence = Some(Iridescence::new(1.0, nanometres));
        Material { iridescence, ..under }
    };
    let sheen = Some(Sheen::new([1.0; 3], 0.5));
    let gold = Model::named("conductor").with("eta", &[0.155, 0.424, 1.382]).with("k", &[3.6, 2.472, 1.915]);
    vec![
        ("metal 0.250", metal(0.5)),
        ("stretched 0.200 0.050", Material { anisotropy: Some(Anisotropy::new(0.397)), ..metal(narrow) }),
        ("plastic 0.250", Material::plastic("plastic", [1.0; 3], 0.5)),
        ("film on metal 0.250 400", filmed(400.0, Material::metal("metal", COLOUR, 0.5))),
        ("film on plastic of 1.5 0.250 250", filmed(250.0, Material::plastic("plastic", [1.0; 3], 0.5))),
        ("sheen 0.5", Material { sheen, ..Material::diffuse("black", [0.0; 3]) }),
        ("coat 1 0.050", coated(1.0, narrow, paint.clone())),
        ("coat 0.5 1.000", coated(0.5, 1.0, paint.clone())),
        ("coated mirror 0.050", coated(1.0, narrow, metal(0.0))),
        ("phong 10", phong(10.0)),
        ("phong 1000", phong(1000.0)),
        ("rough diffuse 0.3", named(Model::named("rough-diffuse"), 0.3)),
        ("conductor 0.050", named(gold, narrow)),
        ("varnished 0.050", named(Model::named("plastic"), narrow)),
    ]
}

/// A square of each lobe and model that loses light, and of what a Wavefront file says.
pub fn plates() -> Vec<Closed> {
    let table = rows();
    let row = |name: &str| table.iter().find(|row| row.name == name).unwrap_or_else(|| panic!("no row \"{name}\""));
    let plate = |(name, material): (&str, Material)| {
        let mut scene = Scene::default();
        let mut square = rectangle(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
        // u grows along x, the direction in which the row's lobes are stretched.
        square.uvs[0] = Some(square.positions.iter().map(|p| Vec2::new(p.x, p.z)).collect());
        place(&mut scene, square, material, 1.0, DVec3::ZERO);
        closed(name, scene, looks(row(name), 0.0))
    };
    let from_file = |(name, x): (&str, f64)| {
        closed(&format!("{name}, from a Wavefront file"), wavefront("plates"), looks(row(name), x))
    };
    let files = [("lambert", 0.0), ("phong 10", 3.0), ("gold", 6.0), ("metal 0.250", 9.0)];
    materials().into_iter().map(plate).chain(files.map(from_file)).collect()
}

/// Towards the point at `x`, from directions at 0.7 about the normal, as the table has it.
fn looks(row: &Row, x: f64) -> Vec<(Look, f64)> {
    let returned = row.returned.as_ref().unwrap_or_else(|| panic!("row \"{}\" does not say what it returns", row.name));
    let look = |cos: f64| {
        let (sin, at) = ((1.0 - cos * cos).sqrt(), DVec3::X * x);
        let eye = at + DVec3::new(sin * 0.7_f64.cos(), cos, sin * 0.7_f64.sin()) * 4.0;
        (Look::pixel(Camera::look_at("slant", eye, at, 0.01), 101, 50, 50), returned(cos))
    };
    SLANTS.map(look).into()
}

fn closed(name: &str, scene: Scene, looks: Vec<(Look, f64)>) -> Closed {
    Closed {
        name: format!("plate: {name}"),
        scene: Scene { environment: Some(uniform_sky()), ..scene },
        looks,
        facets: 0.0,
        choices: Choices::default(),
        is_near: false,
        effort: 1,
    }
}
