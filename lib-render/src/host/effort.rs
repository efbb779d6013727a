//! How much there is to write and to read: lines of code and Halstead's effort (paper, section 5.5 and Table 3).
//!
//! A program is a sequence of N₁ operators and N₂ operands, of which n₁ and n₂ are distinct. Its *volume* is
//! V = (N₁ + N₂) · log₂(n₁ + n₂) bits, its *difficulty* D = n₁/2 · N₂/n₂, and the *effort* of writing it E = D · V (Halstead
//! 1977). Operators are the keywords and the marks, the longest that fits; operands are names, lifetimes and literals.
//! Comments are nothing, and so are tests: a file counts up to its first `#[cfg(test)]`. A line of code is a line with a token
//! on it. Several files together are one program, so what they share counts as distinct once.
//!
//! ```
//! use jerboa_lib_render::host::effort::Effort;
//!
//! let mut effort = Effort::default();
//! effort.add("fn twice(x: f32) -> f32 {\n    x + x // in a register\n}\n");
//! assert_eq!((effort.lines(), effort.operators(), effort.operands()), (3, (8, 8), (3, 6)));
//! ```

use std::collections::BTreeSet;

/// What was counted.
#[derive(Clone, Debug, Default)]
pub struct Effort {
    lines: u64,
    operators: BTreeSet<String>,
    operands: BTreeSet<String>,
    uses: [u64; 2],
}

impl Effort {
    /// Counts a file of Rust.
    pub fn add(&mut self, text: &str) {
        let text = text.split("#[cfg(test)]").next().unwrap_or_default();
        let mut last = 0;
        for Token { text, line, is_operator } in tokens(text) {
            self.lines += u64::from(line != last);
            last = line;
            self.uses[usize::from(is_operator)] += 1;
            let known = if is_operator { &mut self.operators } else { &mut self.operands };
            if !known.contains(text) {
                known.insert(text.into());
            }
        }
    }

    /// Lines with a token on them.
    pub fn lines(&self) -> u64 {
        self.lines
    }

    /// Operators: distinct ones, all.
    pub fn operators(&self) -> (u64, u64) {
        (self.operators.len() as u64, self.uses[1])
    }

    /// Operands: distinct ones, all.
    pub fn operands(&self) -> (u64, u64) {
        (self.operands.len() as u64, self.uses[0])
    }

    /// Halstead's effort; 0 of nothing.
    pub fn effort(&self) -> f64 {
        let ((n1, all1), (n2, all2)) = (self.operators(), self.operands());
        let [n1, all1, n2, all2] = [n1, all1, n2, all2].map(|n| n as f64);
        let volume = (all1 + all2) * (n1 + n2).max(1.0).log2();
        n1 / 2.0 * all2 / n2.max(1.0) * volume
    }
}

/// A token and the line where it begins, from 1.
struct Token<'t> {
    text: &'t str,
    line: usize,
    is_operator: bool,
}

/// The keywords of Rust that are used as such in this edition, without those that name a value (`self`, `Self`, `super`,
/// `crate`, `true`, `false`).
const KEYWORDS: [&str; 29] = [
    "as", "async", "await", "break", "const", "continue", "dyn", "else", "enum", "extern", "fn", "for", "if", "impl",
    "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return", "static", "struct", "trait", "use",
    "while",
];

/// Marks of more than one character, longer ones first.
const MARKS: [&str; 25] = [
    "<<=", ">>=", "...", "..=", "::", "->", "=>", "==", "!=", "<=", ">=", "&&", "||", "+=", "-=", "*=", "/=", "%=",
    "^=", "&=", "|=", "<<", ">>", "..", "#!",
];

/// The tokens of a text.
fn tokens(text: &str) -> impl Iterator<Item = Token<'_>> {
    let (mut rest, mut line) = (text, 1);
    std::iter::from_fn(move || {
        loop {
            let first = rest.chars().next()?;
            let length = length(rest, first);
            let (token, after) = rest.split_at(length);
            let at = line;
            line += token.matches('\n').count();
            rest = after;
            if !(first.is_whitespace() || token.starts_with("//") || token.starts_with("/*")) {
                let is_name = first.is_alphanumeric() || matches!(first, '_' | '"' | '\'');
                return Some(Token { text: token, line: at, is_operator: !is_name || KEYWORDS.contains(&token) });
            }
        }
    })
}

