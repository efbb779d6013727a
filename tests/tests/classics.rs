//! The classic programs of partial evaluation, each with its residual as a golden file in `files/peval`.
//!
//! A file holds the generic program, what is known, and what is left; `BLESS=1` rewrites it. Beside the text, each
//! residual is run against its program, and specialising it again must change nothing.

use std::path::Path;

use jerboa_ir::interp::{self, Limits, Memory};
use jerboa_ir::lang::*;
use jerboa_ir::{Body, Lit, Node, Op, Program, print, stream};
use jerboa_peval::{Arg, Facts, Generic, Options, specialize};
use jerboa_tests::golden::with_outputs;

/// A classic: its file, a line on what it shows, its program, and what is known of the arguments of `main`.
struct Classic {
    name: &'static str,
    shows: &'static str,
    program: Program,
    known: Vec<Option<Lit>>,
}

impl Classic {
    /// Check the golden file, run `inputs` (the unknown arguments) through both programs, specialise again.
    fn check(self, inputs: &[Vec<Lit>]) -> Program {
        self.check_file();
        let args: Vec<Arg> = self.known.iter().map(|k| k.map_or(Arg::Unknown, Arg::Known)).collect();
        let residual = self.specialize(&self.program, &args, None);
        // Decisions that must not matter, flipped by eight seeds.
        let flipped: Vec<Program> = (0..8).map(|seed| self.specialize(&self.program, &args, Some(seed))).collect();
        for input in inputs {
            let mut unknown = input.iter();
            let all: Vec<Lit> = self.known.iter().map(|k| k.unwrap_or_else(|| *unknown.next().unwrap())).collect();
            let expected = run(&self.program, &all);
            assert_eq!(expected, run(&residual, input), "{} of {input:?}", self.name);
            for (seed, program) in flipped.iter().enumerate() {
                assert_eq!(expected, run(program, input), "{} of {input:?}, chaos {seed}", self.name);
            }
        }
        let again = vec![Arg::Unknown; self.known.iter().filter(|k| k.is_none()).count()];
        assert_eq!(
            print(&self.specialize(&residual, &again, None)),
            print(&residual),
            "{}: specialised again",
            self.name
        );
        residual
    }

    fn specialize(&self, program: &Program, args: &[Arg], chaos: Option<u64>) -> Program {
        let options = Options { check: true, chaos, ..Options::default() };
        let residual = specialize(&Generic::new(program.clone()), "main", args, &Facts::none(), &options);
        residual.unwrap_or_else(|e| panic!("{}: {e}", self.name)).program
    }

    fn check_file(&self) {
        let words: Vec<String> = self.known.iter().map(|k| k.map_or("?".into(), |lit| lit.to_string())).collect();
        let head = format!("; {}\n; run: specialize main {}\n{}", self.shows, words.join(" "), print(&self.program));
        let text = with_outputs(&head).unwrap_or_else(|e| panic!("{}: {e}", self.name));
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("files/peval").join(format!("{}.ir", self.name));
        if std::env::var_os("BLESS").is_some_and(|v| v == "1") {
            std::fs::write(&path, &text).unwrap();
        }
        let file = std::fs::read_to_string(&path).unwrap_or_default();
        assert_eq!(file, text, "{}: BLESS=1 accepts what is now", self.name);
    }
}

/// Results, and the words of the streams (eight rows each) after the run.
fn run(program: &Program, args: &[Lit]) -> (Vec<Lit>, Vec<Memory>) {
    let rows = |b: &jerboa_ir::Buffer| Memory { rows: 8, words: vec![0; 8 * b.columns.len()] };
    let mut memory: Vec<Memory> = program.buffers.iter().map(rows).collect();
    let limits = Limits { fuel: 1_000_000, ..Limits::default() };
    let results = interp::run(program, program.entry("main").unwrap(), args, &mut memory, limits).unwrap();
    (results, memory)
}

fn int(x: i32) -> Option<Lit> {
    Some(Lit::I32(x))
}

fn ints(xs: &[i32]) -> Vec<Lit> {
    xs.iter().map(|x| Lit::I32(*x)).collect()
}

fn each(range: std::ops::Range<i32>) -> Vec<Vec<Lit>> {
    range.map(|x| ints(&[x])).collect()
}

/// How often an operation stands in a program.
fn count(program: &Program, op: Op) -> usize {
    program.nodes.iter().filter(|n| matches!(n, Node::Prim { op: o, .. } if *o == op)).count()
}

