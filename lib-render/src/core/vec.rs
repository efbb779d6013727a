//! Vectors of staged floats.

use std::ops::{Add, Div, Mul, Neg, Sub};

use jerboa_ir::impl_staged;
use jerboa_ir::lang::F32;

/// Two floats: texture coordinates, a point of the unit square.
#[derive(Clone, Copy)]
pub struct Vec2 {
    /// First coordinate.
    pub x: F32,
    /// Second coordinate.
    pub y: F32,
}
impl_staged!(Vec2 { x, y });

/// Three floats: a point (m) or a direction.
#[derive(Clone, Copy)]
pub struct Vec3 {
    /// First coordinate.
    pub x: F32,
    /// Second coordinate.
    pub y: F32,
    /// Third coordinate.
    pub z: F32,
}
impl_staged!(Vec3 { x, y, z });

/// A vector of two.
pub fn vec2(x: impl Into<F32>, y: impl Into<F32>) -> Vec2 {
    Vec2 { x: x.into(), y: y.into() }
}

/// A vector of three.
pub fn vec3(x: impl Into<F32>, y: impl Into<F32>, z: impl Into<F32>) -> Vec3 {
    Vec3 { x: x.into(), y: y.into(), z: z.into() }
}

impl Vec3 {
    /// The same function of each coordinate.
    pub fn map(self, f: impl Fn(F32) -> F32) -> Vec3 {
        vec3(f(self.x), f(self.y), f(self.z))
    }

    /// The same function of each pair of coordinates.
    pub fn zip(self, o: Vec3, f: impl Fn(F32, F32) -> F32) -> Vec3 {
        vec3(f(self.x, o.x), f(self.y, o.y), f(self.z, o.z))
    }

    /// Scalar product.
    #[track_caller]
    pub fn dot(self, o: Vec3) -> F32 {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product.
    #[track_caller]
    pub fn cross(self, o: Vec3) -> Vec3 {
        vec3(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }

    /// Squared length.
    #[track_caller]
    pub fn length2(self) -> F32 {
        self.dot(self)
    }

    /// Length.
    #[track_caller]
    pub fn length(self) -> F32 {
        self.length2().sqrt()
    }

    /// Length, also where squares would overflow or vanish: divides by the largest coordinate first. Zero gives 0.
    #[track_caller]
    pub fn length_scaled(self) -> F32 {
        let largest = self.abs().max_element();
        largest.absorb((self / largest).length())
    }

    /// The unit vector in this direction. Zero gives NaN; see [`Vec3::normalize_scaled`] for tiny or huge vectors.
    #[track_caller]
    pub fn normalize(self) -> Vec3 {
        self / self.length()
    }

    /// The unit vector in this direction, also where squares would overflow or vanish: divides by the largest coordinate
    /// first. Zero gives NaN.
    #[track_caller]
    pub fn normalize_scaled(self) -> Vec3 {
        (self / self.abs().max_element()).normalize()
    }

    /// Absolute values.
    pub fn abs(self) -> Vec3 {
        self.map(F32::abs)
    }

    /// Largest coordinate.
    pub fn max_element(self) -> F32 {
        self.x.max(self.y).max(self.z)
    }
}

macro_rules! operators {
    ($($name:ident { $($f:ident),+ })+) => { $(
        impl Add for $name {
            type Output = $name;
            #[track_caller]
            fn add(self, o: $name) -> $name { $name { $($f: self.$f + o.$f),+ } }
        }
        impl Sub for $name {
            type Output = $name;
            #[track_caller]
            fn sub(self, o: $name) -> $name { $name { $($f: self.$f - o.$f),+ } }
        }
        impl Neg for $name {
            type Output = $name;
            #[track_caller]
            fn neg(self) -> $name { $name { $($f: -self.$f),+ } }
        }
        impl Mul<F32> for $name {
            type Output = $name;
            #[track_caller]
            fn mul(self, k: F32) -> $name { $name { $($f: self.$f * k),+ } }
        }
        impl Div<F32> for $name {
            type Output = $name;
            #[track_caller]
            fn div(self, k: F32) -> $name { $name { $($f: self.$f / k),+ } }
        }
    )+ };
}
operators! { Vec2 { x, y } Vec3 { x, y, z } }
