//! T25: a feature that a scene does not use has left nothing in its residual.
//!
//! The tables are in [`jerboa_tests::harness::features`]: what scenes, renders and sources of the library are there for. Every
//! subject, a scene with its choices, a tracer and a device, is held against every row. And what a row says that a feature leaves
//! is found where it is used, so that no row is idle; and every column and every source is some row's, or needed everywhere.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use jerboa_ir::Time;
use jerboa_ir::lang::SpecTy;
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::tables::{Choices, Known, Tables};
use jerboa_lib_render::schema::BUFFERS;
use jerboa_scenes::{Scene, builtin};
use jerboa_tests::harness::features::everywhere::EVERYWHERE;
use jerboa_tests::harness::features::{Content, features, has_model, is_lit, models};
use jerboa_tests::harness::subjects::{Subject, subjects};

/// What the residuals of a subject hold, by kernel.
struct Held {
    subject: Subject,
    kernels: Vec<(String, Content)>,
}

impl Held {
    fn new(subject: Subject, known: Known) -> Held {
        let content = |(kernel, program)| (kernel, Content::of(&program));
        Held { kernels: subject.residuals(known).into_iter().map(content).collect(), subject }
    }

    /// Is this in one of its residuals?
    fn has(&self, mark: &str) -> bool {
        self.kernels.iter().any(|(_, content)| content.has(mark))
    }

    /// Feature, whether it is used, and what only it leaves; for every row and each thing that it leaves.
    fn rows(&self) -> impl Iterator<Item = (&'static str, bool, String)> {
        let subject = &self.subject;
        let rows = features().flat_map(|f| f.leaves.iter().map(move |mark| (f, *mark)));
        let rows = rows.map(|(f, mark)| (f.name, (f.used)(subject), mark.to_string()));
        rows.chain(models().map(|(file, model)| (model, has_model(subject, model), file)))
    }
}

static ALL: LazyLock<Vec<Held>> =
    LazyLock::new(|| subjects().into_iter().map(|subject| Held::new(subject, Known::Structure)).collect());

/// What residuals hold for features that their subjects do not use.
fn idle(all: &[Held]) -> Vec<String> {
    let mut found = Vec::new();
    for held in all {
        for (name, _, mark) in held.rows().filter(|(_, used, _)| !used) {
            let kernels = held.kernels.iter().filter(|(_, content)| content.has(&mark));
            found.extend(kernels.map(|(k, _)| format!("{}: no {name}, but `{mark}` is in `{k}`", held.subject.name)));
        }
    }
    found
}

#[test]
fn what_a_scene_does_not_use_is_in_none_of_its_residuals() {
    assert_eq!(idle(&ALL).join("\n"), "");
}

/// Nor where all of the scene is known: of every eighth subject, or, where `JERBOA_ALL` says so, of each.
#[test]
fn what_a_scene_does_not_use_is_in_none_of_its_residuals_at_all() {
    let every = if std::env::var_os("JERBOA_ALL").is_some() { 1 } else { 8 };
    let all: Vec<Held> = subjects().into_iter().step_by(every).map(|subject| Held::new(subject, Known::All)).collect();
    assert_eq!(idle(&all).join("\n"), "");
}

/// What a row says is left is found where the feature is used, and there is a subject that does not use it.
#[test]
fn no_row_is_idle() {
    let rows = |wanted: fn(&Held, bool, &str) -> bool| -> BTreeSet<(&str, String)> {
        let all = ALL.iter().flat_map(|held| held.rows().filter(move |(_, used, mark)| wanted(held, *used, mark)));
        all.map(|(name, _, mark)| (name, mark)).collect()
    };
    let all = rows(|_, _, _| true);
    let left = rows(|held, used, mark| used && held.has(mark));
    let forbidden = rows(|_, used, _| !used);
    let none: Vec<&(&str, String)> = Vec::new();
    assert_eq!(all.difference(&left).collect::<Vec<_>>(), none, "what no residual has");
    assert_eq!(all.difference(&forbidden).collect::<Vec<_>>(), none, "what every subject uses");
}

