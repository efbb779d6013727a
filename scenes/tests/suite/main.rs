//! The tests of the crate, in one binary.

mod builtin;
mod common;
mod compressed;
mod hostile;
mod lobes;
mod messages;
mod missing;
mod moving;
mod obj;
mod reading;
mod shared;
mod second_reader;
