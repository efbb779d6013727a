//! Vectors: operands that are constants, lanes that move, lanes that are not there.

use jerboa_backend_cranelift::Opt;
use jerboa_ir::op::Rule;
use jerboa_ir::*;

use crate::build::{Build, agree, code, run};
use crate::ops::{operands, special};

/// One operand of each operation is the same literal in every lane, or another literal in each lane: what is known of it
/// must not change the result. The kernel returns a vector for each literal.
#[test]
fn operations_with_an_operand_of_literals() {
    const LANES: usize = 5;
    for &op in Op::ALL.iter().filter(|op| !matches!(op.rule(), Rule::Lanes(_))) {
        for &main in op.scalars() {
            let scalars = operands(op, main);
            for position in 0..scalars.len() {
                let known = special(scalars[position]);
                let shifted = |i: usize| (0..LANES).map(|l| known[(i + l) % known.len()]).collect::<Vec<_>>();
                let splats = known.iter().map(|x| vec![*x; LANES]);
                let known: Vec<Vec<Lit>> = splats.chain((0..known.len()).map(shifted)).collect();
                let p = program(op, &scalars, position, &known);
                let code = code(&p, Opt::None);
                for start in 0..8 {
                    let mut args: Vec<Vec<Lit>> = (scalars.iter().enumerate())
                        .map(|(i, s)| special(*s).into_iter().cycle().skip(start * (2 * i + 5)).take(LANES).collect())
                        .collect();
                    let words = run(&code, "f", &args.concat(), &mut []).expect("it ends");
                    for (known, words) in known.iter().zip(words.chunks(LANES)) {
                        args[position].clone_from(known);
                        for (lane, word) in words.iter().enumerate() {
                            let expected = op.eval(&args.iter().map(|a| a[lane]).collect::<Vec<_>>());
                            assert_eq!(Lit::from_word(expected.scalar(), *word), expected, "{} {args:?}", op.name());
                        }
                    }
                }
            }
        }
    }
}

/// The operation, once for each of these vectors as the operand at `position`.
fn program(op: Op, scalars: &[Scalar], position: usize, known: &[Vec<Lit>]) -> Program {
    let mut b = Build::default();
    let types: Vec<Ty> = scalars.iter().map(|s| Ty::vector(*s, known[0].len())).collect();
    let result = op.result(&types).expect("the operands fit");
    let f = b.entry("f", &types, &vec![result; known.len()]);
    let mut args: Vec<NodeId> = (0..types.len()).map(|i| b.param(f, i)).collect();
    let mut results = Vec::new();
    for lanes in known {
        let lanes: Vec<NodeId> = lanes.iter().map(|x| b.w.lit(*x)).collect();
        args[position] = b.w.pack(&lanes, Loc::NONE);
        // As it stands: with one operand only, construction would fold it.
        let mut padded = [NodeId::NONE; 3];
        padded[..args.len()].copy_from_slice(&args);
        results.push(b.w.node(Node::Prim { op, args: padded }, result, Loc::NONE));
    }
    b.ret(f, f, &results);
    b.finish()
}

/// Lanes of up to three vectors, a scalar and a literal, in every order that some steps reach.
#[test]
fn lanes_go_anywhere() {
    for scalar in Scalar::ALL {
        for lanes in [2, 3, 4, 5, 8, 16] {
            let mut b = Build::default();
            let vector = Ty::vector(scalar, lanes);
            let (short, results) = (Ty::vector(scalar, 4), 12);
            let f = b.entry("f", &[vector, vector, short, Ty::scalar(scalar)], &vec![vector; results]);
            let params: Vec<NodeId> = (0..4).map(|i| b.param(f, i)).collect();
            let mut pool: Vec<NodeId> = (0..lanes).map(|l| b.w.lane(params[0], l, Loc::NONE)).collect();
            pool.extend((0..lanes).map(|l| b.w.lane(params[1], l, Loc::NONE)));
            pool.extend((0..4).map(|l| b.w.lane(params[2], l, Loc::NONE)));
            pool.push(params[3]);
            pool.push(b.w.lit(special(scalar)[1]));
            let mut packed = Vec::new();
            for r in 0..results {
                // Lanes in order and backwards, then strides through one vector, two, and all that there is.
                let source = |l: usize| match r {
                    0 => l / 4 * 4 + 3 - l % 4,
                    1 => lanes - 1,
                    2 => l / 2,
                    3 => l / 2 + l % 2 * lanes,
                    4 => l % 2 * lanes + l,
                    5 => 2 * lanes + l % 4,
                    _ => l * (r - 4) + r,
                };
                let elems: Vec<NodeId> = (0..lanes).map(|l| pool[source(l) % pool.len()]).collect();
                packed.push(b.w.pack(&elems, Loc::NONE));
            }
            b.ret(f, f, &packed);
            let p = b.finish();
            let values = special(scalar);
            let args: Vec<Lit> = (0..2 * lanes + 5).map(|i| values[(i * 3 + 1) % values.len()]).collect();
            agree(&p, "f", &args, &[]);
        }
    }
}

