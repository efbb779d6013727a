//! Tables of shapes: triangles for shading and for intersection, attributes of vertices, and the tree of boxes.

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
    /// Inner nodes of the BVH: the boxes of both children and where they are. See `host::bvh` for the encoding of a child.
    pub Nodes {
        /// Lower corner of child 0.
        LO0_X: F32, bulk;
        /// See [`Nodes::LO0_X`].
        LO0_Y: F32, bulk;
        /// See [`Nodes::LO0_X`].
        LO0_Z: F32, bulk;
        /// Upper corner of child 0.
        HI0_X: F32, bulk;
        /// See [`Nodes::HI0_X`].
        HI0_Y: F32, bulk;
        /// See [`Nodes::HI0_X`].
        HI0_Z: F32, bulk;
        /// Lower corner of child 1.
        LO1_X: F32, bulk;
        /// See [`Nodes::LO1_X`].
        LO1_Y: F32, bulk;
        /// See [`Nodes::LO1_X`].
        LO1_Z: F32, bulk;
        /// Upper corner of child 1.
        HI1_X: F32, bulk;
        /// See [`Nodes::HI1_X`].
        HI1_Y: F32, bulk;
        /// See [`Nodes::HI1_X`].
        HI1_Z: F32, bulk;
        /// Child 0.
        CHILD0: U32, bulk;
        /// Child 1.
        CHILD1: U32, bulk;
        /// Unused: keeps a node at 64 bytes.
        PAD0: U32, bulk;
        /// Unused.
        PAD1: U32, bulk;
    }
}

table! {
    /// Triangles in the order of the BVH's leaves, for intersection.
    pub Triangles {
        /// First corner.
        P0_X: F32, bulk;
        /// See [`Triangles::P0_X`].
        P0_Y: F32, bulk;
        /// See [`Triangles::P0_X`].
        P0_Z: F32, bulk;
        /// Second corner.
        P1_X: F32, bulk;
        /// See [`Triangles::P1_X`].
        P1_Y: F32, bulk;
        /// See [`Triangles::P1_X`].
        P1_Z: F32, bulk;
        /// Third corner.
        P2_X: F32, bulk;
        /// See [`Triangles::P2_X`].
        P2_Y: F32, bulk;
        /// See [`Triangles::P2_X`].
        P2_Z: F32, bulk;
        /// Number of the primitive, a row of [`Primitives`].
        PRIMITIVE: U32, bulk;
    }
}
