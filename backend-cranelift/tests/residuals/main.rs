//! Residuals built by hand, as machine code.

mod build;
mod ops;
