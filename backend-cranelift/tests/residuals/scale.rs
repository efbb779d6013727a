//! Big programs, many programs, many threads.

use jerboa_backend_cranelift::{Code, Opt, Options, compile};
use jerboa_ir::interp::Memory;
use jerboa_ir::*;
use rayon::prelude::*;

use crate::build::{Build, agree, code, run};

/// x → (…((x · 3 + 1) ^ x) · 3 + 1…), a chain of so many nodes in one block.
fn chain(nodes: usize) -> Program {
    let mut b = Build::default();
    let f = b.entry("f", &[Ty::u32()], &[Ty::u32()]);
    let x = b.param(f, 0);
    let (one, three) = (b.u32(1), b.u32(3));
    let mut y = x;
    for i in 0..nodes {
        let (op, z) = [(Op::Mul, three), (Op::Add, one), (Op::Xor, x)][i % 3];
        y = b.op(op, &[y, z]);
    }
    b.ret(f, f, &[y]);
    b.finish()
}

#[test]
fn a_chain_of_100_000_nodes() {
    let p = chain(100_000);
    let y = (0..100_000).fold(7u32, |y, i| [y.wrapping_mul(3), y.wrapping_add(1), y ^ 7][i % 3]);
    assert_eq!(run(&code(&p, Opt::None), "f", &[Lit::U32(7)], &mut []), Ok(vec![y]));
}

#[test]
fn a_chain_of_3_000_loads_and_branches() {
    // Each step loads, and goes on in one of two arms that meet again; some arms leave to one exit. Cranelift's register
    // allocator is quadratic in such chains: 40,000 blocks take it 1.6 s, these 12,000 a tenth of that.
    let mut b = Build::default();
    let s = b.buffer(BufKind::Stream, Layout::Columns, &[Scalar::U32]);
    let mem = Mem::Stream(Column { buf: s, col: 0 });
    let f = b.entry("f", &[Ty::u32()], &[Ty::u32()]);
    let x = b.param(f, 0);
    let exit = b.block(&[Ty::u32()]);
    let (mut at, mut sum) = (f, x);
    for i in 0..3_000 {
        let (got, even, odd, next) = (b.block(&[Ty::u32()]), b.block(&[]), b.block(&[]), b.block(&[Ty::u32()]));
        let index = b.u32(i % 7);
        b.load(at, mem, index, got);
        let loaded = b.param(got, 0);
        let total = b.op(Op::Add, &[sum, loaded]);
        let small = b.op(Op::Lt, &[total, x]);
        b.branch(got, small, even, odd);
        b.jump(even, next, &[loaded]);
        b.jump(odd, if i % 100 == 99 { exit } else { next }, &[total]);
        (at, sum) = (next, b.param(next, 0));
    }
    b.jump(at, exit, &[sum]);
    let result = b.param(exit, 0);
    b.ret(exit, f, &[result]);
    let memory = Memory { rows: 5, words: vec![3, 1, 4, 1, 5] };
    agree(&b.finish(), "f", &[Lit::U32(1000)], &[memory]);
}

#[test]
fn a_block_of_2_000_parameters_and_a_switch_of_5_000_arms() {
    let mut b = Build::default();
    let f = b.entry("f", &[Ty::u32(), Ty::u32()], &[Ty::u32()]);
    let (n, arm) = (b.param(f, 0), b.param(f, 1));
    let header = b.block(&[Ty::u32(); 2000]);
    let start: Vec<NodeId> = (0..2000).map(|i| b.u32(i)).collect();
    b.jump(f, header, &start);
    // Parameter 0 counts the rounds, the others rotate.
    let (step, done) = (b.block(&[]), b.block(&[]));
    let params = b.w.params(header);
    let more = b.op(Op::Lt, &[params[0], n]);
    b.branch(header, more, step, done);
    let one = b.u32(1);
    let round = b.op(Op::Add, &[params[0], one]);
    let rotated: Vec<NodeId> = [&[round], &params[2..], &params[1..2]].concat();
    b.jump(step, header, &rotated);
    let arms: Vec<(u32, NodeId)> = (0..5000)
        .map(|i| {
            let block = b.block(&[]);
            let extra = b.u32(i);
            let sum = b.op(Op::Add, &[params[1 + i as usize % 1999], extra]);
            b.ret(block, f, &[sum]);
            (i * 3, b.value(block))
        })
        .collect();
    let default = arms[0].1;
    b.body(done, Body::Switch { index: arm, arms, default });
    let p = b.finish();
    for (n, arm) in [(0, 0), (5, 3 * 1999), (3, 4), (1, 3 * 4999)] {
        agree(&p, "f", &[Lit::U32(n), Lit::U32(arm)], &[]);
    }
}

#[test]
fn kernels_are_compiled_and_run_in_parallel() {
    let programs: Vec<Program> = (1..40)
        .map(|i| {
            let mut b = Build::default();
            for k in 0..2 {
                let f = b.entry(&format!("f{i}.{k}"), &[Ty::u32()], &[Ty::u32()]);
                let (x, factor) = (b.param(f, 0), b.u32(i + k));
                let y = b.op(Op::Mul, &[x, factor]);
                b.ret(f, f, &[y]);
            }
            b.finish()
        })
        .collect();
    let code: Code = compile(&programs.iter().collect::<Vec<_>>(), &Options::default()).expect("they are valid");
    assert_eq!(code.reports().count(), 78);
    (0..2000u32).into_par_iter().for_each(|x| {
        let (i, k) = (x % 39 + 1, x % 2);
        assert_eq!(run(&code, &format!("f{i}.{k}"), &[Lit::U32(x)], &mut []), Ok(vec![x * (i + k)]));
    });
    assert!(code.kernel("f0.0").is_none());
}

#[test]
fn dumps_are_made_when_asked_for() {
    let p = chain(3);
    let make = |dumps| compile(&[&p], &Options { dumps, ..Options::default() }).expect("it is valid");
    let (silent, chatty) = (make(false), make(true));
    assert_eq!((silent.clif("f"), silent.asm("f"), chatty.clif("g")), (None, None, None));
    let clif = chatty.clif("f").expect("it was asked for");
    assert!(clif.contains("imul") && clif.contains("bxor"), "{clif}");
    let asm = chatty.asm("f").expect("it was asked for");
    assert!(asm.contains("imul") && asm.contains("ret"), "{asm}");
    let report = chatty.reports().next().expect("there is one kernel");
    assert!(report.name == "f" && report.instructions > 3 && report.code_bytes > 10 && report.functions == 2);
}
