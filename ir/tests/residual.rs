//! The analyses of residuals: functions, loops, and where nodes are computed.

use jerboa_ir::cfg::{Call, Cfg};
use jerboa_ir::dom::DomTree;
use jerboa_ir::schedule::{Schedule, Scheduler, check};
use jerboa_ir::*;

fn residual(text: &str) -> Program {
    parse(&format!("jerboa-ir 1\n{text}")).unwrap_or_else(|e| panic!("{e}"))
}

fn analyse(p: &Program) -> Cfg {
    Cfg::new(p, &p.entries.iter().map(|(_, cont)| *cont).collect::<Vec<_>>()).unwrap_or_else(|e| panic!("{e}"))
}

/// The schedule of a program's first function.
struct Placed {
    p: Program,
    cfg: Cfg,
    schedule: Schedule,
}

fn placed(text: &str) -> Placed {
    let p = residual(text);
    let cfg = analyse(&p);
    let schedule = Scheduler::new(&p).function(&cfg.functions[0]);
    assert_eq!(check(&p, &cfg.functions[0], &schedule), [""; 0]);
    Placed { p, cfg, schedule }
}

impl Placed {
    /// The names of the blocks that compute the node of this name.
    fn blocks_of(&self, name: &str) -> Vec<&str> {
        let (node, _) = self.p.names.iter().find(|(_, n)| &***n == name).expect("a node has this name");
        let blocks = self.cfg.functions[0].blocks.iter().zip(&self.schedule.blocks);
        blocks.filter(|(_, nodes)| nodes.contains(node)).map(|(b, _)| &*self.p.cont(b.cont).name).collect()
    }
}

#[test]
fn calls_components_and_recursion() {
    let p = residual(
        "entry main = main
fun main(n: u32, return: fn(u32))
  jump even(n, back)
  rest back(r: u32)
    jump fact(r, return)
fun even(n: u32, return: fn(u32))
  jump odd(n, return)
fun odd(n: u32, return: fn(u32))
  jump even(n, return)
fun fact(n: u32, return: fn(u32))
  jump fact(n, rest)
  rest rest(r: u32)
    y = mul r n
    jump return(y)
",
    );
    let cfg = analyse(&p);
    let f = |name: &str| cfg.functions.iter().find(|f| &*p.cont(f.cont).name == name).expect("it is reached");
    let number = |name: &str| cfg.number[&f(name).cont];
    assert_eq!(cfg.functions.len(), 4);
    assert_eq!(cfg.functions[0].cont, p.entries[0].1);
    assert_eq!(
        f("main").calls,
        [Call { callee: number("even"), tail: false }, Call { callee: number("fact"), tail: true }]
    );
    // Tail calls alone make no recursion: one frame replaces the other.
    assert_eq!(["main", "even", "odd", "fact"].map(|n| f(n).recursive), [false, false, false, true]);
    assert_eq!(f("even").component, f("odd").component);
    assert!(f("main").component > f("even").component.max(f("fact").component));
}

#[test]
fn what_is_no_residual_is_an_error() {
    let higher_order = [
        ("fun f(g: fn(fn()), return: fn())\n  jump g(return)\n", "it takes a fn(fn())"),
        (
            "fun f(c: u32, return: fn())\n  jump x(return, c)\n    label x(k: fn(), i: u32)\n      jump k()\n",
            "it takes a fn()",
        ),
        (
            "fun f(c: u32, return: fn())\n  jump x(return)\n    fun x(k: fn())\n      jump return()\n",
            "not its function's",
        ),
        (
            "table t by rows\n  a: u32 bulk\nfun f(i: u32, return: fn())\n  r = row t i\n  dispatch r -> arm\n    \
          arm arm(s: row(t))\n      jump return()\n",
            "it dispatches",
        ),
    ];
    for (text, why) in higher_order {
        let (buffers, functions) = text.split_at(text.find("fun").expect("there is one"));
        let p = residual(&format!("{buffers}entry f = f\n{functions}"));
        let error = Cfg::new(&p, &[p.entries[0].1]).expect_err("it is no residual").to_string();
        assert!(error.contains(why) && error.contains("specialise"), "{error}");
    }
}

#[test]
fn invariants_leave_loops_and_the_rest_sinks() {
    let s = placed(
        "table t by rows
  a: f32 bulk
entry f = f
fun f(n: u32, x: f32, i: u32, return: fn(f32))
  unused_early = add x 1.0
  jump again(0u, 0.0)
    loop again(k: u32, sum: f32)
      more = lt k n
      branch more step done
        arm step()
          inverse = div 1.0 x
          table_value = read t.a i
          changing = read t.a k
          a = mul inverse table_value
          b = mul a changing
          sum2 = add sum b
          k2 = add k 1u
          jump again(k2, sum2)
        arm done()
          total = add sum unused_early
          jump return(total)
",
    );
    for invariant in ["inverse", "table_value", "a"] {
        assert_eq!(s.blocks_of(invariant), ["f"], "{invariant}");
    }
    assert_eq!(s.blocks_of("changing"), ["step"]);
    assert_eq!(s.blocks_of("more"), ["again"]);
    // Used after the loop only, where it costs nothing in the loop.
    assert_eq!(s.blocks_of("unused_early"), ["done"]);
}

