//! Tables of shapes: triangles for shading, attributes of vertices, and the tree of boxes with triangles for intersection.

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
    /// Primitives: triangles by number, for shading. Corner positions are world coordinates relative to the scene's origin.
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
        /// Unit normal of the plane, world, on the side where the corners run counter-clockwise.
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
    /// The tree of boxes with the triangles in its leaves, for intersection: see `host::bvh` for what its words are.
    pub Tree {
        /// The bits of a coordinate, a reference, or the number of a primitive.
        WORD: U32, bulk;
    }
}
