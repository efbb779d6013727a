//! T8: f(a, b) = f(b, a); across an interface, divided by the square of the index there.
//!
//! The directions are the same floats both ways, so nothing is allowed for their rounding, nor for the steepness of a lobe.

use jerboa_tests::harness::bench::{Random, number};
use jerboa_tests::harness::probe::{Probe, V, dot, random_direction};
use jerboa_tests::harness::scattering::rows;

#[test]
fn scattering_is_reciprocal() {
    let mut random = Random::new(0x8);
    let mut probe = Probe::default();
    let (mut faults, mut worst) = (Vec::new(), (0.0, String::new()));
    for row in rows().into_iter().filter(|row| row.has_one_normal) {
        (row.make)(&mut probe);
        let normal = probe.shading_normal();
        let index2 = |w: V| if dot(w, normal) < 0.0 { row.index * row.index } else { 1.0 };
        for key in 0..number("JERBOA_PAIRS", 1000) as u32 {
            let a = random_direction(&mut random);
            // Narrow lobes are met by sampling only.
            let b = if key % 2 == 0 { random_direction(&mut random) } else { probe.sample(a, key).wi };
            let (ab, ba) = (probe.eval(a, b).0, probe.eval(b, a).0);
            for (x, y) in ab.iter().zip(ba) {
                let (x, y) = (f64::from(*x) / index2(b), f64::from(y) / index2(a));
                let error = if x == y { 0.0 } else { (x - y).abs() / x.max(y) };
                if error > worst.0 {
                    worst = (error, row.name.clone());
                }
                if error.is_nan() || error > 2e-5 {
                    faults.push(format!("{}: {a:?} {b:?}: {x} {y}", row.name));
                }
            }
        }
    }
    println!("largest relative difference {:.2e}, {}", worst.0, worst.1);
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults[..faults.len().min(20)].join("\n"));
}