fn branches(program: &Program) -> usize {
    program.conts.iter().filter(|c| matches!(c.body, Body::Branch { .. } | Body::Switch { .. })).count()
}

/// Section 3.2 of the paper: `fn @(?n & n < 64) pow(x, n)`.
fn power() -> Program {
    build(|| {
        let pow = Fun::<(I32, I32), I32>::rec(
            "pow",
            |(_, n)| known(n) & n.lt(64),
            |b, pow, (x, n)| {
                b.if_(
                    n.eq(0),
                    |_| I32::from(1),
                    |b| {
                        b.if_(
                            (n % 2).eq(0),
                            |b| {
                                let y = pow.call(b, (x, n / 2));
                                y * y
                            },
                            |b| x * pow.call(b, (x, n - 1)),
                        )
                    },
                )
            },
        );
        entry("main", Fun::<(I32, I32), I32>::lam(|b, (x, n)| pow.call(b, (x, n))));
    })
}

#[test]
fn power_of_five_is_three_multiplications() {
    let shows = "pow(x, 5) is three multiplications";
    let classic = Classic { name: "power-5", shows, program: power(), known: vec![None, int(5)] };
    let residual = classic.check(&each(-9..9));
    assert_eq!((count(&residual, Op::Mul), residual.conts.len()), (3, 1));
}

#[test]
fn power_of_sixty_four_stays_a_call() {
    let shows = "pow(x, 64) is beyond the filter: its calls stay, and share one residual function";
    let classic = Classic { name: "power-64", shows, program: power(), known: vec![None, int(64)] };
    let residual = classic.check(&each(-9..9));
    assert_eq!(residual.conts.iter().filter(|c| &*c.name == "pow").count(), 1);
}

#[test]
fn power_of_unknown_stays_a_call() {
    let shows = "pow(x, n): nothing is known, so the calls stay";
    let classic = Classic { name: "power-n", shows, program: power(), known: vec![None, None] };
    classic.check(&(0..70).map(|n| ints(&[3, n])).collect::<Vec<_>>());
}

#[test]
fn ackermann_has_one_function_per_known_argument() {
    let program = build(|| {
        let ack = Fun::<(Keep<I32>, I32), I32>::rec(
            "ack",
            |_| never(),
            |b, ack, (Keep(m), n)| {
                b.if_(
                    m.eq(0),
                    |_| n + 1,
                    |b| {
                        b.if_(
                            n.eq(0),
                            |b| ack.call(b, (Keep(m - 1), 1.into())),
                            |b| {
                                let inner = ack.call(b, (Keep(m), n - 1));
                                ack.call(b, (Keep(m - 1), inner))
                            },
                        )
                    },
                )
            },
        );
        entry("main", Fun::<(I32, I32), I32>::lam(|b, (m, n)| ack.call(b, (Keep(m), n))));
    });
    let shows = "ack(2, n) with m kept: one residual function for each m, none of which tests m";
    let residual = Classic { name: "ackermann", shows, program, known: vec![int(2), None] }.check(&each(0..6));
    assert_eq!(branches(&residual), 2, "one test of n each for m = 2 and m = 1");
}

/// x·Σ i for i in 0..n, by a loop that unrolls where its bounds are known.
fn sum() -> Program {
    build(|| {
        entry(
            "main",
            Fun::<(I32, I32), I32>::lam(|b, (n, x)| {
                b.for_(range(0, n).unroll(), 0.into(), |_, i, sum: I32| sum + i * x)
            }),
        );
    })
}

#[test]
fn a_range_with_known_bounds_unrolls() {
    let shows = "a range with known bounds is straight-line code";
    let residual = Classic { name: "range-4", shows, program: sum(), known: vec![int(4), None] }.check(&each(-5..5));
    assert_eq!(residual.conts.len(), 1);
}

#[test]
fn a_range_with_an_unknown_bound_is_a_loop() {
    let shows = "a range with an unknown bound is one loop";
    let residual = Classic { name: "range-n", shows, program: sum(), known: vec![None, int(3)] }.check(&each(-2..9));
    assert_eq!(branches(&residual), 1);
}

#[test]
fn two_loops_follow_each_other() {
    let program = build(|| {
        entry(
            "main",
            Fun::<I32, I32>::lam(|b, n| {
                let first = b.for_(range(0, n), 1.into(), |_, i, acc: I32| acc * 3 + i);
                b.for_(range(0, 3).unroll(), first, |_, i, acc: I32| acc - i)
            }),
        );
    });
    let shows = "a loop that stays, then one that unrolls";
    Classic { name: "two-loops", shows, program, known: vec![None] }.check(&each(0..9));
}

