//! Names of the text: the authors' hints as words, made unique among what can be seen from one place.

use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::layout::Layout;
use crate::program::*;

/// Words that no name may be, because they could stand where a name stands. Such a name gets a `_` behind it.
const RESERVED: &[&str] = &["true", "false", "inf", "nan", "keep", "now", "later", "unchecked"];

/// Names, unique among what can be seen: within a root and all it contains, and the roots themselves.
pub(super) struct Names {
    /// Of continuations.
    pub conts: Vec<String>,
    /// Of parameters.
    pub params: Vec<Vec<String>>,
    /// Of lines.
    pub nodes: FxHashMap<NodeId, String>,
    /// Of buffers.
    pub buffers: Vec<String>,
    /// Of columns.
    pub columns: Vec<Vec<String>>,
}

impl Names {
    /// Name everything that is printed, in print order.
    pub fn new(p: &Program, layout: &Layout) -> Names {
        let mut names = Names {
            conts: vec![String::new(); p.conts.len()],
            params: vec![Vec::new(); p.conts.len()],
            nodes: FxHashMap::default(),
            buffers: Vec::new(),
            columns: Vec::new(),
        };
        let mut taken = Taken::default();
        for b in &p.buffers {
            names.buffers.push(taken.hint(&b.name));
            let mut columns = Taken::default();
            names.columns.push(b.columns.iter().map(|c| columns.hint(&c.name)).collect());
        }
        let mut global = Taken::default();
        for c in &layout.roots {
            names.conts[c.index()] = global.hint(&p.cont(*c).name);
        }
        for id in &layout.shared {
            names.nodes.insert(*id, global.value(p.names.get(id), SHARED));
        }
        for root in &layout.roots {
            let mut taken = Taken { outer: Some(&global), ..Taken::default() };
            for c in layout.preorder(*root) {
                names.cont(p, c, *root, &mut taken);
                for id in &layout.lines[c.index()] {
                    names.nodes.insert(*id, taken.value(p.names.get(id), LINE));
                }
            }
        }
        names
    }

    fn cont(&mut self, p: &Program, c: ContId, root: ContId, taken: &mut Taken) {
        if c != root {
            self.conts[c.index()] = taken.hint(&p.cont(c).name);
        }
        let params = &p.cont(c).params;
        self.params[c.index()] = params.iter().map(|x| taken.value(x.name.as_ref(), LINE)).collect();
    }
}

/// First letter of a line without a hint, before its number.
const LINE: char = 'y';
/// The same for a line that several functions share.
const SHARED: char = 'g';

/// Is this a name that the printer gives (`y7`)? Then it is no hint.
pub(crate) fn is_automatic(name: &str) -> bool {
    let digits = name.strip_prefix([LINE, SHARED]).unwrap_or("");
    !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
}

/// A hint as a word of the text.
pub(super) fn word(hint: &str) -> String {
    let mut word: String = hint.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if !word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        word.insert(0, '_');
    }
    if RESERVED.contains(&word.as_str()) {
        word.push('_');
    }
    word
}

/// The names that are taken so far.
#[derive(Default)]
struct Taken<'a> {
    outer: Option<&'a Taken<'a>>,
    names: FxHashSet<String>,
    /// Last number tried behind each name that was asked for twice.
    counters: FxHashMap<String, usize>,
}

impl Taken<'_> {
    fn is_taken(&self, name: &str) -> bool {
        self.names.contains(name) || self.outer.is_some_and(|outer| outer.is_taken(name))
    }

    /// The name of a value: its hint, or else the next number.
    fn value(&mut self, hint: Option<&Arc<str>>, letter: char) -> String {
        match hint {
            Some(hint) if !is_automatic(hint) => self.hint(hint),
            _ => self.numbered(&letter.to_string(), "", 1),
        }
    }

    /// The hint as a word, with a number behind it where it is taken.
    fn hint(&mut self, hint: &str) -> String {
        let name = word(hint);
        if self.is_taken(&name) {
            return self.numbered(&name, "_", 2);
        }
        self.names.insert(name.clone());
        name
    }

    fn numbered(&mut self, base: &str, mark: &str, first: usize) -> String {
        let base = format!("{base}{mark}");
        let mut number = *self.counters.get(&base).unwrap_or(&first);
        let mut name = format!("{base}{number}");
        while self.is_taken(&name) {
            number += 1;
            name = format!("{base}{number}");
        }
        self.counters.insert(base, number + 1);
        self.names.insert(name.clone());
        name
    }
}
