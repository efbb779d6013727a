//! Mathematics over staged values, in reading order.

pub mod vec;
pub mod color;
pub mod rng;
