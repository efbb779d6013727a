//! The lights of a whole scene, to be asked from outside: the components of the renderer over its tables, with nothing known,
//! and those of the crate `examples/custom`.
//!
//! [`LightProbe::choose`] says which light a number draws, [`LightProbe::sample`] what light sampling gives at a point, and
//! [`LightProbe::see`] what a ray finds there: the radiance, and the density that the weights of multiple importance
//! sampling are told. [`lights`] is the table: a row there is drawn against its density (T5), and compared between
//! sampling and seeing (T6, T26).
//!
//! ```
//! use jerboa_tests::harness::lights::{LightProbe, lights};
//! let mut probe = LightProbe::default();
//! let row = &lights()[0];
//! probe.load(&row.scene);
//! let drawn = probe.sample(1, row.point, true);
//! let seen = probe.see(row.point, drawn.wi);
//! assert_eq!(drawn.radiance, seen.radiance);
//! assert!((drawn.pdf / seen.pdf - 1.0).abs() < 1e-5);
//! ```

use glam::{DVec3, Vec3};
use jerboa_example_custom::components;
use jerboa_ir::lang::{Bool, F32, Fun, Keep, Row, U32, entry};
use jerboa_lib_render::core::color::{Color, black};
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec;
use jerboa_lib_render::geometry::offset::spawn_shadow_ray;
use jerboa_lib_render::geometry::{SurfaceElement, make_geometry};
use jerboa_lib_render::host::device::Traversal;
use jerboa_lib_render::host::library::Library;
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_lib_render::light::environment::seen_environment;
use jerboa_lib_render::light::seen::{Met, sum_of_shapes, sum_of_suns};
use jerboa_lib_render::light::{choose_light, hit_pdf, sample_light, tree, with_light};
use jerboa_lib_render::ray::Ray;
use jerboa_lib_render::schema::{Geometries, Lights, NONE, Primitives, Settings};
use jerboa_lib_render::shader::make_shader;
use jerboa_lib_render::traverse::{AcceptFn, make_traverse};
use jerboa_scenes::{Clearcoat, Filter, LightKind, Material, Scene, Texture, TextureRef, TextureSource};

pub use chart::Chart;

use super::analytic::{light, maps, place, rectangle, sphere};
use super::bench::{Bench, stream};
use super::probe::{V, surface};

mod chart;

/// What light sampling gave.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    /// Towards the light, unit.
    pub wi: V,
    /// m; infinite for what is infinitely far.
    pub distance: f32,
    /// Green; of lights without extent what arrives on a facing plane.
    pub radiance: f32,
    /// Per steradian, the choice of the light included.
    pub pdf: f32,
    /// No extent?
    pub is_delta: bool,
    /// Does the shadow ray hit anything?
    pub is_blocked: bool,
}

/// What a ray found.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Green.
    pub radiance: f32,
    /// Density with which light sampling finds it, per steradian; 0 where it does not shine, since nobody asks there.
    pub pdf: f32,
    /// m; infinite for the environment and for suns.
    pub distance: f32,
    /// Cosine of the ray with the surface, not negative; 1 for what has none.
    pub cos: f32,
}

/// A ray that leaves a light.
#[derive(Clone, Copy, Debug)]
pub struct Emitted {
    /// Unit.
    pub dir: V,
    /// What it carries: intensity · cosine / density.
    pub flux: f64,
    /// Does it hit anything?
    pub is_blocked: bool,
}

/// The lights of a scene.
pub struct LightProbe {
    /// Are lamps sampled by solid angle in what is loaded next?
    pub solid_angle: bool,
    library: Library,
    bench: Bench,
    /// What the tables subtract from positions.
    origin: DVec3,
}

/// A ray without end that hits everything.
fn ray(org: vec::Vec3, dir: vec::Vec3) -> Ray {
    let none = || NONE.into();
    Ray { org, dir, tmax: F32::from(f32::INFINITY), skip: none(), skip1: none(), skip2: none() }
}

