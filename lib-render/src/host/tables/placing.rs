//! How an instance that shares its triangles stands in the world: from the frame of its mesh to the world and back.
//!
//! The matrix is rounded to f32 once, and everybody's world is what that matrix makes of the frame. With ε = 2^-24 and κ, the
//! largest row of |M| |M⁻¹|, a corner is off by 3εκ of its distance from where zero comes to: three products and their sum. A
//! ray's way into the frame rounds a difference, the entries of the inverse, and again products and sums: 5εκ of that distance.

use glam::{DAffine3, DMat3, DVec3};
use jerboa_ir::lang::{Col, F32};

use super::memory::RowMut;
use crate::host::bvh::Bounds;
use crate::schema::Instances;

/// Largest κ. Rotations and what they make of scaled meshes have at most 3; 8 is what boxes in scenes with instances grow for
/// (`traverse::instance`).
const MOST_CONDITION: f64 = 8.0;
/// ε.
const ROUNDING: f64 = 1.0 / 16_777_216.0;
/// Roundings there and back, over εκ: the 3 and 5 above.
const THERE_AND_BACK: f64 = 8.0;

/// Columns of a vector.
type Columns = [Col<Instances, F32>; 3];

/// How an instance stands in the world.
#[derive(Clone, Debug)]
pub struct Placing {
    /// Where the axes of the frame come to.
    axes: [[f32; 3]; 3],
    /// Where zero comes to.
    pub zero: [f32; 3],
    /// Rows of the matrix that takes rays to the frame.
    pub to_frame: [[f32; 3]; 3],
    /// Where the axes come to as normals.
    normals: [[f32; 3]; 3],
    is_mirrored: bool,
    /// See [`Instances::ROUNDING`] and [`Instances::ROUNDING_AT`].
    rounding: [f32; 2],
}

impl Placing {
    /// From a frame to the world; none if too much would be lost on the way.
    pub fn new(to_world: DAffine3) -> Option<Placing> {
        let axes = to_world.matrix3.to_cols_array_2d().map(|axis| axis.map(|x| x as f32));
        let zero = to_world.translation.as_vec3().to_array();
        let matrix = DMat3::from_cols_array_2d(&axes.map(|axis| axis.map(f64::from)));
        let (inverse, determinant) = (matrix.inverse(), matrix.determinant());
        let to_frame = inverse.transpose().to_cols_array_2d().map(|row| row.map(|x| x as f32));
        let cofactors = inverse.transpose() * determinant;
        let length = cofactors.to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let normals = (cofactors * (determinant.signum() / length)).to_cols_array_2d();
        let condition = condition(&matrix, &inverse);
        // Not where it is NaN, as for a matrix that has become singular.
        let is_sound =
            condition <= MOST_CONDITION && [axes, to_frame].iter().flatten().flatten().all(|x| x.is_finite());
        let is_exact = zero == [0.0; 3] && is_exact(&axes);
        let rounding = [ROUNDING * THERE_AND_BACK * condition, ROUNDING];
        (is_sound && zero.iter().all(|x| x.is_finite())).then(|| Placing {
            axes,
            zero,
            to_frame,
            normals: normals.map(|axis| axis.map(|x| x as f32)),
            is_mirrored: determinant < 0.0,
            rounding: rounding.map(|x| if is_exact { 0.0 } else { x as f32 }),
        })
    }

    /// Bounds in the world of what lies in these boxes of the frame; as they are in f32 or larger.
    pub fn bounds(&self, parts: &[Bounds]) -> Bounds {
        let [x, y, z] = self.axes.map(|axis| DVec3::from(axis.map(f64::from)));
        let zero = DVec3::from(self.zero.map(f64::from));
        let corners = parts.iter().flat_map(|part| {
            (0..8).map(move |corner| {
                let p = [0, 1, 2].map(|k| f64::from(if corner >> k & 1 == 0 { part.lo[k] } else { part.hi[k] }));
                x * p[0] + y * p[1] + z * p[2] + zero
            })
        });
        corners.fold(Bounds::EMPTY, |all, p| {
            let p = p.to_array();
            all.union(&Bounds { lo: p.map(|x| rounded(x, f32::next_down)), hi: p.map(|x| rounded(x, f32::next_up)) })
        })
    }

    /// Set the columns that say so.
    pub fn set(&self, row: &mut RowMut<Instances>) {
        use Instances as I;
        let columns: [(Columns, [f32; 3]); 7] = [
            ([I::AXIS_X_X, I::AXIS_X_Y, I::AXIS_X_Z], self.axes[0]),
            ([I::AXIS_Y_X, I::AXIS_Y_Y, I::AXIS_Y_Z], self.axes[1]),
            ([I::AXIS_Z_X, I::AXIS_Z_Y, I::AXIS_Z_Z], self.axes[2]),
            ([I::NORMAL_X_X, I::NORMAL_X_Y, I::NORMAL_X_Z], self.normals[0]),
            ([I::NORMAL_Y_X, I::NORMAL_Y_Y, I::NORMAL_Y_Z], self.normals[1]),
            ([I::NORMAL_Z_X, I::NORMAL_Z_Y, I::NORMAL_Z_Z], self.normals[2]),
            ([I::ZERO_X, I::ZERO_Y, I::ZERO_Z], self.zero),
        ];
        columns.into_iter().for_each(|(columns, x)| _ = row.set_all(columns, x));
        row.set_all([I::ROUNDING, I::ROUNDING_AT], self.rounding);
        row.set(I::IS_PLACED, true).set(I::IS_MIRRORED, self.is_mirrored);
    }
}

/// The largest row of |M| |M⁻¹|: how much larger an error in the frame is in the world than it would be there.
fn condition(matrix: &DMat3, inverse: &DMat3) -> f64 {
    let abs = |m: &DMat3| DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
    (abs(matrix) * abs(inverse) * DVec3::ONE).max_element()
}

/// Does the matrix only exchange, mirror and scale axes, by powers of two? Then it rounds nothing.
fn is_exact(axes: &[[f32; 3]; 3]) -> bool {
    let is_power_of_two = |x: f32| x.to_bits() & 0x007f_ffff == 0 && x.is_normal();
    axes.iter().all(|axis| axis.iter().filter(|x| **x != 0.0).count() == 1)
        && axes.iter().flatten().all(|x| *x == 0.0 || is_power_of_two(*x))
}

/// Rounded to f32, outwards if that is not exact.
fn rounded(x: f64, outwards: fn(f32) -> f32) -> f32 {
    let near = x as f32;
    let out = outwards(near);
    if f64::from(near) == x || (f64::from(near) < x) == (out < near) { near } else { out }
}
