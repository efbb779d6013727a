//! A material on one surface, to be asked from outside: through the shader, with nothing known. Models are the library's and
//! those of the crate `examples/custom`.

use jerboa_example_custom::components;
use jerboa_ir::lang::{F32, Fun, Row, U32, entry};
use jerboa_lib_render::bsdf::BsdfSample;
use jerboa_lib_render::core::color::{Color, white};
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::{Vec2, Vec3};
use jerboa_lib_render::geometry::{Frame3, SurfaceElement};
use jerboa_lib_render::host::device::Traversal;
use jerboa_lib_render::host::library::Library;
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_lib_render::lobes::Lobe;
use jerboa_lib_render::material::Material;
use jerboa_lib_render::ray::{Hit, Ray};
use jerboa_lib_render::schema::*;
use jerboa_lib_render::shader::make_shader;
use jerboa_scenes::Scene;

use super::bench::{Bench, Random};

/// A vector of the host.
pub type V = [f32; 3];

/// Scalar product, in f64.
pub fn dot(a: V, b: V) -> f64 {
    (0..3).map(|i| f64::from(a[i]) * f64::from(b[i])).sum()
}

/// Of unit length, rounded once.
pub fn normalize(a: [f64; 3]) -> V {
    let l = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| (x / l) as f32)
}

/// Direction with this cosine to z, φ = 0.7.
pub fn at_cos(c: f64) -> V {
    let s = (1.0 - c * c).sqrt();
    [(s * 0.7f64.cos()) as f32, (s * 0.7f64.sin()) as f32, c as f32]
}

/// A direction of the whole sphere.
pub fn random_direction(random: &mut Random) -> V {
    let (z, phi) = (2.0 * random.uniform() - 1.0, std::f64::consts::TAU * random.uniform());
    let s = (1.0 - z * z).sqrt();
    [s * phi.cos(), s * phi.sin(), z].map(|x| x as f32)
}

/// What `sample` gave, and what `eval` and `pdf` say about its direction.
#[derive(Clone, Copy, Debug)]
pub struct Sampled {
    /// Direction, away from the surface, unit.
    pub wi: V,
    /// f · cos / pdf, with the scale of radiance.
    pub weight: V,
    /// Density that the sample states, per steradian.
    pub pdf: f32,
    /// Was a delta component drawn?
    pub is_specular: bool,
    /// (1/eta)² where it was refracted.
    pub scale: f32,
    /// What `eval` says, per steradian.
    pub f_there: V,
    /// What `pdf` says, per steradian.
    pub pdf_there: f32,
}

/// A surface at the origin whose material can be set and asked.
pub struct Probe {
    bench: Bench,
    /// Whose models these are.
    library: Library,
    /// Their names, by number.
    models: Vec<&'static str>,
    /// Geometric normal.
    pub face: V,
    /// Shading normal.
    pub normal: V,
}

/// A surface at the origin with these normals, not a light.
pub fn surface(face_normal: Vec3, normal: Vec3) -> SurfaceElement {
    let zero = || F32::from(0.0);
    let nowhere = Vec3 { x: zero(), y: zero(), z: zero() };
    SurfaceElement {
        point: nowhere,
        error: nowhere,
        face_normal,
        local: Frame3::around(normal),
        uv: [Vec2 { x: zero(), y: zero() }; 2],
        color: white(),
        primitive: 0.into(),
        light: NONE.into(),
        start: nowhere,
    }
}

/// Material 0 on it.
pub fn material(b: &mut jerboa_ir::lang::Block, face_normal: Vec3, normal: Vec3) -> Material {
    let surf = surface(face_normal, normal);
    let (nowhere, end) = (surf.point, F32::from(0.0));
    let ray = Ray { org: nowhere, dir: nowhere, tmax: end, skip: NONE.into(), skip1: NONE.into(), skip2: NONE.into() };
    make_shader(Row::<Materials>::at(0u32)).call(b, (ray, Hit::miss(end), surf))
}