impl Default for LightProbe {
    /// Of no scene yet.
    fn default() -> LightProbe {
        let author = || {
            let traverse = make_traverse();
            let accept = || AcceptFn::lam(|_, _| Bool::from(true));
            entry(
                "choose",
                Fun::lam(|b, u: F32| {
                    let index = choose_light(b, u);
                    (index, Row::<Lights>::at(index).get(Lights::PROBABILITY))
                }),
            );
            entry("choose by tree", Fun::lam(|b, (rng, point): (Rng, vec::Vec3)| tree::choose(b, rng, point)));
            entry("probability", Fun::lam(|b, (light, point): (U32, vec::Vec3)| tree::probability(b, light, point)));
            entry(
                "sample",
                Fun::lam(move |b, (rng, point): (Rng, vec::Vec3)| {
                    let light = sample_light(b, rng, point);
                    let up = vec::vec3(0.0, 1.0, 0.0);
                    let shadow = spawn_shadow_ray(
                        SurfaceElement { point, start: point, primitive: NONE.into(), ..surface(up, up) },
                        light,
                    );
                    (light, traverse.call(b, (shadow, Keep(true.into()), accept())).is_hit())
                }),
            );
            entry(
                "see",
                Fun::lam(move |b, (org, dir): (vec::Vec3, vec::Vec3)| {
                    let ray = ray(org, dir);
                    let hit = traverse.call(b, (ray, Keep(false.into()), accept()));
                    b.if_(
                        hit.is_hit(),
                        |b| {
                            let geometry = Row::<Primitives>::at(hit.primitive).get(Primitives::GEOMETRY);
                            b.dispatch(Row::<Geometries>::at(geometry), |b, row| {
                                let geometry = make_geometry(row, make_shader(row.get(Geometries::MATERIAL)));
                                let surf = geometry.surface_element.call(b, (ray, hit));
                                let emission = geometry.shader.call(b, (ray, hit, surf)).emission.call(b, -dir);
                                let cos = surf.face_cos(dir).abs();
                                let pdf = hit_pdf(b, surf.light, org, hit.t, cos);
                                (emission.intensity, emission.intensity.is_black().select(0.0.into(), pdf), hit.t, cos)
                            })
                        },
                        |b| {
                            let has_sky = Row::<Settings>::at(0u32).get(Settings::HAS_ENVIRONMENT);
                            let sky = |_: &mut _| seen_environment(dir);
                            let (radiance, pdf) = b.if_(has_sky, sky, |_| (black(), F32::from(0.0)));
                            (radiance, pdf, hit.t, F32::from(1.0))
                        },
                    )
                }),
            );
            // Green, density and distance, in place of a colour; a distance of 0 is that of a sun.
            entry(
                "see without a surface",
                Fun::lam(move |b, (org, dir): (vec::Vec3, vec::Vec3)| {
                    let hit = traverse.call(b, (ray(org, dir), Keep(false.into()), accept()));
                    let until = hit.is_hit().select(hit.t, F32::from(f32::INFINITY));
                    let shapes = sum_of_shapes(b, org, dir, until, |_, met| Color {
                        r: met.radiance.g,
                        g: met.pdf_dir,
                        b: met.distance,
                    });
                    let sun = |_: &mut _, met: Met| Color { r: met.radiance.g, g: met.pdf_dir, b: 0.0.into() };
                    let suns = |b: &mut _| sum_of_suns(b, dir, sun);
                    shapes + b.if_(hit.is_hit(), |_| black(), suns)
                }),
            );
            entry(
                "emit",
                Fun::lam(move |b, (rng, index): (Rng, U32)| {
                    with_light(b, index, move |b, light| {
                        let e = light.sample_emission.call(b, rng);
                        let share = e.pdf_dir.gt(0.0).select(e.cos / (e.pdf_area * e.pdf_dir), 0.0.into());
                        let carried: Color = e.intensity * share;
                        let met = traverse.call(b, (e.ray(), Keep(true.into()), accept())).is_hit();
                        (e.dir, carried.g, met)
                    })
                }),
            );
        };
        let library = Library::new(components());
        let bench = library.components().within(|| Bench::new(author));
        LightProbe { solid_angle: false, library, bench, origin: DVec3::ZERO }
    }
}

