//! Accuracy list T2: every operation, at every form, over all special values, on every engine, bit for bit.
//!
//! One suite, instantiated per engine. What is expected is [`Op::eval`], lane by lane; that the table itself says what it
//! promises in words is tested by facts written by hand.

use jerboa_backend_cranelift as cranelift;
use jerboa_backend_spirv::Grid;
use jerboa_ir::interp::{Interp, Limits};
use jerboa_ir::op::Rule;
use jerboa_ir::*;
use jerboa_peval::{Arg, Facts, Generic, specialize};
use jerboa_tests::choices::Choices;
use jerboa_tests::forms::{Form, forms};
use jerboa_tests::machine::call;
use jerboa_tests::spirv::{Spirv, gpu, spirv_val};
use jerboa_tests::sweep::{Through, sweep};
use jerboa_tests::values::specials;

/// Something that computes operations.
trait Engine {
    /// The result's lanes for each case; a case has the lanes of all operands in order.
    fn results(&self, form: &Form, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>>;

    /// Does it have the operation?
    fn has(&self, _: Op) -> bool {
        true
    }
}

/// Every operation at this number of lanes.
fn suite(engine: &dyn Engine, lanes: usize) {
    for form in forms(lanes).into_iter().filter(|form| engine.has(form.op)) {
        let cases = cases(&form, lanes);
        let results = engine.results(&form, &cases);
        assert_eq!(results.len(), cases.len());
        for (case, result) in cases.iter().zip(&results) {
            assert_eq!(*result, expected(&form, lanes, case), "{} of {case:?}", form.op.name());
        }
    }
}

fn expected(form: &Form, lanes: usize, case: &[Lit]) -> Vec<Lit> {
    if matches!(form.op.rule(), Rule::Lanes(_)) {
        return vec![form.op.eval(case)];
    }
    let lane = |l: usize| case.chunks(lanes).map(|operand| operand[l]).collect::<Vec<_>>();
    (0..lanes).map(|l| form.op.eval(&lane(l))).collect()
}

/// Scalars: the whole product of special values. Vectors: the same product, each lane further along in it, so that each
/// lane sees each case; of the operations over lanes, all masks of up to 4 lanes.
fn cases(form: &Form, lanes: usize) -> Vec<Vec<Lit>> {
    if matches!(form.op.rule(), Rule::Lanes(_)) {
        let all = (1u32 << lanes) - 1;
        let masks: Vec<u32> = if lanes <= 4 {
            (0..=all).collect()
        } else {
            (0..lanes).flat_map(|l| [1 << l, all ^ 1 << l]).chain([0, all]).collect()
        };
        return masks.iter().map(|m| (0..lanes).map(|l| Lit::Bool(m >> l & 1 == 1)).collect()).collect();
    }
    let scalars: Vec<Scalar> = form.args.iter().map(|t| t.lanes().expect("operands are data").0).collect();
    let mut product: Vec<Vec<Lit>> = vec![vec![]];
    for s in scalars {
        product = product.iter().flat_map(|head| specials(s).into_iter().map(|x| [&head[..], &[x]].concat())).collect();
    }
    let lane = |case: usize, l: usize| &product[(case + l * 7) % product.len()];
    let case = |i: usize| {
        (0..form.args.len()).flat_map(|arg| (0..lanes).map(|l| lane(i, l)[arg]).collect::<Vec<_>>()).collect()
    };
    (0..product.len()).map(case).collect()
}

/// `main(a, b, …, return) = return(op(a, b, …))`.
fn program(form: &Form) -> Program {
    program_of(form, |w, args| w.prim(form.op, args, Loc::NONE))
}

/// The same with another result.
fn program_of(form: &Form, result: impl FnOnce(&mut World, &[NodeId]) -> NodeId) -> Program {
    let mut w = World::new();
    let param = |ty: Ty| Param { ty, name: None, keep: false };
    let params = form.args.iter().copied().chain([Ty::func(&[form.result])]).map(param).collect();
    let main = w.cont("main", Role::Fun, params, Loc::NONE);
    let nodes = w.params(main);
    let (ret, args) = nodes.split_last().expect("there is a return");
    let result = result(&mut w, args);
    w.set_body(main, Body::Jump { callee: *ret, args: vec![result], mode: Mode::Filter }, Loc::NONE);
    w.entry("main", main);
    w.finish()
}

fn interpret(program: &Program, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
    let main = program.entry("main").expect("there is a main");
    let interp = Interp::new(program);
    cases.iter().map(|case| interp.run(main, case, &mut [], Limits::default()).expect("it runs")).collect()
}

/// The interpreter.
struct Interpreter;

impl Engine for Interpreter {
    fn results(&self, form: &Form, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
        interpret(&program(form), cases)
    }
}

/// Construction: an operation over literals is a literal.
struct Folder;

impl Engine for Folder {
    fn results(&self, form: &Form, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
        let mut w = World::new();
        let fold = |case: &Vec<Lit>| {
            let mut lits = case.iter().map(|lit| w.lit(*lit)).collect::<Vec<_>>().into_iter();
            let mut args = Vec::new();
            for ty in &form.args {
                let (_, lanes) = ty.lanes().expect("operands are data");
                let elems: Vec<NodeId> = lits.by_ref().take(lanes).collect();
                args.push(if lanes == 1 { elems[0] } else { w.pack(&elems, Loc::NONE) });
            }
            let result = w.prim(form.op, &args, Loc::NONE);
            let elems = match w.program().node(result) {
                Node::Pack(elems) => elems.to_vec(),
                _ => vec![result],
            };
            elems.into_iter().map(|e| w.program().as_lit(e).expect("folded")).collect()
        };
        cases.iter().map(fold).collect()
    }
}

/// What the evaluator leaves of a form.
fn residual(generic: &Generic, args: &[Arg]) -> Program {
    specialize(generic, "main", args, &Facts::none(), &Default::default()).expect("it specialises").program
}

/// The evaluator, which knows nothing: its residual is the operation.
struct Unknown;

impl Engine for Unknown {
    fn results(&self, form: &Form, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
        let generic = Generic::new(program(form));
        interpret(&residual(&generic, &vec![Arg::Unknown; form.args.len()]), cases)
    }
}

/// The evaluator, which knows all operands: its residual returns a literal.
struct Known;

impl Engine for Known {
    fn results(&self, form: &Form, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
        let unfolded = program_of(form, |w, args| {
            let mut padded = [NodeId::NONE; 3];
            padded[..args.len()].copy_from_slice(args);
            w.node(Node::Prim { op: form.op, args: padded }, form.result, Loc::NONE)
        });
        let generic = Generic::new(unfolded);
        let result = |case: &Vec<Lit>| {
            let args: Vec<Arg> = case.iter().map(|lit| Arg::Known(*lit)).collect();
            let program = residual(&generic, &args);
            assert!(!program.nodes.iter().any(|n| matches!(n, Node::Prim { .. })), "{} is left", form.op.name());
            interpret(&program, &[vec![]])[0].clone()
        };
        cases.iter().map(result).collect()
    }
}

/// Machine code of the evaluator's residual.
struct Machine(cranelift::Opt);

impl Engine for Machine {
    fn results(&self, form: &Form, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
        let generic = Generic::new(program(form));
        let program = residual(&generic, &vec![Arg::Unknown; form.args.len()]);
        let options = cranelift::Options { opt: self.0, verify: true, ..Default::default() };
        let code = cranelift::compile(&[&program], &options).expect("it compiles");
        let (kernel, main) =
            (code.kernel("main").expect("main is compiled"), program.entry("main").expect("there is a main"));
        cases.iter().map(|case| call(kernel, &program, main, case, &mut []).expect("it runs")).collect()
    }
}

/// A GPU, with an invocation for each case. An operation over vectors is one for each lane, `fma` is refused.
impl Engine for Spirv {
    fn results(&self, form: &Form, cases: &[Vec<Lit>]) -> Vec<Vec<Lit>> {
        let generic = Generic::new(program(form));
        let program = residual(&generic, &vec![Arg::Unknown; form.args.len()]);
        let rows = cases.len() as u32;
        let mut sweep = sweep(&program, &[], rows, Through::Grid, &mut Choices::replay(&[]));
        let [given, _] = &mut sweep.memory[..] else { unreachable!("the streams of a sweep") };
        given.words = (0..cases[0].len()).flat_map(|col| cases.iter().map(move |case| case[col].word())).collect();
        let memory = self.sweep(&sweep, rows).unwrap_or_else(|e| panic!("{}: {e}", form.op.name()));
        let (scalar, lanes) = form.result.lanes().expect("a result is data");
        let result = |row: usize| (0..lanes).map(|l| memory[1].words[l * cases.len() + row]).collect::<Vec<u32>>();
        let lit = |word: u32| {
            assert!(scalar != Scalar::Bool || word < 2, "{}: {word:#x} is no bool", form.op.name());
            Lit::from_word(scalar, word)
        };
        (0..cases.len()).map(|row| result(row).into_iter().map(lit).collect()).collect()
    }

