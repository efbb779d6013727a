//! Textures, samplers and images. An image is decoded only when a material in use needs it.

use super::Loader;
use super::folder::{Resolved, resolve};
use super::json::Json;
use super::schema::{MagFilter, WrappingMode};
use crate::error::warn;
use crate::texture::decode;
use crate::{Error, Filter, Image, Texture, TextureSource, Wrap};

impl<'a> Loader<'a> {
    /// The scene's texture for the index at `reference`; `None`, with a warning, when its image cannot be had.
    pub fn texture(&mut self, reference: &Json<'a>) -> Result<Option<usize>, Error> {
        let (index, at) = reference.refer(&self.root, "textures", "textures")?;
        if let Some(&known) = self.textures.get(&index) {
            return Ok(known);
        }
        let webp = at.extension("EXT_texture_webp")?.and_then(|ext| ext.get("source"));
        let new = match webp.or_else(|| at.get("source")) {
            Some(source) => self.image(&source)?,
            None => {
                warn(&mut self.scene.warnings, &at.path, "a texture without an image of a known format is left out");
                None
            }
        };
        let new = match new {
            None => None,
            Some(image) => {
                let sampler = at.get("sampler").map(|s| s.refer(&self.root, "samplers", "samplers")).transpose()?;
                let texture = read_texture(&at, image, sampler.map(|(_, s)| s))?;
                self.scene.textures.push(texture);
                Some(self.scene.textures.len() - 1)
            }
        };
        self.textures.insert(index, new);
        Ok(new)
    }

    fn decode(&mut self, at: &Json, bytes: &[u8]) -> Result<Result<Image, String>, Error> {
        let decoded = decode(at.file, &at.path, bytes, self.limits, &mut self.images_left)?;
        Ok(decoded.map(|image| Image { name: at.name(), ..image }))
    }

    fn image(&mut self, reference: &Json<'a>) -> Result<Option<usize>, Error> {
        let (index, at) = reference.refer(&self.root, "images", "images")?;
        if let Some(&known) = self.images.get(&index) {
            return Ok(known);
        }
        let new = match self.read_image(&at)? {
            Ok(image) => {
                self.scene.images.push(image);
                Some(self.scene.images.len() - 1)
            }
            Err(reason) => {
                let message = format!("{reason}: white is used instead");
                warn(&mut self.scene.warnings, &at.path, message);
                None
            }
        };
        self.images.insert(index, new);
        Ok(new)
    }

    /// The outer error ends the load; the inner one, a reason, only loses the image.
    fn read_image(&mut self, at: &Json<'a>) -> Result<Result<Image, String>, Error> {
        if let Some(uri) = at.get("uri") {
            return match resolve(&uri, self.limits)? {
                Resolved::Bytes(bytes) => self.decode(at, &bytes),
                Resolved::Missing(reason) => Ok(Err(format!("\"{}\" {reason}", uri.shown()))),
            };
        }
        match at.get("bufferView") {
            Some(reference) => {
                let (bytes, start, length, _) = self.view(&reference)?;
                self.decode(at, &bytes[start..start + length])
            }
            None => Ok(Err("the image has neither uri nor bufferView".into())),
        }
    }
}

fn read_texture(at: &Json, image: usize, sampler: Option<Json>) -> Result<Texture, Error> {
    let wrap = |key| {
        let mode = sampler.as_ref().map_or(Ok(WrappingMode::Repeat), |s| s.word_or(key, WrappingMode::Repeat));
        mode.map(|mode| match mode {
            WrappingMode::Repeat => Wrap::Repeat,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::ClampToEdge => Wrap::Clamp,
        })
    };
    let filter = match sampler.as_ref().map_or(Ok(MagFilter::Linear), |s| s.word_or("magFilter", MagFilter::Linear))? {
        MagFilter::Nearest => Filter::Nearest,
        MagFilter::Linear => Filter::Bilinear,
    };
    let extra = |key| sampler.as_ref().and_then(|s| s.get("extras")).and_then(|extras| extras.get(key));
    let filter = extra("filter").map_or(Ok(filter), |at| own_filter(&at))?;
    let border = extra("border").map(|at| border(&at)).transpose()?;
    let source = TextureSource::Image(image);
    Ok(Texture { name: at.name(), source, wrap_s: wrap("wrapS")?, wrap_t: wrap("wrapT")?, filter, border })
}

/// A filter that glTF has no code for.
fn own_filter(at: &Json) -> Result<Filter, Error> {
    match at.text()? {
        "bicubic" => Ok(Filter::Bicubic),
        _ => Err(at.fault(format!("\"{}\" is not \"bicubic\"; magFilter names the other filters", at.shown()))),
    }
}

/// What is outside of the image.
fn border(at: &Json) -> Result<[f32; 4], Error> {
    let rgba = at.numbers::<4>()?.map(|x| x as f32);
    let valid = rgba.iter().all(|x| (0.0..=1.0).contains(x));
    if valid {
        Ok(rgba)
    } else {
        Err(at.fault("a border is four numbers from 0 to 1: linear red, green, blue and alpha"))
    }
}
