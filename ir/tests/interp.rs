//! The interpreter on small programs whose results are plain.

use jerboa_ir::interp::{Interp, Limits, Memory, Observer, Stop, run};
use jerboa_ir::*;

const HERE: Loc = Loc { file: "test.rs", line: 7 };

fn cont(w: &mut World, name: &str, role: Role, types: &[Ty]) -> (ContId, Vec<NodeId>) {
    let params = types.iter().map(|t| Param { ty: *t, name: None, keep: false }).collect();
    let cont = w.cont(name, role, params, HERE);
    (cont, w.params(cont))
}

fn jump(w: &mut World, from: ContId, callee: NodeId, args: &[NodeId]) {
    w.set_body(from, Body::Jump { callee, args: args.to_vec(), mode: Mode::Filter }, HERE);
}

fn arm(w: &mut World, callee: NodeId, args: &[NodeId]) -> NodeId {
    let (arm, _) = cont(w, "arm", Role::Arm, &[]);
    jump(w, arm, callee, args);
    w.cont_value(arm)
}

fn u(w: &mut World, x: u32) -> NodeId {
    w.lit(Lit::U32(x))
}

fn ret_u32() -> Ty {
    Ty::func(&[Ty::u32()])
}

/// sum(n, ret) = 0 + 1 + … + (n − 1), by a loop.
fn sum() -> (World, ContId) {
    let mut w = World::new();
    let (f, p) = cont(&mut w, "sum", Role::Fun, &[Ty::u32(), ret_u32()]);
    let (head, s) = cont(&mut w, "head", Role::Loop, &[Ty::u32(), Ty::u32()]);
    let (zero, one, again) = (u(&mut w, 0), u(&mut w, 1), w.cont_value(head));
    jump(&mut w, f, again, &[zero, zero]);
    let more = w.prim(Op::Lt, &[s[0], p[0]], HERE);
    let (i, acc) = (w.prim(Op::Add, &[s[0], one], HERE), w.prim(Op::Add, &[s[1], s[0]], HERE));
    let (then, other) = (arm(&mut w, again, &[i, acc]), arm(&mut w, p[1], &[s[1]]));
    w.set_body(head, Body::Branch { cond: more, then, other }, HERE);
    (w, f)
}

/// down(n, ret) = n = 0 ? 0 : down(n − 1) + 1, which is not a tail call.
fn down() -> (World, ContId) {
    let mut w = World::new();
    let (f, p) = cont(&mut w, "down", Role::Fun, &[Ty::u32(), ret_u32()]);
    let (rest, r) = cont(&mut w, "rest", Role::Rest, &[Ty::u32()]);
    let (zero, one) = (u(&mut w, 0), u(&mut w, 1));
    let (less, more) = (w.prim(Op::Sub, &[p[0], one], HERE), w.prim(Op::Add, &[r[0], one], HERE));
    jump(&mut w, rest, p[1], &[more]);
    let (me, back) = (w.cont_value(f), w.cont_value(rest));
    let cond = w.prim(Op::Eq, &[p[0], zero], HERE);
    let (then, other) = (arm(&mut w, p[1], &[zero]), arm(&mut w, me, &[less, back]));
    w.set_body(f, Body::Branch { cond, then, other }, HERE);
    (w, f)
}

fn result(p: &Program, f: ContId, args: &[Lit]) -> Result<Vec<Lit>, Stop> {
    run(p, f, args, &mut [], Limits::default())
}

#[test]
fn a_long_loop_runs_in_bounded_memory() {
    let (w, f) = sum();
    let limits = Limits { fuel: u64::MAX, cells: 1000 };
    let n = 300_000u32;
    let expected = (0..n).fold(0u32, |a, i| a.wrapping_add(i));
    assert_eq!(run(w.program(), f, &[Lit::U32(n)], &mut [], limits), Ok(vec![Lit::U32(expected)]));
}

#[test]
fn limits_stop_a_run() {
    let (w, f) = sum();
    let fuel = Limits { fuel: 100, ..Limits::default() };
    assert_eq!(run(w.program(), f, &[Lit::U32(1000)], &mut [], fuel), Err(Stop::Fuel));
    let (w, f) = down();
    assert_eq!(result(w.program(), f, &[Lit::U32(100_000)]), Ok(vec![Lit::U32(100_000)]));
    let cells = Limits { cells: 1000, ..Limits::default() };
    assert_eq!(run(w.program(), f, &[Lit::U32(100_000)], &mut [], cells), Err(Stop::Limit));
}

