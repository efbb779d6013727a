//! Law 6 over random programs: they verify, they read back as they print, and what was read runs as the original.

use jerboa_ir::interp::{Limits, run};
use jerboa_ir::{parse, print, verify, verify_residual};
use jerboa_peval::{Arg, Facts, Generic, Options, specialize};
use jerboa_tests::choices::Choices;
use jerboa_tests::programs::case;

/// Programs of a run in the test command.
const PROGRAMS: u64 = 500;

/// A run that needs more jumps is not compared.
const LIMITS: Limits = Limits { fuel: 20_000, cells: 1 << 20 };

#[test]
fn random_programs_read_back_as_they_print() {
    for seed in 0..PROGRAMS {
        let mut c = Choices::random(seed);
        let case = case(&mut c);
        let text = print(&case.program);
        assert_eq!(verify(&case.program), [], "seed {seed}:\n{text}");
        let read = parse(&text).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        assert_eq!(print(&read), text, "seed {seed}");
        assert_eq!(verify(&read), [], "seed {seed}:\n{text}");

        let args = case.arguments(&mut c);
        let (mut before, mut after) = (case.memory.clone(), case.memory.clone());
        let main = read.entry("main").expect("main is an entry");
        let expected = run(&case.program, case.main, &args, &mut before, LIMITS);
        let actual = run(&read, main, &args, &mut after, LIMITS);
        if expected.is_ok() {
            assert_eq!((actual, after), (expected, before), "seed {seed}:\n{text}");
        }
    }
}

#[test]
fn residuals_of_random_programs_are_first_order_and_read_back() {
    let mut residuals = 0;
    for seed in 0..PROGRAMS {
        let case = case(&mut Choices::random(seed));
        let args = vec![Arg::Unknown; case.params().len()];
        let generic = Generic::new(case.program);
        // A program whose functions differ by what is unknown has no residual (Law 4).
        let Ok(residual) = specialize(&generic, "main", &args, &Facts::none(), &Options::default()) else { continue };
        residuals += 1;
        let text = print(&residual.program);
        assert_eq!(verify_residual(&residual.program), [], "seed {seed}:\n{text}");
        let read = parse(&text).unwrap_or_else(|e| panic!("seed {seed}: {e}\n{text}"));
        assert_eq!(print(&read), text, "seed {seed}");
    }
    assert!(residuals * 2 > PROGRAMS, "{residuals} of {PROGRAMS} programs have a residual");
}
