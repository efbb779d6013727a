//! Accuracy list T2 on the GPU, where a back end or a driver is tempted: operands that are literals or the same, and
//! operations on results of operations, which algebra would contract, cancel or reorder. Bit for bit what [`Op::eval`] says.

use jerboa_ir::interp::{Interp, Limits};
use jerboa_ir::*;
use jerboa_tests::choices::Choices;
use jerboa_tests::forms::{Form, forms};
use jerboa_tests::machine::canonical;
use jerboa_tests::spirv::{Spirv, gpu, spirv_val};
use jerboa_tests::sweep::{Through, sweep};
use jerboa_tests::values::{random, specials};

/// Results of a kernel at most.
const RESULTS: usize = 64;

/// Inputs of kernels whose inputs are random.
const ROWS: u32 = 1000;

/// An expression over the parameters of a kernel.
type Make<'a> = Box<dyn Fn(&mut World, &[NodeId]) -> NodeId + 'a>;

/// An operation as it stands.
fn raw(w: &mut World, form: &Form, args: &[NodeId]) -> NodeId {
    let mut padded = [NodeId::NONE; 3];
    padded[..args.len()].copy_from_slice(args);
    w.node(Node::Prim { op: form.op, args: padded }, form.result, Loc::NONE)
}

/// A residual that returns these expressions.
fn program(params: &[Ty], makes: &[Make]) -> Program {
    let mut w = World::new();
    // The return's type is known when the results are: so they are made twice, with the same parameters' numbers.
    let mut results = Vec::new();
    for _ in 0..2 {
        w = World::new();
        let ret = Ty::func(&results);
        let params = params.iter().copied().chain([ret]).map(|ty| Param { ty, name: None, keep: false }).collect();
        let main = w.cont("main", Role::Fun, params, Loc::NONE);
        let nodes = w.params(main);
        let (ret, args) = nodes.split_last().expect("there is a return");
        let made: Vec<NodeId> = makes.iter().map(|make| make(&mut w, args)).collect();
        results = made.iter().map(|x| w.program().ty(*x)).collect();
        w.cont_mut(main).filter = w.lit(Lit::Bool(false));
        w.set_body(main, Body::Jump { callee: *ret, args: made, mode: Mode::Filter }, Loc::NONE);
        w.entry("main", main);
    }
    w.finish()
}

/// All expressions on all inputs, on the GPU and in the interpreter. An input has a value for each parameter.
fn check(engine: &Spirv, params: &[Ty], makes: &[Make], inputs: &[Vec<Lit>]) {
    for makes in makes.chunks(RESULTS) {
        let p = program(params, makes);
        let rows = inputs.len() as u32;
        let mut sweep = sweep(&p, &[], rows, Through::Grid, &mut Choices::replay(&[]));
        sweep.memory[0].words =
            (0..params.len()).flat_map(|param| inputs.iter().map(move |input| input[param].word())).collect();
        let mut expected = sweep.memory.clone();
        let interp = Interp::new(&sweep.program);
        let entry = sweep.program.entry("sweep").expect("it has the entry");
        for row in 0..rows {
            interp.run(entry, &[Lit::U32(row)], &mut expected, Limits::default()).expect("it runs");
        }
        let expected = canonical(&sweep.program, expected);
        let got = engine.sweep(&sweep, rows).unwrap_or_else(|e| panic!("{e}\n{}", print(&p)));
        for (at, (expected, got)) in expected[1].words.iter().zip(&got[1].words).enumerate() {
            let (result, row) = (at / inputs.len(), at % inputs.len());
            assert_eq!(
                got,
                expected,
                "{got:#x} is not {expected:#x}: result {result} of {:?}\n{}",
                inputs[row],
                print(&p)
            );
        }
    }
}

/// The forms over scalars that GPUs have.
fn all() -> Vec<Form> {
    forms(1).into_iter().filter(|form| form.op != Op::Fma).collect()
}

fn on_gpu(test: &str) -> Option<Spirv> {
    Some(Spirv { gpu: gpu(test)?, validator: spirv_val(test), spread: false })
}

