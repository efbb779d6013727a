//! Random decisions that can be replayed and shrunk: a generator asks [`Choices::below`], and the answers are its recipe.
//!
//! Shrinking works on the recipe, so every generator gets it for nothing (as Hypothesis does: MacIver and Donaldson,
//! ECOOP 2020). The convention: answer 0 is the simplest alternative, and a recipe that is too short goes on with zeros.

/// A small random number generator (SplitMix64: Steele, Lea, Flood, OOPSLA 2014).
#[derive(Clone, Debug)]
pub struct Rng(pub u64);

impl Rng {
    /// The next 32 bits.
    pub fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    /// A number below `n`.
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.word()) * u64::from(n)) >> 32) as u32
    }
}

/// A source of decisions that remembers them.
#[derive(Clone, Debug)]
pub struct Choices {
    taken: Vec<u32>,
    next: usize,
    fresh: Option<Rng>,
}

impl Choices {
    /// Fresh decisions from a seed.
    pub fn random(seed: u64) -> Choices {
        Choices { taken: Vec::new(), next: 0, fresh: Some(Rng(seed)) }
    }

    /// The decisions of a recipe, then zeros.
    pub fn replay(recipe: &[u32]) -> Choices {
        Choices { taken: recipe.to_vec(), next: 0, fresh: None }
    }

    /// What was decided so far.
    pub fn recipe(&self) -> &[u32] {
        &self.taken
    }

    /// A number below `n`, which is not 0. 0 is the simplest.
    pub fn below(&mut self, n: u32) -> u32 {
        if self.next == self.taken.len() {
            let answer = self.fresh.as_mut().map_or(0, |rng| rng.below(n));
            self.taken.push(answer);
        }
        self.next += 1;
        self.taken[self.next - 1] % n
    }

    /// True once in `n` times; false is the simpler.
    pub fn one_in(&mut self, n: u32) -> bool {
        self.below(n) == n - 1
    }

    /// One of these; the first is the simplest.
    pub fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u32) as usize]
    }
}

/// A shorter and simpler recipe that still fails, by dropping chunks and by putting zeros; at most `tries` are made.
pub fn shrink(recipe: &[u32], tries: usize, mut fails: impl FnMut(&[u32]) -> bool) -> Vec<u32> {
    let mut best = recipe.to_vec();
    let mut left = tries;
    let mut attempt = |best: &mut Vec<u32>, shorter: Vec<u32>| {
        left = left.saturating_sub(1);
        let better = left > 0 && shorter != *best && fails(&shorter);
        if better {
            *best = shorter;
        }
        better
    };
    let mut chunk = best.len();
    while chunk > 0 {
        let mut at = 0;
        while at < best.len() {
            let end = (at + chunk).min(best.len());
            let dropped = [&best[..at], &best[end..]].concat();
            let zeroed = [&best[..at], &vec![0; end - at], &best[end..]].concat();
            if !attempt(&mut best, dropped) {
                attempt(&mut best, zeroed);
                at += chunk;
            }
        }
        chunk /= 2;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shrinking_finds_the_smallest_recipe() {
        let mut c = Choices::random(7);
        (0..100).for_each(|_| _ = c.below(1000));
        let fails = |r: &[u32]| r.iter().any(|x| *x > 900);
        assert!(fails(c.recipe()));
        let small = shrink(c.recipe(), 10_000, fails);
        assert!(small.len() == 1 && small[0] > 900, "{small:?}");
    }

    #[test]
    fn a_replay_repeats() {
        let mut a = Choices::random(3);
        let first: Vec<u32> = (1..50).map(|n| a.below(n)).collect();
        let mut b = Choices::replay(a.recipe());
        assert_eq!(first, (1..50).map(|n| b.below(n)).collect::<Vec<_>>());
        assert_eq!(b.below(9), 0);
    }
}
