//! MTL: libraries of materials.
//!
//! What a material is goes by what the paper's converter makes of it: `illum` 5 is a mirror, 7 is glass of index `Ni`, anything
//! else is diffuse `Kd` and, where `Ks` is not black, Phong's reflection with exponent `Ns`. `Ke` shines. Where a library has
//! the metalness and roughness that modelling programs write (`Pm`, `Pr`), it is glTF's model instead.

use super::Loader;
use super::lines::{Line, lines};
use crate::error::warn;
use crate::texture::decode;
use crate::{AlphaMode, Error, Filter, Image, Material, Model, Texture, TextureRef, TextureSource, UvTransform, Wrap};
use std::path::PathBuf;

/// A material as its lines have it.
#[derive(Default)]
struct Entry {
    name: String,
    kd: Option<[f32; 3]>,
    ks: [f32; 3],
    ke: [f32; 3],
    tf: Option<[f32; 3]>,
    ns: f32,
    ni: f32,
    opacity: f32,
    illum: u32,
    metallic: Option<f32>,
    roughness: Option<f32>,
    map_kd: Option<TextureRef>,
    map_ke: Option<TextureRef>,
    normal: Option<TextureRef>,
    map_d: Option<TextureRef>,
}

impl Loader<'_> {
    /// Reads the libraries that a `mtllib` names.
    pub(super) fn library(&mut self, line: &Line) -> Result<(), Error> {
        let file = self.file.parent().map_or_else(PathBuf::new, |folder| folder.join(line.rest().replace('\\', "/")));
        if !self.libraries.insert(file.canonicalize().unwrap_or_else(|_| file.clone())) {
            return Ok(());
        }
        let Some(bytes) = self.named(line, line.rest())? else { return Ok(()) };
        let text = String::from_utf8_lossy(&bytes);
        let mut entry: Option<Entry> = None;
        for line in lines(&file, &text) {
            if line.keyword() == "newmtl" {
                self.add(entry.take());
                entry = Some(Entry { name: line.rest().into(), opacity: 1.0, ni: 1.5, ..Entry::default() });
                continue;
            }
            match &mut entry {
                Some(entry) => self.property(entry, &line)?,
                None => return Err(line.fault(format!("`{}` before any newmtl", line.keyword()))),
            }
        }
        self.add(entry);
        Ok(())
    }

    /// Ends a material.
    fn add(&mut self, entry: Option<Entry>) {
        let Some(entry) = entry else { return };
        let image = |map: Option<TextureRef>| map.map(|m| self.scene.textures[m.texture].source);
        let holes = entry.map_d.is_some() && image(entry.map_d) == image(entry.map_kd);
        if entry.map_d.is_some() && !holes {
            let message = "a map_d other than map_Kd is ignored: holes are where the colour's texels are transparent";
            warn(&mut self.scene.warnings, &entry.name, message);
        }
        self.materials.insert(entry.name.clone(), self.scene.materials.len());
        self.scene.materials.push(entry.material(holes));
    }

    fn property(&mut self, entry: &mut Entry, line: &Line) -> Result<(), Error> {
        match line.keyword() {
            "Kd" => entry.kd = Some(self.color(line, 1.0)?),
            "Ks" => entry.ks = self.color(line, 1.0)?,
            "Ke" => entry.ke = self.color(line, f32::MAX)?,
            "Tf" => entry.tf = Some(self.color(line, 1.0)?),
            "Ns" => entry.ns = within(line, 0.0, f32::MAX)?,
            // Below 1 is an inside thinner than air: none of a closed body in air.
            "Ni" => entry.ni = within(line, 0.0, 100.0)?.max(1.0),
            "d" => entry.opacity = within(line, 0.0, 1.0)?,
            "Tr" => entry.opacity = 1.0 - within(line, 0.0, 1.0)?,
            "illum" => entry.illum = within(line, 0.0, 10.0)? as u32,
            "Pm" => entry.metallic = Some(within(line, 0.0, 1.0)?),
            "Pr" => entry.roughness = Some(within(line, 0.0, 1.0)?),
            "map_Kd" => entry.map_kd = self.map(line)?,
            "map_Ke" => entry.map_ke = self.map(line)?,
            "norm" | "map_Kn" => entry.normal = self.map(line)?,
            "map_d" => entry.map_d = self.map(line)?,
            // Ambient light is what a path tracer computes.
            "Ka" | "map_Ka" => {}
            other => warn(&mut self.scene.warnings, &line.place(), format!("`{other}` of a material is not read")),
        }
        Ok(())
    }

    /// Three numbers, one of which stands for three; those outside of 0 to `most` are brought there, with a warning.
    fn color(&mut self, line: &Line, most: f32) -> Result<[f32; 3], Error> {
        let color = if line.words().count() == 1 { [line.numbers::<1>()?[0]; 3] } else { line.numbers::<3>()? };
        let valid = color.map(|c| c.clamp(0.0, most));
        if valid != color {
            warn(&mut self.scene.warnings, &line.place(), format!("a colour outside of 0 to {most} is brought there"));
        }
        Ok(valid)
    }

    /// A texture by its file, after its options; none, with a warning, where the image cannot be had.
    fn map(&mut self, line: &Line) -> Result<Option<TextureRef>, Error> {
        let (options, name) = options(line)?;
        let image = match self.images.get(name) {
            Some(known) => *known,
            None => {
                let image = self.image(line, name)?;
                self.images.insert(name.into(), image);
                image
            }
        };
        let Some(image) = image else { return Ok(None) };
        let wrap = if options.clamp { Wrap::Clamp } else { Wrap::Repeat };
        let source = TextureSource::Image(image);
        let texture = Texture { wrap_s: wrap, wrap_t: wrap, ..Texture::repeating(name, source, Filter::Bilinear) };
        let known = self.scene.textures.iter().position(|t| *t == texture);
        let texture = known.unwrap_or_else(|| {
            self.scene.textures.push(texture);
            self.scene.textures.len() - 1
        });
        Ok(Some(TextureRef { texture, uv_set: 0, transform: options.transform() }))
    }

    fn image(&mut self, line: &Line, name: &str) -> Result<Option<usize>, Error> {
        let Some(bytes) = self.named(line, name)? else { return Ok(None) };
        match decode(self.file, &line.place(), &bytes, self.limits, &mut self.images_left)? {
            Ok(image) => {
                self.scene.images.push(Image { name: name.into(), ..image });
                Ok(Some(self.scene.images.len() - 1))
            }
            Err(reason) => {
                warn(&mut self.scene.warnings, &line.place(), format!("\"{name}\": {reason}: it is left out"));
                Ok(None)
            }
        }
    }
}

