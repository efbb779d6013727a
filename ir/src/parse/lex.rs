//! Lines of words for the parser.

use crate::error::TextError;
use crate::print::HEADER;

/// A word, a number or a mark; the text tells which.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Token<'a> {
    /// As written.
    pub text: &'a str,
    /// Where it begins, from 1.
    pub column: usize,
}

/// A line that is not empty, without its comment.
#[derive(Debug)]
pub(super) struct Line<'a> {
    /// Its number, from 1.
    pub number: usize,
    /// Its tokens, at least one.
    pub tokens: Vec<Token<'a>>,
}

impl Line<'_> {
    /// Does it begin at the margin?
    pub fn at_margin(&self) -> bool {
        self.tokens[0].column == 1
    }
}

/// Check the header and cut what follows into lines of tokens.
pub(super) fn lines(text: &str) -> Result<Vec<Line<'_>>, TextError> {
    let mut code = (1..).zip(text.lines().map(|line| line.split(';').next().unwrap_or("")));
    let header = code.by_ref().find(|(_, line)| !line.trim().is_empty());
    match header.map(|(number, line)| (number, line.trim())) {
        Some((_, HEADER)) => {}
        found => {
            let (line, found) = found.unwrap_or((1, "nothing"));
            let what = format!("a text begins with `{HEADER}`, this one with `{}`", found.escape_debug());
            return Err(TextError { line, column: 1, what });
        }
    }
    let mut lines = Vec::new();
    for (number, code) in code {
        let tokens = tokens(code).map_err(|(column, what)| TextError { line: number, column, what })?;
        if !tokens.is_empty() {
            lines.push(Line { number, tokens });
        }
    }
    Ok(lines)
}

fn tokens(code: &str) -> Result<Vec<Token<'_>>, (usize, String)> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = code[at..].chars().next() {
        let rest = &code[at..];
        let length = match first {
            ' ' | '\t' | '\r' => {
                at += 1;
                continue;
            }
            'a'..='z' | 'A'..='Z' | '_' => rest.find(|c: char| !is_word(c)).unwrap_or(rest.len()),
            '0'..='9' => number(rest),
            '-' if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => 1 + number(&rest[1..]),
            '-' if rest.starts_with("-inf") => 4,
            '-' if rest.starts_with("->") => 2,
            ':' if rest.starts_with("::") => 2,
            '(' | ')' | ',' | ':' | '=' | '@' | '.' => 1,
            _ => return Err((at + 1, format!("`{}` means nothing here", first.escape_debug()))),
        };
        tokens.push(Token { text: &rest[..length], column: at + 1 });
        at += length;
    }
    Ok(tokens)
}

/// Is this a letter of a word?
pub(super) fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Length of a number: letters, digits and points, with a sign behind an `e`.
fn number(text: &str) -> usize {
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        if !is_word(c) && c != '.' && !((c == '-' || c == '+') && before == 'e') {
            return at;
        }
        before = c;
    }
    text.len()
}
