//! T34: every error that a crate can return, brought about where a program can bring it about, with its text. The variants
//! are told apart by matches without a wildcard: a new one does not compile until it has its case here.
//!
//! Those of `scenes` are in its own tests, the lines of the command line in `lib-render/tests/cli.rs`, the faults of the
//! verifier in `ir/tests/verify.rs`.

use std::collections::BTreeSet;

use jerboa_backend_cranelift as clif;
use jerboa_ir::interp::{self, Limits, Stop};
use jerboa_ir::{Lit, Program, parse, verify};
use jerboa_peval::{Arg, Budget, Error, Facts, Generic, Options, specialize};

fn program(text: &str) -> Program {
    let p = parse(&format!("jerboa-ir 1\n{text}")).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(verify(&p), [], "{text}");
    p
}

fn refusal(text: &str, entry: &str, args: &[Arg], options: Options) -> Error {
    let refused = specialize(&Generic::new(program(text)), entry, args, &Facts::none(), &options);
    refused.map(|r| panic!("it was specialised to\n{}", jerboa_ir::print(&r.program))).unwrap_or_else(|e| e)
}

const IDENTITY: &str = "entry main = f\nfun f(x: u32, return: fn(u32))\n  jump return(x)\n";

/// Which of two functions is called depends on what is unknown.
const MEET: &str = "\
entry main = f
fun f(c: bool, x: u32, return: fn(u32))
  branch c left right
  arm left()
    jump chosen(same)
  arm right()
    jump chosen(next)
  join chosen(g: fn(u32, fn(u32)))
    jump g(x, return)
fun same(x: u32, return: fn(u32))
  jump return(x)
fun next(x: u32, return: fn(u32))
  y = add x 1u
  jump return(y)
";

/// Each call wraps its function once more.
const GROWS: &str = "\
entry main = f
fun f(n: u32, return: fn(u32))
  jump wrap(n, same, return)
fun wrap(n: u32, g: fn(u32, fn(u32)), return: fn(u32))
  c = eq n 0u
  branch c end again
  arm end()
    jump g(n, return)
  arm again()
    m = sub n 1u
    jump wrap(m, twice, return)
  fun twice(x: u32, return_2: fn(u32))
    jump g(x, once)
    rest once(y: u32)
      jump g(y, return_2)
fun same(x: u32, return: fn(u32))
  jump return(x)
";

/// An iteration that leaves its loop by a function it is given.
const LEAVES: &str = "\
entry main = main
fun main(n: u32, return: fn())
  jump repeat(out, n, return)
  fun out(end: fn())
    jump return()
fun repeat(f: fn(fn()), n: u32, return: fn()) @
  vectorize 4 0u n each() -> return
  fun each(i: u32, end: fn())
    jump f(end)
";

/// A million words on the stack.
const LARGE: &str = "\
entry main = hungry
fun hungry(n: u32, return: fn(u32))
  local u32 1048576 -> made
  rest made(a: local(u32 1048576))
    load a n -> got
    rest got(x: u32)
      jump return(x)
";

/// Two blocks of a loop that is entered at either.
const TWO_ENTRIES: &str = "\
entry main = main
fun main(n: u32, return: fn())
  vectorize 4 0u n each() -> done
  rest done()
  jump return()
fun each(i: u32, return: fn())
  odd = eq i 1u
  branch odd a b
  arm a()
    branch odd b leave
  arm b()
    jump a()
  arm leave()
    jump return()
";

/// Calls itself for ever.
const FOREVER: &str = "\
entry main = f
fun f(n: u32, return: fn(u32))
  jump f(n, again)
  rest again(m: u32)
    k = add m 1u
    jump return(k)
";

#[test]
fn the_evaluators_errors_say_what_to_do() {
    let options = Options::default();
    let small = Options { budget: Budget { nodes: 1, ..Budget::default() }, ..options };
    let fault = jerboa_ir::verify_residual(&program(MEET)).remove(0);
    let cases = [
        (refusal(IDENTITY, "wood", &[], options), "there is no entry `wood`; there are: main"),
        (refusal(IDENTITY, "main", &[], options), "entry `main`: arguments: 1 expected, 0 given"),
        (
            refusal(IDENTITY, "main", &[Arg::Known(Lit::f32(1.0))], options),
            "entry `main`: 1.0 is no argument of type u32",
        ),
        (
            refusal(MEET, "main", &[Arg::Unknown; 2], options),
            "two functions meet at the join `chosen` of an unknown branch: `next` and `same`; choose inside the function, or ask for a copy per branch with `.per_branch()`",
        ),
        (
            refusal(GROWS, "main", &[Arg::Unknown], options),
            "`wrap` has 401 copies because its argument `g` grows with each call; calls: `f`; make that argument a scalar, or give the function a filter that ends",
        ),
        (refusal(GROWS, "main", &[Arg::Unknown], small), "the residual has 6 nodes and still grows; calls: `f`"),
        (
            refusal(LEAVES, "main", &[Arg::Unknown], options),
            "an iteration of `vectorize`, `each`, uses an exit or a local array of the function around it; calls: `main` → `repeat`; make the array inside, and let the iteration come to its end",
        ),
        // A mistake of the evaluator brings this about, or iterations that meet.
        (
            Error::NotFirstOrder { entry: "main".into(), faults: vec![fault] },
            "the residual of `main` breaks rules; is the program verified?\n  residual-jump: in `left`: `same` is passed to `chosen`; only data may be",
        ),
    ];
    let mut seen = BTreeSet::new();
    for (error, text) in &cases {
        assert_eq!(error.to_string(), *text);
        seen.insert(match error {
            Error::NoEntry { .. } => 0,
            Error::Arguments { .. } => 1,
            Error::ClosuresMeet { .. } => 2,
            Error::Budget { .. } => 3,
            Error::NotFirstOrder { .. } => 4,
            Error::TooLarge { .. } => 5,
            Error::NotIndependent { .. } => 6,
        });
    }
    assert_eq!(seen.len(), 7, "{seen:?}");
}

