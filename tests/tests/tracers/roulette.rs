//! T16 for the tracers whose paths start at lights: what roulette costs in a glowing ball, seen from its middle.
//!
//! There both have a theory. From any point of a ball a cosine-weighted direction leads to a point that is uniform over it, and the
//! form factor of any two points is the same. So the vertices of a path are independent and uniform, and every connection of two
//! carries as much. Let the albedo be ρ and the emission 1 − ρ, so that the radiance is 1. A path carries ρ^(k−1) to its k-th vertex
//! up to the scattering s from which roulette begins, after that 1; it has s vertices with probability 1 − ρ^s, and each one
//! beyond is followed by another with probability ρ. Let h(x) be how often the camera draws a point of the ball, over how often a
//! path from a light does: 0 where it does not look, 1 on average.
//!
//! - Light tracer: each vertex adds ρ (1 − ρ) h times what is carried to it.
//! - Bidirectional tracer: of the k + 1 ways to draw a path of k ≥ 2 edges, all but the light tracer's have the same density, h at the
//!   first vertex times that of the light tracer's. So a weight is h / (k h + 1), and the light tracer's 1 / (k h + 1).
//!
//! The rest is sums over both numbers of vertices. In a box vertices are uniform too, but neighbours are not independent: of that the
//! mean is tested alone.
//!
//! A mean must lie within 4 standard errors, so right code fails one for another seed in 1 of 16,000; a variance within a fifth of
//! the theory's, as the list has it, or within 4 of its own standard errors where those are more, as they are in the quick form.
//!
//! ```text
//! JERBOA_PATHS=100000 cargo test --release -p jerboa-tests --test tracers roulette -- --nocapture --test-threads 1
//! ```

use std::f64::consts::PI;

use glam::DVec3;
use jerboa_lib_render::host::film::Film;
use jerboa_lib_render::host::generate::TracerKind;
use jerboa_lib_render::host::renderer::{Handle, Render, Renderer};
use jerboa_lib_render::host::tables::Choices;
use jerboa_scenes::{Camera, Material, Scene};
use jerboa_tests::harness::analytic::{Estimate, SEED, bound, glowing_box, inside_out, place, sphere};
use jerboa_tests::harness::bench::number;

use crate::renderer;

/// Half the film's height at distance 1. With 1.5 the mean of h over the film, which is what the camera's choice costs, is least: 6.
const HALF: f64 = 1.5;

/// What the theory of a path needs.
struct Roulette {
    albedo: f64,
    /// The scattering from which it begins.
    start: i32,
}

impl Roulette {
    /// Numbers of vertices, but for the longest paths: one in 100,000.
    fn lengths(&self) -> std::ops::RangeInclusive<i32> {
        self.start..=self.start + (1e-5_f64.ln() / self.albedo.ln()) as i32
    }

    fn probability(&self, vertices: i32) -> f64 {
        let goes_on = self.albedo.powi(self.start);
        match vertices - self.start {
            0 => 1.0 - goes_on,
            more => goes_on * self.albedo.powi(more - 1) * (1.0 - self.albedo),
        }
    }

    /// To a vertex, from 1 on.
    fn carried(&self, vertex: i32) -> f64 {
        if vertex <= self.start { self.albedo.powi(vertex - 1) } else { 1.0 }
    }

    /// Mean and variance of what a path from a light adds, each vertex `weighed` (from 1 on): by the mean and the variance of h
    /// times a weight.
    fn splats(&self, vertices: i32, weighed: impl Fn(i32) -> [f64; 2]) -> [f64; 2] {
        (1..=vertices).fold([0.0; 2], |[mean, variance], i| {
            let each = self.albedo * (1.0 - self.albedo) * self.carried(i);
            let [m, v] = weighed(i);
            [mean + each * m, variance + each * each * v]
        })
    }

    /// Mean and relative variance of the light tracer.
    fn light(&self) -> [f64; 2] {
        let h = over_film(|h| h);
        relative(self.lengths().map(|n| (self.probability(n), self.splats(n, |_| [1.0, h - 1.0]))))
    }

