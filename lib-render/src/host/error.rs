//! The one error type of the host modules: a line for a human.

use std::fmt;

/// A failure, told in one line that says whose fault it is, where, and what to do.
///
/// There is one way to react to it, showing it to the user, so it carries a sentence and no codes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error(String);

impl Error {
    /// An error that reads as `message`, a single line without a trailing full stop.
    pub fn new(message: impl Into<String>) -> Error {
        Error(message.into())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Error {}
