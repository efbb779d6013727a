//! Literals: the values of scalars. A float is its bits, so that equality is identity; all NaN are one value.

use std::fmt;

use crate::ty::{Scalar, Ty};

/// A literal. `F32` holds bits; a NaN always holds [`NAN_BITS`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub enum Lit {
    /// `bool`
    Bool(bool),
    /// `i32`
    I32(i32),
    /// `u32`
    U32(u32),
    /// `f32`, by its bits
    F32(u32),
}

/// The bits that stand for every NaN: what a bitcast of a NaN gives on every engine (Law 3).
pub const NAN_BITS: u32 = 0x7fc0_0000;

impl Lit {
    /// A float; every NaN becomes the one NaN.
    pub fn f32(x: f32) -> Lit {
        Lit::F32(if x.is_nan() { NAN_BITS } else { x.to_bits() })
    }

    /// Its type.
    pub fn scalar(self) -> Scalar {
        match self {
            Lit::Bool(_) => Scalar::Bool,
            Lit::I32(_) => Scalar::I32,
            Lit::U32(_) => Scalar::U32,
            Lit::F32(_) => Scalar::F32,
        }
    }

    /// Its type.
    pub fn ty(self) -> Ty {
        Ty::scalar(self.scalar())
    }

    /// The 32-bit word that memory holds for it.
    pub fn word(self) -> u32 {
        match self {
            Lit::Bool(b) => b as u32,
            Lit::I32(i) => i as u32,
            Lit::U32(u) | Lit::F32(u) => u,
        }
    }

    /// The literal that a word of memory holds: a `bool` is "not 0", a NaN is the one NaN.
    pub fn from_word(scalar: Scalar, word: u32) -> Lit {
        match scalar {
            Scalar::Bool => Lit::Bool(word != 0),
            Scalar::I32 => Lit::I32(word as i32),
            Scalar::U32 => Lit::U32(word),
            Scalar::F32 => Lit::f32(f32::from_bits(word)),
        }
    }

    /// The float, if it is one.
    pub fn as_f32(self) -> Option<f32> {
        match self {
            Lit::F32(bits) => Some(f32::from_bits(bits)),
            _ => None,
        }
    }

    /// The truth value, if it is one.
    pub fn as_bool(self) -> Option<bool> {
        match self {
            Lit::Bool(b) => Some(b),
            _ => None,
        }
    }

    /// The unsigned integer, if it is one.
    pub fn as_u32(self) -> Option<u32> {
        match self {
            Lit::U32(u) => Some(u),
            _ => None,
        }
    }
}

impl Lit {
    /// The literal that a word says; reads what `Display` writes.
    pub fn parse(text: &str) -> Option<Lit> {
        match text {
            "true" => return Some(Lit::Bool(true)),
            "false" => return Some(Lit::Bool(false)),
            "inf" => return Some(Lit::f32(f32::INFINITY)),
            "-inf" => return Some(Lit::f32(f32::NEG_INFINITY)),
            "nan" => return Some(Lit::f32(f32::NAN)),
            // Rust would read `infinity` and `+1`, too.
            _ if !text.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit()) => return None,
            _ => {}
        }
        if let Some(digits) = text.strip_suffix('i') {
            return digits.parse().ok().map(Lit::I32);
        }
        if let Some(digits) = text.strip_suffix('u') {
            return digits.parse().ok().map(Lit::U32);
        }
        if !text.contains(['.', 'e']) {
            return None;
        }
        text.parse().ok().map(Lit::f32)
    }
}

impl fmt::Display for Lit {
    /// As the text of the IR writes it: `true`, `-3i`, `3u`, `1.5`, `-0.0`, `inf`, `nan`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Lit::Bool(b) => write!(f, "{b}"),
            Lit::I32(i) => write!(f, "{i}i"),
            Lit::U32(u) => write!(f, "{u}u"),
            Lit::F32(bits) => {
                let x = f32::from_bits(bits);
                if x.is_nan() {
                    f.write_str("nan")
                } else {
                    // Shortest decimal that reads back to the same bits; always with a point, an exponent or `inf`.
                    write!(f, "{x:?}")
                }
            }
        }
    }
}
