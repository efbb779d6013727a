//! Classes: rows that agree in every known column (Law 2), and the facts that the evaluator gets.

use std::collections::HashMap;

use jerboa_ir::lang::{Spec, SpecTy};
use jerboa_ir::{BufKind, Lit, Time};
use jerboa_peval::{ColumnFacts, Facts, TableFacts, Target};

use super::memory::Memory;
use crate::schema::BUFFERS;

/// What a specialisation knows of the scene.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug, Default)]
pub enum Known {
    /// Nothing: a renderer for every scene, which dispatches at run time.
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
pub fn classify(memory: &mut [Memory], known: Known) -> Facts {
    let rows = |(spec, m): (&Spec, &Memory)| vec![0; if is_classed(spec) { m.rows as usize } else { 0 }];
    let mut classes: Vec<Vec<u32>> = BUFFERS.iter().zip(&*memory).map(rows).collect();
    if known == Known::Nothing {
        return Facts::none();
    }
    // A class refines with the classes it refers to; references form no cycle, so this settles.
    loop {
        let refined: Vec<Vec<u32>> =
            BUFFERS.iter().enumerate().map(|(b, s)| partition(b, s, memory, &classes, known)).collect();
        if refined == classes {
            break;
        }
        classes = refined;
    }
    for (b, (spec, rows)) in BUFFERS.iter().zip(&classes).enumerate() {
        if is_classed(spec) {
            rows.iter().enumerate().for_each(|(row, class)| memory[b].words[row * spec.3.len()] = *class);
        }
    }
    Facts { tables: BUFFERS.iter().enumerate().map(|(b, s)| facts(b, s, memory, &classes, known)).collect() }
}

fn is_classed(spec: &Spec) -> bool {
    matches!(spec.1, BufKind::Table { classed: true })
}

fn table(name: &str) -> usize {
    BUFFERS.iter().position(|s| s.0 == name).expect("a column refers to a table of the schema")
}

/// Class of each row, numbered by first occurrence.
fn partition(b: usize, spec: &Spec, memory: &[Memory], classes: &[Vec<u32>], known: Known) -> Vec<u32> {
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

fn facts(b: usize, spec: &Spec, memory: &[Memory], classes: &[Vec<u32>], known: Known) -> TableFacts {
    if !is_classed(spec) {
        return TableFacts::default();
    }
    let class_of = classes[b].clone();
    let count = class_of.iter().max().map_or(1, |c| c + 1);
    let first: Vec<usize> =
        (0..count).map(|k| class_of.iter().position(|c| *c == k).expect("numbered by occurrence")).collect();
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
