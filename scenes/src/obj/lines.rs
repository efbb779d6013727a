//! Lines of OBJ and MTL: a keyword and words, and where a fault is.

use crate::Error;
use std::borrow::Cow;
use std::path::Path;
use std::str::FromStr;

/// A line with something on it.
pub(super) struct Line<'a> {
    file: &'a Path,
    /// Of its first line in the file, from 1.
    number: usize,
    /// Without comment and surrounding blanks.
    text: Cow<'a, str>,
}

/// The lines of a file that say something; one that ends in a backslash goes on in the next.
pub(super) fn lines<'a>(file: &'a Path, text: &'a str) -> impl Iterator<Item = Line<'a>> {
    let mut rest = text.lines().zip(1usize..);
    let lines = std::iter::from_fn(move || {
        let (first, number) = rest.next()?;
        let mut text = Cow::from(first);
        while text.ends_with('\\') {
            // In place: a file may be one line in a million pieces.
            let whole = text.to_mut();
            whole.pop();
            whole.push(' ');
            whole.push_str(rest.next().map_or("", |(next, _)| next));
        }
        Some(Line { file, number, text })
    });
    lines.filter_map(|line| {
        let text = match line.text {
            Cow::Borrowed(text) => Cow::from(said(text)),
            Cow::Owned(text) => Cow::from(said(&text).to_string()),
        };
        (!text.is_empty()).then_some(Line { text, ..line })
    })
}

/// What a line says before its comment. A name may hold a `#`, but not begin with one.
fn said(text: &str) -> &str {
    let text = text.trim();
    let comment =
        text.match_indices('#').map(|(at, _)| at).find(|&at| at == 0 || text[..at].ends_with(char::is_whitespace));
    text[..comment.unwrap_or(text.len())].trim_end()
}

impl Line<'_> {
    /// Its first word.
    pub fn keyword(&self) -> &str {
        self.text.split_whitespace().next().unwrap_or_default()
    }

    /// All after the keyword; names of files may have blanks.
    pub fn rest(&self) -> &str {
        self.text[self.keyword().len()..].trim_start()
    }

    /// The words after the keyword.
    pub fn words(&self) -> impl Iterator<Item = &str> {
        self.text.split_whitespace().skip(1)
    }

    /// Where it stands, for messages.
    pub fn place(&self) -> String {
        format!("line {}", self.number)
    }

    /// Something wrong with it.
    pub fn fault(&self, reason: impl Into<String>) -> Error {
        Error::Value { file: self.file.into(), path: self.place(), reason: reason.into() }
    }

    /// A word as a finite number of single precision.
    pub fn number(&self, word: &str) -> Result<f32, Error> {
        let number = f32::from_str(word).ok().filter(|x| x.is_finite());
        number.ok_or_else(|| self.fault(format!("\"{word}\" is not a finite number")))
    }

    /// The first `N` words after the keyword as numbers.
    pub fn numbers<const N: usize>(&self) -> Result<[f32; N], Error> {
        let mut numbers = [0.0; N];
        let mut words = self.words();
        for number in &mut numbers {
            let word = words.next().ok_or_else(|| self.fault(format!("{N} numbers are needed")))?;
            *number = self.number(word)?;
        }
        Ok(numbers)
    }
}
