//! Loops of independent iterations: every engine and every order gives the same bits, whatever is known.

use jerboa_backend_cranelift as cranelift;
use jerboa_backend_cranelift::lanes::Width;
use jerboa_ir::interp::{Interp, Limits, Memory};
use jerboa_ir::lang::*;
use jerboa_ir::{Lit, Program, print, verify, verify_residual};
use jerboa_peval::{Arg, Error, Facts, Generic, Options, Residual, specialize};
use jerboa_tests::choices::Rng;
use jerboa_tests::machine::call;

jerboa_ir::table! {
    /// In which order.
    Order {
        /// A place.
        AT: U32, bulk;
    }
}

jerboa_ir::stream! {
    /// What goes in and out.
    Items {
        /// Read at any index.
        X: F32;
        /// Written at the iteration's index.
        Y: F32;
        /// Read and written.
        SUM: F32;
    }
}

/// What all bodies here are made of: branches, loops of their own length, calls that stay, recursion, a local array,
/// reads and loads at any index.
fn mixed(width: u8) -> Program {
    build(|| {
        declare(&[spec::<Order>(), spec::<Items>()]);
        let half = Fun::<F32, F32>::named("half", |_, x| x * 0.5);
        let tower = Fun::<(F32, U32), F32>::rec(
            "tower",
            |_| never(),
            |b, tower, (x, n)| b.if_(n.eq(0), |_| F32::from(1.0), |b| x * tower.call(b, (x, n - 1)) + 0.25),
        );
        let main = Fun::<(F32, U32, U32, U32), ()>::lam(|b, (a, lo, hi, k)| {
            let limit = a + 2.0;
            b.vectorize(width, lo, hi, |b, i| {
                let from = Row::<Order>::at(i).get(Order::AT);
                let x = b.load::<Items, F32>(Items::X, from);
                let places = b.array::<F32>(3);
                b.set(places, i % 3, x);
                let y = b.if_(
                    x.lt(limit),
                    |b| half.call(b, x) + b.get(places, from),
                    |b| {
                        let rounds = (i & 7, x);
                        b.while_(rounds, |_, (n, _)| n.gt(0), |_, (n, y)| (n - 1, y * a - 1.0)).1
                    },
                );
                let y = y + tower.call(b, (x, from & 3));
                b.when(y.lt(100.0), |b| {
                    let sum = b.load::<Items, F32>(Items::SUM, i + k);
                    b.store(Items::SUM, i + k, sum + y);
                });
                b.store(Items::Y, i, y);
            });
        });
        entry("main", main);
    })
}

fn memory(rows: u32, seed: u64) -> Vec<Memory> {
    let mut rng = Rng(seed);
    let words = |rng: &mut Rng, count: u32, word: &dyn Fn(&mut Rng) -> u32| (0..count).map(|_| word(rng)).collect();
    let order = words(&mut rng, rows.max(1), &|rng| rng.below(2 * rows + 1));
    let special = [0.0, -0.0, 1.5, f32::INFINITY, f32::NAN, 1e-40, -7.0, 3.0].map(f32::to_bits);
    let items = words(&mut rng, rows * 3, &|rng| special[rng.below(8) as usize]);
    vec![Memory { rows: rows.max(1), words: order }, Memory { rows, words: items }]
}

/// The streams with the one NaN.
fn floats(memory: &[Memory]) -> Vec<Lit> {
    memory[1].words.iter().map(|w| Lit::from_word(jerboa_ir::Scalar::F32, *w)).collect()
}

fn residual(p: &Program, known: &[Arg]) -> Residual {
    let options = Options { log: true, ..Options::default() };
    specialize(&Generic::new(p.clone()), "main", known, &Facts::none(), &options).unwrap_or_else(|e| panic!("{e}"))
}

fn interpret(p: &Program, args: &[Lit], memory: &[Memory], order: Option<u64>) -> Vec<Lit> {
    let mut memory = memory.to_vec();
    let interp = order.iter().fold(Interp::new(p), |interp, order| interp.shuffled(*order));
    interp.run(p.entry("main").expect("there is a main"), args, &mut memory, Limits::default()).expect("it runs");
    floats(&memory)
}

fn run(p: &Program, args: &[Lit], memory: &[Memory], opt: cranelift::Opt, lanes: Option<Width>) -> Vec<Lit> {
    let options = cranelift::Options { opt, verify: true, lanes, ..Default::default() };
    let code = cranelift::compile(&[p], &options).unwrap_or_else(|e| panic!("{e}"));
    let mut memory = memory.to_vec();
    let kernel = code.kernel("main").expect("main is compiled");
    call(kernel, p, p.entry("main").expect("there is a main"), args, &mut memory).expect("it runs");
    floats(&memory)
}