    /// Mean and relative variance of the bidirectional tracer.
    fn bidirectional(&self) -> [f64; 2] {
        let (rho, most) = (self.albedo, *self.lengths().end());
        let weighed = |i: i32| {
            let weight = |h: f64| 1.0 / (f64::from(i + 1) * h + 1.0);
            // Over the ball, whatever is h times is over the film.
            let mean = over_film(weight);
            [mean, over_film(|h| h * weight(h).powi(2)) - mean * mean]
        };
        let weighed: Vec<[f64; 2]> = (1..=most).map(weighed).collect();
        let splats: Vec<[f64; 2]> = (0..=most).map(|n| self.splats(n, |i| weighed[i as usize - 1])).collect();
        let carried: Vec<f64> = (0..=most).map(|k| self.carried(k)).collect();
        let moments = film().map(|h| {
            let weights: Vec<f64> = (0..=2 * most + 1).map(|k| h / (f64::from(k) * h + 1.0)).collect();
            // What a path from the camera finds by chance and by asking for a light; and, by the vertices of the other path, what
            // connections bring.
            let (mut alone, mut connected) = (1.0, vec![0.0; most as usize + 1]);
            let mut sums = [0.0; 2];
            for eye in 1..=most as usize {
                let chance = if eye > 1 { carried[eye] * weights[eye] } else { 0.0 };
                alone += chance + rho * carried[eye] * weights[eye + 1];
                let mut to_this = 0.0;
                for light in 1..=most as usize {
                    to_this += rho * rho * carried[light] * weights[eye + light + 1];
                    connected[light] += carried[eye] * to_this;
                }
                if !self.lengths().contains(&(eye as i32)) {
                    continue;
                }
                for light in self.lengths() {
                    let share = self.probability(eye as i32) * self.probability(light);
                    let [mean, variance] = splats[light as usize];
                    let all = (1.0 - rho) * (alone + connected[light as usize]) + mean;
                    sums = [sums[0] + share * all, sums[1] + share * (all * all + variance)];
                }
            }
            sums
        });
        let (count, sums) = moments.fold((0.0, [0.0; 2]), |(n, [a, b]), [c, d]| (n + 1.0, [a + c, b + d]));
        let [mean, square] = sums.map(|sum| sum / count);
        [mean, square / (mean * mean) - 1.0]
    }
}

/// Mean and relative variance of a choice among these, each with its probability, mean and variance.
fn relative(choices: impl Iterator<Item = (f64, [f64; 2])>) -> [f64; 2] {
    let [mean, square] =
        choices.fold([0.0; 2], |[a, b], (p, [mean, variance])| [a + p * mean, b + p * (mean * mean + variance)]);
    [mean, square / (mean * mean) - 1.0]
}

/// h at points that are even over the film; a quarter of it is like the others.
fn film() -> impl Iterator<Item = f64> {
    const SIDE: i32 = 6;
    let square = |i: i32| (HALF * (f64::from(i) + 0.5) / f64::from(SIDE)).powi(2);
    (0..SIDE * SIDE).map(move |i| PI / (HALF * HALF) * (1.0 + square(i % SIDE) + square(i / SIDE)).powf(1.5))
}

/// Mean over the film of a function of h.
fn over_film(f: impl Fn(f64) -> f64) -> f64 {
    let (count, sum) = film().fold((0.0, 0.0), |(n, sum), h| (n + 1.0, sum + f(h)));
    sum / count
}

/// What each sample of a film of one pixel shows.
fn samples(renderer: &Renderer, camera: &Camera, paths: usize) -> Vec<f64> {
    let sample = |sample: usize| {
        let mut film = Film::of_size([1, 1]);
        let job = Render { sample: sample as u32, spp: 1, seed: SEED };
        renderer.render_with(camera, &mut film, job, &Handle::default()).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(film.dropped(), 0);
        f64::from(film.mean().pixels[0][1])
    };
    (0..paths).map(sample).collect()
}