/// Computation fills the lanes that are not there with anything; `any`, `all` and `ballot` do not see them.
#[test]
fn lanes_that_are_not_there_do_not_count() {
    for lanes in 2..=16 {
        let mut b = Build::default();
        let mask = Ty::vector(Scalar::Bool, lanes);
        let results = [Ty::bool(), Ty::bool(), Ty::u32()];
        let f = b.entry("f", &[mask, Ty::bool()], &[results, results, results].concat());
        let (m, x) = (b.param(f, 0), b.param(f, 1));
        let splat = b.w.pack(&vec![x; lanes], Loc::NONE);
        let (not, or, and) = (b.op(Op::Not, &[m]), b.op(Op::Or, &[m, splat]), b.op(Op::And, &[m, splat]));
        let all: Vec<NodeId> =
            [not, or, and].into_iter().flat_map(|m| [Op::Any, Op::All, Op::Ballot].map(|op| b.op(op, &[m]))).collect();
        b.ret(f, f, &all);
        let p = b.finish();
        let ones = (1u32 << lanes) - 1;
        for bits in [0, ones, 1, ones ^ 1, 1 << (lanes - 1), ones >> 1] {
            for x in [false, true] {
                let args: Vec<Lit> = (0..lanes).map(|i| bits >> i & 1 == 1).chain([x]).map(Lit::Bool).collect();
                agree(&p, "f", &args, &[]);
            }
        }
    }
}

/// Clamps that put a float into the range of a conversion, just do, or do not, whatever the order of their operands.
#[test]
fn conversions_of_clamped_floats() {
    let mut b = Build::default();
    let ty = Ty::vector(Scalar::F32, 4);
    let to = |scalar| Ty::vector(scalar, 4);
    let mut kinds = Vec::new();
    let mut results = Vec::new();
    let highs = [127.5, 2_147_483_520.0, 2_147_483_648.0, f32::INFINITY];
    let lows = [0.0, -0.99, -1.0, -2_147_483_648.0, -2_147_483_904.0];
    let f = b.cont("f", Role::Fun, &[ty, to(Scalar::U32)]);
    let (x, bits) = (b.param(f, 0), b.param(f, 1));
    let splat = |b: &mut Build, lit: Lit| {
        let lit = b.w.lit(lit);
        b.w.pack(&[lit; 4], Loc::NONE)
    };
    for (high, low) in highs.iter().flat_map(|h| lows.iter().map(move |l| (*h, *l))) {
        let (high, low) = (splat(&mut b, Lit::f32(high)), splat(&mut b, Lit::f32(low)));
        let inner = b.op(Op::Min, &[x, high]);
        let both = b.op(Op::Max, &[inner, low]);
        let inner = b.op(Op::Min, &[high, x]);
        let turned = b.op(Op::Max, &[low, inner]);
        let floor = b.op(Op::Floor, &[both]);
        for clamped in [both, turned, floor, inner] {
            for (op, scalar) in [(Op::ToI32, Scalar::I32), (Op::ToU32, Scalar::U32), (Op::Bits, Scalar::U32)] {
                results.push(b.op(op, &[clamped]));
                kinds.push(to(scalar));
            }
        }
    }
    for (op, by) in [(Op::Shr, 1), (Op::Shr, 32), (Op::And, i32::MAX as u32), (Op::And, 1 << 31)] {
        let by = splat(&mut b, Lit::U32(by));
        let small = b.op(op, &[bits, by]);
        let float = b.op(Op::ToF32, &[small]);
        results.extend([float, b.op(Op::ToU32, &[float]), b.op(Op::ToI32, &[float])]);
        kinds.extend([ty, to(Scalar::U32), to(Scalar::I32)]);
    }
    // The function's return, whose type is known by now only.
    let entry = b.entry("entry", &[ty, to(Scalar::U32)], &kinds);
    let (own_x, own_bits) = (b.param(entry, 0), b.param(entry, 1));
    b.jump(entry, f, &[own_x, own_bits]);
    b.ret(f, entry, &results);
    let p = b.finish();
    let (floats, words) = (special(Scalar::F32), special(Scalar::U32));
    for start in 0..9 {
        let floats = floats.iter().cycle().skip(start * 4).take(4);
        let words = words.iter().cycle().skip(start * 4).take(4);
        agree(&p, "entry", &floats.chain(words).copied().collect::<Vec<_>>(), &[]);
    }
}

/// A choice by the contrary of a mask, between values and constants.
#[test]
fn choices_by_the_contrary() {
    let p = crate::build::residual(
        "entry f = f
fun f(m: boolx8, n: boolx8, x: f32x8, y: f32x8, return: fn(f32x8, f32x8, f32x8, boolx8, boolx8, boolx8))
  not_m = not m
  zero = pack 0.0 0.0 0.0 0.0 0.0 0.0 0.0 0.0
  yes = pack true true true true true true true true
  a = select not_m x y
  b = select not_m zero y
  c = select not_m x zero
  d = select not_m yes n
  e = select not_m n yes
  g = select not_m not_m n
  jump return(a, b, c, d, e, g)
",
    );
    let mask = |bits: u32| (0..8).map(move |l| Lit::Bool(bits >> l & 1 == 1));
    let float = |from: usize| special(Scalar::F32).into_iter().cycle().skip(from).take(8);
    for (m, n) in [(0b0101_0011, 0b1100_1010), (0, 0xff), (0xff, 0x0f)] {
        agree(&p, "f", &mask(m).chain(mask(n)).chain(float(3)).chain(float(25)).collect::<Vec<_>>(), &[]);
    }
}

/// What an operand is made of may be told from its operation, which need not have two operands.
#[test]
fn conversions_of_operations_of_one_operand() {
    let p = parse(
        "jerboa-ir 1
entry f = f
fun f(x: f32x4, y: u32x4, return: fn(f32x4, f32x4, f32x4))
  bits = bits x
  a = to_f32 bits
  not = not y
  b = to_f32 not
  whole = to_u32 x
  c = to_f32 whole
  jump return(a, b, c)
",
    )
    .expect("it is a program");
    let floats = [-1.5, 0.0, f32::MAX, f32::NAN].map(Lit::f32);
    let words = [0, 1, u32::MAX, 1 << 31].map(Lit::U32);
    agree(&p, "f", &[floats, words].concat(), &[]);
}
