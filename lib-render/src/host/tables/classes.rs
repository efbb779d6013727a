//! Classes: rows that agree in every known column (Law 2), and the facts that the evaluator gets.

use std::collections::HashMap;
use std::sync::Arc;

use jerboa_ir::lang::{Spec, SpecTy};
use jerboa_ir::{BufKind, Lit, Time};
use jerboa_peval::{ColumnFacts, Facts, TableFacts, Target};

use super::memory::Memory;
use crate::host::device::MOST_CLASSES;
use crate::schema::{BUFFERS, Geometries, Models, Sampling, binding};

/// What a specialisation knows of the scene.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug, Default)]
pub enum Known {
    /// Nothing but which components there are: a renderer for every scene of them, which dispatches at run time.
    Nothing,
    /// Kinds, flags and presences: a changed number needs no compilation.
    #[default]
    Structure,
    /// Every number of materials, lights and settings too.
    All,
}

impl Known {
    fn knows(self, time: Time) -> bool {
        match time {
            Time::Structure => self >= Known::Structure,
            Time::Value => self == Known::All,
            Time::Bulk => false,
        }
    }
}

/// Number the classes of every classed table, write them to column 0, and say what is known of each.
///
/// Classes that `former` facts had keep their numbers, as far as they can: so an edit leaves alone the kernels of classes
/// that it does not touch.
pub fn classify(memory: &mut [Arc<Memory>], known: Known, former: &Facts) -> Facts {
    if known == Known::Nothing {
        return components(memory);
    }
    let (known, mut classes) = told_apart(memory, known);
    for (classes, former) in classes.iter_mut().zip(&former.tables) {
        keep_numbers(classes, &former.class_of);
    }
    for (b, (spec, rows)) in BUFFERS.iter().zip(&classes).enumerate() {
        if is_classed(spec) {
            let words = &mut Arc::make_mut(&mut memory[b]).words;
            rows.iter().enumerate().for_each(|(row, class)| words[row * spec.3.len()] = *class);
        }
    }
    Facts { tables: BUFFERS.iter().enumerate().map(|(b, s)| facts(b, s, memory, &classes, known[b])).collect() }
}

/// What is known of each table, and the class of each of its rows.
fn told_apart(memory: &[Arc<Memory>], known: Known) -> (Vec<Known>, Vec<Vec<u32>>) {
    let mut known = vec![known; BUFFERS.len()];
    loop {
        let classes = partitions(memory, &known);
        let too_many = |b: usize| known[b] == Known::All && count(&classes[b]) > MOST_CLASSES;
        let tables: Vec<usize> = (0..BUFFERS.len()).filter(|b| too_many(*b)).collect();
        if tables.is_empty() {
            return (known, classes);
        }
        // So many kernels differ in numbers only; what they would gain by them is not worth the time to make them.
        if tables.contains(&binding::<Geometries>()) {
            known.fill(Known::Structure);
        }
        // No dispatch tells so many rows apart: their kinds are worth more than their numbers.
        tables.into_iter().for_each(|b| known[b] = Known::Structure);
    }
}

/// What is known where nothing is: which components the scene names, and the sampler.
fn components(memory: &[Arc<Memory>]) -> Facts {
    let mut classes = vec![Vec::new(); BUFFERS.len()];
    let mut tables = vec![TableFacts::default(); BUFFERS.len()];
    for b in [binding::<Models>(), binding::<Sampling>()] {
        classes[b] = partition(b, &BUFFERS[b], memory, &classes, Known::Structure);
        tables[b] = facts(b, &BUFFERS[b], memory, &classes, Known::Structure);
    }
    Facts { tables }
}

/// The class of each row of each table, numbered by first occurrence.
fn partitions(memory: &[Arc<Memory>], known: &[Known]) -> Vec<Vec<u32>> {
    let rows = |(spec, m): (&Spec, &Arc<Memory>)| vec![0; if is_classed(spec) { m.rows as usize } else { 0 }];
    let mut classes: Vec<Vec<u32>> = BUFFERS.iter().zip(memory).map(rows).collect();
    // A class refines with the classes it refers to, and only so often as there are rows: this settles.
    loop {
        let refined: Vec<Vec<u32>> =
            BUFFERS.iter().enumerate().map(|(b, s)| partition(b, s, memory, &classes, known[b])).collect();
        if refined == classes {
            return classes;
        }
        classes = refined;
    }
}

fn count(classes: &[u32]) -> u32 {
    classes.iter().max().map_or(0, |c| c + 1)
}