/// Standard error of the variance of samples, over the variance.
fn error_of_variance(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let moment = |n: i32| values.iter().map(|x| (x - mean).powi(n)).sum::<f64>() / count;
    ((moment(4) / moment(2).powi(2) - 1.0) / count).sqrt()
}

/// The mean and the relative variance of what a tracer shows under roulette from each of these scatterings on.
fn check(tracer: TracerKind, albedo: f64, starts: &[u32], quick: usize, theory: fn(&Roulette) -> [f64; 2]) {
    let paths = number("JERBOA_PATHS", quick);
    let rho = albedo as f32;
    let wall = Material { emissive: [1.0 - rho; 3], ..Material::diffuse("wall", [rho; 3]) };
    let mut ball = Scene::default();
    place(&mut ball, inside_out(sphere(3)), wall, 1.0, DVec3::ZERO);
    let camera = Camera::look_at("middle", DVec3::ZERO, DVec3::NEG_Z, 2.0 * HALF.atan());
    // The light tracer sees all but what glowing walls send to the camera themselves.
    let truth = if tracer == TracerKind::Light { albedo } else { 1.0 };
    for &start in starts {
        let choices = Choices { rr_depth: Some(start), ..Choices::default() };
        let what = format!("{}, albedo {albedo}, from {start}", tracer.kernel());
        let values = samples(&renderer(&ball, tracer, choices), &camera, paths);
        let (found, uncertain) = (Estimate::of(&values), error_of_variance(&values));
        let [mean, variance] = theory(&Roulette { albedo, start: start as i32 });
        println!(
            "{what}: {:.4} ± {:.4}, variance {:.3} ± {:.0} %, theory {mean:.4} and {variance:.3}",
            found.mean,
            found.error,
            found.relative_variance(),
            100.0 * uncertain
        );
        assert!((mean / truth - 1.0).abs() < 1e-3, "{what}: the theory is of something else");
        assert_eq!(found.fault(truth, 0.0, bound(1e-2, paths)), None, "{what}");
        let off = (found.relative_variance() / variance - 1.0).abs();
        assert!(off <= 0.2_f64.max(4.0 * uncertain) && uncertain < 0.15, "{what}: {off} off the theory's variance");
    }
}

/// The mean in a closed box of albedo .99, whose paths are the longest.
fn check_box(tracer: TracerKind, quick: usize) {
    let (closed, paths) = (glowing_box(0.99), number("JERBOA_PATHS", quick));
    let values = samples(&renderer(&closed.scene, tracer, Choices::default()), &closed.looks[0].0.camera, paths);
    let found = Estimate::of(&values);
    println!("{}, box of albedo .99: {:.4} ± {:.4}", tracer.kernel(), found.mean, found.error);
    let truth = if tracer == TracerKind::Light { 0.99 } else { 1.0 };
    assert_eq!(found.fault(truth, 0.0, bound(1e-2, paths)), None, "{}, box", tracer.kernel());
}

#[test]
fn roulette_costs_the_light_tracer_what_the_theory_says() {
    for albedo in [0.5, 0.8, 0.9, 0.95, 0.99] {
        check(TracerKind::Light, albedo, &[3, 4], 1 << 12, Roulette::light);
    }
    check_box(TracerKind::Light, 1 << 12);
}

/// Each of its samples takes the product of the lengths of two paths: 10,000 rays at .99.
#[test]
fn roulette_costs_the_bidirectional_tracer_what_the_theory_says() {
    for (albedo, quick) in [(0.5, 1 << 12), (0.8, 1 << 12), (0.9, 1 << 11), (0.95, 1 << 11)] {
        check(TracerKind::Bidirectional, albedo, &[3, 4], quick, Roulette::bidirectional);
    }
    check(TracerKind::Bidirectional, 0.99, &[3], 1 << 8, Roulette::bidirectional);
    check_box(TracerKind::Bidirectional, 1 << 8);
}