#[test]
fn the_code_generators_errors_name_the_kernel() {
    use clif::Error;
    let compile = |programs: &[&Program]| clif::compile(programs, &clif::Options::default()).map(drop).unwrap_err();
    let one = program(IDENTITY);
    let words = |s: &str| s.to_string();
    let cases = [
        (compile(&[&one, &one]), "two kernels are called `main`; give one another name"),
        (
            compile(&[&program(MEET)]),
            "kernel `main`: `same` is not first-order: it takes a fn(u32); specialise the program first",
        ),
        (
            compile(&[&program(LARGE)]),
            "kernel `main` needs 4194304 bytes of stack, most of them in `hungry`; the limit is 1048576: make its local arrays smaller, or keep them out of recursive functions",
        ),
        (
            compile(&[&program(TWO_ENTRIES)]),
            "kernel `main`, in lanes: function `each` has a loop with two entries, `a` and `b`; let one of them go through the other, or make two loops of it",
        ),
        // These three are the machine's or Cranelift's to bring about.
        (
            Error::Host(words("the processor has no SSE4.1")),
            "this machine cannot run the renderer's code: the processor has no SSE4.1",
        ),
        (
            Error::Codegen { kernel: words("path"), function: words("shade"), why: words("invalid value") },
            "kernel `path`, function `shade`: code generation failed; please report this: invalid value",
        ),
        (Error::Memory(words("out of memory")), "the system gave no memory for machine code: out of memory"),
    ];
    let mut seen = BTreeSet::new();
    for (error, text) in &cases {
        assert_eq!(error.to_string(), *text);
        seen.insert(match error {
            Error::Host(_) => 0,
            Error::NotFirstOrder { .. } => 1,
            Error::Stack { .. } => 2,
            Error::SameName(_) => 3,
            Error::Codegen { .. } => 4,
            Error::Memory(_) => 5,
            Error::Lanes { .. } => 6,
        });
    }
    assert_eq!(seen.len(), 7, "{seen:?}");
}

#[test]
fn the_interpreter_says_why_it_stopped() {
    let stop = |text: &str, args: &[Lit], limits: Limits| {
        let p = program(text);
        interp::run(&p, p.entry("main").expect("an entry"), args, &mut [], limits).expect_err("it stops")
    };
    let few = Limits { fuel: 100, ..Limits::default() };
    let cases = [
        (stop(FOREVER, &[Lit::U32(1)], few), "the run used up its fuel"),
        (
            stop(FOREVER, &[Lit::U32(1)], Limits::default()),
            "the run needs more memory than its limit: recursion too deep?",
        ),
        (stop(IDENTITY, &[], Limits::default()), "`f` cannot be run: the arguments do not fit a parameter of type u32"),
    ];
    let mut seen = BTreeSet::new();
    for (stop, text) in &cases {
        assert_eq!(stop.to_string(), *text);
        seen.insert(match stop {
            Stop::Fuel => 0,
            Stop::Limit => 1,
            Stop::Fault { .. } => 2,
        });
    }
    assert_eq!(seen.len(), 3, "{seen:?}");
}

/// A line of the source is told where there is one.
#[test]
fn lines_of_the_source_are_named() {
    let loc = jerboa_ir::Loc { file: "power.rs", line: 7 };
    let place = jerboa_peval::Place { name: "power".into(), loc };
    assert_eq!(place.to_string(), "`power` (power.rs:7)");
    let fault = jerboa_ir::cfg::NotFirstOrder { name: "power".into(), loc, why: "it takes a fn(u32)".into() };
    let text = "`power` is not first-order: it takes a fn(u32); specialise the program first (power.rs:7)";
    assert_eq!(fault.to_string(), text);
    let stop = Stop::Fault { loc, message: "a read beyond the table".into() };
    assert_eq!(stop.to_string(), "a read beyond the table (power.rs:7)");
}

#[test]
fn a_text_that_is_no_program_names_its_place() {
    let cases = [
        ("fun f(", "line 1, column 1: a text begins with `jerboa-ir 1`, this one with `fun f(`"),
        ("jerboa-ir 1\nfun f(x: wood)\n", "line 2, column 10: `wood` is no type"),
        (
            "jerboa-ir 1\nfun f(x: u32, return: fn(u32))\n  y = wood x\n  jump return(y)\n",
            "line 3, column 7: no operation `wood`",
        ),
        (
            "jerboa-ir 1\nfun f(x: u32, return: fn(u32))\n  jump return(z)\n",
            "line 3, column 15: this name is not known here",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(parse(text).unwrap_err().to_string(), expected);
    }
}
