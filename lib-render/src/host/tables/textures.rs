//! Textures and texels.

use std::collections::HashMap;

use jerboa_scenes::{Filter, Scene, TextureRef, TextureSource, UvTransform, Wrap};

use super::memory::{Memory, Table};
use super::models::{Numbers, own_texture};
use crate::components::Components;
use crate::schema::*;
use crate::texture::Lookup;

/// How a use of an image reads its colour channels.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Encoding {
    /// By the sRGB curve.
    Srgb,
    /// As they are.
    Linear,
}

/// Texture rows that are being collected: one for each way in which the materials use a texture.
pub struct Textures<'a> {
    scene: &'a Scene,
    components: &'a Components,
    /// The numbers that components take.
    pub numbers: Numbers,
    table: Table<crate::schema::Textures>,
    /// Images in use, in the order of their texels.
    images: Vec<usize>,
    /// First texel of each of them.
    offsets: HashMap<usize, u32>,
    /// Texels so far.
    count: u32,
    rows: HashMap<Key, u32>,
}

/// What makes two uses the same row.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Key {
    texture: usize,
    uv_set: usize,
    transform: Option<[u32; 5]>,
    encoding: Encoding,
}

impl<'a> Textures<'a> {
    /// None yet.
    pub fn new(scene: &'a Scene, components: &'a Components) -> Self {
        Textures {
            scene,
            components,
            numbers: Numbers::of_lights(scene, components),
            table: Table::new(),
            images: Vec::new(),
            offsets: HashMap::new(),
            count: 0,
            rows: HashMap::new(),
        }
    }

    /// The row of a use of a texture; row 0 for none (nothing reads it then).
    pub fn row(&mut self, use_: Option<&TextureRef>, encoding: Encoding) -> u32 {
        let Some(r) = use_ else { return 0 };
        let bits = |t: UvTransform| [t.offset[0], t.offset[1], t.rotation, t.scale[0], t.scale[1]].map(f32::to_bits);
        let key = Key { texture: r.texture, uv_set: r.uv_set, transform: r.transform.map(bits), encoding };
        if let Some(row) = self.rows.get(&key) {
            return *row;
        }
        let row = self.table.rows();
        self.write(r, encoding);
        self.rows.insert(key, row);
        row
    }

    fn write(&mut self, r: &TextureRef, encoding: Encoding) {
        use crate::schema::Textures as T;
        let texture = &self.scene.textures[r.texture];
        let image = match texture.source {
            TextureSource::Image(i) => Some((i, self.offset(i))),
            TextureSource::Checkerboard { .. } | TextureSource::Noise { .. } | TextureSource::Own(_) => None,
        };
        let own = match texture.source {
            TextureSource::Own(own) => own_texture(self.scene, own, self.components).ok(),
            _ => None,
        };
        let mut row = self.table.push();
        row.set(T::UV_SET, r.uv_set as u32).set(T::SRGB, encoding == Encoding::Srgb);
        row.set(T::FILTER, filter(texture.filter));
        match texture.border {
            Some(border) => row
                .set(T::WRAP_U, WRAP_BORDER)
                .set(T::WRAP_V, WRAP_BORDER)
                .set_all([T::BORDER_R, T::BORDER_G, T::BORDER_B, T::BORDER_A], border),
            None => row.set(T::WRAP_U, wrap(texture.wrap_s)).set(T::WRAP_V, wrap(texture.wrap_t)),
        };
        if let Some((i, offset)) = image {
            let image = &self.scene.images[i];
            row.set(T::KIND, TEXTURE_IMAGE)
                .set(T::OFFSET, offset)
                .set(T::WIDTH, image.width)
                .set(T::HEIGHT, image.height);
        }
        if let TextureSource::Checkerboard { even, odd } = texture.source {
            row.set(T::KIND, TEXTURE_CHECKERBOARD);
            row.set_all([T::EVEN_R, T::EVEN_G, T::EVEN_B], even).set_all([T::ODD_R, T::ODD_G, T::ODD_B], odd);
        }
        if let TextureSource::Noise { low, high } = texture.source {
            row.set(T::KIND, TEXTURE_NOISE);
            row.set_all([T::EVEN_R, T::EVEN_G, T::EVEN_B], low).set_all([T::ODD_R, T::ODD_G, T::ODD_B], high);
        }
        if let Some((kind, numbers)) = own {
            row.set(T::KIND, TEXTURE_OWN + kind).set(T::NUMBERS, self.numbers.place(&numbers));
        }
        if let Some(t) = r.transform {
            let m = matrix(t);
            row.set(T::TRANSFORMED, true).set_all([T::M00, T::M01, T::M02, T::M10, T::M11, T::M12], m);
        }
    }

    /// First texel of an image.
    fn offset(&mut self, image: usize) -> u32 {
        *self.offsets.entry(image).or_insert_with(|| {
            let first = self.count;
            self.images.push(image);
            self.count += self.scene.images[image].rgba.len() as u32;
            first
        })
    }

    /// The images in use, in the order of their texels.
    pub fn images(&self) -> &[usize] {
        &self.images
    }

    /// The texels of the images in use.
    pub fn texels(&self) -> Memory {
        let mut table = Table::<Texels>::with_rows(self.count as usize);
        for rgba in self.images.iter().flat_map(|image| &self.scene.images[*image].rgba) {
            table.push().set(Texels::RGBA, u32::from_le_bytes(*rgba));
        }
        table.finish()
    }

    /// The finished table of textures.
    pub fn finish(self) -> Memory {
        self.table.finish()
    }
}

/// Does any texture in use ask for this?
pub fn asks_for(scene: &Scene, lookup: Lookup) -> bool {
    let asks = |texture: &jerboa_scenes::Texture| match lookup {
        Lookup::Border => texture.border.is_some(),
        Lookup::Bicubic => texture.filter == Filter::Bicubic,
        Lookup::Noise => matches!(texture.source, TextureSource::Noise { .. }),
    };
    let mut used = scene.materials.iter().flat_map(jerboa_scenes::Material::textures);
    used.any(|used| asks(&scene.textures[used.texture]))
}

fn filter(f: Filter) -> u32 {
    match f {
        Filter::Nearest => FILTER_NEAREST,
        Filter::Bilinear => FILTER_BILINEAR,
        Filter::Bicubic => FILTER_BICUBIC,
    }
}

fn wrap(w: Wrap) -> u32 {
    match w {
        Wrap::Repeat => WRAP_REPEAT,
        Wrap::Clamp => WRAP_CLAMP,
        Wrap::Mirror => WRAP_MIRROR,
    }
}

/// The transform as two rows of three, rounded once from double precision.
fn matrix(t: UvTransform) -> [f32; 6] {
    let [sx, sy] = t.scale.map(f64::from);
    let (sin, cos) = f64::from(t.rotation).sin_cos();
    [cos * sx, sin * sy, t.offset[0].into(), -sin * sx, cos * sy, t.offset[1].into()].map(|x: f64| x as f32)
}

/// The sRGB curve at its 256 codes (IEC 61966-2-1), rounded once from double precision.
pub fn srgb_curve() -> Memory {
    let mut table = Table::<SrgbCurve>::new();
    for code in 0..256 {
        let s = f64::from(code) / 255.0;
        let linear = if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
        table.push().set(SrgbCurve::LINEAR, linear as f32);
    }
    table.finish()
}
