//! Textures: an image or a pattern, and how it is looked up.

use crate::{Error, Limits};
use image::{ImageDecoder, ImageFormat};
use std::io::Cursor;
use std::path::Path;

/// What a texture coordinate outside 0..1 means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Periodic.
    #[default]
    Repeat,
    /// Periodic, every other copy mirrored.
    Mirror,
    /// The edge texel continues.
    Clamp,
}

/// How texels become a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The texel at `floor(u · width), floor(v · height)`.
    Nearest,
    /// Four texels around, centres at half integers. There are no mipmaps: samples within a pixel filter minified ones.
    #[default]
    Bilinear,
    /// Sixteen texels around, weighed by cubic B-splines: smooth, and within the range of the texels.
    Bicubic,
}

/// What a texture is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextureSource {
    /// Index into [`Scene::images`](crate::Scene::images). Whether it is sRGB or linear is decided by its use.
    Image(usize),
    /// Unit squares of uv, `even` where `floor(u) + floor(v)` is even. Linear RGB; wrap and filter do not apply.
    Checkerboard {
        /// Linear RGB of the square at the origin.
        even: [f32; 3],
        /// Linear RGB of its neighbours.
        odd: [f32; 3],
    },
    /// Smooth noise between two colours, with features as large as a unit of uv; wrap and filter do not apply.
    Noise {
        /// Linear RGB of the lowest value.
        low: [f32; 3],
        /// Linear RGB of the highest.
        high: [f32; 3],
    },
    /// A texture of a user's crate, by its place in [`Scene::own`](crate::Scene::own). Wrap and filter do not apply.
    Own(usize),
}

/// A texture as a material refers to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The author's name, for messages.
    pub name: String,
    /// Texels or pattern.
    pub source: TextureSource,
    /// Along u.
    pub wrap_s: Wrap,
    /// Along v.
    pub wrap_t: Wrap,
    /// From glTF's magnification filter, or `extras.filter` of the sampler.
    pub filter: Filter,
    /// Linear RGBA from 0 to 1 of all that lies outside of the image, in place of `wrap_s` and `wrap_t`; `extras.border` of the
    /// sampler.
    pub border: Option<[f32; 4]>,
}

impl Texture {
    /// A texture that repeats.
    pub fn repeating(name: impl Into<String>, source: TextureSource, filter: Filter) -> Texture {
        let (wrap_s, wrap_t) = (Wrap::Repeat, Wrap::Repeat);
        Texture { name: name.into(), source, wrap_s, wrap_t, filter, border: None }
    }
}

/// Eight-bit RGBA texels as the file has them (not yet linear). Row 0 is the top, v = 0.
///
/// Grey is replicated, a missing alpha is 255, 16-bit channels are rounded to 8. Colour profiles and PNG gamma are ignored,
/// as glTF asks.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// The author's name, for messages.
    pub name: String,
    /// Texels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Row by row, `width · height` of them.
    pub rgba: Vec<[u8; 4]>,
}

/// Refuses an image before it is decoded: no texels, or more than the limits allow.
pub(crate) fn check_size(
    file: &Path,
    path: &str,
    [width, height]: [u32; 2],
    texel: u64,
    limits: &Limits,
) -> Result<(), Error> {
    let too_large = |limit| Error::Limit {
        file: file.into(),
        path: path.into(),
        what: format!("an image of {width} x {height} texels"),
        limit,
    };
    if width == 0 || height == 0 {
        return Err(Error::Value { file: file.into(), path: path.into(), reason: "an image without texels".into() });
    }
    if width.max(height) > limits.image_side {
        return Err(too_large(format!("{} texels a side (image_side)", limits.image_side)));
    }
    if u64::from(width) * u64::from(height) * texel > limits.image_bytes {
        return Err(too_large(format!("{} bytes decoded (image_bytes)", limits.image_bytes)));
    }
    Ok(())
}

/// Decodes PNG, JPEG or WebP, told by their first bytes (the stated type is often wrong), once header and limits agree;
/// `left` are the bytes that images may still take. The outer error ends the load; the inner one, a reason, only loses the
/// image, whose name is the caller's to give. `path` is where the scene file refers to it.
pub(crate) fn decode(
    file: &Path,
    path: &str,
    bytes: &[u8],
    limits: &Limits,
    left: &mut u64,
) -> Result<Result<Image, String>, Error> {
    let format = image::guess_format(bytes);
    let Some(format) = format.ok().filter(|f| matches!(f, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP))
    else {
        return Ok(Err("the image is neither PNG, JPEG nor WebP".into()));
    };
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), format);
    let mut bounds = image::Limits::default();
    // The decoder's own working memory: 16-bit channels and a row or two beside the image.
    bounds.max_alloc = Some(limits.image_bytes.saturating_mul(3));
    reader.limits(bounds);
    let decoder = match reader.into_decoder() {
        Ok(decoder) => decoder,
        Err(e) => return Ok(Err(undecodable(e))),
    };
    let (width, height) = decoder.dimensions();
    check_size(file, path, [width, height], 4, limits)?;
    let cost = u64::from(width) * u64::from(height) * 4;
    *left = left.checked_sub(cost).ok_or_else(|| Error::Limit {
        file: file.into(),
        path: path.into(),
        what: format!("the images up to here, {width} x {height} texels more,"),
        limit: format!("{} bytes in all (images_bytes)", limits.images_bytes),
    })?;
    Ok(match image::DynamicImage::from_decoder(decoder) {
        Ok(decoded) => {
            let rgba = decoded.into_rgba8().as_chunks::<4>().0.to_vec();
            Ok(Image { name: String::new(), width, height, rgba })
        }
        Err(e) => Err(undecodable(e)),
    })
}

fn undecodable(error: image::ImageError) -> String {
    format!("the image cannot be decoded ({error})")
}
