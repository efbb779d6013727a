//! The whole renderer on every engine: T3, the levels of knowledge, Laws 1 and 4.
//!
//! The quick form runs small windows of small scenes. `JERBOA_T3=full cargo test --release -p jerboa-tests --test renderer`
//! runs T3 as the list has it, 32x32 at 4 spp on the matched scenes and five built-ins (an hour: the generic program is
//! interpreted).

use std::path::Path;

use jerboa_ir::interp::Observer;
use jerboa_ir::{Lit, NodeId, Program, Role, print};
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::generate::{Keep, Request, TracerKind, every_entry, generic, residual};
use jerboa_lib_render::host::library::Library;
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::replay::interpret;
use jerboa_lib_render::host::tables::{Choices, Known, Pass, Tables};
use jerboa_peval::{Arg, Facts, Generic, specialize};
use jerboa_scenes::{Scene, builtin};
use jerboa_tests::sources::shared_scenes;

const LEVELS: [Known; 3] = [Known::Nothing, Known::Structure, Known::All];

/// Built-ins of T3, each with something the others lack: area light, metals and glass under an environment, cut-outs,
/// textures, many lights, instances, every filter, lights without a surface.
const BUILTINS: [&str; 8] = [
    "cornell-box",
    "material-balls",
    "alpha",
    "checkerboard",
    "many-lights",
    "pebbles",
    "fine-textures",
    "round-lights",
];

/// Matched scenes of T3.
const MATCHED: [&str; 4] = ["cornell-box", "living-room", "staircase", "coffee-maker"];

