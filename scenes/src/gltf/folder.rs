//! Every access to the disk: regular files only, bounded in size, and for a URI only inside the scene's own folder.

use super::json::Json;
use crate::{Error, Limits};
use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Exporters disagree on base64's trailing `=`.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Reads a regular file the user named (pipes and devices could block or never end).
pub(crate) fn read(file: &Path, limits: &Limits) -> Result<Vec<u8>, Error> {
    let fault = |reason: String| Error::Read { file: file.into(), reason };
    let metadata = std::fs::metadata(file).map_err(|e| fault(e.to_string()))?;
    if !metadata.is_file() {
        return Err(fault("not a regular file".into()));
    }
    let too_large = |size: u64| Error::Limit {
        file: file.into(),
        path: String::new(),
        what: format!("a file of {size} bytes"),
        limit: format!("{} (file_bytes)", limits.file_bytes),
    };
    if metadata.len() > limits.file_bytes {
        return Err(too_large(metadata.len()));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(metadata.len() as usize).map_err(|e| fault(e.to_string()))?;
    // The file may grow between the two calls.
    let bounded = File::open(file).map(|f| f.take(limits.file_bytes + 1));
    bounded.and_then(|mut f| f.read_to_end(&mut bytes)).map_err(|e| fault(e.to_string()))?;
    if bytes.len() as u64 > limits.file_bytes { Err(too_large(bytes.len() as u64)) } else { Ok(bytes) }
}

/// What an acceptable URI leads to. A missing file, told by a reason, need not end the load: a texture can be done without.
pub(super) enum Resolved {
    Bytes(Vec<u8>),
    Missing(String),
}

/// Resolves the URI at `at`: `data:` in base64, or a relative path whose target lies inside the folder of the scene file.
pub(super) fn resolve(at: &Json, limits: &Limits) -> Result<Resolved, Error> {
    let uri = at.text()?;
    let refuse = |reason: &str| Err(at.uri_fault(reason.into()));
    let missing = |reason: String| Ok(Resolved::Missing(format!("cannot be read: {reason}")));
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
    let scheme = name.split(['/', '\\']).next().unwrap_or_default();
    if scheme.contains(':') {
        return refuse("has a scheme or a drive");
    }
    if name.contains('\0') || name.is_empty() {
        return refuse("is not a file name");
    }
    if name.starts_with(['/', '\\']) {
        return refuse("is an absolute path");
    }
    let beside = at.file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (folder, target) = match (beside.canonicalize(), beside.join(&name).canonicalize()) {
        (Ok(folder), Ok(target)) => (folder, target),
        // Whether a file outside exists is none of the scene's business.
        _ if climbs_out(&name) => return refuse("is outside the scene's folder"),
        (Err(e), _) | (_, Err(e)) => return missing(e.to_string()),
    };
    if !target.starts_with(&folder) {
        return refuse("is outside the scene's folder");
    }
    match read(&target, limits) {
        Ok(bytes) => Ok(Resolved::Bytes(bytes)),
        Err(Error::Read { reason, .. }) => missing(reason),
        Err(other) => Err(other),
    }
}

/// Whether the path, read without looking at the disk, leaves the folder it starts in.
fn climbs_out(name: &str) -> bool {
    let mut depth = 0i64;
    name.split(['/', '\\']).any(|part| {
        depth += match part {
            ".." => -1,
            "" | "." => 0,
            _ => 1,
        };
        depth < 0
    })
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
