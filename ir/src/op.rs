//! The one table of primitive operations: name, arity, type rule and exact meaning.
//!
//! The table drives type checking, folding, the interpreter and the back ends. All operations are *total*: there is no
//! input that traps, and the result is specified for each one, bit for bit (every NaN is one value). Floats follow
//! IEEE 754 binary32, round to nearest even, denormals kept; nothing is contracted or reassociated.
//!
//! # How to add an operation
//! 1. Add its row to `ops!` below: variant, name, rule, meaning in words.
//! 2. The compiler names each `match` that now misses it: [`Op::eval`] (the meaning, one line) and `ops.rs` of each back
//!    end. Interpreter, evaluator, printer, parser and verifier need nothing.
//! 3. `cargo test -p jerboa-tests conformance` runs it on every engine over all special values; random programs use it
//!    from then on. A method for authors goes to `lang/value.rs`.

use crate::lit::Lit;
use crate::ty::{Scalar, Ty};

/// The type rule of an operation, stated for scalars; vectors of equal length work lane by lane.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Rule {
    /// T, T → T for `i32`, `u32`, `f32`.
    Arith,
    /// T, T → T for `i32`, `u32`.
    IntArith,
    /// T → T for `i32`, `f32`.
    Signed,
    /// `f32` → `f32`.
    Float,
    /// `f32`, `f32` → `f32`.
    Float2,
    /// `f32`, `f32`, `f32` → `f32`.
    Float3,
    /// T, T → T for `bool`, `i32`, `u32`.
    Logic,
    /// T → T for `bool`, `i32`, `u32`.
    Not,
    /// T, `u32` → T for `i32`, `u32`.
    Shift,
    /// T, T → `bool` for every scalar.
    Equal,
    /// T, T → `bool` for `i32`, `u32`, `f32`.
    Order,
    /// `bool`, T, T → T for every scalar.
    Select,
    /// From one scalar of the first list to the second.
    Convert(&'static [Scalar], Scalar),
    /// A vector of `bool` → this scalar.
    Lanes(Scalar),
}

