//! T8: f(a, b) = f(b, a); across an interface, divided by the square of the index there.

use jerboa_tests::harness::bench::{Random, number};
use jerboa_tests::harness::probe::{Probe, V, random_direction};
use jerboa_tests::harness::scattering::rows;

#[test]
fn scattering_is_reciprocal() {
    let mut random = Random::new(0x8);
    let mut probe = Probe::default();
    let (mut faults, mut worst) = (Vec::new(), (0.0, String::new()));
    for row in rows() {
        (row.make)(&mut probe);
        let index2 = |w: V| if w[2] < 0.0 { row.index * row.index } else { 1.0 };
        for key in 0..number("JERBOA_PAIRS", 1000) as u32 {
            let a = random_direction(&mut random);
            // Narrow lobes are met by sampling only.
            let b = if key % 2 == 0 { random_direction(&mut random) } else { probe.sample(a, key).wi };
            let across = a[2] * b[2] < 0.0 && row.index != 1.0;
            let lost = if across { digits_lost(a, b, row.index) } else { 0.0 };
            let (ab, ba) = (probe.eval(a, b).0, probe.eval(b, a).0);
            for (x, y) in ab.iter().zip(ba) {
                let (x, y) = (f64::from(*x) / index2(b), f64::from(y) / index2(a));
                let allowed = (row.precision() + lost) * x.max(y) + 1e-9;
                if (x - y).abs() > worst.0 * allowed {
                    worst = ((x - y).abs() / allowed, row.name.clone());
                }
                if (x - y).abs() > allowed {
                    faults.push(format!("{}: {a:?} {b:?}: {x} {y}", row.name));
                }
            }
        }
    }
    println!("{}: {:.2} of what is allowed", worst.1, worst.0);
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults[..faults.len().min(20)].join("\n"));
}

/// How far f of a refraction may be off, relatively. It goes with 1 − F, which goes with the cosine o to the microfacet in
/// the thinner medium. From the denser one o is the root of a difference of order 1: its rounding, 4e-7, counts by 1/o².
fn digits_lost(a: V, b: V, index: f64) -> f64 {
    let (above, below) = if a[2] > 0.0 { (a, b) } else { (b, a) };
    let half: [f64; 3] = std::array::from_fn(|i| f64::from(above[i]) + index * f64::from(below[i]));
    let scalar = |x: &dyn Fn(usize) -> f64| (0..3).map(|i| x(i) * half[i]).sum::<f64>();
    let o2 = scalar(&|i| f64::from(above[i])).powi(2) / scalar(&|i| half[i]);
    4e-7 / o2
}
