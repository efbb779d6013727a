//! A place in a line of tokens, with the errors of what is found there.

use super::lex::{Line, is_word};
use crate::error::TextError;

/// Walks along a line.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    line: &'a Line<'a>,
    at: usize,
}

impl<'a> Cursor<'a> {
    /// At the line's first token.
    pub fn new(line: &'a Line<'a>) -> Cursor<'a> {
        Cursor { line, at: 0 }
    }

    /// The token so many places on; empty behind the end.
    pub fn peek(&self, ahead: usize) -> &'a str {
        self.line.tokens.get(self.at + ahead).map_or("", |t| t.text)
    }

    /// Is the line at its end?
    pub fn at_end(&self) -> bool {
        self.at >= self.line.tokens.len()
    }

    /// The next token.
    pub fn token(&mut self) -> Result<&'a str, TextError> {
        let token = self.line.tokens.get(self.at).ok_or_else(|| self.error("the line ends too early".to_owned()))?;
        self.at += 1;
        Ok(token.text)
    }

    /// The next token, a word.
    pub fn word(&mut self) -> Result<&'a str, TextError> {
        let text = self.token()?;
        match text.starts_with(|c: char| is_word(c) && !c.is_ascii_digit()) {
            true => Ok(text),
            false => Err(self.error_before(format!("a word stands here, not `{text}`"))),
        }
    }

    /// The next token, a number without a suffix.
    pub fn number(&mut self) -> Result<u32, TextError> {
        let text = self.token()?;
        text.parse().map_err(|_| self.error_before(format!("a number from 0 to 4294967295 stands here, not `{text}`")))
    }

    /// Pass this token if it is next.
    pub fn skip(&mut self, text: &str) -> bool {
        let found = self.peek(0) == text;
        self.at += found as usize;
        found
    }

    /// Pass this token.
    pub fn expect(&mut self, text: &str) -> Result<(), TextError> {
        match self.skip(text) {
            true => Ok(()),
            false => Err(self.error(format!("expected `{text}`"))),
        }
    }

    /// The line ends here.
    pub fn end(&self) -> Result<(), TextError> {
        match self.at_end() {
            true => Ok(()),
            false => Err(self.error(format!("`{}` is too much", self.peek(0)))),
        }
    }

    /// Pass everything up to the end of the first parentheses.
    pub fn skip_parentheses(&mut self) {
        let mut open = 0;
        while !self.at_end() {
            let text = self.peek(0);
            self.at += 1;
            open += (text == "(") as usize;
            if text == ")" && open <= 1 {
                return;
            }
            open -= (text == ")") as usize;
        }
    }

    /// An error at the next token, without words yet.
    pub fn place(&self) -> TextError {
        self.error(String::new())
    }

    /// An error at the next token.
    pub fn error(&self, what: String) -> TextError {
        self.error_at(self.at, what)
    }

    /// An error at the token just passed.
    pub fn error_before(&self, what: String) -> TextError {
        self.error_at(self.at.saturating_sub(1), what)
    }

    /// An error at a token of this line, or at its end.
    pub fn error_at(&self, token: usize, what: String) -> TextError {
        let tokens = &self.line.tokens;
        let end = tokens.last().map_or(1, |t| t.column + t.text.len());
        TextError { line: self.line.number, column: tokens.get(token).map_or(end, |t| t.column), what }
    }
}