#[test]
fn all_engines_and_orders_agree() {
    for width in [4, 8, 16] {
        let p = mixed(width);
        assert_eq!(verify(&p), []);
        let once = residual(&p, &[Arg::Unknown; 4]).program;
        assert_eq!(verify_residual(&once), []);
        assert_eq!(print(&residual(&once, &[Arg::Unknown; 4]).program), print(&once));
        for (rows, lo, hi, k) in [(23, 0, 23, 0), (23, 5, 21, 2), (9, 4, 4, 1), (9, 8, 2, 0), (0, 0, 3, 0)] {
            let args = [Lit::f32(1.25), Lit::U32(lo), Lit::U32(hi), Lit::U32(k)];
            let memory = memory(rows, u64::from(rows + hi));
            let expected = interpret(&p, &args, &memory, None);
            for order in [0, 3, 0x9e37_79b9_7f4a_7c15] {
                assert_eq!(interpret(&p, &args, &memory, Some(order)), expected, "order {order}");
            }
            assert_eq!(interpret(&once, &args, &memory, None), expected);
            assert_eq!(interpret(&once, &args, &memory, Some(5)), expected);
            for opt in [cranelift::Opt::None, cranelift::Opt::Speed] {
                for lanes in [None, Some(Width::Hint), Some(Width::Lanes(8))] {
                    assert_eq!(run(&once, &args, &memory, opt, lanes), expected);
                }
            }
            let all = residual(&p, &args.map(Arg::Known)).program;
            assert_eq!(interpret(&all, &[], &memory, None), expected);
            assert_eq!(run(&all, &[], &memory, cranelift::Opt::Speed, Some(Width::Hint)), expected);
        }
    }
}

#[test]
fn no_iteration_leaves_nothing_and_the_log_tells() {
    let p = mixed(8);
    let known = |lo: u32, hi: u32| [Arg::Unknown, Arg::Known(Lit::U32(lo)), Arg::Known(Lit::U32(hi)), Arg::Unknown];
    let empty = residual(&p, &known(3, 3));
    assert_eq!(empty.program.conts.len(), 1, "{}", print(&empty.program));
    let line =
        |r: &Residual| r.log.to_string().lines().find(|l| l.contains("vectorize")).unwrap_or_default().to_owned();
    assert!(line(&empty).ends_with("body of a vectorize, never runs"), "{}", empty.log);
    let one = residual(&p, &known(3, 4));
    assert!(line(&one).ends_with("body of a vectorize, stays as a function"), "{}", one.log);
}

/// The order matters where iterations meet, so an order that is not ascending shows it; and the residual's verifier.
#[test]
fn iterations_that_meet_are_found() {
    let p = build(|| {
        declare(&[spec::<Order>(), spec::<Items>()]);
        let main = Fun::<U32, ()>::lam(|b, n| {
            b.vectorize(4, 1, n, |b, i| {
                let before = b.load::<Items, F32>(Items::X, i - 1);
                b.store(Items::X, i, before + 1.0);
            });
        });
        entry("main", main);
    });
    assert_eq!(verify(&p), []);
    let memory = [Memory { rows: 1, words: vec![0] }, Memory { rows: 8, words: vec![0; 24] }];
    let results = |order| interpret(&p, &[Lit::U32(8)], &memory, order);
    assert_ne!(results(None), results(Some(2)));
    let options = Options { check: true, ..Options::default() };
    match specialize(&Generic::new(p.clone()), "main", &[Arg::Unknown], &Facts::none(), &options) {
        Err(Error::NotFirstOrder { faults, .. }) => {
            assert_eq!(faults[0].rule, "independent");
            assert!(faults[0].to_string().contains("tests/vectorize.rs"), "it names the author's line: {}", faults[0]);
        }
        other => panic!("{other:?}"),
    }
}

/// Two things that look alike: a load that clamps to a row which another iteration stores, and one to a row which none does.
#[test]
fn loads_beyond_what_iterations_store_are_found() {
    let p = build(|| {
        declare(&[spec::<Order>(), spec::<Items>()]);
        let main = Fun::<(U32, U32), ()>::lam(|b, (lo, hi)| {
            b.vectorize(4, lo, hi, |b, i| {
                let sum = b.load::<Items, F32>(Items::SUM, i);
                b.store(Items::SUM, i, sum + 1.0);
            });
        });
        entry("main", main);
    });
    let run = |lo: u32, hi: u32| {
        let mut memory = memory(8, 1);
        let main = p.entry("main").expect("there is a main");
        Interp::new(&p).run(main, &[Lit::U32(lo), Lit::U32(hi)], &mut memory, Limits::default())
    };
    assert_eq!(run(0, 8), Ok(vec![]));
    assert_eq!(run(8, 12), Ok(vec![]));
    let stop = run(0, 9).expect_err("iteration 8 loads what iteration 7 stores").to_string();
    assert!(stop.contains("beyond the last row of `Items.SUM`") && stop.contains("tests/vectorize.rs"), "{stop}");
}

#[test]
#[should_panic(expected = "`vectorize` is 4, 8 or 16 wide, not 3")]
fn other_widths_are_refused() {
    build(|| {
        declare(&[spec::<Items>()]);
        entry("main", Fun::<U32, ()>::lam(|b, n| b.vectorize(3, 0, n, |_, _| ())));
    });
}
