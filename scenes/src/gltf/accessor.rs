//! Accessors: typed arrays in buffers, every offset and count checked in 64 bits before a byte is read.

use super::Loader;
use super::buffer::Bytes;
use super::json::Json;
use super::schema::{ComponentType, ElementType, GenericComponentType, IndexComponentType};
use crate::Error;

/// The number at the start of `b`, which holds at least one of `component`. `normalized` integers become fractions
/// (glTF 2.0, section 3.11).
fn float(component: ComponentType, b: &[u8], normalized: bool) -> f32 {
    let (value, unit) = match component {
        ComponentType::I8 => (f32::from(b[0] as i8), 127.0),
        ComponentType::U8 => (f32::from(b[0]), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
        ComponentType::U32 => (u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, 4294967295.0),
        ComponentType::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
    };
    if normalized { (value / unit).max(-1.0) } else { value }
}

/// The unsigned integer at the start of `b`.
fn index(component: ComponentType, b: &[u8]) -> u32 {
    match component {
        ComponentType::U8 => u32::from(b[0]),
        ComponentType::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
        _ => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
    }
}

/// An accessor whose description is consistent and whose bytes are all there.
pub(super) struct Accessor<'a> {
    pub at: Json<'a>,
    pub count: usize,
    pub component: ComponentType,
    /// Components of an element: 1 for SCALAR, 16 for MAT4. (The padding in matrices of integers, which glTF has no use for, is
    /// not told apart.)
    pub width: usize,
    pub normalized: bool,
    /// `None`: all zero.
    dense: Option<Elements<'a>>,
    sparse: Option<Sparse<'a>>,
}

/// Equally spaced elements in a buffer.
struct Elements<'a> {
    bytes: Bytes<'a>,
    start: usize,
    stride: usize,
}

impl Elements<'_> {
    fn at(&self, i: usize) -> &[u8] {
        &self.bytes[self.start + i * self.stride..]
    }
}

/// Elements that replace some of an accessor's.
struct Sparse<'a> {
    indices: Vec<u32>,
    values: Elements<'a>,
}