#[test]
fn an_exit_leaves_both_loops() {
    let program = build(|| {
        entry(
            "main",
            Fun::<(I32, I32), I32>::lam(|b, (n, most)| {
                b.label(|b, found: Exit<I32>| {
                    b.for_(range(0, n), (), |b, i, ()| {
                        b.for_(range(0, i), (), |b, j, ()| b.when((i * j).gt(most), |b| found.take(b, i * 100 + j)));
                    });
                    I32::from(-1)
                })
            }),
        );
    });
    let shows = "an exit inside two loops returns from the whole function: no flag, no closure";
    let classic = Classic { name: "multi-level-break", shows, program, known: vec![None, int(7)] };
    let residual = classic.check(&each(0..9));
    assert_eq!(branches(&residual), 3);
}

#[test]
fn safe_division_has_an_error_exit() {
    let program = build(|| {
        let safe_div = Fun::<(I32, I32, Exit<I32>), I32>::lam(|b, (x, y, error)| {
            b.when(y.eq(0), |b| error.take(b, x));
            x / y
        });
        entry(
            "main",
            Fun::<(I32, I32), I32>::lam(|b, (x, y)| {
                b.label(|b, error: Exit<I32>| {
                    let first = safe_div.call(b, (x, y, error));
                    let second = safe_div.call(b, (first, 3.into(), error));
                    second + safe_div.call(b, (second, y, error))
                })
            }),
        );
    });
    let shows = "safe_div's error is an exit: a jump where the divisor is unknown, nothing where it is known";
    let inputs: Vec<Vec<Lit>> = (-3..4).flat_map(|x| (-3..4).map(move |y| ints(&[x * 100, y]))).collect();
    Classic { name: "safe-div", shows, program, known: vec![None, None] }.check(&inputs);
}

/// Odd-even transposition over an array that is a function from places to values: it exists while specialising only.
#[test]
fn a_sorting_network_has_no_array() {
    type Array = Fun<I32, I32>;
    let program = build(|| {
        let put = |a: Array, at: I32, x: I32, y: I32| {
            Array::lam(move |b, i| b.if_(i.eq(at), |_| x, |b| b.if_(i.eq(at + 1), |_| y, |b| a.call(b, i))))
        };
        entry(
            "main",
            Fun::<(I32, I32, I32, I32), I32>::lam(|b, (p, q, r, s)| {
                let input = Array::lam(move |b, i| {
                    b.if_(i.eq(0), |_| p, |b| b.if_(i.eq(1), |_| q, |b| b.if_(i.eq(2), |_| r, |_| s)))
                });
                let sorted = b.for_(range(0, 4).unroll(), input, |b, round, a| {
                    b.for_(range(0, 2).unroll(), a, |b, k, a| {
                        let at = k * 2 + round % 2;
                        b.if_(
                            at.lt(3),
                            |b| {
                                let (x, y) = (a.call(b, at), a.call(b, at + 1));
                                put(a, at, x.min(y), x.max(y))
                            },
                            |_| a,
                        )
                    })
                });
                let digit = |b: &mut Block, i: i32| sorted.call(b, i.into());
                let (first, second) = (digit(b, 0), digit(b, 1));
                let (third, fourth) = (digit(b, 2), digit(b, 3));
                ((first * 10 + second) * 10 + third) * 10 + fourth
            }),
        );
    });
    let shows = "a sorting network: six comparators, no array, no loop";
    let inputs: Vec<Vec<Lit>> = (0..256).map(|k| ints(&[k & 3, k >> 2 & 3, k >> 4 & 3, k >> 6])).collect();
    let residual = Classic { name: "sorting-network", shows, program, known: vec![None; 4] }.check(&inputs);
    assert_eq!((count(&residual, Op::Min), count(&residual, Op::Max), residual.conts.len()), (6, 6, 1));
}

stream! {
    /// Where the digits go.
    Digits { DIGIT: I32; }
}

/// The stack is the recursion: digits come out last first, and are stored first last.
fn digits() -> Program {
    build(|| {
        declare(&[spec::<Digits>()]);
        let put = Fun::<I32, I32>::rec("put", known::<I32>, |b, put, n| {
            b.if_(
                n.eq(0),
                |_| I32::from(0),
                |b| {
                    let at = put.call(b, n / 10);
                    b.store(Digits::DIGIT, at.bits(), n % 10);
                    at + 1
                },
            )
        });
        entry("main", Fun::<I32, I32>::lam(|b, n| put.call(b, n)));
    })
}