impl Entry {
    /// `holes`: where the texels of `map_Kd` are transparent.
    fn material(self, holes: bool) -> Material {
        let emissive = if self.map_ke.is_some() && self.ke == [0.0; 3] { [1.0; 3] } else { self.ke };
        // A texture stands alone where the library gives no factor beside it.
        let [r, g, b] = self.kd.unwrap_or(if self.map_kd.is_some() { [1.0; 3] } else { [0.5; 3] });
        let base = Material {
            base_color_texture: self.map_kd,
            normal_texture: self.normal,
            emissive,
            emissive_texture: self.map_ke,
            alpha_mode: match (self.opacity < 1.0, holes) {
                (true, _) => AlphaMode::Blend,
                (false, true) => AlphaMode::Mask(0.5),
                (false, false) => AlphaMode::Opaque,
            },
            ..Material::diffuse(&self.name, [r, g, b])
        };
        let opaque = Material { base_color: [r, g, b, self.opacity], ..base.clone() };
        match self.illum {
            5 => {
                let [r, g, b] = self.ks;
                let base_color = [r, g, b, self.opacity];
                Material { base_color, base_color_texture: None, metallic: 1.0, roughness: 0.0, ..base }
            }
            7 => {
                let [r, g, b] = self.tf.unwrap_or([1.0; 3]);
                let glass = Material::glass(&self.name, self.ni);
                Material { base_color: [r, g, b, 1.0], emissive, normal_texture: self.normal, ..glass }
            }
            _ if self.metallic.is_some() || self.roughness.is_some() => Material {
                metallic: self.metallic.unwrap_or(0.0),
                roughness: self.roughness.unwrap_or(1.0),
                specular: 1.0,
                ior: self.ni,
                ..opaque
            },
            _ if self.ks.iter().any(|c| *c > 0.0) => {
                let phong = Model::named("phong").with("ks", &self.ks).with("ns", &[self.ns]);
                Material { model: Some(phong), ..opaque }
            }
            _ => opaque,
        }
    }
}

/// What stands before the file of a texture.
struct Options {
    offset: [f32; 2],
    scale: [f32; 2],
    clamp: bool,
}

impl Options {
    /// The map of texture coordinates: v runs upwards in the file, downwards here.
    fn transform(&self) -> Option<UvTransform> {
        let ([s, t], [u, v]) = (self.scale, self.offset);
        let is_identity = self.scale == [1.0; 2] && self.offset == [0.0; 2];
        (!is_identity).then_some(UvTransform { offset: [u, 1.0 - t - v], rotation: 0.0, scale: [s, t] })
    }
}

/// Options of a texture, and the file after them.
fn options<'a>(line: &'a Line) -> Result<(Options, &'a str), Error> {
    let mut found = Options { offset: [0.0; 2], scale: [1.0; 2], clamp: false };
    let mut rest = line.rest();
    while rest.starts_with('-') {
        let option = take(&mut rest);
        let mut numbers = Vec::new();
        let most = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            "-bm" | "-boost" | "-texres" => 1,
            "-clamp" | "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-type" => {
                let word = take(&mut rest);
                found.clamp |= option == "-clamp" && word == "on";
                0
            }
            other => return Err(line.fault(format!("\"{other}\" is not an option of a texture"))),
        };
        while numbers.len() < most && rest.split_whitespace().next().is_some_and(|w| w.parse::<f32>().is_ok()) {
            numbers.push(line.number(take(&mut rest))?);
        }
        let target = match option {
            "-o" => &mut found.offset,
            "-s" => &mut found.scale,
            _ => continue,
        };
        target.iter_mut().zip(numbers).for_each(|(target, number)| *target = number);
    }
    if rest.is_empty() { Err(line.fault("a texture without a file")) } else { Ok((found, rest)) }
}

/// The next word, which is taken off the front.
fn take<'a>(rest: &mut &'a str) -> &'a str {
    let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
    let (word, after) = rest.split_at(end);
    *rest = after.trim_start();
    word
}

/// A number within a range.
fn within(line: &Line, least: f32, most: f32) -> Result<f32, Error> {
    let [number] = line.numbers::<1>()?;
    let valid = (least..=most).contains(&number);
    if valid { Ok(number) } else { Err(line.fault(format!("{number} is outside of {least} to {most}"))) }
}
