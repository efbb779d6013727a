//! The models that a material can name: one list, and the choice among its rows.
//!
//! A model is a name, the numbers it takes beside glTF's, and a constructor. All of them are in the generic program; a
//! kernel that knows a material's model keeps that one alone, and a model that no material of the scene has leaves no code
//! even where the material is unknown ([`Models::USED`]).
//!
//! Source: the shader's choice of a BSDF is the paper's, section 4.5.

use jerboa_ir::lang::{Block, Bool, Col, F32, Fun, Row};

use crate::bsdf::gltf::make_gltf_bsdf;
use crate::bsdf::{Bsdf, conductor, dielectric, mirror, mix, phong, plastic, rough_diffuse, thin_glass};
use crate::components::{Components, Numbers, Parameter};
use crate::core::color::Color;
use crate::geometry::SurfaceElement;
use crate::lobes::{make_layers, with_lobes};
use crate::material::{base_color, gltf_values, is_smooth};
use crate::schema::{Materials, Models};
use crate::texture::look_up;

/// A model of scattering.
#[derive(Clone, Copy, Debug)]
pub struct Model {
    /// What materials call it.
    pub name: &'static str,
    /// The numbers it takes beside those of glTF's materials, in the order in which [`Site::numbers`] counts them.
    pub parameters: &'static [Parameter],
    /// Is it made of two other materials?
    pub has_parts: bool,
    /// Builds it at a point of a surface.
    pub make: MakeBsdf,
}

/// A constructor of BSDFs. It runs while the generic program is built.
pub type MakeBsdf = fn(&mut Block, Site) -> Bsdf;

/// glTF's own model, of a material that names no other.
const GLTF: Model = Model {
    name: "gltf",
    parameters: &[],
    has_parts: false,
    make: |b, site| {
        let values = gltf_values(b, site.row, site.base, site.surf.uv);
        let values = with_lobes(b, site, values);
        let layers = (site.row.get(Materials::HAS_SHEEN), site.row.get(Materials::HAS_COAT));
        make_layers(b, site, values, make_gltf_bsdf(site.surf, values).whole_unless_known(layers))
    },
};

/// The library's models, by number: [`Materials::MODEL`].
pub const MODELS: &[Model] = &[
    GLTF,
    phong::MODEL,
    rough_diffuse::MODEL,
    conductor::MODEL,
    dielectric::MODEL,
    plastic::MODEL,
    thin_glass::MODEL,
    mirror::MODEL,
    mix::MODEL,
];

/// A point of a surface, and the material there: what a constructor is given.
#[derive(Clone, Copy)]
pub struct Site {
    /// The material.
    pub row: Row<Materials>,
    /// The surface, with the normal map applied.
    pub surf: SurfaceElement,
    /// The surface without it.
    pub plain: SurfaceElement,
    /// Base colour there.
    pub base: Color,
    /// Is the constructor's model the one that the material has? Elsewhere nothing need be looked up.
    pub is_chosen: Bool,
    /// Models without parts.
    alone: Option<AloneFn>,
}

/// (material, base colour) → its BSDF, if its model has no parts.
type AloneFn = Fun<(Row<Materials>, Color), Bsdf>;

impl Site {
    /// The numbers that the model takes.
    pub fn numbers(self) -> Numbers {
        numbers(self.row)
    }

    /// The material's roughness, by its texture too.
    pub fn roughness(self, b: &mut Block) -> F32 {
        let factor = self.row.get(Materials::ROUGHNESS);
        b.if_(
            self.is_chosen & self.row.get(Materials::METALLIC_ROUGHNESS_TEXTURED),
            |b| factor * look_up(b, self.row.get(Materials::METALLIC_ROUGHNESS_TEXTURE), self.surf.uv).color.g,
            |_| factor,
        )
    }

    /// GGX's α, the square of roughness, and whether it counts as perfectly smooth.
    pub fn alpha(self, b: &mut Block) -> (F32, Bool) {
        let roughness = self.roughness(b);
        let alpha = roughness * roughness;
        (alpha, is_smooth(self.row.get(Materials::SMOOTH), alpha))
    }

    /// The BSDF of a material that this one is made of, [`Materials::FIRST`] or [`Materials::SECOND`].
    ///
    /// # Panics
    /// When the model says that it has no parts.
    pub fn part(self, b: &mut Block, which: Col<Materials, Row<Materials>>) -> Bsdf {
        let alone = self.alone.expect("a model that asks for parts has `has_parts`");
        let row = self.row.get(which);
        let base = base_color(b, row, self.surf.uv);
        alone.call(b, (row, base))
    }
}

/// The numbers of a material's model.
pub fn numbers(row: Row<Materials>) -> Numbers {
    Numbers(row.get(Materials::NUMBERS))
}

/// The BSDF of a material at a point, whatever its model. The surface is given without the normal map, and with it.
pub fn make_bsdf(
    b: &mut Block,
    row: Row<Materials>,
    (plain, surf): (SurfaceElement, SurfaceElement),
    base: Color,
) -> Bsdf {
    let components = Components::current();
    let all = || components.models().iter().zip(0u32..);
    let make = |b: &mut Block, (model, number): (&Model, u32), site: Site| {
        let is_chosen = Row::<Models>::at(number).get(Models::USED) & site.row.get(Materials::MODEL).eq(number);
        (is_chosen, (model.make)(b, Site { is_chosen, ..site }))
    };
    let site = |row, base, alone| Site { row, surf, plain, base, is_chosen: true.into(), alone };
    let choose = |other: Bsdf, (is_chosen, bsdf): (Bool, Bsdf)| Bsdf::choose(is_chosen, bsdf, other);
    // A function of the row, so that parts of others are made by the same code. glTF's is what no other is.
    let alone = AloneFn::lam(|b, (row, base)| {
        let site = site(row, base, None);
        let (_, gltf) = make(b, (&GLTF, 0), site);
        let all = all().skip(1).filter(|(m, _)| !m.has_parts).map(|model| make(b, model, site)).fold(gltf, choose);
        all.whole_unless_known(row.get(Materials::MODEL))
    });
    let own = alone.call(b, (row, base));
    all().filter(|(m, _)| m.has_parts).map(|model| make(b, model, site(row, base, Some(alone)))).fold(own, choose)
}
