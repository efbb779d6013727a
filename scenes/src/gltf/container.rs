//! The two wrappings of glTF (plain JSON, or GLB) taken off with every length checked, and the JSON parsed.

use crate::{Error, Limits};
use serde_json::Value;
use std::path::Path;

const GLB_HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// Splits a file into its JSON text and, for a GLB, its binary chunk.
pub(super) fn split<'a>(file: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), Error> {
    if !bytes.starts_with(b"glTF") {
        // A byte order mark is not JSON, but a reader may skip it (RFC 8259, section 8.1).
        return Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None));
    }
    let fault = |reason: String| Error::Container { file: file.into(), reason };
    let word = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(fault("the GLB header is cut off".into()));
    };
    if version != 2 {
        return Err(fault(format!("GLB version {version}, not 2")));
    }
    let end = length as usize;
    if end < GLB_HEADER || end > bytes.len() {
        return Err(fault(format!("the GLB header says {length} bytes, the file has {}", bytes.len())));
    }
    let (mut json, mut bin) = (None, None);
    let mut at = GLB_HEADER;
    while at + CHUNK_HEADER <= end {
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else {
            break;
        };
        let start = at + CHUNK_HEADER;
        let Some(chunk) = bytes[..end].get(start..).and_then(|rest| rest.get(..size as usize)) else {
            return Err(fault(format!("the GLB chunk at byte {at} says {size} bytes, {} are left", end - start)));
        };
        match &kind.to_le_bytes() {
            b"JSON" if at == GLB_HEADER => json = Some(chunk),
            b"BIN\0" if bin.is_none() => bin = Some(chunk),
            _ => {} // The specification: clients must ignore unknown chunks.
        }
        at = start + (size as usize).next_multiple_of(4);
    }
    let json = json.ok_or_else(|| fault("the first GLB chunk is not JSON".into()))?;
    Ok((json, bin))
}

/// Parses the JSON text, after a count of its values so that a tree is never built that memory does not hold. The parser
/// itself stops at 128 nested levels.
pub(super) fn parse(file: &Path, json: &[u8], limits: &Limits) -> Result<Value, Error> {
    // Every value but the first follows one of these bytes; those inside strings only make the count safer.
    let values = json.iter().filter(|b| matches!(b, b',' | b'[' | b'{')).count() as u64;
    if values > limits.json_values {
        return Err(Error::Limit {
            file: file.into(),
            path: String::new(),
            what: format!("JSON of {values} values"),
            limit: format!("{} (json_values)", limits.json_values),
        });
    }
    serde_json::from_slice(json).map_err(|e| Error::Json { file: file.into(), reason: e.to_string() })
}
