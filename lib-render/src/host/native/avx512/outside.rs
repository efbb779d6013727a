//! Rays that pass by: sixteen at once beside some boxes.

use std::arch::x86_64::*;

use super::super::Rays;
use super::sixteen::{Lines, Sixteen};
use super::vector::floats_16;
use crate::host::bvh::Bounds;

/// Hands in, with what they hit so far, the rays that enter none of the boxes before they end, in a scene of this box. A
/// larger box is entered no later: so they hit nothing that lies in one.
#[target_feature(enable = "avx512f,avx512dq")]
pub(super) fn outside(scene: &Bounds, boxes: &[Bounds], sixteen: &mut Sixteen, rays: &mut impl Rays) {
    loop {
        sixteen.take(rays);
        if sixteen.count == 0 {
            return;
        }
        let lines = Lines::new(scene, sixteen);
        let mut inside = 0;
        for Bounds { lo, hi } in boxes {
            let (entry, enters) = lines.enters(*lo, *hi);
            inside |= _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(enters, entry, floats_16(&sixteen.tmax));
        }
        sixteen.hand_in(rays, !(inside & lines.are_usable));
    }
}
