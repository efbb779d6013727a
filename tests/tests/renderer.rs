//! The whole renderer on every engine: T3, the levels of knowledge, Laws 1 and 4, T25.
//!
//! The quick form runs small windows of small scenes. `JERBOA_T3=full cargo test --release -p jerboa-tests --test renderer`
//! runs T3 as the list has it, 32x32 at 4 spp on the matched scenes and five built-ins (an hour: the generic program is
//! interpreted).

use std::path::{Path, PathBuf};

use jerboa_ir::lang::Buf;
use jerboa_ir::print;
use jerboa_ir::{Lit, Program, Role};
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::generate::{Keep, TracerKind, every_entry, generic, residual};
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::replay::interpret;
use jerboa_lib_render::host::tables::{Choices, Known, Pass, Tables};
use jerboa_lib_render::schema::*;
use jerboa_scenes::{Scene, builtin};

const LEVELS: [Known; 3] = [Known::Nothing, Known::Structure, Known::All];

/// Built-ins of T3, each with something the others lack: area light, metals and glass under an environment, cut-outs,
/// textures, many lights.
const BUILTINS: [&str; 5] = ["cornell-box", "material-balls", "alpha", "checkerboard", "many-lights"];

/// Matched scenes of T3.
const MATCHED: [&str; 4] = ["cornell-box", "living-room", "staircase", "coffee-maker"];

fn shared() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let at = std::env::var_os("JERBOA_SHARED").map_or(beside, PathBuf::from).join("scenes");
    at.is_dir().then_some(at)
}

fn load(name: &str) -> Scene {
    Scene::load(name).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A pass over a window in the middle of a small film.
fn pass(side: u32, window: u32, samples: u32) -> Pass {
    let start = (side - window) / 2;
    let window = Window { x: start, y: start, width: window, height: window };
    Pass { size: [side, side], window, sample: 3, samples, seed: 7 }
}

fn renderer(scene: &Scene, known: Known) -> Renderer {
    Renderer::new(scene, Options { known, ..Options::default() }).unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Generic program interpreted, residual interpreted, machine code: the same words.
fn engines_agree(scene: &Scene, pass: &Pass) {
    let camera = scene.camera_or_default();
    let name = &scene.name;
    let kernel = TracerKind::Path.kernel();
    let mut first: Option<Vec<u32>> = None;
    for known in LEVELS {
        let r = renderer(scene, known);
        let compiled = r.samples(&camera, pass).unwrap_or_else(|e| panic!("{name}: {e}"));
        let residual = &r.generated().residual.program;
        let meant = interpret(residual, kernel, r.tables(), &camera, pass, &mut ()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(differences(&compiled, &meant), 0, "{name}, {known:?}: machine code against the interpreted residual");
        let first = first.get_or_insert_with(|| {
            interpret(generic().program(), kernel, r.tables(), &camera, pass, &mut ()).unwrap_or_else(|e| panic!("{name}: {e}"))
        });
        assert_eq!(differences(&compiled, first), 0, "{name}, {known:?}: machine code against the interpreted generic program");
    }
}

/// Words that differ; every NaN is one value.
fn differences(a: &[u32], b: &[u32]) -> usize {
    let canonical = |w: u32| Lit::f32(f32::from_bits(w));
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b && canonical(**a) != canonical(**b)).count()
}

#[test]
fn engines_agree_on_built_in_scenes() {
    let full = std::env::var_os("JERBOA_T3").is_some();
    let pass = if full { pass(32, 32, 4) } else { pass(32, 6, 1) };
    for name in BUILTINS {
        engines_agree(&load(&format!("builtin:{name}")), &pass);
    }
}

#[test]
fn engines_agree_on_matched_scenes() {
    let Some(shared) = shared() else {
        println!("skipped: engines_agree_on_matched_scenes (no shared scenes)");
        return;
    };
    let full = std::env::var_os("JERBOA_T3").is_some();
    let pass = if full { pass(32, 32, 4) } else { pass(32, 3, 1) };
    for name in MATCHED {
        let file = shared.join(name).join(format!("{name}.matched.glb"));
        engines_agree(&load(&file.to_string_lossy()), &pass);
    }
}

/// `--known` never changes the image: machine code of the three levels on every built-in scene.
#[test]
fn levels_give_the_same_bytes() {
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = load(&format!("builtin:{name}"));
        let camera = scene.camera_or_default();
        let pass = pass(48, 48, 2);
        let images = LEVELS.map(|known| renderer(&scene, known).samples(&camera, &pass).unwrap_or_else(|e| panic!("{name}: {e}")));
        assert_eq!(differences(&images[0], &images[1]), 0, "{name}: nothing against structure");
        assert_eq!(differences(&images[1], &images[2]), 0, "{name}: structure against all");
    }
}

/// Law 1: the program is built without a scene, and building it again gives the same text.
#[test]
fn the_generic_program_does_not_depend_on_the_scene() {
    let entries = |p: &Program| p.entries.iter().map(|(n, _)| n.to_string()).collect::<Vec<_>>();
    let first = print(generic().program());
    assert_eq!(entries(generic().program()), ["path", "normals", "albedo", "depth"]);
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = load(&format!("builtin:{name}"));
        let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
        residual(&tables, TracerKind::Path, Keep::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let again = every_entry();
        assert_eq!(entries(&again), entries(generic().program()), "{name}");
        assert!(print(&again) == first, "{name}: the generic program changed");
    }
}

/// Law 4: the library asks nowhere for a copy per branch. (That no closure meets another is an error of the evaluator, which
/// the tests above would show.)
#[test]
fn no_join_is_copied_per_branch() {
    let p = generic().program();
    let joins: Vec<_> = p.conts.iter().filter(|c| c.role == Role::Join).collect();
    assert!(joins.len() > 50, "the library branches: {} joins", joins.len());
    let copied: Vec<_> = joins.iter().filter(|c| p.as_lit(c.filter) == Some(Lit::Bool(true))).map(|c| c.loc.to_string()).collect();
    assert_eq!(copied, Vec::<String>::new());
}

/// Buffers whose columns a program reads, loads or stores.
fn touched(p: &Program) -> Vec<String> {
    let text = print(p);
    let used = |name: &str| text.lines().any(|l| l.contains(&format!("{name}.")) && !l.trim_start().starts_with(';'));
    BUFFERS.iter().map(|b| b.0).filter(|name| used(name)).map(Into::into).collect()
}

fn residual_at(scene: &Scene, known: Known) -> Program {
    let tables = Tables::new(scene, &Choices::default(), known);
    residual(&tables, TracerKind::Path, Keep::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name)).program
}