#[test]
fn a_stack_by_recursion_stays_recursive() {
    let shows = "recursion as a stack: a residual function that calls itself, not in the last place";
    let inputs: Vec<Vec<Lit>> = [0, 7, 42, 90210].iter().map(|n| ints(&[*n])).collect();
    Classic { name: "stack-n", shows, program: digits(), known: vec![None] }.check(&inputs);
}

#[test]
fn a_known_stack_is_stores() {
    let shows = "the same stack with known content is three stores";
    let residual = Classic { name: "stack-421", shows, program: digits(), known: vec![int(421)] }.check(&[vec![]]);
    assert_eq!(branches(&residual), 0);
}

#[test]
fn logic_operators_take_what_they_need() {
    let program = build(|| {
        let and =
            Fun::<(Bool, Fun<(), Bool>), Bool>::lam(|b, (x, y)| b.if_(x, |b| y.call(b, ()), |_| Bool::from(false)));
        let or = Fun::<(Bool, Fun<(), Bool>), Bool>::lam(|b, (x, y)| b.if_(x, |_| Bool::from(true), |b| y.call(b, ())));
        entry(
            "main",
            Fun::<(I32, I32, Bool), Bool>::lam(|b, (x, y, deep)| {
                let fits = Fun::<(), Bool>::lam(move |_, ()| (x / y).gt(2));
                let nonzero = and.call(b, (y.ne(0), fits));
                let rest = Fun::<(), Bool>::lam(move |_, ()| nonzero);
                let gate = Fun::<(), Bool>::lam(move |b, ()| or.call(b, (y.gt(100), rest)));
                and.call(b, (deep, gate))
            }),
        );
    });
    let shows = "`and` and `or` with lazy right sides: the division stays behind its test";
    let inputs: Vec<Vec<Lit>> = (0..40).map(|k| ints(&[k * 17, k % 7])).collect();
    Classic { name: "logic", shows, program, known: vec![None, None, Some(Lit::Bool(true))] }.check(&inputs);
}

/// Ten lines of interpreter over a program that is data: what is left is the program, compiled.
#[test]
fn an_interpreter_becomes_a_compiler() {
    let program = build(|| {
        // (operation, operand) at each place: acc ← 1; while n > 0 { acc ← acc · x; n ← n − 1 }; stop.
        let fetch = Fun::<I32, (I32, I32)>::lam(|b, pc| {
            b.switch(
                pc.bits(),
                &[
                    (0, &|_| (I32::from(0), I32::from(4))),
                    (1, &|_| (I32::from(1), I32::from(0))),
                    (2, &|_| (I32::from(2), I32::from(1))),
                    (3, &|_| (I32::from(3), I32::from(0))),
                ],
                |_| (I32::from(4), I32::from(0)),
            )
        });
        type State = (Keep<I32>, I32, I32, I32);
        let run = Fun::<State, I32>::rec(
            "run",
            |_| never(),
            |b, run, (Keep(pc), x, n, acc)| {
                let (op, operand) = fetch.call(b, pc);
                let next = Keep(pc + 1);
                b.switch(
                    op.bits(),
                    &[
                        (0, &|b| {
                            b.if_(
                                n.le(0),
                                |b| run.call(b, (Keep(operand), x, n, acc)),
                                |b| run.call(b, (next, x, n, acc)),
                            )
                        }),
                        (1, &|b| run.call(b, (next, x, n, acc * x))),
                        (2, &|b| run.call(b, (next, x, n - operand, acc))),
                        (3, &|b| run.call(b, (Keep(operand), x, n, acc))),
                    ],
                    |_| acc,
                )
            },
        );
        entry("main", Fun::<(I32, I32), I32>::lam(|b, (x, n)| run.call(b, (Keep(0.into()), x, n, 1.into()))));
    });
    let shows = "the first Futamura projection: an interpreter and its program become one loop with one multiplication";
    let inputs: Vec<Vec<Lit>> = (-1..9).map(|n| ints(&[3, n])).collect();
    let residual = Classic { name: "futamura", shows, program, known: vec![None, None] }.check(&inputs);
    assert_eq!((branches(&residual), count(&residual, Op::Mul)), (1, 1));
}