impl Default for Probe {
    /// A surface in the plane z = 0.
    fn default() -> Probe {
        let components = components();
        let models = components.models().iter().map(|model| model.name).collect();
        let author = || {
            entry(
                "eval",
                Fun::lam(|b, (g, n, wi, wo): (Vec3, Vec3, Vec3, Vec3)| {
                    let bsdf = material(b, g, n).bsdf;
                    let f: Color = bsdf.eval.call(b, (wi, wo));
                    (f, bsdf.pdf.call(b, (wi, wo)), bsdf.is_specular.select(F32::from(1.0), 0.0.into()))
                }),
            );
            entry(
                "sample",
                Fun::lam(|b, (g, n, wo, key): (Vec3, Vec3, Vec3, U32)| {
                    let bsdf = material(b, g, n).bsdf;
                    let s: BsdfSample = bsdf.sample.call(b, (Rng::new(0.into(), 0.into(), key), wo));
                    let f: Color = bsdf.eval.call(b, (s.wi, wo));
                    (s, f, bsdf.pdf.call(b, (s.wi, wo)))
                }),
            );
            entry("normal", Fun::lam(|b, (g, n): (Vec3, Vec3)| material(b, g, n).normal));
        };
        let bench = components.within(|| Bench::new(author));
        let library = Library::new(components);
        Probe { bench, library, models, face: [0.0, 0.0, 1.0], normal: [0.0, 0.0, 1.0] }
    }
}

impl Probe {
    /// White, index 1.5, no lobe on; the normals as they were made.
    fn reset(&mut self) -> &mut Probe {
        self.bench.rows::<Materials>(1);
        self.bench.rows::<Models>(self.models.len() + Lobe::ALL.len());
        for column in [Materials::BASE_R, Materials::BASE_G, Materials::BASE_B] {
            self.number(column, 1.0);
        }
        for column in [Materials::SPECULAR_R, Materials::SPECULAR_G, Materials::SPECULAR_B] {
            self.number(column, 1.0);
        }
        (self.face, self.normal) = ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        self.number(Materials::IOR, 1.5)
    }

    /// The first material of a scene, as the host lays it out, at texture coordinates of 0; free normals.
    pub fn load(&mut self, scene: &Scene) -> &mut Probe {
        let choices = Choices { consistent_normals: false, ..Choices::default() };
        self.bench.load(&Tables::of(&self.library, scene, &choices, Known::Nothing, Traversal::Ir));
        (self.face, self.normal) = ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        self
    }

    /// Does the geometric normal tell the sides apart?
    pub fn consistent(&mut self, yes: bool) -> &mut Probe {
        self.bench.set(Settings::CONSISTENT_NORMALS, 0, yes);
        self
    }

    /// The number in a column of the material.
    pub fn number(&mut self, column: jerboa_ir::lang::Col<Materials, F32>, x: f32) -> &mut Probe {
        self.bench.set(column, 0, x);
        self
    }

    /// The flag in a column of the material.
    pub fn flag(&mut self, column: jerboa_ir::lang::Col<Materials, jerboa_ir::lang::Bool>, x: bool) -> &mut Probe {
        self.bench.set(column, 0, x);
        self
    }

    /// Albedo 0.8, 0.5, 0.2.
    pub fn coloured(&mut self) -> &mut Probe {
        self.number(Materials::BASE_R, 0.8).number(Materials::BASE_G, 0.5).number(Materials::BASE_B, 0.2)
    }

    /// Roughness, and whether its square counts as smooth.
    pub fn roughness(&mut self, roughness: f32) -> &mut Probe {
        let smooth = if roughness * roughness < SMOOTH_ALPHA { SMOOTH_ALWAYS } else { SMOOTH_NEVER };
        self.bench.set(Materials::SMOOTH, 0, smooth);
        self.number(Materials::ROUGHNESS, roughness)
    }

    /// Lambert's surface, coloured.
    pub fn lambert(&mut self) -> &mut Probe {
        self.reset().flag(Materials::HAS_DIFFUSE, true).roughness(1.0).coloured()
    }

    /// White metal.
    pub fn metal(&mut self, roughness: f32) -> &mut Probe {
        self.reset().flag(Materials::HAS_METAL, true).number(Materials::METALLIC, 1.0).roughness(roughness)
    }

    /// White diffuse under a layer.
    pub fn plastic(&mut self, roughness: f32) -> &mut Probe {
        self.reset().flag(Materials::HAS_DIFFUSE, true).flag(Materials::HAS_SPECULAR, true);
        self.number(Materials::SPECULAR, 1.0).roughness(roughness)
    }

