//! Borders: what coordinates outside of the image mean, along one axis. One file per kind.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Fun, I32, U32};

use crate::schema::{WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT};

pub mod clamp;
pub mod constant;
pub mod mirror;
pub mod repeat;

/// What coordinates outside of the image mean, along one axis.
#[derive(Clone, Copy)]
pub struct BorderHandling {
    /// Coordinate → the same place in [0, 1], both ends included; 0 for NaN. With a border it is in [−2, 3], −2 for NaN, and
    /// outside of the image if the coordinate is.
    pub fold: Fun<F32, F32>,
    /// (index from −1 to size, size) → index from 0 to size − 1 of the texel that continues the image there.
    pub index: Fun<(I32, I32), I32>,
    /// The same for what reaches two texels far: nothing changes any more beyond −2 and 3, or it is folded to [0, 1].
    pub far_fold: Fun<F32, F32>,
    /// (any index that `far_fold` leads to, size) → index from 0 to size − 1, or as it is.
    pub far_index: Fun<(I32, I32), I32>,
    /// Does the image not go on outside? Then an index stands for itself.
    pub is_border: Bool,
}
impl_staged!(BorderHandling { fold, index, far_fold, far_index, is_border });

impl BorderHandling {
    /// The index of the nearest texel, or of the border.
    pub fn nearest(self, i: I32, size: I32) -> I32 {
        self.is_border.select(i, within(i, size))
    }
}

/// Border handling by its code, one of `WRAP_*`.
pub fn make_border(wrap: U32) -> BorderHandling {
    let is_border = constant::is_chosen(wrap);
    let nearest = move |i: I32, size: I32| is_border.select(i, within(i, size));
    BorderHandling {
        fold: Fun::lam(|b, x: F32| {
            let mirror_or_border = |b: &mut Block| b.if_(is_border, |_| clamp_far(x), |_| mirror::fold(x));
            let not_repeat = |b: &mut Block| b.if_(wrap.eq(WRAP_CLAMP), |_| clamp::fold(x), mirror_or_border);
            b.if_(wrap.eq(WRAP_REPEAT), |_| repeat::fold(x), not_repeat)
        }),
        index: Fun::lam(|b, (i, size): (I32, I32)| {
            b.if_(wrap.eq(WRAP_REPEAT), |_| repeat::index(i, size), |_| nearest(i, size))
        }),
        far_fold: Fun::lam(|b, x: F32| {
            let mirror_or_not = |b: &mut Block| b.if_(wrap.eq(WRAP_MIRROR), |_| mirror::fold(x), |_| clamp_far(x));
            b.if_(wrap.eq(WRAP_REPEAT), |_| repeat::fold(x), mirror_or_not)
        }),
        far_index: Fun::lam(|b, (i, size): (I32, I32)| {
            let mirrored = wrap.eq(WRAP_MIRROR).select(mirror::index(i, size), i);
            // The ring of one texel goes round twice.
            let twice = |_: &mut Block| repeat::index(repeat::index(i, size), size);
            b.if_(wrap.eq(WRAP_REPEAT), twice, |_| nearest(mirrored, size))
        }),
        is_border,
    }
}

/// To two texels beyond an image of one texel, in which a filter as wide as four texels sees nothing of the image.
fn clamp_far(x: F32) -> F32 {
    x.max(-2.0).min(3.0)
}

/// The index in [0, size) nearest to i.
fn within(i: I32, size: I32) -> I32 {
    i.max(0).min(size - 1)
}

/// Is an index before the first of so many, or behind the last?
fn beyond(i: I32, size: I32) -> (Bool, Bool) {
    (i.lt(0), i.ge(size))
}