#[test]
fn costly_nodes_stand_in_the_arms_that_use_them() {
    let s = placed(
        "entry f = f
fun f(c: u32, x: f32, y: f32, return: fn(f32))
  some = div x y
  all = sqrt x
  cheap = add x y
  switch c 0: one, 1: two, else three
    arm one()
      a = add some all
      a2 = add a cheap
      jump return(a2)
    arm two()
      b = mul some all
      b2 = mul b cheap
      jump return(b2)
    arm three()
      jump return(all)
",
    );
    let mut some = s.blocks_of("some");
    some.sort_unstable();
    assert_eq!(some, ["one", "two"]);
    assert_eq!((s.blocks_of("all"), s.blocks_of("cheap")), (vec!["f"], vec!["f"]));
}

#[test]
fn an_arm_with_a_loop_does_not_draw_a_division_into_it() {
    let s = placed(
        "entry f = f
fun f(c: bool, n: u32, x: f32, y: f32, return: fn(f32))
  q = div x y
  branch c looped straight
    arm straight()
      jump return(x)
    arm looped()
      jump again(0u, q)
        loop again(k: u32, sum: f32)
          more = lt k n
          branch more step done
            arm step()
              sum2 = add sum q
              k2 = add k 1u
              jump again(k2, sum2)
            arm done()
              jump return(sum)
",
    );
    assert_eq!(s.blocks_of("q"), ["looped"]);
}

/// A residual with a random control flow graph, loops and irreducible ones included, and random nodes. Place `k` is a
/// block that loads and one that gets the loaded value and switches; a node may use what dominates it.
fn random(seed: u64, places: usize) -> Program {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut random = |n: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % n
    };
    let mut succs: Vec<Vec<usize>> = vec![Vec::new(); places];
    for k in 1..places {
        // Mostly deep: chains make long ways.
        let parent = if random(4) > 0 { k - 1 } else { random(k) };
        succs[parent].push(k);
        let extra = random(3);
        (0..extra).for_each(|_| succs[k].push(1 + random(places - 1)));
    }
    // In reverse postorder, as the tree wants them.
    let mut order: Vec<usize> = Vec::new();
    let (mut seen, mut path) = (vec![false; places], vec![(0, 0)]);
    seen[0] = true;
    while let Some((k, next)) = path.last_mut() {
        match succs[*k].get(*next).copied() {
            Some(s) => {
                *next += 1;
                if !std::mem::replace(&mut seen[s], true) {
                    path.push((s, 0));
                }
            }
            None => {
                order.push(*k);
                path.pop();
            }
        }
    }
    order.reverse();
    let mut number = vec![0; places];
    order.iter().enumerate().for_each(|(i, k)| number[*k] = i as u32);
    let mut preds = vec![Vec::new(); places];
    order.iter().for_each(|k| succs[*k].iter().for_each(|s| preds[number[*s] as usize].push(number[*k])));
    let dom = DomTree::new(&preds);

    let mut w = World::new();
    let column = ColumnDecl { name: "x".into(), ty: ColTy::Scalar(Scalar::U32), time: Time::Bulk };
    let kinds = [BufKind::Stream, BufKind::Table { classed: false }];
    let buffers = kinds
        .map(|kind| w.buffer(Buffer { name: "b".into(), kind, layout: Layout::Rows, columns: vec![column.clone()] }));
    let columns = buffers.map(|buf| Column { buf, col: 0 });
    let cont = |w: &mut World, role: Role, types: &[Ty]| {
        let params = types.iter().map(|ty| Param { ty: *ty, name: None, keep: false }).collect();
        w.cont("c", role, params, Loc::NONE)
    };
    let f = cont(&mut w, Role::Fun, &[Ty::u32(), Ty::func(&[Ty::u32()])]);
    w.entry("f", f);
    let heads: Vec<ContId> = (0..places).map(|_| cont(&mut w, Role::Join, &[])).collect();
    let rests: Vec<ContId> = (0..places).map(|_| cont(&mut w, Role::Rest, &[Ty::u32()])).collect();
    let first = w.cont_value(heads[0]);
    w.set_body(f, Body::Jump { callee: first, args: vec![], mode: Mode::Filter }, Loc::NONE);
    let (x, ret) = (w.param(f, 0), w.param(f, 1));
    // Nodes, and the place that they depend on most deeply.
    let mut pool: Vec<(NodeId, u32)> = vec![(x, 0)];
    for (at, k) in order.iter().map(|k| (number[*k], *k)) {
        // The head knows what the blocks above know.
        let above: Vec<(NodeId, u32)> = pool.iter().copied().filter(|(_, d)| dom.dominates(*d, at)).collect();
        let index = above[random(above.len())].0;
        let next = w.cont_value(rests[k]);
        w.set_body(heads[k], Body::Load { mem: Mem::Stream(columns[0]), index, next }, Loc::NONE);
        let mut known = above;
        known.push((w.param(rests[k], 0), at));
        for _ in 0..1 + random(6) {
            let ((a, da), (b, db)) = (known[random(known.len())], known[random(known.len())]);
            let node = match random(4) {
                0 => w.read(columns[1], a, Loc::NONE),
                n => w.prim([Op::Add, Op::Div, Op::Xor][n - 1], &[a, b], Loc::NONE),
            };
            known.push((node, if dom.depth(da) > dom.depth(db) { da } else { db }));
        }
        let picked = known[random(known.len())].0;
        pool.extend(known);
        pool.sort_unstable();
        pool.dedup();
        let body = if succs[k].is_empty() {
            Body::Jump { callee: ret, args: vec![picked], mode: Mode::Filter }
        } else {
            let targets: Vec<NodeId> = succs[k].iter().map(|s| w.cont_value(heads[*s])).collect();
            let arms = targets.iter().enumerate().map(|(i, t)| (i as u32, *t)).collect();
            Body::Switch { index: picked, arms, default: targets[0] }
        };
        w.set_body(rests[k], body, Loc::NONE);
    }
    w.finish()
}

