//! The tree of a function goes where its control flow graph goes, for random decisions: over residuals of random programs,
//! over random graphs, and over all kernels of the renderer. And no block stands in it twice.

use jerboa_ir::Program;
use jerboa_ir::cfg::{Cfg, Function};
use jerboa_ir::structure::{Step, structure};
use jerboa_lib_render::host::device::DeviceKind;
use jerboa_lib_render::host::generate::{Keep, TracerKind, residual};
use jerboa_lib_render::host::tables::{Choices as Chosen, Known, Tables};
use jerboa_peval::{Arg, Facts, Generic, Options, specialize};
use jerboa_scenes::{Scene, builtin};
use jerboa_tests::choices::{Choices, Rng};
use jerboa_tests::{graphs, programs};

/// Random programs of a run in the test command.
const PROGRAMS: u64 = 1000;

/// Walks of each function, and blocks of a walk at most.
const WALKS: u64 = 16;
const BLOCKS: usize = 400;

/// A sequence under way, and what its end does.
struct Frame<'t> {
    steps: &'t [Step],
    at: usize,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Arm,
    Label(u32),
    Loop(u32),
}

/// The blocks that a tree visits, for decisions from a seed.
fn walk_tree(f: &Function, tree: &[Step], rng: &mut Rng) -> Vec<u32> {
    let mut visited = Vec::new();
    let mut frames = vec![Frame { steps: tree, at: 0, kind: Kind::Arm }];
    while let Some(frame) = frames.last_mut() {
        let Some(step) = frame.steps.get(frame.at) else {
            match frame.kind {
                Kind::Loop(_) => frame.at = 0,
                _ => _ = frames.pop(),
            }
            continue;
        };
        frame.at += 1;
        let mut push = |steps, kind| frames.push(Frame { steps, at: 0, kind });
        match step {
            Step::Block(block) => visited.push(*block),
            Step::Choice { block, arms } => {
                visited.push(*block);
                push(&arms[rng.below(arms.len() as u32) as usize], Kind::Arm);
            }
            Step::Label { join, body } => push(body, Kind::Label(*join)),
            Step::Loop { header, body } => push(body, Kind::Loop(*header)),
            Step::Break(join) => {
                while frames.pop().expect("a label is around its breaks").kind != Kind::Label(*join) {}
            }
            Step::Continue(header) => {
                while frames.last().expect("a loop is around its continues").kind != Kind::Loop(*header) {
                    frames.pop();
                }
                frames.last_mut().expect("it is there").at = 0;
            }
        }
        let returned = visited.last().is_some_and(|block| f.blocks[*block as usize].succs.is_empty());
        if returned || visited.len() >= BLOCKS {
            break;
        }
    }
    visited
}

/// The blocks that the graph visits, for the same decisions.
fn walk_graph(f: &Function, rng: &mut Rng) -> Vec<u32> {
    let mut visited = vec![0];
    while let Some(at) = visited.last().filter(|_| visited.len() < BLOCKS) {
        let succs = &f.blocks[*at as usize].succs;
        match succs.len() {
            0 => break,
            1 => visited.push(succs[0]),
            n => visited.push(succs[rng.below(n as u32) as usize]),
        }
    }
    visited
}

/// How often each block stands in the tree.
fn count(steps: &[Step], times: &mut [u32]) {
    for step in steps {
        match step {
            Step::Block(block) => times[*block as usize] += 1,
            Step::Choice { block, arms } => {
                times[*block as usize] += 1;
                arms.iter().for_each(|arm| count(arm, times));
            }
            Step::Label { body, .. } | Step::Loop { body, .. } => count(body, times),
            Step::Break(_) | Step::Continue(_) => {}
        }
    }
}

/// Check all functions of a residual; gives the number of blocks.
fn check(p: &Program, seed: u64) -> usize {
    let entries: Vec<_> = p.entries.iter().map(|(_, cont)| *cont).collect();
    let cfg = Cfg::new(p, &entries).expect("a residual is first-order");
    for f in &cfg.functions {
        let tree = structure(p, f).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{}", jerboa_ir::print(p)));
        let mut times = vec![0; f.blocks.len()];
        count(&tree, &mut times);
        assert!(times.iter().all(|n| *n == 1), "seed {seed}: blocks stand {times:?} times in\n{tree:#?}");
        for walk in 0..WALKS {
            let seed = seed << 8 | walk;
            let (by_tree, by_graph) = (walk_tree(f, &tree, &mut Rng(seed)), walk_graph(f, &mut Rng(seed)));
            assert_eq!(by_tree, by_graph, "walk {seed} of `{}`: the tree\n{tree:#?}", p.cont(f.cont).name);
        }
    }
    cfg.functions.iter().map(|f| f.blocks.len()).sum()
}

#[test]
fn trees_of_random_programs_go_where_the_graph_goes() {
    let mut blocks = 0;
    for seed in 0..PROGRAMS {
        let case = programs::case(&mut Choices::random(seed));
        let args = vec![Arg::Unknown; case.params().len()];
        let generic = Generic::new(case.program);
        let Ok(residual) = specialize(&generic, "main", &args, &Facts::none(), &Options::default()) else { continue };
        blocks += check(&residual.program, seed);
    }
    assert!(blocks > 4000, "only {blocks} blocks");
}

#[test]
fn trees_of_random_graphs_go_where_the_graph_goes() {
    let mut blocks = 0;
    for seed in 0..PROGRAMS {
        blocks += check(&graphs::case(&mut Choices::random(seed)).program, seed);
    }
    assert!(blocks > 50_000, "only {blocks} blocks");
}

#[test]
fn trees_of_kernels_go_where_the_graph_goes() {
    let check_scene = |name: &str, known: Known, kinds: &[TracerKind]| {
        let scene = Scene::load(format!("builtin:{name}")).unwrap_or_else(|e| panic!("{name}: {e}"));
        let tables = Tables::new(&scene, &Chosen::default(), known);
        for kind in kinds {
            for request in DeviceKind::ALL.iter().flat_map(|d| d.requests(&tables, *kind)) {
                let kernel = residual(&tables, &request, Keep::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
                check(&kernel.program, 0);
            }
        }
    };
    builtin::list().iter().for_each(|b| check_scene(b.name, Known::Structure, &[TracerKind::Path]));
    for known in [Known::Nothing, Known::Structure, Known::All] {
        check_scene("cornell-box", known, &TracerKind::ALL);
    }
}
