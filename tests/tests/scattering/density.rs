//! T5: samples fall as the density says.

use jerboa_tests::harness::bench::number;
use jerboa_tests::harness::chi2;
use jerboa_tests::harness::probe::{Probe, V, at_cos};
use jerboa_tests::harness::scattering::rows;
use jerboa_tests::harness::stats::{FAMILY, sidak};

/// Cosines of the angles to the normal from which is looked: 0, 45, 80, 89.9 degrees, and from below, where a ray of index
/// 1.5 gets out at 30 degrees and is totally reflected from 41.8 degrees on.
fn views() -> [f64; 8] {
    [0.0, 45.0, 80.0, 89.9, 150.0, 135.0, 100.0, 90.1].map(|degrees: f64| degrees.to_radians().cos())
}

/// The seed of T5: samples are numbered from here.
const FIRST: u32 = 0x5000_0000;

#[test]
fn samples_follow_the_density() {
    println!("first key {FIRST:#x}");
    let mut probe = Probe::default();
    let (rows, samples) = (rows(), number("JERBOA_SAMPLES", 5000) as u32);
    let level = sidak(FAMILY, rows.len() * views().len());
    let (mut faults, mut smallest) = (Vec::new(), f64::INFINITY);
    for (i, row) in rows.iter().enumerate() {
        (row.make)(&mut probe);
        // The quick version looks from every third side, in turn.
        let every = if samples > 5000 { 1 } else { 3 };
        for cos in views().into_iter().skip(i % every).step_by(every) {
            let wo = at_cos(cos);
            let report = chi2::sphere(&directions(&mut probe, wo, samples), |wi| f64::from(probe.eval(wi, wo).1));
            smallest = if report.freedom > 0 { report.p.min(smallest) } else { smallest };
            faults.extend(report.fault(level).map(|fault| format!("{} at {cos:.4}: {fault}", row.name)));
        }
    }
    println!("smallest p {smallest:.2e}, level {level:.2e}");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Samples that have a density.
fn directions(probe: &mut Probe, wo: V, samples: u32) -> Vec<Option<V>> {
    let keys = FIRST..FIRST + samples;
    keys.map(|key| Some(probe.sample(wo, key)).filter(|s| !s.is_specular && s.pdf > 0.0).map(|s| s.wi)).collect()
}