/// Every source whose code is in a residual is some row's, or needed everywhere.
#[test]
fn every_source_is_some_rows() {
    let mut files: BTreeSet<&str> =
        ALL.iter().flat_map(|h| &h.kernels).flat_map(|(_, c)| c.files()).map(|f| &**f).collect();
    let models: Vec<String> = models().map(|(file, _)| file).collect();
    let listed = features().flat_map(|f| f.leaves).chain(EVERYWHERE).copied().chain(models.iter().map(|f| &**f));
    listed.for_each(|file| _ = files.remove(file));
    assert!(files.is_empty(), "sources in residuals that are in no row: {files:?}");
}

/// What is needed everywhere is there, or it would be a feature's.
#[test]
fn what_every_picture_needs_is_in_the_residuals_of_each() {
    let lacks = |mark: &'static str| {
        ALL.iter().filter(move |h| !h.has(mark)).map(move |h| format!("{}: no `{mark}`", h.subject.name))
    };
    let missing: Vec<String> = EVERYWHERE.iter().flat_map(|mark| lacks(mark)).collect();
    assert!(missing.is_empty(), "{}", missing.join("\n"));
}

/// No column is forgotten: what is known is some row's fact, and what is read is some row's, or needed everywhere. (A reference is
/// both: a row whose number may be unknown.)
#[test]
fn every_column_is_some_rows() {
    let marks: Vec<&str> = features().flat_map(|f| f.leaves).chain(EVERYWHERE).copied().collect();
    let facts: Vec<&str> = features().flat_map(|f| f.facts).copied().collect();
    let mut forgotten = Vec::new();
    for (table, _, _, columns) in BUFFERS {
        for column in columns.iter().filter(|c| c.name != "CLASS") {
            let name = format!("{table}.{}", column.name);
            let is_named = |list: &[&str]| list.iter().any(|mark| name.starts_with(mark));
            let is_reference = matches!(column.ty, SpecTy::Ref(_));
            let is_known = column.time == Time::Structure;
            if (!is_known || is_reference) && !is_named(&marks) || is_known && !is_reference && !is_named(&facts) {
                forgotten.push(name);
            }
        }
    }
    assert_eq!(forgotten, [""; 0]);
    let columns: Vec<String> =
        BUFFERS.iter().flat_map(|(t, _, _, columns)| columns.iter().map(move |c| format!("{t}.{}", c.name))).collect();
    let idle: Vec<&&str> = facts.iter().filter(|fact| !columns.iter().any(|c| c.starts_with(**fact))).collect();
    assert_eq!(idle, [&""; 0], "facts that are no columns");
}

/// Shadow rays have a kernel only where a vertex may ask for light; a renderer that knows nothing must always have it.
#[test]
fn without_lights_no_kernel_traces_shadow_rays() {
    let mut dark = 0;
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{name}: {e}"));
        let has = |known: Known, tracer: TracerKind| {
            let tables = Tables::new(&scene, &Choices::default(), known);
            [DeviceKind::Cpu, DeviceKind::GpuWavefront]
                .map(|device| device.requests(&tables, tracer).iter().any(|r| r.name.ends_with("shadow")))
        };
        dark += u32::from(!is_lit(&scene));
        assert_eq!(has(Known::Structure, TracerKind::Path), [is_lit(&scene); 2], "{name}");
        assert_eq!(has(Known::Nothing, TracerKind::Path), [true; 2], "{name}");
        assert_eq!(has(Known::Structure, TracerKind::Depth), [false; 2], "{name}");
        assert_eq!(has(Known::Structure, TracerKind::Occlusion), [true; 2], "{name}");
    }
    assert!(dark > 0, "every scene is lit");
}
