//! Surfaces that are cut out (glTF's alpha mode MASK).

use jerboa_ir::lang::{Bool, F32, Row};

use crate::schema::Materials;

/// Is there a surface of this alpha? From the cutoff on.
pub fn masked_is_there(row: Row<Materials>, alpha: F32) -> Bool {
    alpha.ge(row.get(Materials::ALPHA_CUTOFF))
}
