//! The environment: light from infinitely far, as a lat-long image.

use crate::{Error, Limits};
use image::{ImageDecoder, ImageFormat};
use std::io::Cursor;
use std::path::Path;

/// Radiance arriving from every direction.
///
/// For a world direction d, first turned by −`rotation_deg` about +Y: u = 0.5 + atan2(d.x, −d.z) / 2π, v = acos(d.y) / π.
/// So u = 0.5 is −Z, row 0 is +Y, and a positive rotation turns the image counter-clockwise seen from above. Lookup
/// is bilinear with texel centres at half integers; u wraps, v clamps.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Texels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Linear RGB radiance, W·sr⁻¹·m⁻² up to the scene's scale, before `intensity`; row 0 is the zenith. Finite, not negative.
    pub radiance: Vec<[f32; 3]>,
    /// Multiplies the radiance.
    pub intensity: f32,
    /// Degrees about +Y.
    pub rotation_deg: f32,
}

/// Decodes the image that `path` of `file` refers to (`path` empty: `file` itself): a Radiance .hdr (RGBE as mantissa · 2^(e − 136), without +0.5) or an OpenEXR image. Returns the environment at
/// intensity 1 and how many texels were non-finite or negative and so set to zero.
pub(crate) fn decode(file: &Path, path: &str, bytes: &[u8], limits: &Limits) -> Result<(Environment, usize), Error> {
    let fault = |reason: String| Error::Environment { file: file.into(), path: path.into(), reason };
    let reader = image::ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| fault(e.to_string()))?;
    if !matches!(reader.format(), Some(ImageFormat::Hdr | ImageFormat::OpenExr)) {
        return Err(fault("neither Radiance HDR nor OpenEXR".into()));
    }
    let decoder = reader.into_decoder().map_err(|e| fault(e.to_string()))?;
    let (width, height) = decoder.dimensions();
    crate::texture::check_size(file, path, [width, height], 12, limits)?;
    let decoded = image::DynamicImage::from_decoder(decoder).map_err(|e| fault(e.to_string()))?;
    let mut repaired = 0;
    let radiance = decoded
        .into_rgb32f()
        .pixels()
        .map(|p| {
            if p.0.iter().all(|c| c.is_finite() && *c >= 0.0) {
                return p.0;
            }
            repaired += 1;
            p.0.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 })
        })
        .collect();
    Ok((Environment { width, height, radiance, intensity: 1.0, rotation_deg: 0.0 }, repaired))
}
