//! How kernels grow with a scene (T24): not with its materials, lights and textures, but with the structures among its
//! shaders, in proportion, up to a budget.
//!
//! JERBOA_SHADERS sets how many structures the proportion is looked at over, JERBOA_MANY how many rows of one structure
//! there are. With times: `cargo run --release -p jerboa-tests --bin compile`.

use jerboa_ir::hash::hash;
use jerboa_ir::print;
use jerboa_lib_render::host::device::{DeviceKind, MOST_CLASSES};
use jerboa_lib_render::host::film::Window;
use jerboa_lib_render::host::generate::{Keep, TracerKind, residual};
use jerboa_lib_render::host::renderer::{Options, Renderer};
use jerboa_lib_render::host::tables::light_tree::TREE_FROM;
use jerboa_lib_render::host::tables::{Choices, Known, Pass, Tables};
use jerboa_scenes::{Model, Scene};
use jerboa_tests::harness::bench::number;
use jerboa_tests::harness::many::{lights, line, materials, most_shaders, shaders, textures};

/// Kernels with their residuals' structural hashes and sizes in nodes.
fn residuals(scene: &Scene, known: Known) -> Vec<(String, u128, usize)> {
    let tables = Tables::new(scene, &Choices::default(), known);
    let requests = DeviceKind::Cpu.requests(&tables, TracerKind::Path);
    let made = requests.iter().map(|request| {
        let made = residual(&tables, request, Keep::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        (request.name.clone(), hash(&made.program), made.program.nodes.len())
    });
    made.collect()
}

fn nodes(kernels: &[(String, u128, usize)]) -> usize {
    kernels.iter().map(|(_, _, nodes)| nodes).sum()
}

/// Makes a scene with so many of something.
type Build = fn(usize) -> Scene;

#[test]
fn rows_of_one_structure_cost_nothing() {
    let many = number("JERBOA_MANY", 4096);
    // One light is a structure of its own, since nothing has to choose it, and so are those that have a tree.
    let kinds: [(&str, Build, &[usize]); 4] = [
        ("materials", materials, &[1, 2, 65, many]),
        ("lights", lights, &[2, 3, TREE_FROM - 1]),
        ("lights with a tree", lights, &[TREE_FROM, 65, many]),
        ("textures", textures, &[1, 2, 65, many]),
    ];
    for (what, build, counts) in kinds {
        let of_few = residuals(&build(counts[0]), Known::Structure);
        for n in &counts[1..] {
            assert!(residuals(&build(*n), Known::Structure) == of_few, "{n} {what} are not as {}", counts[0]);
        }
    }
}

/// Where all is known and there are more lights than a dispatch tells apart, it tells their kinds apart and no others.
#[test]
fn of_very_many_lights_their_kinds_are_known() {
    let scene = lights(MOST_CLASSES as usize + 1);
    let [structure, all] = [Known::Structure, Known::All].map(|known| nodes(&residuals(&scene, known)));
    println!("nodes: {structure} with structure known, {all} with all");
    assert!(all <= structure);
}

/// Also where a kernel does not know the material, there is no model in it that no material has.
#[test]
fn the_kernel_of_the_rest_has_the_models_of_the_scene_alone() {
    let rest = |scene: &Scene| {
        let tables = Tables::new(scene, &Choices::default(), Known::Structure);
        let request = DeviceKind::Cpu.requests(&tables, TracerKind::Path).pop().expect("there are kernels");
        assert_eq!(request.name, "shade");
        let made = residual(&tables, &request, Keep::default()).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        let text = print(&made.program);
        text[text.find("\nfun ").expect("a residual has a function")..].to_string()
    };
    let mut scene = shaders(MOST_CLASSES as usize + 1);
    let words = ["Materials.MODEL", "Parameters.VALUE", "Materials.FIRST", "Models.USED"];
    let text = rest(&scene);
    assert!(words.iter().all(|word| !text.contains(word)));
    scene.materials[0].model = Some(Model::named("phong"));
    let text = rest(&scene);
    assert_eq!(words.map(|word| text.contains(word)), [true, true, false, false]);
}

#[test]
fn kernels_grow_with_the_shaders() {
    let most = number("JERBOA_SHADERS", 32).min(MOST_CLASSES as usize);
    let mut sizes = [Vec::new(), Vec::new()];
    for n in (1..).map(|i| 1_usize << i).take_while(|n| *n <= most) {
        let renderer = Renderer::new(&shaders(n), Options::default()).unwrap_or_else(|e| panic!("{n} shaders: {e}"));
        let kernels = renderer.kernels();
        let mut shade: Vec<u128> = kernels.iter().skip(4).map(|k| hash(&k.residual.program)).collect();
        shade.sort_unstable();
        shade.dedup();
        assert_eq!(shade.len(), n, "a kernel for each structure");
        let bytes = kernels.iter().flat_map(|k| k.code.reports()).map(|r| r.code_bytes).sum::<usize>();
        let nodes = kernels.iter().map(|k| k.residual.program.nodes.len()).sum::<usize>();
        println!("{n} shaders: {nodes} nodes, {bytes} bytes of code");
        sizes[0].push((n as f64, nodes as f64));
        sizes[1].push((n as f64, bytes as f64));
    }
    for (what, points) in ["nodes", "bytes"].iter().zip(&sizes) {
        let (slope, start, share) = line(points);
        println!("{what}: {slope:.0} a shader, {start:.0} besides, R² {share:.4}");
        assert!(share >= 0.98, "{what} do not lie on a line: {points:?}");
    }
}

/// Above the budget of kernels the last one reads what it needs to know, so nothing grows any more.
#[test]
fn above_the_budget_nothing_grows() {
    let budget = MOST_CLASSES as usize;
    let all = most_shaders();
    assert!(all > budget + 64, "{all} structures");
    let [full, above, most] = [budget, budget + 1, all].map(|n| residuals(&shaders(n), Known::Structure));
    let names = |kernels: &[(String, u128, usize)]| kernels.iter().map(|k| k.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&above), names(&most));
    assert_eq!((full.len(), above.len()), (4 + budget, 4 + budget));
    assert_eq!(names(&above).last().map(String::as_str), Some("shade"));
    println!("nodes: {} at the budget, {} above, {} far above", nodes(&full), nodes(&above), nodes(&most));
    assert!(nodes(&above) as f64 <= 1.3 * nodes(&full) as f64);
    assert!(nodes(&most) as f64 <= 1.3 * nodes(&full) as f64);
}

/// At level `all` every number makes a class; if that is too many, the renderer is specialised for their structures.
#[test]
fn too_many_numbers_leave_their_structure() {
    let (few, many) = (materials(3), materials(4096));
    assert_eq!(residuals(&few, Known::All).len(), 4 + 3);
    let all = residuals(&many, Known::All);
    assert!(all == residuals(&many, Known::Structure));
}

#[test]
fn above_the_budget_the_image_is_the_same() {
    let scene = shaders(MOST_CLASSES as usize + 6);
    let size = [24, 24];
    let samples = |options: Options| {
        let pass = Pass { size, window: Window { x: 0, y: 0, width: 24, height: 24 }, sample: 0, samples: 2, seed: 7 };
        let renderer = Renderer::new(&scene, options).unwrap_or_else(|e| panic!("{e}"));
        renderer.samples(&scene.camera_or_default(), &pass).unwrap_or_else(|e| panic!("{e}"))
    };
    let expected = samples(Options { known: Known::Nothing, device: DeviceKind::CpuScalar, ..Options::default() });
    assert!(samples(Options::default()) == expected);
    assert!(samples(Options { known: Known::Nothing, ..Options::default() }) == expected);
}