    fn has(&self, op: Op) -> bool {
        op != Op::Fma
    }
}

/// The GPU as an engine, all of whose modules pass `spirv-val`.
fn on_gpu(test: &str) -> Option<Spirv> {
    Some(Spirv { gpu: gpu(test)?, validator: spirv_val(test), spread: true })
}

#[test]
fn on_scalars_on_the_gpu() {
    let Some(gpu) = on_gpu("on_scalars_on_the_gpu") else { return };
    suite(&gpu, 1);
    let fma = forms(1).into_iter().find(|f| f.op == Op::Fma).expect("it is an operation");
    let generic = Generic::new(program(&fma));
    let program = residual(&generic, &[Arg::Unknown; 3]);
    let refused = gpu.module(&program, "main", Grid::Single).expect_err("it may round twice");
    assert!(refused.contains("fma"), "{refused}");
}

#[test]
fn on_vectors_on_the_gpu() {
    let Some(gpu) = on_gpu("on_vectors_on_the_gpu") else { return };
    [2, 3, 16].into_iter().for_each(|lanes| suite(&gpu, lanes));
}

/// A test per engine and number of lanes.
macro_rules! conforms {
    ($($name:ident: $engine:expr;)+) => { $(mod $name {
        use super::*;
        #[test]
        fn on_scalars() { suite(&$engine, 1); }
        #[test]
        fn on_vectors() { [2, 3, 4, 5, 8, 16].into_iter().for_each(|lanes| suite(&$engine, lanes)); }
    })+ };
}

conforms! {
    interpreter: Interpreter;
    folder: Folder;
    evaluator: Unknown;
    machine_code: Machine(cranelift::Opt::None);
    optimised_machine_code: Machine(cranelift::Opt::Speed);
}

/// Only scalar arguments can be known.
#[test]
fn evaluator_folds_on_scalars() {
    suite(&Known, 1);
}

/// What construction does with operands that are known or the same, and with an operation on its own result, is true of
/// every input.
#[test]
fn folding_in_part_changes_no_bit() {
    for form in forms(1) {
        let cases = cases(&form, 1);
        let results = interpret(&program(&form), &cases);
        for position in 0..form.args.len() {
            let Some(scalar) = form.args[position].as_scalar() else { unreachable!("forms(1) are scalar") };
            for known in specials(scalar) {
                let fold = |w: &mut World, args: &[NodeId]| {
                    let mut args = args.to_vec();
                    args[position] = w.lit(known);
                    w.prim(form.op, &args, Loc::NONE)
                };
                let folded = program_of(&form, fold);
                for (case, result) in cases.iter().zip(&results).filter(|(case, _)| case[position] == known) {
                    assert_eq!(
                        interpret(&folded, std::slice::from_ref(case))[0],
                        *result,
                        "{} of {case:?}",
                        form.op.name()
                    );
                }
            }
        }
        let first_again = program_of(&form, |w, args| {
            let same: Vec<NodeId> =
                args.iter().map(|a| if w.program().ty(*a) == form.args[0] { args[0] } else { *a }).collect();
            w.prim(form.op, &same, Loc::NONE)
        });
        for case in &cases {
            let same: Vec<Lit> = case.iter().map(|x| if x.ty() == form.args[0] { case[0] } else { *x }).collect();
            assert_eq!(
                interpret(&first_again, std::slice::from_ref(case))[0],
                [form.op.eval(&same)],
                "{} of {same:?}",
                form.op.name()
            );
        }
        if form.args == [form.result] {
            let twice = program_of(&form, |w, args| {
                let once = w.prim(form.op, args, Loc::NONE);
                w.prim(form.op, &[once], Loc::NONE)
            });
            for case in &cases {
                let expected = form.op.eval(&[form.op.eval(case)]);
                assert_eq!(
                    interpret(&twice, std::slice::from_ref(case))[0],
                    [expected],
                    "{} twice of {case:?}",
                    form.op.name()
                );
            }
        }
    }
}

/// The words of the table, by examples computed by hand.
#[test]
fn operations_keep_their_word() {
    use Op::*;
    let (f, i, u, b) = (Lit::f32, Lit::I32, Lit::U32, Lit::Bool);
    let (inf, nan, tiny) = (f32::INFINITY, f32::NAN, f32::from_bits(1));
    let facts: &[(Op, &[Lit], Lit)] = &[
        (Add, &[i(i32::MAX), i(1)], i(i32::MIN)),
        (Add, &[f(16_777_216.0), f(1.0)], f(16_777_216.0)),
        (Add, &[f(-0.0), f(-0.0)], f(-0.0)),
        (Add, &[f(-0.0), f(0.0)], f(0.0)),
        (Add, &[f(tiny), f(tiny)], Lit::F32(2)),
        (Sub, &[u(0), u(1)], u(u32::MAX)),
        (Sub, &[f(inf), f(inf)], f(nan)),
        (Mul, &[u(0x8000_0000), u(2)], u(0)),
        (Mul, &[f(0.0), f(inf)], f(nan)),
        (Mul, &[f(f32::MAX), f(2.0)], f(inf)),
        (Mul, &[f(tiny), f(0.5)], f(0.0)),
        (Div, &[i(-7), i(2)], i(-3)),
        (Div, &[i(7), i(0)], i(0)),
        (Div, &[u(7), u(0)], u(0)),
        (Div, &[i(i32::MIN), i(-1)], i(i32::MIN)),
        (Div, &[f(1.0), f(-0.0)], f(-inf)),
        (Div, &[f(0.0), f(0.0)], f(nan)),
        (Rem, &[i(-7), i(2)], i(-1)),
        (Rem, &[i(7), i(0)], i(0)),
        (Rem, &[u(7), u(0)], u(0)),
        (Rem, &[i(i32::MIN), i(-1)], i(0)),
        (Min, &[f(nan), f(1.0)], f(1.0)),
        (Min, &[f(1.0), f(nan)], f(nan)),
        (Min, &[f(-0.0), f(0.0)], f(0.0)),
        (Min, &[f(0.0), f(-0.0)], f(-0.0)),
        (Min, &[u(1), u(u32::MAX)], u(1)),
        (Min, &[i(1), i(-1)], i(-1)),
        (Max, &[f(nan), f(1.0)], f(1.0)),
        (Max, &[f(1.0), f(nan)], f(nan)),
        (Max, &[f(0.0), f(-0.0)], f(-0.0)),
        (Max, &[u(1), u(u32::MAX)], u(u32::MAX)),
        (Neg, &[i(i32::MIN)], i(i32::MIN)),
        (Neg, &[f(0.0)], f(-0.0)),
        (Abs, &[i(i32::MIN)], i(i32::MIN)),
        (Abs, &[f(-0.0)], f(0.0)),
        // (1 + 2^-23)² − (1 + 2^-22) = 2^-46 exactly, which a rounded product loses.
        (Fma, &[f(1.000_000_1), f(1.000_000_1), f(-1.000_000_2)], f(f32::from_bits((127 - 46) << 23))),
        (Absorb, &[f(-0.0), f(inf)], f(0.0)),
        (Absorb, &[f(nan), f(0.0)], f(0.0)),
        (Absorb, &[f(2.0), f(-3.0)], f(-6.0)),
        (Absorb, &[f(-tiny), f(tiny)], f(-0.0)),
        (Sqrt, &[f(-0.0)], f(-0.0)),
        (Sqrt, &[f(-1.0)], f(nan)),
        (Sqrt, &[f(2.0)], Lit::F32(0x3fb5_04f3)),
        (Floor, &[f(-0.5)], f(-1.0)),
        (Floor, &[f(8_388_607.5)], f(8_388_607.0)),
        (Ceil, &[f(-0.5)], f(-0.0)),
        (Trunc, &[f(-1.5)], f(-1.0)),
        (Round, &[f(2.5)], f(2.0)),
        (Round, &[f(-0.5)], f(-0.0)),
        (And, &[i(6), i(3)], i(2)),
        (Or, &[u(6), u(3)], u(7)),
        (Xor, &[b(true), b(true)], b(false)),
        (Not, &[u(0)], u(u32::MAX)),
        (Not, &[b(true)], b(false)),
        (Shl, &[u(1), u(33)], u(2)),
        (Shl, &[i(1), u(31)], i(i32::MIN)),
        (Shr, &[i(-8), u(1)], i(-4)),
        (Shr, &[u(0x8000_0000), u(32)], u(0x8000_0000)),
        (Eq, &[f(nan), f(nan)], b(false)),
        (Eq, &[f(0.0), f(-0.0)], b(true)),
        (Ne, &[f(nan), f(nan)], b(true)),
        (Lt, &[u(1), u(u32::MAX)], b(true)),
        (Lt, &[i(1), i(-1)], b(false)),
        (Le, &[f(nan), f(1.0)], b(false)),
        (Gt, &[f(1.0), f(nan)], b(false)),
        (Ge, &[f(0.0), f(-0.0)], b(true)),
        (Select, &[b(true), u(1), u(2)], u(1)),
        (Select, &[b(false), f(1.0), f(-0.0)], f(-0.0)),
        (ToF32, &[u(u32::MAX)], f(4_294_967_296.0)),
        (ToF32, &[i(16_777_217)], f(16_777_216.0)),
        (ToI32, &[f(nan)], i(0)),
        (ToI32, &[f(3e9)], i(i32::MAX)),
        (ToI32, &[f(-3e9)], i(i32::MIN)),
        (ToI32, &[f(-1.9)], i(-1)),
        (ToU32, &[f(-1.0)], u(0)),
        (ToU32, &[f(inf)], u(u32::MAX)),
        (ToU32, &[f(4_294_967_040.0)], u(4_294_967_040)),
        (Bits, &[f(-nan)], u(0x7fc0_0000)),
        (Bits, &[i(-1)], u(u32::MAX)),
        (Bits, &[b(true)], u(1)),
        (FloatOfBits, &[u(0xff80_0000)], f(-inf)),
        (FloatOfBits, &[u(0x7f80_0001)], f(nan)),
        (IntOfBits, &[u(0x8000_0000)], i(i32::MIN)),
        (Any, &[b(false), b(true)], b(true)),
        (All, &[b(false), b(true)], b(false)),
        (Ballot, &[b(true), b(false), b(true)], u(5)),
    ];
    for (op, args, result) in facts {
        assert_eq!(op.eval(args), *result, "{} of {args:?}", op.name());
    }
    let untold: Vec<&Op> = Op::ALL.iter().filter(|op| !facts.iter().any(|f| f.0 == **op)).collect();
    assert!(untold.is_empty(), "no fact about {untold:?}");
}