fn load(name: &str) -> Scene {
    Scene::load(name).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A pass over a window in the middle of a small film.
fn pass(side: u32, window: u32, samples: u32) -> Pass {
    let start = (side - window) / 2;
    let window = Window { x: start, y: start, width: window, height: window };
    Pass { size: [side, side], window, sample: 3, samples, seed: 7 }
}

fn renderer(scene: &Scene, device: DeviceKind, known: Known) -> Renderer {
    Renderer::new(scene, Options { device, known, ..Options::default() })
        .unwrap_or_else(|e| panic!("{}: {e}", scene.name))
}

/// Generic program interpreted, residual interpreted, machine code of every device: the same words. What is interpreted is
/// the kernel of the scalar device, which is a whole renderer.
fn engines_agree(scene: &Scene, pass: &Pass) {
    let camera = scene.camera_or_default();
    let name = &scene.name;
    let kernel = TracerKind::Path.kernel();
    let mut first: Option<Vec<u32>> = None;
    for known in LEVELS {
        let r = renderer(scene, DeviceKind::CpuScalar, known);
        let compiled = r.samples(&camera, pass).unwrap_or_else(|e| panic!("{name}: {e}"));
        let waves = renderer(scene, DeviceKind::Cpu, known).samples(&camera, pass);
        let waves = waves.unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(differences(&compiled, &waves), 0, "{name}, {known:?}: the devices differ");
        let residual = &r.kernels()[0].residual.program;
        let meant =
            interpret(residual, kernel, r.tables(), &camera, pass, &mut ()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(
            differences(&compiled, &meant),
            0,
            "{name}, {known:?}: machine code against the interpreted residual"
        );
        let first = first.get_or_insert_with(|| {
            interpret(generic().program(), kernel, r.tables(), &camera, pass, &mut ())
                .unwrap_or_else(|e| panic!("{name}: {e}"))
        });
        assert_eq!(
            differences(&compiled, first),
            0,
            "{name}, {known:?}: machine code against the interpreted generic program"
        );
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
    let Some(shared) = shared_scenes() else {
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

/// `--known` and `--device` never change the image: machine code of the three levels on every built-in scene.
#[test]
fn levels_give_the_same_bytes() {
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = load(&format!("builtin:{name}"));
        let camera = scene.camera_or_default();
        let pass = pass(24, 24, 2);
        let image = |device, known| {
            renderer(&scene, device, known).samples(&camera, &pass).unwrap_or_else(|e| panic!("{name}: {e}"))
        };
        let scalar = image(DeviceKind::CpuScalar, Known::Structure);
        for known in LEVELS {
            assert_eq!(differences(&image(DeviceKind::Cpu, known), &scalar), 0, "{name}: {known:?}");
        }
    }
}

/// Law 1: the program is built without a scene, and building it again gives the same text.
#[test]
fn the_generic_program_does_not_depend_on_the_scene() {
    let entries = |p: &Program| p.entries.iter().map(|(n, _)| n.to_string()).collect::<Vec<_>>();
    let first = print(generic().program());
    assert_eq!(entries(generic().program()), ["trace", "shadow", "path", "generate", "shade", "miss"]);
    let rare = entries(Library::standard().generic(DeviceKind::Cpu, TracerKind::Normals).program());
    for tracer in ["normals", "albedo", "depth", "occlusion", "aov_normal", "aov_place"] {
        let of = |stage: &str| format!("{tracer}_{stage}");
        for entry in [tracer.into(), of("generate"), of("shade"), of("miss")] {
            assert_eq!(rare.iter().filter(|e| **e == entry).count(), 1, "{entry} in {rare:?}");
        }
    }
    for name in builtin::list().iter().map(|b| b.name) {
        let scene = load(&format!("builtin:{name}"));
        let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
        path(&scene, &tables);
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
    let copied: Vec<_> =
        joins.iter().filter(|c| p.as_lit(c.filter) == Some(Lit::Bool(true))).map(|c| c.loc.to_string()).collect();
    assert_eq!(copied, Vec::<String>::new());
}

fn residual_of(scene: &Scene, tables: &Tables, request: &Request) -> Program {
    residual(tables, request, Keep::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name)).program
}

/// The kernel of the scalar device, which has all that a scene needs.
fn path(scene: &Scene, tables: &Tables) -> Program {
    residual_of(scene, tables, &DeviceKind::CpuScalar.requests(tables, TracerKind::Path)[0])
}

fn residual_at(scene: &Scene, known: Known) -> Program {
    path(scene, &Tables::new(scene, &Choices::default(), known))
}

/// Notes reads beyond the last row of a table.
struct Clamps<'p> {
    program: &'p Program,
    found: Vec<String>,
}

impl Observer for Clamps<'_> {
    fn clamped(&mut self, read: NodeId, index: u32) {
        self.found.push(format!("index {index} at {}", self.program.locs[read.index()]));
    }
}

fn clamps(scene: &Scene) -> Vec<String> {
    let tables = Tables::new(scene, &Choices::default(), Known::Structure);
    let program = path(scene, &tables);
    let mut clamps = Clamps { program: &program, found: Vec::new() };
    let (camera, pass) = (scene.camera_or_default(), pass(32, 4, 1));
    interpret(&program, "path", &tables, &camera, &pass, &mut clamps).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    clamps.found
}

/// Reads are clamped so that no index can do harm; a valid scene never needs it.
#[test]
fn no_built_in_scene_reads_beyond_a_table() {
    for scene in builtin::list().iter().map(|b| load(&format!("builtin:{}", b.name))) {
        assert_eq!(clamps(&scene), Vec::<String>::new(), "{}", scene.name);
    }
}

/// Specialising a residual again changes nothing.
#[test]
fn a_residual_is_its_own_residual() {
    for (name, known) in [("cornell-box", Known::Structure), ("material-balls", Known::All), ("alpha", Known::Nothing)]
    {
        let once = residual_at(&load(&format!("builtin:{name}")), known);
        let unknown = [Arg::Unknown, Arg::Unknown];
        let options = jerboa_peval::Options::default();
        let again = specialize(&Generic::new(once.clone()), "path", &unknown, &Facts::none(), &options);
        let again = again.unwrap_or_else(|e| panic!("{name}: {e}")).program;
        assert!(
            print(&again) == print(&once),
            "{name} at {known:?}: {} became {}",
            first_line(&once),
            first_line(&again)
        );
    }
}

/// The counters that begin a dump.
fn first_line(p: &Program) -> String {
    print(p).lines().next().unwrap_or_default().to_string()
}

/// The sizes of residuals, as a golden: a change of the library or the evaluator shows its effect here. The scalar kernel of
/// each built-in, and the kernels of streams of some. `BLESS=1` rewrites it.
#[test]
fn counters_of_the_residuals() {
    let mut found = String::new();
    for b in builtin::list() {
        let scene = load(&format!("builtin:{}", b.name));
        let tables = Tables::new(&scene, &Choices::default(), Known::Structure);
        let mut requests = DeviceKind::CpuScalar.requests(&tables, TracerKind::Path);
        if ["cornell-box", "material-balls"].contains(&b.name) {
            requests.extend(DeviceKind::Cpu.requests(&tables, TracerKind::Path));
        }
        for request in requests {
            let counters = first_line(&residual_of(&scene, &tables, &request));
            let name = if request.name == "path" { b.name } else { &format!("  {}", request.name) };
            found += &format!("{name:<16}{}\n", counters.split_once(';').map_or("", |(_, c)| c));
        }
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("files/counters.txt");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&file, &found).expect("the golden can be written");
    }
    let golden = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(golden == found, "the counters changed; if they should, BLESS=1 rewrites {}:\n{found}", file.display());
}
