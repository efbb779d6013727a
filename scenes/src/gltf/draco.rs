//! KHR_draco_mesh_compression: what a primitive's accessors say is described only, and the values are in a Draco stream.

use super::Loader;
use super::json::Json;
use super::schema::{ComponentType, GenericComponentType, IndexComponentType, Mode};
use crate::Error;
use draco_core::{DecodeLimits, DecoderBuffer, FaceIndex, MeshDecoder};
use std::rc::Rc;

impl<'a> Loader<'a> {
    /// Decodes the stream of a primitive, if it has one. Its accessors then find their bytes among the decoded.
    pub fn decompress(&mut self, primitive: &Json<'a>, mode: Mode) -> Result<(), Error> {
        let Some(ext) = primitive.extension("KHR_draco_mesh_compression")? else {
            return Ok(());
        };
        if mode != Mode::Triangles {
            return Err(ext.fault("only plain triangles are read from Draco streams"));
        }
        let (bytes, start, length, _) = self.view(&ext.need("bufferView")?)?;
        self.spend(&ext, length, 1)?;
        let limits = DecodeLimits::default()
            .with_max_faces(self.geometry_left / 12)
            .with_max_points(self.geometry_left / 12)
            .with_max_decoded_bytes(self.geometry_left);
        let mut stream = DecoderBuffer::new(&bytes[start..start + length]).with_limits(limits);
        let mut mesh = draco_core::Mesh::new();
        let decoded = MeshDecoder::new().decode(&mut stream, &mut mesh);
        decoded.map_err(|e| ext.fault(format!("the Draco stream cannot be decoded ({e})")))?;
        self.spend(&ext, mesh.num_faces(), 12)?;

        let (index, at) = primitive.need("indices")?.refer(&self.root, "accessors", "accessors")?;
        let IndexComponentType(component) = at.need("componentType")?.word()?;
        let faces = (0..mesh.num_faces()).map(|i| mesh.face(FaceIndex(i as u32)));
        let corners = faces.flatten().flat_map(|corner| number(f64::from(corner.0), component));
        self.decoded.insert(index, Rc::new(corners.collect::<Vec<u8>>().into()));

        let (attributes, ids) = (primitive.need("attributes")?, ext.need("attributes")?);
        for name in ids.value.as_object().into_iter().flat_map(|ids| ids.keys()) {
            let id = ids.need(name)?;
            let attribute = u32::try_from(id.integer()?).ok().and_then(|id| mesh.attribute_by_unique_id(id));
            let attribute = attribute.ok_or_else(|| id.fault("the Draco stream has no such attribute"))?;
            let (index, at) = attributes.need(name)?.refer(&self.root, "accessors", "accessors")?;
            let GenericComponentType(component) = at.need("componentType")?.word()?;
            let width = usize::from(attribute.num_components());
            self.spend(&id, mesh.num_points(), 4 * width)?;
            let values = attribute.read_f32s(mesh.num_points(), width);
            let bytes = values.into_iter().flat_map(|x| number(f64::from(x), component));
            self.decoded.insert(index, Rc::new(bytes.collect::<Vec<u8>>().into()));
        }
        Ok(())
    }
}

/// The bytes of a number. Integers that do not fit are the largest or the smallest that do.
fn number(x: f64, component: ComponentType) -> impl Iterator<Item = u8> {
    let (bytes, size) = match component {
        ComponentType::I8 => ((x as i8).to_le_bytes()[0].into(), 1),
        ComponentType::U8 => (u32::from(x as u8), 1),
        ComponentType::I16 => (u16::from_le_bytes((x as i16).to_le_bytes()).into(), 2),
        ComponentType::U16 => (u32::from(x as u16), 2),
        ComponentType::U32 => (x as u32, 4),
        ComponentType::F32 => ((x as f32).to_bits(), 4),
    };
    bytes.to_le_bytes().into_iter().take(size)
}
