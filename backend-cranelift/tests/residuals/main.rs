//! Residuals as machine code, compared with the interpreter, bit for bit.

mod build;
mod control;
mod memory;
mod ops;
mod scale;
mod vectors;
