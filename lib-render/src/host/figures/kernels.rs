//! The kernels of Figures 3 and 4: rays of one stream, what shading them gives to another.

use jerboa_ir::Program;
use jerboa_ir::lang::{Block, Bool, Col, F32, Fun, Row, Spec, U32, build, declare, entry, spec};

use crate::bsdf::Bsdf;
use crate::bsdf::diffuse::make_diffuse_bsdf;
use crate::bsdf::models::numbers;
use crate::bsdf::phong::make_mixed_phong_bsdf;
use crate::core::color::{Color, white};
use crate::core::rng::Rng;
use crate::core::vec::{Vec2, Vec3, vec2, vec3};
use crate::geometry::{Frame3, SurfaceElement, make_geometry};
use crate::image::Texel;
use crate::material::base_color;
use crate::ray::{Hit, Ray};
use crate::schema::{BUFFERS, Geometries, Materials, NONE};
use crate::shader::make_shader;
use crate::texture::{look_up, make_texture};

/// Rays that are shaded at once, as on the device of streams.
const WIDTH: u8 = 8;

jerboa_ir::stream! {
    /// What is to be shaded.
    pub Asked {
        /// The record `Hit`.
        PRIMITIVE: U32;
        /// See [`Asked::PRIMITIVE`].
        T: F32;
        /// See [`Asked::PRIMITIVE`].
        U: F32;
        /// See [`Asked::PRIMITIVE`].
        V: F32;
        /// Direction towards the viewer, unit.
        VIEWER_X: F32;
        /// See [`Asked::VIEWER_X`].
        VIEWER_Y: F32;
        /// See [`Asked::VIEWER_X`].
        VIEWER_Z: F32;
        /// Direction towards the light, unit.
        LIGHT_X: F32;
        /// See [`Asked::LIGHT_X`].
        LIGHT_Y: F32;
        /// See [`Asked::LIGHT_X`].
        LIGHT_Z: F32;
        /// Unit normal, where the shader does not find its own.
        NORMAL_X: F32;
        /// See [`Asked::NORMAL_X`].
        NORMAL_Y: F32;
        /// See [`Asked::NORMAL_X`].
        NORMAL_Z: F32;
        /// Of an `Rng`.
        START: U32;
        /// See [`Asked::START`].
        STEP: U32;
        /// See [`Asked::START`].
        DIM: U32;
        /// Which of the shaders, S in the paper.
        MATERIAL: U32;
    }
}

jerboa_ir::stream! {
    /// What comes of it.
    pub Shaded {
        /// Light from the light and weight of the next ray, together.
        R: F32;
        /// Green.
        G: F32;
        /// Blue.
        B: F32;
        /// Direction of the next ray.
        NEXT_X: F32;
        /// See [`Shaded::NEXT_X`].
        NEXT_Y: F32;
        /// See [`Shaded::NEXT_X`].
        NEXT_Z: F32;
    }
}

/// Both streams, to be declared behind the tables.
fn streams() -> [Spec; 2] {
    [spec::<Asked>(), spec::<Shaded>()]
}

/// A vector in three columns.
fn load_vector(b: &mut Block, columns: [Col<Asked, F32>; 3], i: U32) -> Vec3 {
    let [x, y, z] = columns.map(|c| b.load(c, i));
    vec3(x, y, z)
}

/// Towards the viewer.
fn viewer(b: &mut Block, i: U32) -> Vec3 {
    load_vector(b, [Asked::VIEWER_X, Asked::VIEWER_Y, Asked::VIEWER_Z], i)
}

/// What a path tracer asks of a surface: the light from one direction, and another direction to go on.
fn scatter(b: &mut Block, i: U32, bsdf: Bsdf, normal: Vec3) {
    let (wo, light) = (viewer(b, i), load_vector(b, [Asked::LIGHT_X, Asked::LIGHT_Y, Asked::LIGHT_Z], i));
    let (start, step, dim): (U32, U32, U32) = b.load_record(Asked::START, i);
    let rng = Rng { start, step, index: 0.into(), dim, is_second: false.into() };
    let lit: Color = bsdf.eval.call(b, (light, wo)) * normal.dot(light).abs();
    let next = bsdf.sample.call(b, (rng, wo));
    b.store_record(Shaded::R, i, (lit + next.weight, next.wi));
}

/// The kernel of Figure 3, `shade`: rays of a range, whose materials are of one class.
pub fn phong() -> Program {
    build(|| {
        declare(&[BUFFERS, &streams()].concat());
        entry(
            "shade",
            Fun::<(Row<Materials>, U32, U32), ()>::named("shade", |b, (class, lo, hi)| {
                b.vectorize(WIDTH, lo, hi, |b, i| {
                    let material: U32 = b.load(Asked::MATERIAL, i);
                    b.dispatch(class.sibling(material), |b, row| shade(b, row, i));
                });
            }),
        );
    })
}

