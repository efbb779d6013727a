//! Where a primitive lies: in the world, or in the frame of the instance that it is seen in (see [`Instances`]).

use jerboa_ir::lang::{Block, Bool, Col, F32, Row, U32};

use crate::core::cdf::last;
use crate::core::vec::{Vec3, vec3};
use crate::schema::{Instances, Primitives, Settings};

/// A matrix by its columns.
type Axes = [[Col<Instances, F32>; 3]; 3];

/// To the world.
const TO_WORLD: Axes = [
    [Instances::AXIS_X_X, Instances::AXIS_X_Y, Instances::AXIS_X_Z],
    [Instances::AXIS_Y_X, Instances::AXIS_Y_Y, Instances::AXIS_Y_Z],
    [Instances::AXIS_Z_X, Instances::AXIS_Z_Y, Instances::AXIS_Z_Z],
];
/// The same for normals.
const NORMALS_TO_WORLD: Axes = [
    [Instances::NORMAL_X_X, Instances::NORMAL_X_Y, Instances::NORMAL_X_Z],
    [Instances::NORMAL_Y_X, Instances::NORMAL_Y_Y, Instances::NORMAL_Y_Z],
    [Instances::NORMAL_Z_X, Instances::NORMAL_Z_Y, Instances::NORMAL_Z_Z],
];

/// Where a primitive lies.
#[derive(Clone, Copy)]
pub struct Place {
    /// Its row.
    pub row: Row<Primitives>,
    /// The run of numbers that it belongs to; without meaning in a scene without instances.
    run: Row<Instances>,
}

impl Place {
    /// That of the primitive of this number.
    pub fn of(b: &mut Block, number: U32) -> Place {
        let settings = Row::<Settings>::at(0u32);
        let search = |b: &mut Block| {
            let begins = |run: U32| Row::<Instances>::at(run).get(Instances::FIRST).le(number);
            let run = last(b, settings.get(Settings::INSTANCE_COUNT), begins);
            (number + Row::<Instances>::at(run).get(Instances::TO_ROW), run)
        };
        let (row, run) = b.if_(has_instances(), search, |_| (number, U32::from(0)));
        Place { row: Row::at(row), run: Row::at(run) }
    }

    /// Is it in the frame of an instance?
    pub fn is_placed(self) -> Bool {
        has_instances() & self.run.get(Instances::IS_PLACED)
    }

    /// Do its second and third corners change places?
    pub fn is_mirrored(self) -> Bool {
        has_instances() & self.run.get(Instances::IS_MIRRORED)
    }

    /// A corner in the world.
    pub fn point(self, p: Vec3) -> Vec3 {
        self.is_placed().select(self.transform(TO_WORLD, p) + self.zero(), p)
    }

    /// The unit normal of a corner in the world; zero stays zero.
    pub fn normal(self, n: Vec3) -> Vec3 {
        self.unit(NORMALS_TO_WORLD, n)
    }

    /// The unit tangent of a corner in the world; zero stays zero.
    pub fn tangent(self, t: Vec3) -> Vec3 {
        self.unit(TO_WORLD, t)
    }

    /// How far each coordinate in the world may be off if each in the frame may by this much.
    pub fn spread(self, error: F32) -> Vec3 {
        let [x, y, z] = self.axes(TO_WORLD).map(Vec3::abs);
        (x + y + z) * error
    }

    /// How far each coordinate of a point in the world may be off by what the transform there, and that of a ray back,
    /// have rounded.
    pub fn rounding(self, point: Vec3) -> F32 {
        let [there, here] = [point - self.zero(), point].map(|v| v.abs().max_element());
        there * self.run.get(Instances::ROUNDING) + here * self.run.get(Instances::ROUNDING_AT)
    }

    fn unit(self, matrix: Axes, v: Vec3) -> Vec3 {
        let turned = self.transform(matrix, v);
        let largest = turned.abs().max_element();
        let unit = largest.gt(0.0).select(turned.normalize_scaled(), turned);
        self.is_placed().select(unit, v)
    }

    fn transform(self, matrix: Axes, v: Vec3) -> Vec3 {
        let [x, y, z] = self.axes(matrix);
        x * v.x + y * v.y + z * v.z
    }

    fn axes(self, matrix: Axes) -> [Vec3; 3] {
        matrix.map(|axis| self.vector(axis))
    }

    fn zero(self) -> Vec3 {
        self.vector([Instances::ZERO_X, Instances::ZERO_Y, Instances::ZERO_Z])
    }

    fn vector(self, columns: [Col<Instances, F32>; 3]) -> Vec3 {
        let [x, y, z] = columns.map(|column| self.run.get(column));
        vec3(x, y, z)
    }
}

/// Do instances share triangles?
fn has_instances() -> Bool {
    Row::<Settings>::at(0u32).get(Settings::HAS_INSTANCES)
}
