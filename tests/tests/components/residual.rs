//! What is left of a material when its structure is known (T25): the operations of its own lobes and nothing else.

use jerboa_ir::lang::{Fun, U32, build, entry};
use jerboa_ir::{Column, Lit, Node, Program, Time};
use jerboa_lib_render::core::rng::Rng;
use jerboa_lib_render::core::vec::Vec3;
use jerboa_lib_render::schema::*;
use jerboa_peval::{self as peval, Arg, ColumnFacts, Facts, Generic, TableFacts};

use jerboa_tests::harness::probe::material;

/// The residual of sampling and evaluating a material whose structure columns are 0 but for these.
fn residual(structure: &[(u32, Lit)]) -> Program {
    let generic = Generic::new(build(|| {
        declare_all();
        entry(
            "scatter",
            Fun::lam(|b, (g, n, wi, wo, key): (Vec3, Vec3, Vec3, Vec3, U32)| {
                let bsdf = material(b, g, n).bsdf;
                let sample = bsdf.sample.call(b, (Rng::new(0.into(), 0.into(), key), wo));
                (sample, bsdf.eval.call(b, (wi, wo)), bsdf.pdf.call(b, (wi, wo)))
            }),
        );
    }));
    let known = |name: &str, set: &[(u32, Lit)]| {
        let buffer = generic.program().buffers.iter().find(|b| &*b.name == name).expect("declared");
        let columns = buffer.columns.iter().enumerate().map(|(i, c)| match (c.time, c.ty) {
            (Time::Structure, jerboa_ir::ColTy::Scalar(s)) => {
                let set = set.iter().find(|(column, _)| *column == i as u32);
                ColumnFacts::Known(vec![set.map_or(Lit::from_word(s, 0), |(_, lit)| *lit)])
            }
            _ => ColumnFacts::Unknown,
        });
        TableFacts { class_of: vec![], classes: 1, columns: columns.collect() }
    };
    let tables = generic.program().buffers.iter().map(|b| match &*b.name {
        "Materials" => known("Materials", structure),
        "Settings" | "Sampling" => known(&b.name, &[]),
        _ => TableFacts::default(),
    });
    let facts = Facts { tables: tables.collect() };
    let options = peval::Options::default();
    peval::specialize(&generic, "scatter", &[Arg::Unknown; 13], &facts, &options)
        .expect("it can be specialised")
        .program
}

/// Names of the columns that the residual reads, in order of the schema.
fn reads(program: &Program) -> Vec<String> {
    let column = |node: &Node| match node {
        Node::Read { column, .. } => Some(*column),
        _ => None,
    };
    let mut columns: Vec<Column> = program.nodes.iter().filter_map(column).collect();
    columns.sort();
    columns.dedup();
    columns.into_iter().map(|c| program.column(c).name.to_string()).collect()
}

const YES: Lit = Lit::Bool(true);
const BASE: [&str; 3] = ["BASE_R", "BASE_G", "BASE_B"];

#[test]
fn a_diffuse_surface_is_one_block_that_reads_its_colour() {
    let program = residual(&[(Materials::HAS_DIFFUSE.0, YES)]);
    assert_eq!(reads(&program), BASE);
    assert_eq!(program.conts.len(), 1);
}

#[test]
fn a_mirror_knows_no_roughness() {
    let program = residual(&[(Materials::HAS_METAL.0, YES), (Materials::SMOOTH.0, Lit::U32(SMOOTH_ALWAYS))]);
    assert_eq!(reads(&program), [&BASE[..], &["METALLIC"]].concat());
    assert_eq!(program.conts.len(), 1);
}

#[test]
fn smooth_glass_knows_neither_roughness_nor_metal() {
    let flags = [Materials::HAS_SPECULAR.0, Materials::HAS_TRANSMISSION.0].map(|c| (c, YES));
    let program = residual(&[&flags[..], &[(Materials::SMOOTH.0, Lit::U32(SMOOTH_ALWAYS))]].concat());
    let layer = ["IOR", "SPECULAR", "SPECULAR_R", "SPECULAR_G", "SPECULAR_B", "TRANSMISSION"];
    assert_eq!(reads(&program), [&BASE[..], &layer].concat());
}