/// The shader of the paper.
fn shade(b: &mut Block, row: Row<Materials>, i: U32) {
    let normal = load_vector(b, [Asked::NORMAL_X, Asked::NORMAL_Y, Asked::NORMAL_Z], i);
    let (u, v): (F32, F32) = (b.load(Asked::U, i), b.load(Asked::V, i));
    let uv = [vec2(u, v); 2];
    let origin = vec3(0.0, 0.0, 0.0);
    let surf = SurfaceElement {
        point: origin,
        error: origin,
        face_normal: normal,
        local: Frame3::around(normal),
        uv,
        color: white(),
        primitive: 0.into(),
        light: NONE.into(),
        start: origin,
    };
    let (kd, ks) = (base_color(b, row, uv), reflectance(b, row, uv));
    scatter(b, i, make_mixed_phong_bsdf(surf, kd, ks, numbers(row).number(3)), normal);
}

/// `ks`: a constant, times a texture if there is one.
fn reflectance(b: &mut Block, row: Row<Materials>, uv: [Vec2; 2]) -> Color {
    let ks = numbers(row).color(0);
    let textured = |b: &mut Block| ks * look_up(b, row.get(Materials::SPECULAR_COLOR_TEXTURE), uv).color;
    b.if_(row.get(Materials::SPECULAR_COLOR_TEXTURED), textured, |_| ks)
}

/// (row of the geometry, ray, hit) → the surface there.
type ElementFn = Fun<(U32, Ray, Hit), SurfaceElement>;

/// (row of the texture, coordinates) → its value there.
type ColourFn = Fun<(U32, Vec2), Texel>;

/// Which interfaces are specialised.
#[derive(Clone, Copy, Debug)]
pub struct Interfaces {
    /// Name of the kernel.
    pub name: &'static str,
    /// That of the texture.
    pub texture: bool,
    /// That of the attributes.
    pub attributes: bool,
}

/// All combinations.
pub const INTERFACES: [Interfaces; 4] = [
    Interfaces { name: "neither", texture: false, attributes: false },
    Interfaces { name: "texture", texture: true, attributes: false },
    Interfaces { name: "attributes", texture: false, attributes: true },
    Interfaces { name: "both", texture: true, attributes: true },
];

/// The kernels of Figure 4, one for each of [`INTERFACES`]: rays 0..middle hit the geometry of row 0, middle..end that of row 1.
/// Each has a shader, and both use the same interfaces, which so stay functions where they are not specialised.
pub fn interfaces() -> Program {
    build(|| {
        declare(&[BUFFERS, &streams()].concat());
        for Interfaces { name, texture, attributes } in INTERFACES {
            let element = ElementFn::rec(
                "attributes",
                |_| Bool::from(attributes),
                |b, _, (geometry, ray, hit)| {
                    let row = Row::<Geometries>::at(geometry);
                    make_geometry(row, make_shader(row.get(Geometries::MATERIAL))).surface_element.call(b, (ray, hit))
                },
            );
            let colour = ColourFn::rec(
                "texture",
                |_| Bool::from(texture),
                |b, _, (texture, uv)| make_texture(Row::at(texture)).call(b, uv),
            );
            let shade = Fun::<(U32, U32), ()>::named(name, |b, (middle, end)| {
                for (geometry, lo, hi) in [(0, 0.into(), middle), (1, middle, end)] {
                    b.vectorize(WIDTH, lo, hi, |b, i| diffuse(b, element, colour, geometry.into(), i));
                }
            });
            entry(name, shade);
        }
    })
}

/// The diffuse shader of the paper.
fn diffuse(b: &mut Block, element: ElementFn, colour: ColourFn, geometry: U32, i: U32) {
    let (hit, wo, none): (Hit, _, _) = (b.load_record(Asked::PRIMITIVE, i), viewer(b, i), U32::from(NONE));
    let ray = Ray { org: wo, dir: -wo, tmax: hit.t, skip: none, skip1: none, skip2: none };
    let surf = element.call(b, (geometry, ray, hit));
    let material = Row::<Geometries>::at(geometry).get(Geometries::MATERIAL);
    let texture = material.get(Materials::BASE_TEXTURE).index();
    let kd = colour.call(b, (texture, surf.uv[0])).color;
    scatter(b, i, make_diffuse_bsdf(surf, kd), surf.local.normal);
}
