//! Colours: linear RGB, used for radiance, reflectance and throughput alike.

use std::ops::{Add, Div, Mul, Sub};

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Bool, Buf, Col, F32, Row};

/// Linear RGB.
#[derive(Clone, Copy)]
pub struct Color {
    /// Red.
    pub r: F32,
    /// Green.
    pub g: F32,
    /// Blue.
    pub b: F32,
}
impl_staged!(Color { r, g, b });

/// A colour.
pub fn color(r: impl Into<F32>, g: impl Into<F32>, b: impl Into<F32>) -> Color {
    Color { r: r.into(), g: g.into(), b: b.into() }
}

/// A colour that stands in three columns of a row.
pub fn read_color<B: Buf>(row: Row<B>, columns: [Col<B, F32>; 3]) -> Color {
    let [r, g, b] = columns.map(|c| row.get(c));
    color(r, g, b)
}

/// The same value in each channel.
pub fn gray(x: impl Into<F32>) -> Color {
    let x = x.into();
    color(x, x, x)
}

/// No light.
pub fn black() -> Color {
    gray(0.0)
}

/// Factor 1.
pub fn white() -> Color {
    gray(1.0)
}

impl Color {
    /// The same function of each channel.
    pub fn map(self, f: impl Fn(F32) -> F32) -> Color {
        color(f(self.r), f(self.g), f(self.b))
    }

    /// The same function of each pair of channels.
    pub fn zip(self, o: Color, f: impl Fn(F32, F32) -> F32) -> Color {
        color(f(self.r, o.r), f(self.g, o.g), f(self.b, o.b))
    }

    /// Channel by channel, +0 where either is ±0: a black factor switches a term off, even an infinite one.
    #[track_caller]
    pub fn absorb(self, o: Color) -> Color {
        color(self.r.absorb(o.r), self.g.absorb(o.g), self.b.absorb(o.b))
    }

    /// (1 − k) self + k other
    #[track_caller]
    pub fn lerp(self, o: Color, k: F32) -> Color {
        self * (1.0 - k) + o * k
    }

    /// Largest channel.
    pub fn max_channel(self) -> F32 {
        self.r.max(self.g).max(self.b)
    }

    /// Are all channels ±0?
    pub fn is_black(self) -> Bool {
        self.r.eq(0.0) & self.g.eq(0.0) & self.b.eq(0.0)
    }

    /// Relative luminance, Rec. 709.
    pub fn luminance(self) -> F32 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }
}

impl Add for Color {
    type Output = Color;
    #[track_caller]
    fn add(self, o: Color) -> Color {
        self.zip(o, |a, b| a + b)
    }
}

impl Sub for Color {
    type Output = Color;
    #[track_caller]
    fn sub(self, o: Color) -> Color {
        self.zip(o, |a, b| a - b)
    }
}

impl Mul for Color {
    type Output = Color;
    #[track_caller]
    fn mul(self, o: Color) -> Color {
        self.zip(o, |a, b| a * b)
    }
}

impl Mul<F32> for Color {
    type Output = Color;
    #[track_caller]
    fn mul(self, k: F32) -> Color {
        self.map(|c| c * k)
    }
}

impl Div<F32> for Color {
    type Output = Color;
    #[track_caller]
    fn div(self, k: F32) -> Color {
        self.map(|c| c / k)
    }
}
