//! T18: each function of the math library against f64, and special values on every engine. The rows are in
//! [`jerboa_tests::harness::functions`]; the command `sweep` is the long version, over all 2^32 arguments.

use jerboa_tests::harness::bench::{Random, number};
use jerboa_tests::harness::functions::FUNCTIONS;

#[test]
fn functions_are_within_their_bounds() {
    let n = number("JERBOA_ARGUMENTS", 1 << 18);
    let mut random = Random::new(0x5eed_0019);
    let mut beyond = vec![];
    for f in FUNCTIONS {
        let worst = f.sweep(&mut random, n);
        println!("{}: {worst:?}", f.name);
        if worst.error > f.bound {
            beyond.push((f.name, worst));
        }
    }
    assert!(beyond.is_empty(), "{beyond:#?}");
}

#[test]
fn special_values_are_the_same_on_every_engine() {
    FUNCTIONS.iter().for_each(|f| f.special());
}