    /// White glass of a solid, or of a thin wall.
    pub fn glass(&mut self, roughness: f32, thin: bool) -> &mut Probe {
        self.reset().flag(Materials::HAS_SPECULAR, true).flag(Materials::HAS_TRANSMISSION, true);
        self.flag(Materials::THIN, thin).number(Materials::SPECULAR, 1.0).number(Materials::TRANSMISSION, 1.0);
        self.roughness(roughness)
    }

    /// Everything at once.
    pub fn medley(&mut self, roughness: f32) -> &mut Probe {
        self.glass(roughness, false).flag(Materials::HAS_DIFFUSE, true).flag(Materials::HAS_METAL, true).coloured();
        self.number(Materials::METALLIC, 0.3).number(Materials::TRANSMISSION, 0.6).number(Materials::SPECULAR, 0.7);
        self.number(Materials::SPECULAR_R, 0.0).number(Materials::SPECULAR_G, 2.0)
    }

    /// The model of this name with these numbers, on white.
    pub fn model(&mut self, name: &str, numbers: &[f32]) -> &mut Probe {
        let place = self.models.iter().position(|model| *model == name).expect("it is in the list");
        self.reset();
        self.bench.set(Models::USED, place, true);
        self.bench.set(Materials::MODEL, 0, place as u32);
        self.bench.rows::<Parameters>(numbers.len().max(1));
        numbers.iter().enumerate().for_each(|(i, x)| self.bench.set(Parameters::VALUE, i, *x));
        self
    }

    /// Diffuse and Phong.
    pub fn phong(&mut self, ns: f32) -> &mut Probe {
        self.model("phong", &[1.0, 1.0, 1.0, ns]).coloured()
    }

    /// A lobe of the material, which a scene then has.
    fn lobe(&mut self, lobe: Lobe, flag: jerboa_ir::lang::Col<Materials, jerboa_ir::lang::Bool>) -> &mut Probe {
        self.bench.set(Models::USED, self.models.len() + lobe as usize, true);
        self.flag(flag, true)
    }

    /// A white sheen over what is there.
    pub fn sheen(&mut self, roughness: f32) -> &mut Probe {
        for column in [Materials::SHEEN_R, Materials::SHEEN_G, Materials::SHEEN_B] {
            self.number(column, 1.0);
        }
        self.lobe(Lobe::Sheen, Materials::HAS_SHEEN).number(Materials::SHEEN_ROUGHNESS, roughness)
    }

    /// What is there, rougher along x.
    pub fn anisotropy(&mut self, strength: f32) -> &mut Probe {
        self.bench.set(Materials::SMOOTH, 0, SMOOTH_NEVER);
        self.lobe(Lobe::Anisotropy, Materials::HAS_ANISOTROPY).number(Materials::ANISOTROPY, strength);
        self.number(Materials::ANISOTROPY_X, 1.0)
    }

    /// A share of the diffuse light comes through, 0.3, 0.5, 0.7 of it.
    pub fn diffuse_transmission(&mut self, share: f32) -> &mut Probe {
        self.lobe(Lobe::DiffuseTransmission, Materials::HAS_DIFFUSE_TRANSMISSION)
            .number(Materials::DIFFUSE_TRANSMISSION, share);
        self.number(Materials::DIFFUSE_TRANSMISSION_R, 0.3).number(Materials::DIFFUSE_TRANSMISSION_G, 0.5);
        self.number(Materials::DIFFUSE_TRANSMISSION_B, 0.7)
    }

    /// A film of this thickness on what is there.
    pub fn film(&mut self, share: f32, nanometres: f32) -> &mut Probe {
        self.lobe(Lobe::Film, Materials::HAS_FILM).number(Materials::FILM, share).number(Materials::FILM_IOR, 1.3);
        self.number(Materials::FILM_THICKEST, nanometres)
    }

    /// A coat of this strength over what is there.
    pub fn coat(&mut self, strength: f32, roughness: f32) -> &mut Probe {
        let smooth = if roughness * roughness < SMOOTH_ALPHA { SMOOTH_ALWAYS } else { SMOOTH_NEVER };
        self.bench.set(Materials::COAT_SMOOTH, 0, smooth);
        self.lobe(Lobe::Coat, Materials::HAS_COAT)
            .number(Materials::COAT, strength)
            .number(Materials::COAT_ROUGHNESS, roughness)
    }