/// Number classes as they were: each gets the number that most of its rows had, the largest claim first; the others get
/// the lowest numbers that are left.
fn keep_numbers(classes: &mut [u32], former: &[u32]) {
    let count = count(classes) as usize;
    let mut claims: HashMap<(u32, u32), usize> = HashMap::new();
    for (class, number) in classes.iter().zip(former).filter(|(_, number)| (**number as usize) < count) {
        *claims.entry((*class, *number)).or_default() += 1;
    }
    let mut claims: Vec<_> = claims.into_iter().collect();
    claims.sort_unstable_by_key(|((class, number), rows)| (std::cmp::Reverse(*rows), *number, *class));
    let (mut number_of, mut taken) = (vec![None; count], vec![false; count]);
    for ((class, number), _) in claims {
        if number_of[class as usize].is_none() && !taken[number as usize] {
            number_of[class as usize] = Some(number);
            taken[number as usize] = true;
        }
    }
    let mut left = (0..count as u32).filter(|number| !taken[*number as usize]);
    let number_of: Vec<u32> = number_of.into_iter().map(|n| n.or_else(|| left.next()).expect("as many")).collect();
    classes.iter_mut().for_each(|class| *class = number_of[*class as usize]);
}

fn is_classed(spec: &Spec) -> bool {
    matches!(spec.1, BufKind::Table { classed: true })
}

fn table(name: &str) -> usize {
    BUFFERS.iter().position(|s| s.0 == name).expect("a column refers to a table of the schema")
}

/// Class of each row, numbered by first occurrence.
fn partition(b: usize, spec: &Spec, memory: &[Arc<Memory>], classes: &[Vec<u32>], known: Known) -> Vec<u32> {
    if !is_classed(spec) {
        return Vec::new();
    }
    let mut numbers: HashMap<Vec<u32>, u32> = HashMap::new();
    let row_key = |row: &[u32]| -> Vec<u32> {
        let columns = spec.3.iter().zip(row).skip(1).filter(|(c, _)| known.knows(c.time));
        columns
            .flat_map(|(c, word)| match c.ty {
                SpecTy::Scalar(_) => [*word, 0],
                // The index within the class is a value.
                SpecTy::Ref(to) => [classes[table(to)][*word as usize], if known == Known::All { *word } else { 0 }],
            })
            .collect()
    };
    let rows = memory[b].words.chunks(spec.3.len());
    rows.map(|row| {
        let next = numbers.len() as u32;
        *numbers.entry(row_key(row)).or_insert(next)
    })
    .collect()
}

fn facts(b: usize, spec: &Spec, memory: &[Arc<Memory>], classes: &[Vec<u32>], known: Known) -> TableFacts {
    if !is_classed(spec) {
        return TableFacts::default();
    }
    let class_of = classes[b].clone();
    let count = count(&class_of).max(1);
    let first: Vec<usize> =
        (0..count).map(|k| class_of.iter().position(|c| *c == k).expect("no class is empty")).collect();
    let word = |row: usize, col: usize| memory[b].words[row * spec.3.len() + col];
    let column = |(col, c): (usize, &jerboa_ir::lang::ColumnSpec)| match c.ty {
        _ if col == 0 || !known.knows(c.time) => ColumnFacts::Unknown,
        SpecTy::Scalar(s) => ColumnFacts::Known(first.iter().map(|r| Lit::from_word(s, word(*r, col))).collect()),
        SpecTy::Ref(to) => ColumnFacts::Refs(
            first
                .iter()
                .map(|r| Target {
                    class: classes[table(to)][word(*r, col) as usize],
                    index: (known == Known::All).then(|| word(*r, col)),
                })
                .collect(),
        ),
    };
    TableFacts { class_of, classes: count, columns: spec.3.iter().enumerate().map(column).collect() }
}

#[cfg(test)]
mod tests {
    use super::keep_numbers;

    #[test]
    fn classes_keep_their_numbers() {
        let renumbered = |mut classes: Vec<u32>, former: &[u32]| {
            keep_numbers(&mut classes, former);
            classes
        };
        // The first row leaves class 0, which is still that of most of its rows.
        assert_eq!(renumbered(vec![0, 1, 1, 2], &[0, 0, 0, 1]), [2, 0, 0, 1]);
        // Class 1 has lost its row; the last number fills the gap.
        assert_eq!(renumbered(vec![0, 0, 1, 2], &[0, 1, 2, 3]), [0, 0, 2, 1]);
        // Rows came, and rows went.
        assert_eq!(renumbered(vec![0, 1, 2], &[1]), [1, 0, 2]);
        assert_eq!(renumbered(vec![0], &[1, 0, 0]), [0]);
        assert_eq!(renumbered(vec![0, 1, 0], &[]), [0, 1, 0]);
    }
}
