//! What a specialisation knows of random tables, as Law 2 says: columns by their binding time, rows by their class.

use jerboa_ir::interp::Memory;
use jerboa_ir::*;
use jerboa_peval::{ColumnFacts, Facts, TableFacts, Target};
use rustc_hash::FxHashMap;

/// How much is known: each level knows the columns of one more binding time.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Level {
    /// Nothing.
    Nothing,
    /// Columns of [`Time::Structure`].
    Structure,
    /// Columns of [`Time::Value`] too.
    All,
}

impl Level {
    fn knows(self, time: Time) -> bool {
        match time {
            Time::Structure => self >= Level::Structure,
            Time::Value => self == Level::All,
            Time::Bulk => false,
        }
    }
}

/// Number the classes of the classed tables, write them to column 0, and say what is known. A table that is not classed
/// is one class, of which those columns are known that have one content.
pub fn classify(p: &Program, memory: &mut [Memory], level: Level) -> Facts {
    if level == Level::Nothing {
        return Facts::none();
    }
    let mut classes: Vec<Vec<u32>> = memory.iter().map(|m| vec![0; m.rows as usize]).collect();
    loop {
        let tables = p.buffers.iter().enumerate();
        let refined: Vec<Vec<u32>> = tables.map(|(b, decl)| partition(b, decl, memory, &classes, level)).collect();
        if refined == classes {
            break;
        }
        classes = refined;
    }
    for (b, decl) in p.buffers.iter().enumerate().filter(|(_, decl)| is_classed(decl)) {
        for (row, class) in classes[b].iter().enumerate() {
            memory[b].words[decl.word(classes[b].len(), row, 0)] = *class;
        }
    }
    Facts { tables: p.buffers.iter().enumerate().map(|(b, decl)| facts(b, decl, memory, &classes, level)).collect() }
}

fn is_classed(decl: &Buffer) -> bool {
    decl.kind == BufKind::Table { classed: true }
}

/// Class of a row; the index is clamped as a read clamps it.
fn class_of(classes: &[u32], row: u32) -> u32 {
    classes[(row as usize).min(classes.len() - 1)]
}

/// Class of each row, numbered by first occurrence: rows agree in their former class, in what is known, and in the
/// classes of the rows they refer to.
fn partition(b: usize, decl: &Buffer, memory: &[Memory], classes: &[Vec<u32>], level: Level) -> Vec<u32> {
    if !is_classed(decl) {
        return classes[b].clone();
    }
    let rows = classes[b].len();
    let mut numbers: FxHashMap<Vec<u32>, u32> = FxHashMap::default();
    let class = |row: usize| {
        let mut key = vec![classes[b][row]];
        for (col, c) in decl.columns.iter().enumerate().skip(1).filter(|(_, c)| level.knows(c.time)) {
            let word = memory[b].words[decl.word(rows, row, col)];
            match c.ty {
                ColTy::Scalar(_) => key.push(word),
                ColTy::Ref(to) => {
                    key.extend([class_of(&classes[to.index()], word), if level == Level::All { word } else { 0 }])
                }
            }
        }
        let next = numbers.len() as u32;
        *numbers.entry(key).or_insert(next)
    };
    (0..rows).map(class).collect()
}

fn facts(b: usize, decl: &Buffer, memory: &[Memory], classes: &[Vec<u32>], level: Level) -> TableFacts {
    if decl.kind == BufKind::Stream {
        return TableFacts::default();
    }
    let (rows, class_of_row) = (classes[b].len(), &classes[b]);
    let count = class_of_row.iter().max().map_or(1, |c| c + 1);
    let words = |class: u32, col: usize| {
        let of_class = (0..rows).filter(move |r| class_of_row[*r] == class);
        of_class.map(move |r| memory[b].words[decl.word(rows, r, col)]).collect::<Vec<u32>>()
    };
    let column = |(col, c): (usize, &ColumnDecl)| {
        let all: Vec<Vec<u32>> = (0..count).map(|class| words(class, col)).collect();
        let agree = all.iter().all(|words| words.iter().all(|w| *w == words[0]));
        match c.ty {
            _ if !level.knows(c.time) => ColumnFacts::Unknown,
            ColTy::Scalar(s) if agree => ColumnFacts::Known(all.iter().map(|w| Lit::from_word(s, w[0])).collect()),
            ColTy::Scalar(_) => ColumnFacts::Unknown,
            ColTy::Ref(to) => {
                let target = |words: &Vec<u32>| {
                    let class = class_of(&classes[to.index()], words[0]);
                    let same = words.iter().all(|w| class_of(&classes[to.index()], *w) == class);
                    let index = (agree && level == Level::All).then(|| words[0]);
                    same.then_some(Target { class, index })
                };
                all.iter().map(target).collect::<Option<_>>().map_or(ColumnFacts::Unknown, ColumnFacts::Refs)
            }
        }
    };
    let columns = decl.columns.iter().enumerate().map(column).collect();
    let class_of = if is_classed(decl) { class_of_row.clone() } else { Vec::new() };
    TableFacts { class_of, classes: count, columns }
}