/// T25: what a scene does not use is not in its residual.
#[test]
fn a_residual_has_only_what_the_scene_needs() {
    let plain = residual_at(&load("builtin:cornell-box"), Known::Structure);
    let rich = residual_at(&load("builtin:material-balls"), Known::Structure);
    let text = print(&plain);
    // (feature, what would show it)
    let forbidden: [(&str, &[&str]); 6] = [
        ("textures", &["Texels.", "Textures.", "SrgbCurve."]),
        ("texture coordinates", &["Uvs.", "Tangents."]),
        ("environment", &["Environment.", "EnvironmentTexels.", "EnvironmentRows.", "EnvironmentColumns."]),
        ("glass", &["Materials.IOR", "Materials.TRANSMISSION", "Materials.ABSORPTION"]),
        ("KHR_texture_transform", &["Textures.M0", "Textures.M1"]),
        ("cut-outs", &["Materials.ALPHA", "Materials.BASE_A "]),
    ];
    let body: String = text.lines().filter(|l| !l.starts_with("table") && !l.starts_with("stream")).collect::<Vec<_>>().join("\n");
    for (feature, traces) in forbidden {
        for trace in traces {
            assert!(!body.contains(trace), "{feature}: `{trace}` in the residual of a scene without it");
        }
    }
    // The same search finds them where they are needed.
    assert!(touched(&rich).contains(&EnvironmentTexels::NAME.to_string()), "{:?}", touched(&rich));
    assert!(!touched(&plain).contains(&Environment::NAME.to_string()), "{:?}", touched(&plain));
}
