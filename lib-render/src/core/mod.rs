//! Mathematics over staged values, in reading order.

pub mod vec;
pub mod color;
pub mod exact;
pub mod rng;
pub mod sobol;
pub mod math;
pub mod onb;
pub mod sampling;
pub mod triangle;
pub mod spherical;
pub mod cdf;
pub mod alias;
pub mod fresnel;
pub mod thin_film;
pub mod microfacet;