#[test]
fn every_use_is_dominated_by_one_definition() {
    let mut copied = 0;
    for seed in 0..400 {
        let p = random(seed, 2 + seed as usize % 40);
        let cfg = analyse(&p);
        let f = &cfg.functions[0];
        let schedule = Scheduler::new(&p).function(f);
        assert_eq!(check(&p, f, &schedule), [""; 0], "seed {seed}");
        let mut nodes: Vec<NodeId> = schedule.blocks.concat();
        let all = nodes.len();
        nodes.sort_unstable();
        nodes.dedup();
        copied += all - nodes.len();
    }
    assert!(copied > 0, "no node stands in two arms: the test is too weak");
}

#[test]
fn a_scheduler_serves_many_functions() {
    let p = residual(
        "entry f = f
fun f(x: f32, return: fn(f32))
  shared = sqrt 2.5
  y = mul x x
  jump g(y, return)
fun g(x: f32, return: fn(f32))
  y = mul x x
  jump return(y)
",
    );
    let cfg = analyse(&p);
    let mut scheduler = Scheduler::new(&p);
    for f in cfg.functions.iter().chain(&cfg.functions) {
        assert_eq!(scheduler.function(f).blocks.concat().len(), 1);
    }
}

#[test]
fn a_deep_graph_of_100_000_nodes_in_20_000_blocks() {
    let mut w = World::new();
    let stream = w.buffer(Buffer {
        name: "s".into(),
        kind: BufKind::Stream,
        layout: Layout::Columns,
        columns: vec![ColumnDecl { name: "x".into(), ty: ColTy::Scalar(Scalar::U32), time: Time::Bulk }],
    });
    let mem = Mem::Stream(Column { buf: stream, col: 0 });
    let param = |ty| Param { ty, name: None, keep: false };
    let f = w.cont("f", Role::Fun, vec![param(Ty::u32()), param(Ty::func(&[Ty::u32()]))], Loc::NONE);
    let (x, ret) = (w.param(f, 0), w.param(f, 1));
    let (mut at, mut y) = (f, x);
    for _ in 0..20_000 {
        let next = w.cont("next", Role::Rest, vec![param(Ty::u32())], Loc::NONE);
        let next_value = w.cont_value(next);
        w.set_body(at, Body::Load { mem, index: x, next: next_value }, Loc::NONE);
        (at, y) = (next, w.prim(Op::Add, &[y, x], Loc::NONE));
        // Shared by two users at each step: 2^20000 paths.
        for op in [Op::Xor, Op::Div, Op::Mul, Op::Add] {
            let z = w.prim(Op::Sub, &[y, x], Loc::NONE);
            y = w.prim(op, &[y, z], Loc::NONE);
        }
    }
    let loaded = w.param(at, 0);
    let sum = w.prim(Op::Add, &[y, loaded], Loc::NONE);
    w.set_body(at, Body::Jump { callee: ret, args: vec![sum], mode: Mode::Filter }, Loc::NONE);
    w.entry("f", f);
    let p = w.finish();
    let cfg = analyse(&p);
    let schedule = Scheduler::new(&p).function(&cfg.functions[0]);
    assert_eq!(check(&p, &cfg.functions[0], &schedule), [""; 0]);
    // Only the last block needs any of it.
    assert!(schedule.blocks.last().is_some_and(|nodes| nodes.len() > 100_000));
}