/// Words of floats.
fn floats<const N: usize>(words: &[u32]) -> [f32; N] {
    std::array::from_fn(|i| f32::from_bits(words[i]))
}

impl LightProbe {
    /// Take this scene; gives its tables.
    pub fn load(&mut self, scene: &Scene) -> Tables {
        let choices = Choices { solid_angle: self.solid_angle, ..Choices::default() };
        let tables = Tables::of(&self.library, scene, &choices, Known::Nothing, Traversal::Ir);
        self.bench.load(&tables);
        self.origin = tables.origin;
        tables
    }

    /// A point of the world where the tables have it.
    fn place(&self, point: V) -> V {
        (DVec3::from(point.map(f64::from)) - self.origin).as_vec3().to_array()
    }

    /// The light, a row of `Lights`, that a uniform number draws, and the probability that its row states.
    pub fn choose(&mut self, u: f32) -> (usize, f32) {
        let out = self.bench.run("choose", &[u.to_bits()]);
        (out[0] as usize, f32::from_bits(out[1]))
    }

    /// The light that the tree draws for a point by the numbers of a key, and its probability.
    pub fn choose_by_tree(&mut self, key: u32, point: V) -> (usize, f32) {
        let args = [&stream(key)[..], &self.place(point).map(f32::to_bits)].concat();
        let out = self.bench.run("choose by tree", &args);
        (out[0] as usize, f32::from_bits(out[1]))
    }

    /// Probability with which the tree draws a light for a point; of the first lights by the interpreter too.
    pub fn probability(&mut self, light: usize, point: V) -> f32 {
        let args = [&[light as u32], &self.place(point).map(f32::to_bits)[..]].concat();
        let both = light < 10;
        let out = if both { self.bench.run_both("probability", &args) } else { self.bench.run("probability", &args) };
        f32::from_bits(out[0])
    }

    /// Light sampling at a point in the air by the numbers of a key; `both`: by the interpreter too, to the same bits.
    pub fn sample(&mut self, key: u32, point: V, both: bool) -> Drawn {
        let args = [&stream(key)[..], &self.place(point).map(f32::to_bits)].concat();
        let out = if both { self.bench.run_both("sample", &args) } else { self.bench.run("sample", &args) };
        let [x, y, z, _, _, _, distance, _, radiance, _, pdf] = floats(&out);
        Drawn { wi: [x, y, z], distance, radiance, pdf, is_delta: out[11] != 0, is_blocked: out[14] != 0 }
    }

    /// What a ray from a point finds in a unit direction: the light without a surface that it meets (two are added up), or else
    /// what it hits.
    pub fn see(&mut self, point: V, dir: V) -> Seen {
        let args: Vec<u32> = [self.place(point), dir].concat().into_iter().map(f32::to_bits).collect();
        let [radiance, pdf, distance] = floats(&self.bench.run("see without a surface", &args));
        if radiance > 0.0 {
            let distance = if distance == 0.0 { f32::INFINITY } else { distance };
            return Seen { radiance, pdf, distance, cos: 1.0 };
        }
        let [_, radiance, _, pdf, distance, cos] = floats(&self.bench.run("see", &args));
        Seen { radiance, pdf, distance, cos }
    }

    /// A ray that leaves light `index`, by the numbers of a key.
    pub fn emit(&mut self, key: u32, index: u32, both: bool) -> Emitted {
        let args = [&stream(key)[..], &[index]].concat();
        let out = if both { self.bench.run_both("emit", &args) } else { self.bench.run("emit", &args) };
        let [x, y, z, flux] = floats(&out);
        Emitted { dir: [x, y, z], flux: f64::from(flux), is_blocked: out[4] != 0 }
    }
}

/// On a bench without a scene, light `row` becomes a triangle or a parallelogram (`kind`).
pub fn set_area(bench: &mut Bench, row: usize, kind: u32, corner: V, e1: V, e2: V, area: f32) {
    bench.set(Lights::KIND, row, kind);
    bench.set(Lights::AREA, row, area);
    use Lights as L;
    let columns = [L::P_X, L::P_Y, L::P_Z, L::E1_X, L::E1_Y, L::E1_Z, L::E2_X, L::E2_Y, L::E2_Z];
    for (column, value) in columns.into_iter().zip([corner, e1, e2].concat()) {
        bench.set(column, row, value);
    }
}

