//! The words that the Sobol sampler draws, asked for in bulk: those of a *set*, which are the six dimensions that belong together.

use jerboa_ir::lang::U32;
use jerboa_lib_render::core::rng::{DIM_BSDF, DIM_LIGHT, Stream};
use jerboa_lib_render::core::sobol::reversed;
use jerboa_lib_render::sampler::sobol::make_sobol_sampler;

use super::sweep::Sweep;

/// Dimensions of a set: a pair and a choice, then the other half's pair and choice.
pub const DIMENSIONS: usize = 6;

/// A point of a set: a word for each dimension.
pub type Point = [u32; DIMENSIONS];

/// Which points, in their order: (pixel, number in the pixel's sequence), and how far each goes on.
#[derive(Clone, Copy, Debug, Default)]
pub struct Walk {
    /// Seed of the render.
    pub seed: u32,
    /// Pixel of the first point.
    pub pixel: u32,
    /// Number of the first point.
    pub number: u32,
    /// Vertex of the path whose first numbers they are.
    pub vertex: u32,
    /// How far the pixel goes on.
    pub pixels: u32,
    /// How far the number goes on.
    pub numbers: u32,
}

/// The sampler, compiled.
pub struct Points(Sweep);

impl Default for Points {
    fn default() -> Points {
        type Shared = (U32, U32, U32, U32, U32, U32);
        Points(Sweep::new(|_, cell, (seed, pixel, number, vertex, pixels, numbers): Shared| {
            let (outer, inner) = (cell >> 3, cell & 7u32);
            let sampler = make_sobol_sampler();
            let stream = Stream {
                index: reversed(number + outer * numbers),
                ..Stream::keyed(seed, pixel + outer * pixels, 0.into())
            };
            let half = |vertex, dim| {
                let rng = stream.vertex(vertex, dim);
                let [u, v] = (sampler.pair)(rng.ahead(1));
                [u, v, (sampler.number)(rng)]
            };
            let words = [half(vertex, DIM_BSDF), half(vertex + 1u32, DIM_LIGHT)].concat();
            words.iter().enumerate().fold(U32::from(0), |found, (i, word)| inner.eq(i as u32).select(*word, found))
        }))
    }
}

impl Points {
    /// The first `n` points of a walk.
    pub fn of(&self, walk: Walk, n: usize) -> Vec<Point> {
        let Walk { seed, pixel, number, vertex, pixels, numbers } = walk;
        let mut words = vec![0; 8 * n];
        self.0.fill(&[seed, pixel, number, vertex, pixels, numbers], [&[], &[]], &mut words);
        points(&words)
    }

    /// Interpreter and machine code agree on the first `n` points of a walk.
    pub fn check_engines(&self, walk: Walk, n: usize) {
        let Walk { seed, pixel, number, vertex, pixels, numbers } = walk;
        let words = self.0.interpret(&[seed, pixel, number, vertex, pixels, numbers], [&[], &[]], 8 * n);
        assert_eq!(points(&words), self.of(walk, n), "{walk:?}");
    }
}

/// Eight words are a point.
fn points(words: &[u32]) -> Vec<Point> {
    words.chunks(8).map(|point| std::array::from_fn(|d| point[d])).collect()
}

/// A word as a number in [0, 1).
pub fn fraction(word: u32) -> f64 {
    f64::from(word) / 4_294_967_296.0
}
