//! Every warp of the table against its density and its shape (T5, N8). `JERBOA_SAMPLES=N` draws N times from each.

use jerboa_ir::lang::{Fun, entry};
use jerboa_lib_render::core::sampling::cone_rim;
use jerboa_lib_render::core::vec::{Vec2, Vec3};
use jerboa_tests::harness::bench::{Bench, Random, number};
use jerboa_tests::harness::chi2::{self, Report};
use jerboa_tests::harness::probe::{V, dot};
use jerboa_tests::harness::stats::{FAMILY, sidak};
use jerboa_tests::harness::warps::{Shape, WARPS, Warp};

/// Largest number below 1 that is drawn.
const LAST: f32 = 1.0 - 1.0 / 16_777_216.0;

/// For each warp NAME: (u, v) → point, density there; `NAME at`: point → density.
fn bench() -> Bench {
    Bench::new(|| {
        for Warp { name, map, pdf, .. } in WARPS {
            entry(
                name,
                Fun::lam(move |_, u: Vec2| {
                    let p = map(u);
                    (p, pdf(p))
                }),
            );
            entry(&format!("{name} at"), Fun::lam(move |_, p: Vec3| pdf(p)));
        }
        entry("rim", Fun::lam(|_, u: Vec2| cone_rim(u.x, u.y)));
    })
}

fn point(out: &[f32]) -> V {
    [out[0], out[1], out[2]]
}

#[test]
fn warps_are_drawn_by_their_density() {
    let mut bench = bench();
    let mut random = Random::new(0x5eed_0005);
    let level = sidak(FAMILY, WARPS.len());
    for Warp { name, shape, .. } in WARPS {
        let points: Vec<V> = (0..number("JERBOA_SAMPLES", 10_000))
            .map(|_| {
                let u = [(); 2].map(|()| (random.bits() >> 40) as f32 / 16_777_216.0);
                point(&bench.run_floats(name, &u))
            })
            .collect();
        let at = format!("{name} at");
        let mut pdf = |p: V| f64::from(bench.run_floats(&at, &p)[0]);
        let report: Report = match shape {
            Shape::Directions => chi2::sphere(&points.iter().copied().map(Some).collect::<Vec<_>>(), pdf),
            // The disk in its square, four times as large as the unit one.
            Shape::Disk => {
                let inside = |p: &V| Some([0, 1].map(|i| (f64::from(p[i]) + 1.0) / 2.0));
                let samples: Vec<_> = points.iter().map(inside).collect();
                chi2::square(&samples, |[x, y]| 4.0 * pdf([(2.0 * x - 1.0) as f32, (2.0 * y - 1.0) as f32, 0.0]))
            }
            Shape::Triangle => {
                let samples: Vec<_> = points.iter().map(|p| Some([f64::from(p[0]), f64::from(p[1])])).collect();
                chi2::square(&samples, |[x, y]| pdf([x as f32, y as f32, 0.0]))
            }
        };
        println!("{name}: ∫ {:.6}, p {:.3}", report.integral, report.p);
        assert_eq!(report.fault(level), None, "{name}");
    }
}

/// Corners, middles and a grid of the unit square: finite, of unit length or flat, where the density is positive, and the
/// same by the interpreter.
#[test]
fn warps_keep_their_shape_at_the_ends() {
    let mut bench = bench();
    let numbers = [0.0, 1.0 / 16_777_216.0, 0.125, 0.25, 0.5, 0.5 + 1.0 / 16_777_216.0, 0.7, 0.75, LAST];
    for Warp { name, shape, .. } in WARPS {
        for (u, v) in numbers.iter().flat_map(|u| numbers.map(|v| (*u, v))) {
            let out: Vec<f32> =
                bench.run_both(name, &[u, v].map(f32::to_bits)).into_iter().map(f32::from_bits).collect();
            let p = point(&out);
            assert!(out.iter().all(|x| x.is_finite()), "{name} at {u}, {v}: {out:?}");
            // The rim of the hemisphere itself has cosine and density 0.
            assert!(out[3] > 0.0 || (name == "cosine hemisphere" && p[2] == 0.0), "{name} at {u}, {v}: {out:?}");
            match shape {
                Shape::Directions => assert!((dot(p, p) - 1.0).abs() < 1e-6, "{name} at {u}, {v}: {p:?}"),
                Shape::Disk | Shape::Triangle => assert_eq!(p[2], 0.0, "{name} at {u}, {v}: {p:?}"),
            }
        }
    }
}

/// N8. A cone that is narrower than what a cosine can tell from 1 keeps its width: the sine of its rim is right to 1e-6.
#[test]
fn narrow_cones_keep_their_width() {
    let mut bench = bench();
    for exponent in -40..=1 {
        let c = 2_f32.powi(exponent);
        for turns in [0.0, 0.1, 0.25, 0.6] {
            let [x, y] = [0, 1].map(|i| f64::from(bench.run_floats("rim", &[c, turns])[i]));
            let truth = (f64::from(c) * (2.0 - f64::from(c))).sqrt();
            assert!((x.hypot(y) - truth).abs() <= 1e-6 * truth, "1 − cos = {c}: {}", x.hypot(y));
        }
    }
}
