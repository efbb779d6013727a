//! Every operation, on every pair and triple of special values, against [`Op::eval`].

use jerboa_backend_cranelift::Opt;
use jerboa_ir::op::Rule;
use jerboa_ir::*;

use crate::build::{Build, code, run};

/// Values where operations go wrong.
pub fn special(scalar: Scalar) -> Vec<Lit> {
    match scalar {
        Scalar::Bool => vec![Lit::Bool(false), Lit::Bool(true)],
        Scalar::I32 => [0, 1, -1, 2, -2, 7, 31, 32, 33, 1 << 24, (1 << 24) + 1, i32::MAX, i32::MIN, i32::MIN + 1]
            .map(Lit::I32)
            .into(),
        Scalar::U32 => {
            let floats = [f32::NAN.to_bits(), 0xffc0_0001, 0x7f80_0001, 1.5f32.to_bits(), (-0.0f32).to_bits(), 1];
            let ints = [0, 2, 31, 32, 33, 100, (1 << 24) + 1, (1 << 31) - 1, u32::MAX, u32::MAX - 1];
            floats.into_iter().chain(ints).map(Lit::U32).collect()
        }
        Scalar::F32 => {
            let positive = [
                0.0,
                f32::from_bits(1),
                f32::MIN_POSITIVE,
                0.5,
                1.0 - f32::EPSILON / 2.0,
                1.0,
                1.0 + f32::EPSILON,
                1.5,
                2.5,
                16_777_217.0,
                8_388_607.5,
                2_147_483_648.0,
                4_294_967_040.0,
                4_294_967_296.0,
                f32::MAX,
                f32::INFINITY,
                f32::NAN,
            ];
            positive.into_iter().flat_map(|x| [Lit::f32(x), Lit::f32(-x)]).collect()
        }
    }
}

/// The operand types for which an operation of this main type is defined.
pub fn operands(op: Op, main: Scalar) -> Vec<Scalar> {
    match op.rule() {
        Rule::Select => vec![Scalar::Bool, main, main],
        Rule::Shift => vec![main, Scalar::U32],
        _ => vec![main; op.arity()],
    }
}

/// All tuples with one element of each list.
fn product(lists: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
    lists.iter().fold(vec![vec![]], |sum, list| {
        sum.iter().flat_map(|head| list.iter().map(|x| [&head[..], &[*x]].concat())).collect()
    })
}

/// A kernel that applies the operation, over `lanes` lanes.
fn program(op: Op, scalars: &[Scalar], lanes: usize) -> Program {
    let mut b = Build::default();
    let types: Vec<Ty> =
        scalars.iter().map(|s| if lanes == 1 { Ty::scalar(*s) } else { Ty::vector(*s, lanes) }).collect();
    let result = op.result(&types).expect("the operands fit");
    let f = b.entry("f", &types, &[result]);
    let args: Vec<NodeId> = (0..types.len()).map(|i| b.param(f, i)).collect();
    let value = b.op(op, &args);
    b.ret(f, f, &[value]);
    b.finish()
}

#[test]
fn every_operation_on_special_values() {
    for opt in [Opt::None, Opt::Speed] {
        for &op in Op::ALL.iter().filter(|op| !matches!(op.rule(), Rule::Lanes(_))) {
            for &main in op.scalars() {
                let scalars = operands(op, main);
                let p = program(op, &scalars, 1);
                let code = code(&p, opt);
                let lists: Vec<Vec<Lit>> = scalars.iter().map(|s| special(*s)).collect();
                for args in product(&lists) {
                    let expected = op.eval(&args);
                    let got = Lit::from_word(expected.scalar(), run(&code, "f", &args, &mut []).expect("it ends")[0]);
                    assert_eq!(got, expected, "{} {args:?} at {opt:?}", op.name());
                }
            }
        }
    }
}

#[test]
fn every_operation_on_vectors() {
    const LANES: usize = 3;
    for &op in Op::ALL.iter().filter(|op| !matches!(op.rule(), Rule::Lanes(_))) {
        for &main in op.scalars() {
            let scalars = operands(op, main);
            let p = program(op, &scalars, LANES);
            let code = code(&p, Opt::None);
            for start in 0..20 {
                let args: Vec<Vec<Lit>> = (scalars.iter().enumerate())
                    .map(|(i, s)| special(*s).into_iter().cycle().skip(start * (i + 1)).take(LANES).collect())
                    .collect();
                let words = run(&code, "f", &args.concat(), &mut []).expect("it ends");
                for lane in 0..LANES {
                    let expected = op.eval(&args.iter().map(|a| a[lane]).collect::<Vec<_>>());
                    assert_eq!(Lit::from_word(expected.scalar(), words[lane]), expected, "{} {args:?}", op.name());
                }
            }
        }
    }
}

#[test]
fn operations_over_lanes() {
    for &op in Op::ALL.iter().filter(|op| matches!(op.rule(), Rule::Lanes(_))) {
        for lanes in [2, 5, 16] {
            let p = program(op, &[Scalar::Bool], lanes);
            let code = code(&p, Opt::None);
            for bits in (0..1u32 << lanes).step_by(if lanes == 16 { 97 } else { 1 }).chain([(1 << lanes) - 1]) {
                let args: Vec<Lit> = (0..lanes).map(|i| Lit::Bool(bits >> i & 1 == 1)).collect();
                let expected = op.eval(&args);
                assert_eq!(
                    run(&code, "f", &args, &mut []).expect("it ends"),
                    [expected.word()],
                    "{} {args:?}",
                    op.name()
                );
            }
        }
    }
}

#[test]
fn vectors_are_packed_and_taken_apart() {
    let mut b = Build::default();
    let f = b.entry("f", &[Ty::vector(Scalar::F32, 4), Ty::f32()], &[Ty::vector(Scalar::F32, 3), Ty::f32()]);
    let (v, x) = (b.param(f, 0), b.param(f, 1));
    let (third, first) = (b.w.lane(v, 2, Loc::NONE), b.w.lane(v, 0, Loc::NONE));
    let sum = b.op(Op::Add, &[third, x]);
    let packed = b.w.pack(&[sum, first, x], Loc::NONE);
    b.ret(f, f, &[packed, third]);
    let p = b.finish();
    let got = run(&code(&p, Opt::None), "f", &[1.0, 2.0, 3.0, 4.0, 10.0].map(Lit::f32), &mut []).expect("it ends");
    assert_eq!(got.iter().map(|w| f32::from_bits(*w)).collect::<Vec<_>>(), [13.0, 1.0, 10.0, 3.0]);
}
