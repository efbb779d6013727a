//! Axis-aligned boxes.

/// An axis-aligned box in world space, exactly as the f32 coordinates it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub lo: [f32; 3],
    /// Largest coordinates.
    pub hi: [f32; 3],
}

impl Bounds {
    /// The box of nothing: no ray hits it, and it changes no union.
    pub const EMPTY: Bounds = Bounds { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    /// The smallest box around `points`.
    pub fn of(points: &[[f32; 3]]) -> Bounds {
        points.iter().fold(Bounds::EMPTY, |all, p| all.union(&Bounds { lo: *p, hi: *p }))
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Bounds) -> Bounds {
        Bounds {
            lo: [0, 1, 2].map(|k| self.lo[k].min(other.lo[k])),
            hi: [0, 1, 2].map(|k| self.hi[k].max(other.hi[k])),
        }
    }

    /// Side lengths; negative infinity for the empty box. In f64 they never overflow.
    pub fn extent(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| f64::from(self.hi[k]) - f64::from(self.lo[k]))
    }

    /// Twice the centre, which orders boxes as the centre does.
    pub(super) fn doubled_centre(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| f64::from(self.hi[k]) + f64::from(self.lo[k]))
    }

    /// Half the surface, in proportion to how many rays hit the box. In f64 it never overflows or vanishes.
    pub(in crate::host) fn half_area(&self) -> f64 {
        let [x, y, z] = self.extent();
        x * y + y * z + z * x
    }
}
