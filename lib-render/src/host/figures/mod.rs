//! The paper's experiments (section 5), on any scene: what `jerboa bench table-2`, `figure-2` to `figure-5` and `devices` measure.
//!
//! | paper | what is measured |
//! |---|---|
//! | Table 2 | [`table_2`]: samples per second, by what is known of the scene, and those of a [`peer`] |
//! | Figure 2 | [`figure_2`]: where the time goes, and what shading a vertex takes |
//! | Figure 3 | [`figure_3`]: a shader whose parameters are constants or textures, specialised or not |
//! | Figure 4 | [`figure_4`]: the interfaces of textures and attributes, specialised or not |
//! | Figure 5 | [`figure_5`]: the time of specialisation and code generation |
//! | | [`devices`]: CPU and GPU side by side |
//!
//! Each gives charts: groups of bars, which [`plot`] draws. What is compared takes turns ([`in_turn`]), so that whatever
//! else the machine does meets all alike; a bar is the median of the rounds, with the least and the most beside it. A *gain* is
//! how many times quicker one is than the other.

pub mod table_2;
pub mod peer;
pub mod figure_2;
pub mod kernels;
pub mod batch;
pub mod figure_3;
pub mod figure_4;
pub mod figure_5;
pub mod devices;
pub mod plot;

use super::error::Error;
use super::tables::Known;

/// What repetitions showed.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Spread {
    /// The value in the middle.
    pub median: f64,
    /// The smallest.
    pub least: f64,
    /// The largest.
    pub most: f64,
}

impl Spread {
    /// Of at least one value.
    pub fn of(values: &[f64]) -> Spread {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (least, most) = (sorted[0], sorted[sorted.len() - 1]);
        let middle = sorted.len() / 2;
        let median = if sorted.len() % 2 == 1 { sorted[middle] } else { (sorted[middle - 1] + sorted[middle]) / 2.0 };
        Spread { median, least, most }
    }

    /// Of what was found once.
    pub fn once(value: f64) -> Spread {
        Spread::of(&[value])
    }
}

/// Bars that are compared with each other, and what else was found about them.
#[derive(Clone, PartialEq, Debug)]
pub struct Group {
    /// What they are about.
    pub name: String,
    /// One for each series of the chart; none where there is nothing to measure.
    pub bars: Vec<Option<Spread>>,
    /// Numbers that are no bars, by their names.
    pub notes: Vec<(String, f64)>,
}

/// A chart.
#[derive(Clone, PartialEq, Debug)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Unit of all bars.
    pub unit: &'static str,
    /// Are the bars of a group parts of a whole, to be put end to end?
    pub stacked: bool,
    /// Names of the bars of each group.
    pub series: Vec<String>,
    /// The groups.
    pub groups: Vec<Group>,
}

/// The levels of knowledge, by the names of the command line.
pub const LEVELS: [(Known, &str); 3] =
    [(Known::Nothing, "nothing"), (Known::Structure, "structure"), (Known::All, "all")];

/// Measures each variant once in each round, one after the other, and gives for each what the rounds showed.
///
/// # Errors
/// As `measure`.
pub fn in_turn<V>(
    rounds: u32,
    variants: &mut [V],
    mut measure: impl FnMut(u32, &mut V) -> Result<f64, Error>,
) -> Result<Vec<Spread>, Error> {
    let mut values = vec![Vec::new(); variants.len()];
    for round in 0..rounds {
        for (variant, values) in variants.iter_mut().zip(&mut values) {
            values.push(measure(round, variant)?);
        }
    }
    Ok(values.iter().map(|v| Spread::of(v)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_the_middle_and_both_ends() {
        assert_eq!(Spread::of(&[3.0, 1.0, 8.0]), Spread { median: 3.0, least: 1.0, most: 8.0 });
        assert_eq!(Spread::of(&[4.0, 1.0, 8.0, 2.0]).median, 3.0);
        assert_eq!(Spread::once(2.0), Spread { median: 2.0, least: 2.0, most: 2.0 });
    }

    #[test]
    fn variants_take_turns() {
        let mut seen = String::new();
        let spreads = in_turn(2, &mut ['a', 'b'], |round, v| {
            seen.push(*v);
            Ok(f64::from(round))
        });
        assert_eq!((seen.as_str(), spreads.expect("no error").len()), ("abab", 2));
    }
}
