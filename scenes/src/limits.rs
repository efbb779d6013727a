//! How large a scene may be: what bounds memory and time whatever a file claims.

/// Sizes above which loading ends in [`Error::Limit`](crate::Error::Limit), checked before anything is allocated.
/// The defaults leave room for scenes of tens of millions of triangles.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Bytes of any one file, or of one `data:` URI.
    pub file_bytes: u64,
    /// Values in the JSON text (it is parsed to a tree of about 100 bytes each).
    pub json_values: u64,
    /// Depth of the node tree.
    pub node_depth: usize,
    /// Instances of meshes.
    pub instances: usize,
    /// Triangles in the world, counted with their instances: a few nodes can repeat a large mesh without end.
    pub triangles: u64,
    /// Light sources: punctual lights, and emissive triangles in the world. They are told apart by random numbers of 24 bits,
    /// so a renderer has no use for more than the default.
    pub lights: u64,
    /// Bytes of all vertex attributes and triangles together, decoded.
    pub geometry_bytes: u64,
    /// Elements of an accessor without a buffer view, which a few bytes of JSON can make as long as they like.
    pub zero_elements: u64,
    /// Texels along either side of an image.
    pub image_side: u32,
    /// Bytes of one image, decoded (4 per texel; 12 for an environment).
    pub image_bytes: u64,
    /// Bytes of all images together, decoded.
    pub images_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            file_bytes: 2 << 30,
            json_values: 8 << 20,
            node_depth: 1024,
            instances: 1 << 24,
            triangles: 1 << 26,
            lights: (1 << 24) - 1,
            geometry_bytes: 4 << 30,
            zero_elements: 1 << 22,
            image_side: 16384,
            image_bytes: 256 << 20,
            images_bytes: 2 << 30,
        }
    }
}