macro_rules! ops {
    ($($(#[doc = $doc:literal])+ $op:ident $name:literal $rule:expr;)+) => {
        /// A primitive operation. See the module's page.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
        pub enum Op { $($(#[doc = $doc])+ $op,)+ }

        impl Op {
            /// Every operation, in the order of the table.
            pub const ALL: &'static [Op] = &[$(Op::$op,)+];

            /// The word that the text uses.
            pub fn name(self) -> &'static str { match self { $(Op::$op => $name,)+ } }

            /// Its type rule.
            pub fn rule(self) -> Rule { use Rule::*; match self { $(Op::$op => $rule,)+ } }
        }
    };
}

ops! {
    /// a + b; integers wrap.
    Add "add" Arith;
    /// a − b; integers wrap.
    Sub "sub" Arith;
    /// a · b; integers wrap.
    Mul "mul" Arith;
    /// a / b; floats correctly rounded; integers truncate, x / 0 = 0, `i32::MIN` / −1 = `i32::MIN`.
    Div "div" Arith;
    /// a − (a / b) · b with the quotient truncated; x rem 0 = 0, `i32::MIN` rem −1 = 0.
    Rem "rem" IntArith;
    /// a < b ? a : b. So the second operand when either is NaN, and for zeros of either sign.
    Min "min" Arith;
    /// a > b ? a : b. So the second operand when either is NaN, and for zeros of either sign.
    Max "max" Arith;
    /// −a; floats flip the sign bit, integers wrap.
    Neg "neg" Signed;
    /// |a|; floats clear the sign bit, integers wrap.
    Abs "abs" Signed;
    /// a · b + c rounded once. Only where it is written; never made from a product and a sum.
    Fma "fma" Float3;
    /// The absorbing product: +0 when either operand is ±0, else a · b. A black factor switches a term off, whatever the
    /// other factor is (infinite or NaN).
    Absorb "absorb" Float2;
    /// Square root, correctly rounded; of less than −0 it is NaN.
    Sqrt "sqrt" Float;
    /// Largest integer not above a; keeps the sign of zero.
    Floor "floor" Float;
    /// Smallest integer not below a; keeps the sign of zero.
    Ceil "ceil" Float;
    /// Integer part towards zero; keeps the sign of zero.
    Trunc "trunc" Float;
    /// Nearest integer, ties to even; keeps the sign of zero.
    Round "round" Float;
    /// Bitwise (or logical) and.
    And "and" Logic;
    /// Bitwise (or logical) or.
    Or "or" Logic;
    /// Bitwise (or logical) exclusive or.
    Xor "xor" Logic;
    /// Bitwise (or logical) complement.
    Not "not" Not;
    /// a · 2^(b mod 32).
    Shl "shl" Shift;
    /// a / 2^(b mod 32) rounded down: arithmetic for `i32`, logical for `u32`.
    Shr "shr" Shift;
    /// a = b; false when either is NaN, true for zeros of either sign.
    Eq "eq" Equal;
    /// Not a = b; true when either is NaN.
    Ne "ne" Equal;
    /// a < b; false when either is NaN.
    Lt "lt" Order;
    /// a ≤ b; false when either is NaN.
    Le "le" Order;
    /// a > b; false when either is NaN.
    Gt "gt" Order;
    /// a ≥ b; false when either is NaN.
    Ge "ge" Order;
    /// a ? b : c. Both are values already; nothing is skipped.
    Select "select" Select;
    /// The nearest `f32`, ties to even.
    ToF32 "to_f32" Convert(&[Scalar::I32, Scalar::U32], Scalar::F32);
    /// Truncated towards zero; NaN gives 0, out of range the nearest bound.
    ToI32 "to_i32" Convert(&[Scalar::F32], Scalar::I32);
    /// Truncated towards zero; NaN gives 0, out of range the nearest bound.
    ToU32 "to_u32" Convert(&[Scalar::F32], Scalar::U32);
    /// The bits of a float; 0x7fc00000 for every NaN. Of an `i32` its two's complement, of a `bool` 0 or 1.
    Bits "bits" Convert(&[Scalar::Bool, Scalar::I32, Scalar::F32], Scalar::U32);
    /// The float that has these bits.
    FloatOfBits "float_of_bits" Convert(&[Scalar::U32], Scalar::F32);
    /// The `i32` that has these bits.
    IntOfBits "int_of_bits" Convert(&[Scalar::U32], Scalar::I32);
    /// Does any lane hold?
    Any "any" Lanes(Scalar::Bool);
    /// Do all lanes hold?
    All "all" Lanes(Scalar::Bool);
    /// Bit i is lane i.
    Ballot "ballot" Lanes(Scalar::U32);
}

impl Op {
    /// Number of operands.
    pub fn arity(self) -> usize {
        match self.rule() {
            Rule::Signed | Rule::Float | Rule::Not | Rule::Convert(..) | Rule::Lanes(_) => 1,
            Rule::Arith | Rule::IntArith | Rule::Float2 | Rule::Logic | Rule::Shift | Rule::Equal | Rule::Order => 2,
            Rule::Float3 | Rule::Select => 3,
        }
    }

    /// The operation of this name.
    pub fn by_name(name: &str) -> Option<Op> {
        Op::ALL.iter().copied().find(|op| op.name() == name)
    }

    /// The scalars that the last operand may have.
    pub fn scalars(self) -> &'static [Scalar] {
        use Scalar::*;
        match self.rule() {
            Rule::Arith | Rule::Order => &[I32, U32, F32],
            Rule::IntArith | Rule::Shift => &[I32, U32],
            Rule::Signed => &[I32, F32],
            Rule::Float | Rule::Float2 | Rule::Float3 => &[F32],
            Rule::Logic | Rule::Not => &[Bool, I32, U32],
            Rule::Equal | Rule::Select => &Scalar::ALL,
            Rule::Convert(from, _) => from,
            Rule::Lanes(_) => &[Bool],
        }
    }

    /// The type of the result, or what is wrong with the operands.
    pub fn result(self, args: &[Ty]) -> Result<Ty, String> {
        let wrong = || Err(format!("{} does not take {args:?}", self.name()));
        if args.len() != self.arity() {
            return Err(format!("{} takes {} operands, not {}", self.name(), self.arity(), args.len()));
        }
        let rule = self.rule();
        // The operand that the rule calls T.
        let main = if rule == Rule::Select { args[1] } else { args[0] };
        let Some((scalar, lanes)) = main.lanes() else { return wrong() };
        let same = |t: Ty, s: Scalar| t.lanes() == Some((s, lanes));
        let others_fit = match rule {
            Rule::Select => same(args[0], Scalar::Bool) && args[2] == main,
            Rule::Shift => same(args[1], Scalar::U32),
            Rule::Lanes(_) => lanes > 1,
            _ => args.iter().all(|t| *t == main),
        };
        if !others_fit || !self.scalars().contains(&scalar) {
            return wrong();
        }
        Ok(match rule {
            Rule::Equal | Rule::Order => main.with_scalar(Scalar::Bool),
            Rule::Convert(_, to) => main.with_scalar(to),
            Rule::Lanes(to) => Ty::scalar(to),
            _ => main,
        })
    }

    /// The meaning on scalars. `args` fit the rule; the three operations over lanes take all lanes as `args`.
    ///
    /// # Panics
    /// When the operands do not fit [`Op::result`].
    pub fn eval(self, args: &[Lit]) -> Lit {
        use Lit::*;
        let float = |bits: u32| f32::from_bits(bits);
        match (self, args) {
            (Op::Add, [I32(a), I32(b)]) => I32(a.wrapping_add(*b)),
            (Op::Add, [U32(a), U32(b)]) => U32(a.wrapping_add(*b)),
            (Op::Add, [F32(a), F32(b)]) => Lit::f32(float(*a) + float(*b)),
            (Op::Sub, [I32(a), I32(b)]) => I32(a.wrapping_sub(*b)),
            (Op::Sub, [U32(a), U32(b)]) => U32(a.wrapping_sub(*b)),
            (Op::Sub, [F32(a), F32(b)]) => Lit::f32(float(*a) - float(*b)),
            (Op::Mul, [I32(a), I32(b)]) => I32(a.wrapping_mul(*b)),
            (Op::Mul, [U32(a), U32(b)]) => U32(a.wrapping_mul(*b)),
            (Op::Mul, [F32(a), F32(b)]) => Lit::f32(float(*a) * float(*b)),
            (Op::Div, [I32(a), I32(b)]) => I32(if *b == 0 { 0 } else { a.wrapping_div(*b) }),
            (Op::Div, [U32(a), U32(b)]) => U32(a.checked_div(*b).unwrap_or(0)),
            (Op::Div, [F32(a), F32(b)]) => Lit::f32(float(*a) / float(*b)),
            (Op::Rem, [I32(a), I32(b)]) => I32(if *b == 0 { 0 } else { a.wrapping_rem(*b) }),
            (Op::Rem, [U32(a), U32(b)]) => U32(a.checked_rem(*b).unwrap_or(0)),
            (Op::Min, [a, b]) => {
                if Op::Lt.eval(&[*a, *b]) == Bool(true) {
                    *a
                } else {
                    *b
                }
            }
            (Op::Max, [a, b]) => {
                if Op::Gt.eval(&[*a, *b]) == Bool(true) {
                    *a
                } else {
                    *b
                }
            }
            (Op::Neg, [I32(a)]) => I32(a.wrapping_neg()),
            (Op::Neg, [F32(a)]) => Lit::f32(-float(*a)),
            (Op::Abs, [I32(a)]) => I32(a.wrapping_abs()),
            (Op::Abs, [F32(a)]) => Lit::f32(float(*a).abs()),
            (Op::Fma, [F32(a), F32(b), F32(c)]) => Lit::f32(float(*a).mul_add(float(*b), float(*c))),
            (Op::Absorb, [F32(a), F32(b)]) => {
                let (a, b) = (float(*a), float(*b));
                Lit::f32(if a == 0.0 || b == 0.0 { 0.0 } else { a * b })
            }
            (Op::Sqrt, [F32(a)]) => Lit::f32(float(*a).sqrt()),
            (Op::Floor, [F32(a)]) => Lit::f32(float(*a).floor()),
            (Op::Ceil, [F32(a)]) => Lit::f32(float(*a).ceil()),
            (Op::Trunc, [F32(a)]) => Lit::f32(float(*a).trunc()),
            (Op::Round, [F32(a)]) => Lit::f32(float(*a).round_ties_even()),
            (Op::And, [Bool(a), Bool(b)]) => Bool(a & b),
            (Op::And, [I32(a), I32(b)]) => I32(a & b),
            (Op::And, [U32(a), U32(b)]) => U32(a & b),
            (Op::Or, [Bool(a), Bool(b)]) => Bool(a | b),
            (Op::Or, [I32(a), I32(b)]) => I32(a | b),
            (Op::Or, [U32(a), U32(b)]) => U32(a | b),
            (Op::Xor, [Bool(a), Bool(b)]) => Bool(a ^ b),
            (Op::Xor, [I32(a), I32(b)]) => I32(a ^ b),
            (Op::Xor, [U32(a), U32(b)]) => U32(a ^ b),
            (Op::Not, [Bool(a)]) => Bool(!a),
            (Op::Not, [I32(a)]) => I32(!a),
            (Op::Not, [U32(a)]) => U32(!a),
            (Op::Shl, [I32(a), U32(b)]) => I32(a.wrapping_shl(*b)),
            (Op::Shl, [U32(a), U32(b)]) => U32(a.wrapping_shl(*b)),
            (Op::Shr, [I32(a), U32(b)]) => I32(a.wrapping_shr(*b)),
            (Op::Shr, [U32(a), U32(b)]) => U32(a.wrapping_shr(*b)),
            (Op::Eq, [F32(a), F32(b)]) => Bool(float(*a) == float(*b)),
            (Op::Eq, [a, b]) => Bool(a == b),
            (Op::Ne, [a, b]) => Op::Not.eval(&[Op::Eq.eval(&[*a, *b])]),
            (Op::Lt, [I32(a), I32(b)]) => Bool(a < b),
            (Op::Lt, [U32(a), U32(b)]) => Bool(a < b),
            (Op::Lt, [F32(a), F32(b)]) => Bool(float(*a) < float(*b)),
            (Op::Le, [I32(a), I32(b)]) => Bool(a <= b),
            (Op::Le, [U32(a), U32(b)]) => Bool(a <= b),
            (Op::Le, [F32(a), F32(b)]) => Bool(float(*a) <= float(*b)),
            (Op::Gt, [a, b]) => Op::Lt.eval(&[*b, *a]),
            (Op::Ge, [a, b]) => Op::Le.eval(&[*b, *a]),
            (Op::Select, [Bool(c), a, b]) => {
                if *c {
                    *a
                } else {
                    *b
                }
            }
            (Op::ToF32, [I32(a)]) => Lit::f32(*a as f32),
            (Op::ToF32, [U32(a)]) => Lit::f32(*a as f32),
            // Rust's `as` saturates and sends NaN to 0.
            (Op::ToI32, [F32(a)]) => I32(float(*a) as i32),
            (Op::ToU32, [F32(a)]) => U32(float(*a) as u32),
            (Op::Bits, [a]) => U32(a.word()),
            (Op::FloatOfBits, [U32(a)]) => Lit::f32(float(*a)),
            (Op::IntOfBits, [U32(a)]) => I32(*a as i32),
            (Op::Any, lanes) => Bool(lanes.contains(&Bool(true))),
            (Op::All, lanes) => Bool(lanes.iter().all(|l| *l == Bool(true))),
            (Op::Ballot, lanes) => U32(lanes.iter().rev().fold(0, |bits, l| bits << 1 | l.word())),
            // No wildcard over `Op`: a new operation must state its meaning above.
            (
                Op::Add
                | Op::Sub
                | Op::Mul
                | Op::Div
                | Op::Rem
                | Op::Min
                | Op::Max
                | Op::Neg
                | Op::Abs
                | Op::Fma
                | Op::Absorb
                | Op::Sqrt
                | Op::Floor
                | Op::Ceil
                | Op::Trunc
                | Op::Round
                | Op::And
                | Op::Or
                | Op::Xor
                | Op::Not
                | Op::Shl
                | Op::Shr
                | Op::Eq
                | Op::Ne
                | Op::Lt
                | Op::Le
                | Op::Gt
                | Op::Ge
                | Op::Select
                | Op::ToF32
                | Op::ToI32
                | Op::ToU32
                | Op::Bits
                | Op::FloatOfBits
                | Op::IntOfBits,
                _,
            ) => panic!("{} does not take {args:?}", self.name()),
        }
    }
}