/// A scene of lights and a point in the air from which to look.
pub struct Lit {
    /// For messages.
    pub name: String,
    /// Lights alone.
    pub scene: Scene,
    /// From where.
    pub point: V,
    /// Coordinates in which the density is smooth in each cell of a grid; nothing for many lights.
    pub chart: Option<Chart>,
}

/// A scene of emitters, each a parallelogram: corner and edges, radiance, and whether it shines on both sides.
fn lamps(lamps: &[([V; 3], f32, bool)]) -> Scene {
    let mut scene = Scene::default();
    for ([corner, u, v], radiance, double_sided) in lamps {
        let mesh = rectangle(Vec3::from(*corner), Vec3::from(*u), Vec3::from(*v));
        let material = Material { double_sided: *double_sided, ..Material::emitter("lamp", [*radiance; 3]) };
        place(&mut scene, mesh, material, 1.0, DVec3::ZERO);
    }
    scene
}

/// Lights with extent: each kind, near and far, from the side and from behind, textured, several at once, and every map.
pub fn lights() -> Vec<Lit> {
    let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    let lamp = |name: &str, quad: [V; 3], both: bool, point: V| {
        let chart = Some(Chart::Parallelogram(quad));
        Lit { name: name.into(), scene: lamps(&[(quad, 2.0, both)]), point, chart }
    };
    let above = |height: f32| [[-0.5, height, -0.5], x, z];
    let mut all = vec![
        lamp("square lamp", above(1.0), false, [0.1, 0.0, 0.2]),
        lamp("square lamp, close", above(0.05), false, [0.1, 0.0, 0.2]),
        lamp("square lamp, far", above(50.0), false, [0.1, 0.0, 0.2]),
        lamp("square lamp, from the side", above(0.1), false, [2.0, 0.0, 0.3]),
        lamp("leaning lamp", [[0.3, 0.2, 0.1], [0.7, 0.1, -0.2], [0.2, 0.8, 0.5]], true, [0.9, 0.7, 0.2]),
        lamp("narrow lamp", [[-0.5, 1.0, 0.0], x, [0.0, 0.0, 1e-4]], false, [0.0; 3]),
        lamp("two-sided lamp, from behind", above(0.5), true, [0.1, 1.0, 0.2]),
        lamp("one-sided lamp, from behind", above(0.5), false, [0.1, 1.0, 0.2]),
        lamp("lamp, from its plane", above(0.5), false, [1.1, 0.5, 0.2]),
    ];
    // Triangles begin opposite their longest side: the diagonal, or one edge or the other of a quad cut along the shorter one.
    let edges = [("diagonal", x, z), ("first edge", x, [-0.6, 0.0, 0.7]), ("second edge", [0.7, 0.0, -0.6], z)];
    for (longest, u, v) in edges {
        let quad = lamp(&format!("quad, its {longest} longest"), [[-0.2, 0.5, -0.3], u, v], true, [0.1, 0.0, 0.2]);
        all.push(textured(&quad));
    }
    let mut coated = lamp("coated lamp", above(0.3), false, [0.9, 0.0, 0.2]);
    coated.scene.materials[0].clearcoat = Some(Clearcoat::new(0.8, 0.0));
    all.push(textured(&coated));
    all.push(coated);
    let mut triangle = lamp("triangle", above(0.5), false, [0.1, 0.0, 0.2]);
    triangle.scene.meshes[0].triangles.truncate(1);
    triangle.chart = Some(Chart::Triangle(above(0.5)));
    all.push(textured(&triangle));
    all.push(triangle);
    let mut ball = Scene::default();
    place(&mut ball, sphere(0), Material::emitter("ball", [1.0; 3]), 0.5, DVec3::Y);
    all.push(Lit { name: "ball of 20 triangles".into(), scene: ball, point: [0.2, 0.0, 0.3], chart: None });
    all.extend(round_lights());
    all.push(medley());
    for (name, map) in maps() {
        let chart = Some(Chart::Map(map.clone()));
        let scene = Scene { environment: Some(map), ..Scene::default() };
        all.push(Lit { name: format!("sky: {name}"), scene, point: [0.0; 3], chart });
    }
    all
}

