//! Every access to the disk: regular files only, bounded in size, and for a file that a scene names only inside the scene's
//! own folder.

use crate::{Error, Limits};
use std::fs::File;
use std::io::Read;
use std::path::Path;

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

/// What an acceptable reference leads to. A missing file, told by a reason, need not end the load: a texture can be done without.
pub(crate) enum Resolved {
    Bytes(Vec<u8>),
    Missing(String),
}

/// Reads the file of this relative path, which must lie inside the folder of the scene file. The inner error says why a
/// name is refused.
pub(crate) fn beside(file: &Path, name: &str, limits: &Limits) -> Result<Result<Resolved, &'static str>, Error> {
    let refused = |reason| Ok(Err(reason));
    let missing = |reason: String| Ok(Ok(Resolved::Missing(format!("cannot be read: {reason}"))));
    let scheme = name.split(['/', '\\']).next().unwrap_or_default();
    if scheme.contains(':') {
        return refused("has a scheme or a drive");
    }
    if name.contains('\0') || name.is_empty() {
        return refused("is not a file name");
    }
    if name.starts_with(['/', '\\']) {
        return refused("is an absolute path");
    }
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (folder, target) = match (folder.canonicalize(), folder.join(name).canonicalize()) {
        (Ok(folder), Ok(target)) => (folder, target),
        // Whether a file outside exists is none of the scene's business.
        _ if climbs_out(name) => return refused("is outside the scene's folder"),
        (Err(e), _) | (_, Err(e)) => return missing(e.to_string()),
    };
    if !target.starts_with(&folder) {
        return refused("is outside the scene's folder");
    }
    match read(&target, limits) {
        Ok(bytes) => Ok(Ok(Resolved::Bytes(bytes))),
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