#[test]
fn literals_change_no_bit_on_the_gpu() {
    let Some(engine) = on_gpu("literals_change_no_bit_on_the_gpu") else { return };
    let all = all();
    for scalar in Scalar::ALL {
        let mut makes: Vec<Make> = Vec::new();
        let places =
            |form: &Form| (0..form.args.len()).filter(|i| form.args[*i] == Ty::scalar(scalar)).collect::<Vec<_>>();
        for (form, place) in all.iter().flat_map(|form| places(form).into_iter().map(move |place| (form, place))) {
            let most = (0..form.args.len()).map(|i| specials_of(form, i).len()).max().unwrap_or(0);
            for k in 0..if form.args.len() == 1 { 1 } else { most } {
                makes.push(Box::new(move |w, args| {
                    let operand =
                        |w: &mut World, i: usize| if i == place { args[0] } else { w.lit(literal(form, i, k)) };
                    let operands: Vec<NodeId> = (0..form.args.len()).map(|i| operand(w, i)).collect();
                    raw(w, form, &operands)
                }));
            }
        }
        let inputs: Vec<Vec<Lit>> = specials(scalar).into_iter().map(|x| vec![x]).collect();
        check(&engine, &[Ty::scalar(scalar)], &makes, &inputs);
    }
}

fn specials_of(form: &Form, i: usize) -> Vec<Lit> {
    specials(form.args[i].as_scalar().expect("a form over scalars"))
}

/// The k-th literal as an operand; of two operands, each goes with several others.
fn literal(form: &Form, i: usize, k: usize) -> Lit {
    let all = specials_of(form, i);
    all[(k + 3 * i) % all.len()]
}

/// op(a, a), and an operation on its own result.
#[test]
fn operands_that_are_the_same_change_no_bit_on_the_gpu() {
    let Some(engine) = on_gpu("operands_that_are_the_same_change_no_bit_on_the_gpu") else { return };
    let all = all();
    for scalar in Scalar::ALL {
        let ty = Ty::scalar(scalar);
        let mut makes: Vec<Make> = Vec::new();
        for form in all.iter().filter(|form| form.args.iter().all(|arg| *arg == ty)) {
            makes.push(Box::new(|w, args| raw(w, form, &vec![args[0]; form.args.len()])));
            if form.result == ty {
                makes.push(Box::new(|w, args| {
                    let once = raw(w, form, &vec![args[0]; form.args.len()]);
                    raw(w, form, &vec![once; form.args.len()])
                }));
            }
        }
        let inputs: Vec<Vec<Lit>> = specials(scalar).into_iter().map(|x| vec![x]).collect();
        check(&engine, &[ty], &makes, &inputs);
    }
}

/// What the other operand of an operation on a result may be: an operand of it, another value, two literals.
const OTHERS: usize = 4;

/// The two literals: −0, in integers its bits, and 1.
fn simple(scalar: Scalar, at: usize) -> Lit {
    match scalar {
        Scalar::F32 => Lit::f32([-0.0, 1.0][at]),
        _ => Lit::from_word(scalar, [0x8000_0000, 1][at]),
    }
}

/// op2(op1(a, b), c) and op2(c, op1(a, b)) for all operations on floats and on integers, comparisons too, c one of the
/// operands, another, or a literal.
#[test]
fn chains_of_operations_change_no_bit_on_the_gpu() {
    let Some(engine) = on_gpu("chains_of_operations_change_no_bit_on_the_gpu") else { return };
    let all = all();
    for scalar in [Scalar::F32, Scalar::I32, Scalar::U32] {
        let ty = Ty::scalar(scalar);
        let closed: Vec<&Form> =
            all.iter().filter(|form| form.result == ty && form.args.iter().all(|arg| *arg == ty)).collect();
        let mut makes: Vec<Make> = Vec::new();
        let after: Vec<&Form> = all.iter().filter(|form| form.args.iter().all(|arg| *arg == ty)).collect();
        let after = &after;
        for (first, second) in closed.iter().flat_map(|a| after.iter().map(move |b| (*a, *b))) {
            for turn in 0..OTHERS * 2 {
                makes.push(Box::new(move |w, args| {
                    let inner = raw(w, first, &args[..first.args.len()]);
                    let other = match turn / 2 {
                        others @ 0..2 => args[others + 1],
                        lit => w.lit(simple(scalar, lit - 2)),
                    };
                    let operands =
                        if turn % 2 == 0 || second.args.len() == 1 { [inner, other] } else { [other, inner] };
                    let operands = if second.args.len() == 1 { &operands[..1] } else { &operands };
                    raw(w, second, operands)
                }));
            }
        }
        let mut c = Choices::random(1);
        let inputs: Vec<Vec<Lit>> = (0..ROWS).map(|_| (0..3).map(|_| random(scalar, &mut c)).collect()).collect();
        check(&engine, &[ty; 3], &makes, &inputs);
    }
}
