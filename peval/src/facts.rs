//! What a specialisation knows of the scene: Law 2 of the design, as data.
//!
//! The host lays a scene out as tables and decides which columns are known (`nothing`, `structure`, `all`). Rows that
//! agree in every known column form a *class*. All of it reaches the evaluator in this one struct; a table or column
//! that is not mentioned is unknown. Facts must describe the very memory that the residual will run on.

use jerboa_ir::{BufId, Column, Lit};
use rustc_hash::FxHashSet;

/// Facts about every table, by binding number. Tables beyond the end, and streams, are unknown.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// One entry for each binding.
    pub tables: Vec<TableFacts>,
}

/// Facts about one table.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct TableFacts {
    /// Class of each row; empty when there is one class only. If not empty, the table is `classed` and its column 0
    /// holds these very numbers.
    pub class_of: Vec<u32>,
    /// Number of classes, numbered from 0; 0 and 1 mean that all rows are of class 0.
    pub classes: u32,
    /// One entry for each column; columns beyond the end are unknown.
    pub columns: Vec<ColumnFacts>,
}

/// Facts about one column.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub enum ColumnFacts {
    /// It is read when the residual runs.
    #[default]
    Unknown,
    /// The scalar that all rows of a class hold, by class.
    Known(Vec<Lit>),
    /// A reference column: where the rows of a class point, by class.
    Refs(Vec<Target>),
}

/// Where a known reference points.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Target {
    /// Class of the row it points to.
    pub class: u32,
    /// Index of that row in its table, if all rows of the class agree on it and it is known at this level.
    pub index: Option<u32>,
}

impl Facts {
    /// Level `nothing`: every table has one class, of which nothing is known.
    pub fn none() -> Facts {
        Facts::default()
    }

    /// Number of classes of a table.
    pub(crate) fn classes(&self, table: BufId) -> u32 {
        self.tables.get(table.index()).map_or(1, |t| t.classes.max(1))
    }

    /// Class of a row; the index is clamped as a read would be.
    pub(crate) fn class_of(&self, table: BufId, row: u32) -> Option<u32> {
        let classes = &self.tables.get(table.index())?.class_of;
        classes.get((row as usize).min(classes.len().checked_sub(1)?)).copied()
    }

    fn column(&self, column: Column) -> &ColumnFacts {
        let table = self.tables.get(column.buf.index());
        table.and_then(|t| t.columns.get(column.col as usize)).unwrap_or(&ColumnFacts::Unknown)
    }

    /// What a row of this class (of any class, if `None`) holds in a column: known if the classes in question agree.
    pub(crate) fn scalar(&self, column: Column, class: Option<u32>) -> Option<Lit> {
        match self.column(column) {
            ColumnFacts::Known(lits) => agreed(lits, class),
            _ => None,
        }
    }

    /// Where a row of this class (of any class, if `None`) points: class and index, each if the classes agree on it.
    pub(crate) fn target(&self, column: Column, class: Option<u32>) -> (Option<u32>, Option<u32>) {
        match self.column(column) {
            ColumnFacts::Refs(targets) => {
                let classes: Vec<u32> = targets.iter().map(|t| t.class).collect();
                let indices: Vec<Option<u32>> = targets.iter().map(|t| t.index).collect();
                (agreed(&classes, class), agreed(&indices, class).flatten())
            }
            _ => (None, None),
        }
    }
}

impl Facts {
    /// Do these facts and others say the same where a residual depended on them? If they do for all of its folds, it is a
    /// residual for the others as well.
    pub fn agrees(&self, other: &Facts, fold: Fold) -> bool {
        match fold {
            Fold::Column { column, class } => {
                self.scalar(column, class) == other.scalar(column, class)
                    && self.target(column, class) == other.target(column, class)
            }
            Fold::Classes(table) => {
                let rows = |f: &Facts| f.tables.get(table.index()).map(|t| t.class_of.clone());
                self.classes(table) == other.classes(table) && rows(self) == rows(other)
            }
        }
    }
}

/// The value of one class, or the value that all classes share.
fn agreed<T: Copy + PartialEq>(by_class: &[T], class: Option<u32>) -> Option<T> {
    match class {
        Some(class) => by_class.get(class as usize).copied(),
        None => by_class.first().copied().filter(|first| by_class.iter().all(|x| x == first)),
    }
}

/// A fact of the scene that the residual depends on.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Fold {
    /// What a column holds in the rows of a class; `None`: in all rows.
    Column {
        /// The column.
        column: Column,
        /// The class, or all.
        class: Option<u32>,
    },
    /// Which classes a table has and which rows belong to them.
    Classes(BufId),
}

/// The facts that were used.
#[derive(Default)]
pub(crate) struct Used(FxHashSet<Fold>);

impl Used {
    pub fn add(&mut self, fold: Fold) {
        self.0.insert(fold);
    }

    /// In ascending order.
    pub fn finish(self) -> Vec<Fold> {
        let mut folds: Vec<Fold> = self.0.into_iter().collect();
        folds.sort_unstable();
        folds
    }
}