impl<'a> Loader<'a> {
    /// The accessor that the index at `reference` points to.
    pub fn accessor(&mut self, reference: &Json<'a>) -> Result<Accessor<'a>, Error> {
        let (index, at) = reference.refer(&self.root, "accessors", "accessors")?;
        let count = at.need("count")?.integer()?;
        if count == 0 {
            return Err(at.need("count")?.fault("0 elements; at least 1 is required"));
        }
        let width = at.need("type")?.word::<ElementType>()?.multiplicity();
        let GenericComponentType(component) = at.need("componentType")?.word()?;
        let size = width * component.size();
        let dense = match (self.decoded.get(&index), at.get("bufferView")) {
            (Some(bytes), _) if (bytes.len() as u64) < count.saturating_mul(size as u64) => {
                return Err(at.fault(format!("{count} elements, but {} bytes in the Draco stream", bytes.len())));
            }
            (Some(bytes), _) => Some(Elements { bytes: bytes.clone(), start: 0, stride: size }),
            (None, Some(_)) => Some(self.elements(&at, count, size, true)?),
            (None, None) if count > self.limits.zero_elements => {
                let limit = format!("{} (zero_elements)", self.limits.zero_elements);
                return Err(at.limit_fault(format!("{count} elements without a bufferView"), limit));
            }
            (None, None) => None,
        };
        let sparse = at.get("sparse").map(|s| self.sparse(&s, count, size)).transpose()?;
        let normalized = at.flag("normalized")?;
        Ok(Accessor { count: count as usize, component, width, normalized, dense, sparse, at })
    }

    fn sparse(&mut self, at: &Json<'a>, count: u64, size: usize) -> Result<Sparse<'a>, Error> {
        let number = at.need("count")?.integer()?;
        if number == 0 || number > count {
            return Err(at.need("count")?.fault(format!("{number} replacements for {count} elements")));
        }
        let place = at.need("indices")?;
        let IndexComponentType(component) = place.need("componentType")?.word()?;
        let elements = self.elements(&place, number, component.size(), false)?;
        let indices: Vec<u32> = (0..number as usize).map(|i| index(component, elements.at(i))).collect();
        if let Some(pair) = indices.windows(2).find(|w| w[0] >= w[1]) {
            return Err(place.fault(format!("index {} follows {}; they must increase", pair[1], pair[0])));
        }
        if let Some(&last) = indices.last().filter(|&&i| u64::from(i) >= count) {
            return Err(place.index_fault(last.into(), format!("{count} elements")));
        }
        Ok(Sparse { indices, values: self.elements(&at.need("values")?, number, size, false)? })
    }

    /// `count` elements of `size` bytes in the buffer view that the object at `at` names, from its byteOffset on.
    fn elements(&mut self, at: &Json<'a>, count: u64, size: usize, strided: bool) -> Result<Elements<'a>, Error> {
        let (bytes, start, length, view) = self.view(&at.need("bufferView")?)?;
        let stride = match view.get("byteStride").filter(|_| strided) {
            None => size as u64,
            Some(stride) => match stride.integer()? {
                s if s < size as u64 => {
                    return Err(stride.fault(format!("{s} bytes for elements of {size}")));
                }
                s => s,
            },
        };
        let offset = at.integer_or("byteOffset", 0)?;
        // count ≥ 1: the last element need not fill its stride.
        let end = (count - 1)
            .checked_mul(stride)
            .and_then(|n| n.checked_add(offset))
            .and_then(|n| n.checked_add(size as u64));
        if end.is_none_or(|end| end > length as u64) {
            let reason =
                format!("{count} elements of {size} bytes from byte {offset}, stride {stride}, in a view of {length}");
            return Err(at.fault(reason));
        }
        Ok(Elements { bytes, start: start + offset as usize, stride: stride as usize })
    }

    /// All elements as vectors of `N` floats; missing components (an RGB of RGBA) are `fill`.
    pub fn floats<const N: usize>(&mut self, accessor: &Accessor<'a>, fill: f32) -> Result<Vec<[f32; N]>, Error> {
        self.spend(&accessor.at, accessor.count, 4 * N)?;
        let Accessor { component, width, normalized, .. } = *accessor;
        let size = component.size();
        let element = |b: &[u8]| -> [f32; N] {
            std::array::from_fn(|c| if c < width { float(component, &b[c * size..], normalized) } else { fill })
        };
        let mut floats = match &accessor.dense {
            Some(dense) => (0..accessor.count).map(|i| element(dense.at(i))).collect(),
            None => vec![element(&[0; 64]); accessor.count],
        };
        if let Some(sparse) = &accessor.sparse {
            for (k, &i) in sparse.indices.iter().enumerate() {
                floats[i as usize] = element(sparse.values.at(k));
            }
        }
        Ok(floats)
    }

    /// All elements as vertex indices below `vertices`.
    pub fn indices(&mut self, accessor: &Accessor<'a>, vertices: usize) -> Result<Vec<u32>, Error> {
        if accessor.width != 1 {
            return Err(accessor.at.need("type")?.fault("indices must be SCALAR"));
        }
        let IndexComponentType(component) = accessor.at.need("componentType")?.word()?;
        self.spend(&accessor.at, accessor.count, 4)?;
        let mut indices = match &accessor.dense {
            Some(dense) => (0..accessor.count).map(|i| index(component, dense.at(i))).collect(),
            None => vec![0; accessor.count],
        };
        if let Some(sparse) = &accessor.sparse {
            for (k, &i) in sparse.indices.iter().enumerate() {
                indices[i as usize] = index(component, sparse.values.at(k));
            }
        }
        match indices.iter().find(|&&i| i as usize >= vertices) {
            Some(&i) => Err(accessor.at.index_fault(i.into(), format!("{vertices} vertices"))),
            None => Ok(indices),
        }
    }
}