#[test]
fn a_deep_chain_of_nodes_needs_no_stack() {
    let mut w = World::new();
    let (f, p) = cont(&mut w, "chain", Role::Fun, &[Ty::u32(), ret_u32()]);
    let mut x = p[0];
    for _ in 0..100_000 {
        x = w.prim(Op::Add, &[x, p[0]], HERE);
    }
    jump(&mut w, f, p[1], &[x]);
    assert_eq!(result(w.program(), f, &[Lit::U32(3)]), Ok(vec![Lit::U32(300_003)]));
}

/// twice(g)(x) = g(g(x)) with g = (+ captured): closures in tuples, and frames that outlive the jump that made them.
#[test]
fn closures_remember_their_frame() {
    let mut w = World::new();
    let fun = Ty::func(&[Ty::u32(), ret_u32()]);
    let (twice, t) = cont(&mut w, "twice", Role::Fun, &[Ty::tuple(&[fun, Ty::u32()]), ret_u32()]);
    let (g, x) = (w.extract(t[0], 0, HERE), w.extract(t[0], 1, HERE));
    let (once, o) = cont(&mut w, "once", Role::Rest, &[Ty::u32()]);
    jump(&mut w, once, g, &[o[0], t[1]]);
    let back = w.cont_value(once);
    jump(&mut w, twice, g, &[x, back]);
    let (main, m) = cont(&mut w, "main", Role::Fun, &[Ty::u32(), Ty::u32(), ret_u32()]);
    let (plus, p) = cont(&mut w, "plus", Role::Fun, &[Ty::u32(), ret_u32()]);
    let sum = w.prim(Op::Add, &[p[0], m[0]], HERE);
    jump(&mut w, plus, p[1], &[sum]);
    let plus = w.cont_value(plus);
    let (pair, callee) = (w.tuple(&[plus, m[1]], HERE), w.cont_value(twice));
    jump(&mut w, main, callee, &[pair, m[2]]);
    assert_eq!(result(w.program(), main, &[Lit::U32(5), Lit::U32(100)]), Ok(vec![Lit::U32(110)]));
}

fn column(buf: BufId) -> Column {
    Column { buf, col: 0 }
}

fn buffer(w: &mut World, name: &str, kind: BufKind) -> BufId {
    let decl = ColumnDecl { name: "x".into(), ty: ColTy::Scalar(Scalar::F32), time: Time::Bulk };
    w.buffer(Buffer { name: name.into(), kind, layout: Layout::Rows, columns: vec![decl] })
}

#[test]
fn memory_clamps_loads_drops_stores_and_faults_where_unchecked() {
    let mut w = World::new();
    let table = buffer(&mut w, "table", BufKind::Table { classed: false });
    let stream = buffer(&mut w, "stream", BufKind::Stream);
    let (f, p) = cont(&mut w, "f", Role::Fun, &[Ty::u32(), Ty::func(&[Ty::f32(), Ty::f32()])]);
    let read = w.read(column(table), p[0], HERE);
    let (stored, _) = cont(&mut w, "stored", Role::Rest, &[]);
    let (loaded, l) = cont(&mut w, "loaded", Role::Rest, &[Ty::f32()]);
    let (next, after) = (w.cont_value(stored), w.cont_value(loaded));
    w.set_body(
        f,
        Body::Store { mem: Mem::Stream(column(stream)), index: p[0], value: read, mask: NodeId::NONE, next },
        HERE,
    );
    w.set_body(stored, Body::Load { mem: Mem::Stream(column(stream)), index: p[0], next: after }, HERE);
    jump(&mut w, loaded, p[1], &[read, l[0]]);
    let (check, c) = cont(&mut w, "check", Role::Fun, &[Ty::u32(), Ty::func(&[Ty::f32()])]);
    w.set_body(check, Body::Load { mem: Mem::Unchecked(column(table)), index: c[0], next: c[1] }, HERE);
    let words = |xs: &[f32]| Memory { rows: xs.len() as u32, words: xs.iter().map(|x| x.to_bits()).collect() };
    let lits = |xs: &[f32]| xs.iter().map(|x| Lit::f32(*x)).collect::<Vec<_>>();
    let mut memory = [words(&[1.0, 2.0, 3.0]), words(&[0.0, 0.5])];
    let run = |f, i, memory: &mut [Memory]| run(w.program(), f, &[Lit::U32(i)], memory, Limits::default());
    assert_eq!(run(f, 9, &mut memory), Ok(lits(&[3.0, 0.5])));
    assert_eq!(memory[1], words(&[0.0, 0.5]));
    assert_eq!(run(f, 0, &mut memory), Ok(lits(&[1.0, 1.0])));
    assert_eq!(memory[1], words(&[1.0, 0.5]));
    assert_eq!(run(check, 2, &mut memory), Ok(lits(&[3.0])));
    let message = "unchecked read of `table` at 3, which has 3 rows".to_string();
    assert_eq!(run(check, 3, &mut memory), Err(Stop::Fault { loc: HERE, message }));
    memory[1] = words(&[]);
    assert_eq!(run(f, 0, &mut memory), Ok(lits(&[1.0, 0.0])));
}

