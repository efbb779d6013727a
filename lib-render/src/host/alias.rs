//! Alias tables: an index drawn with one look at a table (Walker 1977; built as in Vose, *A linear algorithm for generating
//! random numbers with a given distribution*, 1991).
//!
//! Each of 2^k slots is drawn equally often, and shares what it is drawn for out between its own index and one other. So a
//! kernel reads one word where an inversion searches ([`crate::core::alias`]). What is lost is the order of the numbers:
//! well distributed ones do not stay so.
//!
//! *Probabilities are exact*: both the distribution and the slots count in parts of 2^-24.
//!
//! ```
//! use jerboa_lib_render::host::alias::{draw, log_slots, slots};
//! use jerboa_lib_render::host::distribution::Distribution1D;
//! let table = slots(&Distribution1D::new(&[1.0, 0.0, 3.0]));
//! assert_eq!((table.len(), log_slots(3)), (4, 2));
//! let drawn = (0..8_u32).filter(|eighth| draw(&table, eighth << 29) == 2).count();
//! assert_eq!(drawn, 6);
//! ```

use super::distribution::{Distribution1D, PARTS};

/// How many slots a table of so many indices has, as a power of two: at least as many as indices, and two.
///
/// # Panics
/// If there are more than 2^23 indices.
pub fn log_slots(count: usize) -> u32 {
    let log = count.next_power_of_two().trailing_zeros().max(1);
    assert!(log < PARTS.trailing_zeros(), "alias::log_slots: {count} indices; it takes at most 2^23");
    log
}

/// The table of a distribution. In the word of a slot the low bits are the other index, those above say how many parts of
/// the slot are its own index's.
///
/// # Panics
/// As [`log_slots`].
pub fn slots(distribution: &Distribution1D) -> Vec<u32> {
    let log = log_slots(distribution.count());
    let room = PARTS >> log;
    let mut parts: Vec<u32> =
        (0..distribution.count()).map(|i| (distribution.probability(i) * PARTS as f32) as u32).collect();
    parts.resize(1 << log, 0);
    // Whoever has less than a slot's room borrows what is missing from one that has more.
    let (mut poor, mut rich): (Vec<usize>, Vec<usize>) = (0..parts.len()).rev().partition(|i| parts[*i] < room);
    let mut table: Vec<u32> = (0..).zip(&parts).map(|(own, _)| room << log | own).collect();
    while let (Some(slot), Some(lender)) = (poor.pop(), rich.last().copied()) {
        table[slot] = parts[slot] << log | lender as u32;
        parts[lender] -= room - parts[slot];
        if parts[lender] < room {
            poor.extend(rich.pop());
        }
    }
    table
}

/// The index that a random word draws, as kernels find it.
pub fn draw(table: &[u32], word: u32) -> usize {
    let log = table.len().trailing_zeros();
    let (slot, part) = (word >> (32 - log), (word << log) >> (log + 8));
    let entry = table[slot as usize];
    (if part < entry >> log { slot } else { entry & ((1 << log) - 1) }) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_index_is_drawn_by_its_share_of_the_numbers() {
        let uneven = (0..1000).map(|i| f64::from(i * i % 97)).collect::<Vec<_>>();
        let peak = (0..777).map(|i| if i == 500 { 1e9 } else { f64::from(i % 2) }).collect::<Vec<_>>();
        let even = [1.0; 64];
        for weights in [&[1.0][..], &[0.0, 5.0], &[5.0, 0.0], &[1.0, 2.0, 3.0], &even, &uneven, &peak] {
            let distribution = Distribution1D::new(weights);
            let table = slots(&distribution);
            let log = log_slots(weights.len());
            assert_eq!(table.len(), 1 << log);
            let mut drawn = vec![0; table.len()];
            for (own, entry) in table.iter().enumerate() {
                drawn[own] += entry >> log;
                drawn[(entry & ((1 << log) - 1)) as usize] += (PARTS >> log) - (entry >> log);
            }
            for (i, parts) in drawn.into_iter().enumerate() {
                let p = if i < weights.len() { distribution.probability(i) } else { 0.0 };
                assert_eq!(parts as f32 / PARTS as f32, p, "index {i} of {}", weights.len());
            }
        }
    }

    #[test]
    fn the_bits_of_a_word_choose_slot_and_part() {
        let half = 1 << 29;
        let table = slots(&Distribution1D::new(&[1.0, 3.0]));
        assert_eq!([0, half - 1, half, 2 * half - 1, 2 * half].map(|word| draw(&table, word)), [0, 0, 0, 0, 1]);
        let table = slots(&Distribution1D::new(&[0.25, 1.75]));
        assert_eq!([0, half - 1, half, 2 * half, 3 * half].map(|word| draw(&table, word)), [0, 0, 1, 1, 1]);
    }
}