/// Balls, disks and suns.
fn round_lights() -> Vec<Lit> {
    let alone = |what: &str, kind: LightKind, height: f64, point: V, chart: Chart| Lit {
        name: what.into(),
        scene: Scene { lights: vec![light(kind, 1.0, height)], ..Scene::default() },
        point,
        chart: Some(chart),
    };
    let ball = |what: &str, radius: f32, point: V| {
        let to = DVec3::Y - DVec3::from(point.map(f64::from));
        let s = (f64::from(radius) / to.length()).min(1.0);
        let chart = Chart::Cone(to.normalize_or(DVec3::Y), s * s / (1.0 + (1.0 - s * s).sqrt()));
        alone(&format!("ball of light, {what}"), LightKind::Sphere { radius }, 1.0, point, chart)
    };
    let (inner, outer) = (0.6, 1.57);
    let disk = |what: &str, height: f32, point: V| {
        let chart = Chart::Disk(DVec3::Y * f64::from(height), DVec3::Y, 0.5);
        let kind = LightKind::Disk { inner, outer, radius: 0.5 };
        alone(&format!("disk of light, {what}"), kind, height.into(), point, chart)
    };
    let sun = |angle: f32| {
        let opening = 2.0 * (f64::from(angle) / 4.0).sin().powi(2);
        let chart = Chart::Cone(DVec3::Y, opening);
        alone(&format!("sun of {angle} radians"), LightKind::Sun { angle }, 0.0, [0.3, 0.0, 0.2], chart)
    };
    vec![
        ball("beside", 0.5, [0.2, 0.0, 0.3]),
        ball("close", 0.5, [0.0, 0.499, 0.0]),
        ball("far", 0.1, [30.0, 0.0, 20.0]),
        ball("from within", 0.5, [0.1, 0.9, 0.0]),
        ball("from its middle", 0.5, [0.0, 1.0, 0.0]),
        disk("below", 1.0, [0.1, 0.0, 0.2]),
        disk("close", 0.05, [0.1, 0.0, 0.2]),
        disk("from the side", 0.5, [3.0, 0.0, 0.2]),
        disk("from behind", 0.5, [0.1, 1.0, 0.2]),
        disk("from its plane", 0.5, [1.1, 0.5, 0.2]),
        sun(0.1),
        sun(3.0),
    ]
}

/// The same with a checkerboard on it, five by five.
fn textured(plain: &Lit) -> Lit {
    let mut scene = plain.scene.clone();
    let board = TextureSource::Checkerboard { even: [1.0; 3], odd: [0.25; 3] };
    scene.textures.push(Texture::repeating("board", board, Filter::Nearest));
    scene.materials[0].emissive_texture = Some(TextureRef { texture: 0, uv_set: 0, transform: None });
    scene.meshes[0].uvs[0] = Some([[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [0.0, 5.0]].map(glam::Vec2::from).to_vec());
    Lit { name: format!("textured {}", plain.name), scene, chart: plain.chart.clone(), ..*plain }
}

/// Everything at once.
fn medley() -> Lit {
    let z = [0.0, 0.0, 1.0];
    let mut scene = lamps(&[
        ([[-2.0, 1.0, -0.5], [1.0, 0.0, 0.0], z], 1.0, false),
        ([[1.0, 1.0, -0.5], [0.5, 0.0, 0.0], z], 3.0, false),
        // Behind the first.
        ([[-4.0, 2.0, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]], 0.5, true),
    ]);
    scene.environment = maps().into_iter().find(|m| m.0 == "one texel in the dark").map(|m| m.1);
    scene.lights = vec![light(LightKind::Point, 1.0, 3.0), light(LightKind::Directional, 1.0, 0.0)];
    let name = "lamps, one behind another, and a sky, a point and a sun".into();
    Lit { name, scene, point: [0.2, 0.0, 0.3], chart: None }
}
