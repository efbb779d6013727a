//! (front page to come)

pub mod cli;
pub mod host;