/// Bytes of the token, comment or white space at the beginning of a text, whose first character is `first`.
fn length(text: &str, first: char) -> usize {
    let until = |end: &str, from: usize| text[from..].find(end).map_or(text.len(), |at| from + at);
    let while_ = |is: fn(char) -> bool| text.find(|c| !is(c)).unwrap_or(text.len());
    if first.is_whitespace() {
        while_(char::is_whitespace)
    } else if text.starts_with("//") {
        until("\n", 0)
    } else if text.starts_with("/*") {
        (until("*/", 2) + 2).min(text.len())
    } else if first == '"' {
        string(text, 1)
    } else if text.starts_with("b\"") {
        string(text, 2)
    } else if text.starts_with("r\"") {
        (until("\"", 2) + 1).min(text.len())
    } else if text.starts_with("r#\"") {
        (until("\"#", 3) + 2).min(text.len())
    } else if first == '\'' {
        character_or_lifetime(text)
    } else if first.is_ascii_digit() {
        number(text)
    } else if first.is_alphanumeric() || first == '_' {
        while_(|c| c.is_alphanumeric() || c == '_')
    } else {
        MARKS.iter().find(|m| text.starts_with(**m)).map_or(first.len_utf8(), |m| m.len())
    }
}

/// Bytes of a string whose text begins at `from`.
fn string(text: &str, from: usize) -> usize {
    let mut escaped = false;
    for (at, c) in text[from..].char_indices() {
        match c {
            '"' if !escaped => return from + at + 1,
            '\\' => escaped = !escaped,
            _ => escaped = false,
        }
    }
    text.len()
}

/// Bytes of `'c'`, `'\n'` or `'name`.
fn character_or_lifetime(text: &str) -> usize {
    let inside: Vec<(usize, char)> = text.char_indices().skip(1).take(2).collect();
    match inside[..] {
        [(_, '\\'), (second, c)] => {
            let from = second + c.len_utf8();
            text[from..].find('\'').map_or(text.len(), |at| from + at + 1)
        }
        [_, (second, '\'')] => second + 1,
        _ => text[1..].find(|c: char| !(c.is_alphanumeric() || c == '_')).map_or(text.len(), |at| at + 1),
    }
}

/// Bytes of a number: `1.5e-3` and `0..n` too.
fn number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let is_hex = text.starts_with("0x");
    let mut at = 1;
    while at < bytes.len() {
        let (before, c) = (bytes[at - 1], bytes[at]);
        let fraction = c == b'.' && bytes.get(at + 1).is_some_and(u8::is_ascii_digit);
        let exponent = matches!(c, b'+' | b'-') && matches!(before, b'e' | b'E') && !is_hex;
        if !(c.is_ascii_alphanumeric() || c == b'_' || fraction || exponent) {
            break;
        }
        at += 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<&str> {
        tokens(text).map(|t| t.text).collect()
    }

    #[test]
    fn tokens_are_those_of_rust() {
        assert_eq!(
            words("a::<'b>(0..n, 1.5e-3, x.0)"),
            ["a", "::", "<", "'b", ">", "(", "0", "..", "n", ",", "1.5e-3", ",", "x", ".", "0", ")"]
        );
        assert_eq!(words(r#"'"' '\'' "a\"b" b"c" r"d\""#), ["'\"'", r"'\''", r#""a\"b""#, "b\"c\"", r#"r"d\""#]);
        assert_eq!(words("x /* y\n */ <<= 0xE-1 // z"), ["x", "<<=", "0xE", "-", "1"]);
    }

    #[test]
    fn effort_is_halsteads() {
        let mut effort = Effort::default();
        effort.add("a = b + c;\nd = a + a;\n#[cfg(test)]\nmod tests {}\n");
        // Operators = + ; twice each, operands a, b, c, d of six uses.
        assert_eq!((effort.lines(), effort.operators(), effort.operands()), (2, (3, 6), (4, 6)));
        assert!((effort.effort() - 3.0 / 2.0 * 6.0 / 4.0 * 12.0 * 7f64.log2()).abs() < 1e-9);
        assert_eq!(Effort::default().effort(), 0.0);
    }
}
