//! What a URI of glTF leads to: the bytes in it, or a file in the scene's own folder.

use super::json::Json;
pub(super) use crate::folder::Resolved;
use crate::folder::beside;
use crate::{Error, Limits};
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// Exporters disagree on base64's trailing `=`.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Resolves the URI at `at`: `data:` in base64, or a relative path whose target lies inside the folder of the scene file.
pub(super) fn resolve(at: &Json, limits: &Limits) -> Result<Resolved, Error> {
    let uri = at.text()?;
    let refuse = |reason: &str| Err(at.uri_fault(reason.into()));
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((_, text)) = data.split_once(";base64,") else {
            return refuse("is not in base64");
        };
        if text.len() as u64 / 4 * 3 > limits.file_bytes {
            let what = format!("a data: URI of {} bytes", text.len());
            return Err(at.limit_fault(what, format!("{} (file_bytes)", limits.file_bytes)));
        }
        return match BASE64.decode(text) {
            Ok(bytes) => Ok(Resolved::Bytes(bytes)),
            Err(e) => refuse(&format!("is not base64 ({e})")),
        };
    }
    let Some(name) = percent_decode(uri) else {
        return refuse("is not UTF-8 once percent-decoded");
    };
    match beside(at.file, &name, limits)? {
        Ok(found) => Ok(found),
        Err(reason) => refuse(reason),
    }
}

fn percent_decode(uri: &str) -> Option<String> {
    let bytes = uri.as_bytes();
    let digit = |i: usize| bytes.get(i).and_then(|&b| char::from(b).to_digit(16));
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], digit(i + 1), digit(i + 2)) {
            (b'%', Some(high), Some(low)) => {
                decoded.push((high * 16 + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                decoded.push(byte);
                i += 1;
            }
        }
    }
    String::from_utf8(decoded).ok()
}
