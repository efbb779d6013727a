//! Numbers that have nothing to do with each other.

use crate::core::rng::{Rng, Stream, hash};
use crate::sampler::Sampler;

/// Each word is the hash of its position.
pub fn make_independent_sampler() -> Sampler {
    Sampler {
        stream: Stream::keyed,
        number: Rng::word,
        pair: |rng| [rng.word(), rng.ahead(1).word()],
        of: |rng, thing| hash(rng.word() ^ thing),
    }
}
