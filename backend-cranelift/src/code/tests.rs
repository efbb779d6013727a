//! Code for the least machine that will do, run here.

use super::*;
use jerboa_ir::op::Rule;
use jerboa_ir::{Body, Lit, Loc, Mode, Op, Param, Role, Scalar, Ty, World};

/// A kernel `f` that applies the operation to its arguments.
fn program(op: Op, types: &[Ty]) -> Program {
    let mut w = World::new();
    let result = op.result(types).expect("the operands fit");
    let param = |ty| Param { ty, name: None, keep: false };
    let params = types.iter().copied().chain([Ty::func(&[result])]).map(param).collect();
    let f = w.cont("f", Role::Fun, params, Loc::NONE);
    let params = w.params(f);
    let value = w.prim(op, &params[..types.len()], Loc::NONE);
    let body = Body::Jump { callee: params[types.len()], args: vec![value], mode: Mode::Filter };
    w.set_body(f, body, Loc::NONE);
    w.entry("f", f);
    w.finish()
}

fn words(scalar: Scalar) -> Vec<u32> {
    let floats = [0.0, -0.0, 1.5, -2.5, 3e9, -3e9, 1e-45, f32::MAX, f32::INFINITY, f32::NAN].map(f32::to_bits);
    match scalar {
        Scalar::F32 => [&floats[..], &[(1.0 + f32::EPSILON).to_bits()]].concat(),
        Scalar::Bool => vec![0, 1],
        _ => [&floats[..], &[0, 1, 31, 33, i32::MIN as u32, u32::MAX]].concat(),
    }
}

#[test]
fn the_least_machine_computes_the_same() {
    const LANES: usize = 5;
    let options = Options::default();
    let target = Target::least(&options);
    let forms = Op::ALL.iter().flat_map(|op| op.scalars().iter().map(move |s| (*op, *s)));
    for ((op, scalar), lanes) in forms.flat_map(|form| [1, LANES].map(|lanes| (form, lanes))) {
        let ty = |s| if lanes == 1 { Ty::scalar(s) } else { Ty::vector(s, lanes) };
        let types = match op.rule() {
            Rule::Lanes(_) if lanes == 1 => continue,
            Rule::Select => vec![ty(Scalar::Bool), ty(scalar), ty(scalar)],
            Rule::Shift => vec![ty(scalar), ty(Scalar::U32)],
            _ => vec![ty(scalar); op.arity()],
        };
        let code = Code::for_target(&[&program(op, &types)], &options, &target).expect("it is a residual");
        let kernel = code.kernel("f").expect("it is an entry");
        for start in 0..40 {
            let args = types.iter().enumerate().flat_map(|(i, ty)| {
                let scalar = ty.lanes().expect("it is data").0;
                words(scalar).into_iter().cycle().skip(start * (i + 1) + i).take(lanes)
            });
            let args: Vec<u32> = args.collect();
            let mut got = vec![0; kernel.results()];
            // SAFETY: the kernel touches no buffer.
            let status = unsafe { kernel.call(&[], &args, &mut got) };
            assert_eq!(status, Status::Done);
            let lit = |arg: usize, lane: usize| {
                Lit::from_word(types[arg].lanes().expect("it is data").0, args[arg * lanes + lane])
            };
            for (lane, got) in got.iter().enumerate() {
                let operands: Vec<Lit> = match op.rule() {
                    Rule::Lanes(_) => (0..lanes).map(|l| lit(0, l)).collect(),
                    _ => (0..types.len()).map(|arg| lit(arg, lane)).collect(),
                };
                let expected = op.eval(&operands);
                assert_eq!(Lit::from_word(expected.scalar(), *got), expected, "{} {operands:?}", op.name());
            }
        }
    }
}

#[test]
fn multiply_add_rounds_once_where_it_is_a_call() {
    let options = Options::default();
    let code =
        Code::for_target(&[&program(Op::Fma, &[Ty::vector(Scalar::F32, 2); 3])], &options, &Target::least(&options));
    let code = code.expect("it is a residual");
    // The first product is not exact: its two roundings would give 0.
    let tiny = 1.0 + f32::EPSILON;
    let args = [tiny, f32::MAX, tiny, 2.0, -(tiny * tiny), -f32::MAX].map(f32::to_bits);
    let mut got = [0; 2];
    // SAFETY: the kernel touches no buffer.
    let status = unsafe { code.kernel("f").expect("it is an entry").call(&[], &args, &mut got) };
    assert_eq!((status, got.map(f32::from_bits)), (Status::Done, [f32::EPSILON * f32::EPSILON, f32::MAX]));
}

/// Without AVX a load that is part of another instruction must be aligned to 16 bytes, and a run rarely is.
#[test]
fn runs_need_no_alignment() {
    let p = jerboa_ir::parse(
        "jerboa-ir 1
table t by columns
  x: f32 bulk
entry f = f
fun f(i: u32, y: f32x8, return: fn(f32x8))
  load unchecked t.x i -> got
  rest got(x: f32x8)
  sum = add y x
  jump return(sum)
",
    )
    .expect("it is a program");
    let options = Options::default();
    let code = Code::for_target(&[&p], &options, &Target::least(&options)).expect("it is a residual");
    let mut words: Vec<u32> = (0..16u16).map(|i| f32::from(i).to_bits()).collect();
    let bindings = [Binding::new(&mut words, 16)];
    for first in 0..8u16 {
        let args = [&[u32::from(first)], &[1f32.to_bits(); 8][..]].concat();
        let mut sums = [0; 8];
        // SAFETY: the one buffer is bound, with a word in each of its 16 rows, and the run ends before them.
        let status = unsafe { code.kernel("f").expect("it is an entry").call(&bindings, &args, &mut sums) };
        assert_eq!(status, Status::Done);
        assert_eq!(sums.map(f32::from_bits), std::array::from_fn(|lane| f32::from(first) + lane as f32 + 1.0));
    }
}