    /// An image of one texel, which all textures are.
    fn texel(&mut self, rgba: [u8; 4]) -> &mut Probe {
        self.bench.rows::<Textures>(1);
        self.bench.rows::<Texels>(1);
        self.bench.set(Textures::WIDTH, 0, 1u32);
        self.bench.set(Textures::HEIGHT, 0, 1u32);
        self.bench.set(Texels::RGBA, 0, u32::from_le_bytes(rgba));
        self
    }

    /// A normal map of one texel on what is there, which a coat does not have.
    pub fn normal_map(&mut self, [r, g, b]: [u8; 3]) -> &mut Probe {
        self.texel([r, g, b, 255]).flag(Materials::NORMAL_TEXTURED, true).number(Materials::NORMAL_SCALE, 1.0)
    }

    /// The same on the coat, which what it covers does not have.
    pub fn coat_normal_map(&mut self, [r, g, b]: [u8; 3]) -> &mut Probe {
        self.texel([r, g, b, 255]).flag(Materials::COAT_NORMAL_TEXTURED, true);
        self.number(Materials::COAT_NORMAL_SCALE, 1.0)
    }

    /// A blend: so much of white metal of this roughness, the rest Lambert's surface, coloured.
    pub fn blend(&mut self, share: f32, roughness: f32) -> &mut Probe {
        self.model("blend", &[share]);
        let words = [(Materials::HAS_DIFFUSE, 1), (Materials::HAS_METAL, 2)];
        self.bench.add_rows::<Materials>(2);
        words.into_iter().for_each(|(flag, row)| self.bench.set(flag, row, true));
        let colours = [(Materials::BASE_R, 0.8f32), (Materials::BASE_G, 0.5), (Materials::BASE_B, 0.2)];
        for (column, albedo) in colours {
            self.bench.set(column, 1, albedo);
            self.bench.set(column, 2, 1.0f32);
        }
        self.bench.set(Materials::METALLIC, 2, 1.0f32);
        self.bench.set(Materials::ROUGHNESS, 2, roughness);
        self.bench.set(Materials::SMOOTH, 2, if roughness == 0.0 { SMOOTH_ALWAYS } else { SMOOTH_NEVER });
        self.bench.set(Materials::FIRST, 0, 1u32);
        self.bench.set(Materials::SECOND, 0, 2u32);
        self
    }

    /// The shading normal that goes with f, by the normal map too.
    pub fn shading_normal(&mut self) -> V {
        let n = self.bench.run_floats("normal", &[self.face, self.normal].concat());
        [n[0], n[1], n[2]]
    }

    /// f, pdf, is the whole specular?
    pub fn eval(&mut self, wi: V, wo: V) -> (V, f32, bool) {
        let args = [self.face, self.normal, wi, wo].concat();
        let out = self.bench.run_floats("eval", &args);
        ([out[0], out[1], out[2]], out[3], out[4] == 1.0)
    }

    /// A sample with the numbers of a key.
    pub fn sample(&mut self, wo: V, key: u32) -> Sampled {
        let mut args: Vec<u32> = [self.face, self.normal, wo].concat().iter().map(|x| x.to_bits()).collect();
        args.push(key);
        let words = self.bench.run("sample", &args);
        let x: Vec<f32> = words.iter().map(|w| f32::from_bits(*w)).collect();
        Sampled {
            wi: [x[0], x[1], x[2]],
            weight: [x[3], x[4], x[5]],
            pdf: x[6],
            is_specular: words[7] != 0,
            scale: x[8],
            f_there: [x[9], x[10], x[11]],
            pdf_there: x[12],
        }
    }

    /// Machine code and interpreter agree on some calls.
    pub fn check_engines(&mut self, wo: V) {
        for key in 0..5 {
            let mut args: Vec<u32> = [self.face, self.normal, wo].concat().iter().map(|x| x.to_bits()).collect();
            args.push(key);
            self.bench.run_both("sample", &args);
        }
    }

    /// Mean weight of n samples (green), without the scale of radiance, and its standard error.
    pub fn albedo(&mut self, wo: V, n: u32) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for key in 0..n {
            let s = self.sample(wo, key);
            let w = f64::from(s.weight[1] / s.scale);
            sum += w;
            squares += w * w;
        }
        let n = f64::from(n);
        let mean = sum / n;
        (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
    }
}
