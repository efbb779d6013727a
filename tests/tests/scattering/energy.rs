//! T7: as much light comes back as a calculation in f64 says, and never more than came.

use jerboa_tests::harness::bench::number;
use jerboa_tests::harness::probe::{Probe, at_cos};
use jerboa_tests::harness::scattering::rows;

/// Cosines at which energy is compared; the negative ones are seen from below.
const VIEWS: [f64; 11] = [1.0, 0.9, 0.7, 0.5, 0.3, 0.1, 0.01, -1.0, -0.8, -0.5, -0.05];

#[test]
fn albedo_is_what_quadrature_says() {
    let mut probe = Probe::default();
    let samples = number("JERBOA_SAMPLES", 4000) as u32;
    let (mut faults, mut largest) = (Vec::new(), 0.0_f64);
    for row in rows() {
        (row.make)(&mut probe);
        for cos in VIEWS {
            let (mean, error) = probe.albedo(at_cos(cos), samples);
            if mean > 1.0 + 4.0 * error + 1e-6 {
                faults.push(format!("{} at {cos}: {mean} ± {error} is more than all", row.name));
            }
            let Some(returned) = &row.returned else { continue };
            let expected = returned(cos);
            largest = largest.max((mean - expected).abs());
            if (mean - expected).abs() > (4.0 * error).max(5e-4) {
                faults.push(format!("{} at {cos}: {mean} ± {error}, not {expected}", row.name));
            }
        }
    }
    println!("largest difference {largest:.2e}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Smooth white interfaces lose nothing at all.
#[test]
fn smooth_interfaces_are_lossless() {
    let mut probe = Probe::default();
    for row in rows().iter().filter(|row| ["metal 0.000", "glass 0.000", "thin 0.000"].contains(&&*row.name)) {
        (row.make)(&mut probe);
        for cos in VIEWS {
            for key in 0..200 {
                let s = probe.sample(at_cos(cos), key);
                assert!((s.weight[1] / s.scale - 1.0).abs() < 1e-6, "{} at {cos}: {s:?}", row.name);
            }
        }
    }
}

/// N5: the weight of a visible microfacet is what remains to be masked, at most 1.
#[test]
fn visible_microfacets_weigh_at_most_one() {
    let mut probe = Probe::default();
    for row in rows().iter().filter(|row| row.name.starts_with("metal")) {
        (row.make)(&mut probe);
        for cos in VIEWS {
            for key in 0..500 {
                let s = probe.sample(at_cos(cos), key);
                assert!(s.weight[1] <= 1.0 + 1e-6, "{} at {cos}: {s:?}", row.name);
            }
        }
    }
}