#[test]
fn local_arrays_are_zero_each_time() {
    let mut w = World::new();
    let (f, p) = cont(&mut w, "f", Role::Fun, &[Ty::u32(), ret_u32()]);
    let (made, a) = cont(&mut w, "made", Role::Rest, &[Ty::local(Scalar::U32, 3)]);
    let (loaded, l) = cont(&mut w, "loaded", Role::Rest, &[Ty::u32()]);
    let (stored, _) = cont(&mut w, "stored", Role::Rest, &[]);
    let [after_made, after_load, after_store] = [made, loaded, stored].map(|c| w.cont_value(c));
    w.set_body(f, Body::Local { scalar: Scalar::U32, len: 3, next: after_made }, HERE);
    w.set_body(made, Body::Load { mem: Mem::Local(a[0]), index: p[0], next: after_load }, HERE);
    let one = u(&mut w, 1);
    let more = w.prim(Op::Add, &[l[0], one], HERE);
    w.set_body(
        loaded,
        Body::Store { mem: Mem::Local(a[0]), index: p[0], value: more, mask: NodeId::NONE, next: after_store },
        HERE,
    );
    w.set_body(stored, Body::Load { mem: Mem::Local(a[0]), index: p[0], next: p[1] }, HERE);
    let interp = Interp::new(w.program());
    for (index, expected) in [(0, 1), (0, 1), (2, 1), (3, 0)] {
        let result = interp.run(f, &[Lit::U32(index)], &mut [], Limits::default());
        assert_eq!(result, Ok(vec![Lit::U32(expected)]), "at {index}");
    }
}

#[test]
fn vectors_work_lane_by_lane() {
    let mut w = World::new();
    let v = Ty::vector(Scalar::I32, 3);
    let (f, p) = cont(&mut w, "f", Role::Fun, &[v, v, Ty::func(&[v, Ty::u32()])]);
    let (sum, less) = (w.prim(Op::Add, &[p[0], p[1]], HERE), w.prim(Op::Lt, &[p[0], p[1]], HERE));
    let ballot = w.prim(Op::Ballot, &[less], HERE);
    jump(&mut w, f, p[2], &[sum, ballot]);
    let args = [1, 5, 3, 2, 4, 4].map(Lit::I32);
    let expected = vec![Lit::I32(3), Lit::I32(9), Lit::I32(7), Lit::U32(0b101)];
    assert_eq!(result(w.program(), f, &args), Ok(expected));
    assert!(matches!(result(w.program(), f, &args[1..]), Err(Stop::Fault { .. })));
}

#[test]
fn an_observer_sees_what_is_evaluated_and_nothing_else() {
    #[derive(Default)]
    struct Log(Vec<ContId>, Vec<Lit>);
    impl Observer for Log {
        fn enter(&mut self, cont: ContId) {
            self.0.push(cont);
        }
        fn value(&mut self, _: NodeId, lit: Lit) {
            self.1.push(lit);
        }
    }
    let mut w = World::new();
    let (f, p) = cont(&mut w, "f", Role::Fun, &[Ty::f32(), Ty::func(&[Ty::f32()])]);
    let root = w.prim(Op::Sqrt, &[p[0]], HERE);
    w.prim(Op::Floor, &[p[0]], HERE);
    jump(&mut w, f, p[1], &[root]);
    let mut log = Log::default();
    let result = Interp::new(w.program()).run_observed(f, &[Lit::f32(-1.0)], &mut [], Limits::default(), &mut log);
    assert_eq!(result, Ok(vec![Lit::F32(NAN_BITS)]));
    assert_eq!((log.0, log.1), (vec![f], vec![Lit::f32(-1.0), Lit::F32(NAN_BITS)]));
}
