//! Tables of shapes: triangles for shading, attributes of vertices, instances that share them, and the tree of boxes with
//! triangles for intersection.

use jerboa_ir::table;

use super::Materials;

table! {
    /// Geometries: what the triangles of one instance of a mesh have in common.
    pub classed Geometries {
        /// Vertices have normals.
        HAS_NORMALS: Bool, structure;
        /// Vertices have a first set of texture coordinates.
        HAS_UV0: Bool, structure;
        /// Vertices have a second set.
        HAS_UV1: Bool, structure;
        /// Vertices have tangents.
        HAS_TANGENTS: Bool, structure;
        /// Vertices have colours.
        HAS_COLORS: Bool, structure;
        /// Its material.
        MATERIAL: ref Materials, structure;
    }
}

table! {
    /// Primitives: triangles, for shading. Corner positions are world coordinates relative to the scene's origin, or those of
    /// the frame that [`Instances`] share. The row of a triangle is its number, but for scenes with instances.
    pub Primitives {
        /// First corner, a row of [`Vertices`] and its attributes.
        I0: U32, bulk;
        /// Second corner.
        I1: U32, bulk;
        /// Third corner.
        I2: U32, bulk;
        /// Row of [`Geometries`].
        GEOMETRY: U32, bulk;
        /// Row of [`Lights`], or `NONE`.
        LIGHT: U32, bulk;
        /// Unit normal of the plane, in the frame of the corners, on the side where they run counter-clockwise.
        NORMAL_X: F32, bulk;
        /// See [`Primitives::NORMAL_X`].
        NORMAL_Y: F32, bulk;
        /// See [`Primitives::NORMAL_X`].
        NORMAL_Z: F32, bulk;
        /// Largest difference of a coordinate between the first corner and another, m.
        SIZE: F32, bulk;
        /// How far off the plane a ray that starts on it may find it, m; see `host::tables::plane`.
        PLANE_ERROR: F32, bulk;
    }
}

table! {
    /// Positions, world.
    pub Vertices {
        /// x
        X: F32, bulk;
        /// y
        Y: F32, bulk;
        /// z
        Z: F32, bulk;
        /// Nothing: lanes load rows of four words at once.
        PADDING: F32, bulk;
    }
}

table! {
    /// Unit shading normals, world; one row per vertex where any geometry has normals.
    pub Normals {
        /// x
        X: F32, bulk;
        /// y
        Y: F32, bulk;
        /// z
        Z: F32, bulk;
        /// Nothing: lanes load rows of four words at once.
        PADDING: F32, bulk;
    }
}

table! {
    /// Texture coordinates, first set then second set.
    pub Uvs {
        /// u of set 0
        U0: F32, bulk;
        /// v of set 0
        V0: F32, bulk;
        /// u of set 1
        U1: F32, bulk;
        /// v of set 1
        V1: F32, bulk;
    }
}

table! {
    /// Tangents, world, and the sign of the bitangent.
    pub Tangents {
        /// x
        X: F32, bulk;
        /// y
        Y: F32, bulk;
        /// z
        Z: F32, bulk;
        /// +1 or −1: bitangent = sign · normal × tangent.
        SIGN: F32, bulk;
    }
}

table! {
    /// Colours of vertices, linear, and alpha: factors of the base colour.
    pub Colors {
        /// Red
        R: F32, bulk;
        /// Green
        G: F32, bulk;
        /// Blue
        B: F32, bulk;
        /// Alpha
        A: F32, bulk;
    }
}

table! {
    /// Runs of primitives by number, ascending, in scenes with instances: a triangle's number is what it would be if all
    /// instances were laid out in the world one after the other. A run is an instance whose triangles are shared with others,
    /// in a frame of its own, or all triangles in the world between two of those.
    pub Instances {
        /// Its first number.
        FIRST: U32, bulk;
        /// From a number to its row of [`Primitives`], modulo 2^32.
        TO_ROW: U32, bulk;
        /// Is it an instance?
        IS_PLACED: Bool, bulk;
        /// Does it mirror? Then its second and third corners change places.
        IS_MIRRORED: Bool, bulk;
        /// Where the first axis of the frame comes to, world; a column of the matrix.
        AXIS_X_X: F32, bulk;
        /// See [`Instances::AXIS_X_X`].
        AXIS_X_Y: F32, bulk;
        /// See [`Instances::AXIS_X_X`].
        AXIS_X_Z: F32, bulk;
        /// The second.
        AXIS_Y_X: F32, bulk;
        /// See [`Instances::AXIS_Y_X`].
        AXIS_Y_Y: F32, bulk;
        /// See [`Instances::AXIS_Y_X`].
        AXIS_Y_Z: F32, bulk;
        /// The third.
        AXIS_Z_X: F32, bulk;
        /// See [`Instances::AXIS_Z_X`].
        AXIS_Z_Y: F32, bulk;
        /// See [`Instances::AXIS_Z_X`].
        AXIS_Z_Z: F32, bulk;
        /// Where zero comes to, world.
        ZERO_X: F32, bulk;
        /// See [`Instances::ZERO_X`].
        ZERO_Y: F32, bulk;
        /// See [`Instances::ZERO_X`].
        ZERO_Z: F32, bulk;
        /// What its transform there and back rounds, over the distance from where zero comes to: see `host::tables::placing`.
        ROUNDING: F32, bulk;
        /// What takes normals to the world, up to their length: the cofactors of the matrix, over its length and its sign.
        NORMAL_X_X: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_X_Y: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_X_Z: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_Y_X: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_Y_Y: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_Y_Z: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_Z_X: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_Z_Y: F32, bulk;
        /// See [`Instances::NORMAL_X_X`].
        NORMAL_Z_Z: F32, bulk;
        /// What it rounds over the distance from zero of the world.
        ROUNDING_AT: F32, bulk;
        /// Nothing: lanes load rows of four words at once.
        PADDING: U32, bulk;
    }
}

table! {
    /// The tree of boxes with the triangles in its leaves, for intersection: see `host::bvh` for what its words are.
    pub Tree {
        /// The bits of a coordinate, a reference, or the number of a primitive.
        WORD: U32, bulk;
    }
}
