//! Image textures: alpha, wrap modes and filters, lookups at the edge.

use super::shapes::{panel, quad, sky};
use super::surfaces::on_checkerboard;
use crate::{
    AlphaMode, Filter, Image, Instance, Light, LightKind, Material, Scene, Texture, TextureRef, TextureSource,
    UvTransform, Wrap,
};
use glam::{DAffine3, DVec3, Vec2, Vec3, vec3};

/// Cards with holes (MASK) and cards that fade (BLEND), before a checkerboard, with their shadows.
pub(super) fn alpha() -> Scene {
    let mut scene = on_checkerboard();
    let disc = |x: f32, y: f32| if x * x + y * y < 0.8 { 255 } else { 0 };
    let fade = |x: f32, _: f32| ((x + 1.0) * 127.5).round() as u8;
    let disc = scene.picture("disc", [64, 64], |x, y| [230, 120, 40, disc(x, y)], Filter::Nearest);
    let fade = scene.picture("fade", [64, 64], |x, y| [40, 120, 230, fade(x, y)], Filter::Bilinear);
    let card = |texture, alpha_mode| Material {
        base_color_texture: Some(texture),
        alpha_mode,
        ..Material::diffuse("card", [1.0; 3])
    };
    let mask = scene.paint(card(disc, AlphaMode::Mask(0.5)));
    let blend = scene.paint(card(fade, AlphaMode::Blend));
    let lamp = scene.paint(Material::emitter("lamp", [20.0; 3]));
    for i in 0..3 {
        let shift = vec3(i as f32 * 0.3, 0.0, i as f32 * -0.8);
        scene.place(quad(vec3(-1.5, 0.0, 0.5) + shift, Vec3::X, Vec3::Y), mask);
        scene.place(quad(vec3(0.2, 0.0, 0.5) + shift, Vec3::X, Vec3::Y), blend);
    }
    scene.place(panel(vec3(0.0, 3.0, 2.0), 0.5, 0.5), lamp);
    scene.view([0.0, 1.2, 4.5], [0.0, 0.4, 0.0], 0.6, (512, 384));
    scene
}

/// Every wrap mode, nearest and bilinear: a small picture from -1 to 2 on each card.
pub(super) fn textures() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let picture = |x: f32, y: f32| {
        [(x * 100.0 + 128.0) as u8, (y * 100.0 + 128.0) as u8, if x * y > 0.0 { 200 } else { 40 }, 255]
    };
    for (row, filter) in [Filter::Nearest, Filter::Bilinear].into_iter().enumerate() {
        for (column, wrap) in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp].into_iter().enumerate() {
            let texture = scene.picture("picture", [4, 4], picture, filter);
            scene.textures[texture.texture].wrap_s = wrap;
            scene.textures[texture.texture].wrap_t = wrap;
            let corner = vec3(column as f32 * 1.1 - 1.6, row as f32 * -1.1 + 0.05, 0.0);
            scene.card(corner, texture, UvTransform { offset: [-1.0; 2], rotation: 0.0, scale: [3.0; 2] });
        }
    }
    scene.view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 0.5, (384, 256));
    scene
}

/// A small picture from -1 to 2 on each card: above by the bicubic filter with every wrap mode and a border, below with a border
/// by the other filters, where texels end and fade; then noise.
pub(super) fn fine_textures() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let picture = |x: f32, y: f32| [(x * 100.0 + 128.0) as u8, (y * 100.0 + 128.0) as u8, 90, 255];
    let repeat = (Wrap::Repeat, None);
    let border = (Wrap::Repeat, Some([0.9, 0.6, 0.1, 1.0]));
    let bicubic = [repeat, (Wrap::Mirror, None), (Wrap::Clamp, None), border].map(|outside| (Filter::Bicubic, outside));
    let cards = bicubic.into_iter().chain([(Filter::Nearest, border), (Filter::Bilinear, border)]);
    for (i, (filter, (wrap, border))) in cards.enumerate() {
        let texture = scene.picture("picture", [4, 4], picture, filter);
        let texels = &mut scene.textures[texture.texture];
        (texels.wrap_s, texels.wrap_t, texels.border) = (wrap, wrap, border);
        scene.card(cell(i), texture, UvTransform { offset: [-1.0; 2], rotation: 0.0, scale: [3.0; 2] });
    }
    for (i, scale) in [(6, 2.0), (7, 16.0)] {
        let noise = TextureSource::Noise { low: [0.05, 0.1, 0.3], high: [0.9, 0.8, 0.6] };
        scene.textures.push(Texture::repeating("noise", noise, Filter::Nearest));
        let texture = TextureRef { texture: scene.textures.len() - 1, uv_set: 0, transform: None };
        scene.card(cell(i), texture, UvTransform { offset: [-0.5 * scale; 2], rotation: 0.3, scale: [scale; 2] });
    }
    scene.view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 0.42, (512, 256));
    scene
}

/// The corner of a card, of four in a row.
fn cell(i: usize) -> Vec3 {
    vec3((i % 4) as f32 * 1.1 - 2.15, (i / 4) as f32 * -1.1 + 0.05, 0.0)
}

/// Lookups at the edge of what single precision can do: textures of one texel and one row, coordinates of ten million
/// and of minus a billionth (whose fraction rounds to 1).
pub(super) fn odd_textures() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |_| [1.0; 3])), ..Scene::default() };
    let picture = |x: f32, y: f32| [(x * 127.0 + 128.0) as u8, (y * 127.0 + 128.0) as u8, 90, 255];
    let sizes = [[1, 1], [1, 7], [7, 1], [4, 4]];
    let spans = [([1e7, 1e7], 1.0), ([-1e-9, -1e-9], 0.0), ([-1e-9, 0.5], 1e7)];
    for (column, size) in sizes.into_iter().enumerate() {
        for (row, (offset, scale)) in spans.into_iter().enumerate() {
            let filter = if row == 0 { Filter::Nearest } else { Filter::Bilinear };
            let texture = scene.picture("odd", size, picture, filter);
            let corner = vec3(column as f32 * 1.1 - 2.15, row as f32 * 1.1 - 1.6, 0.0);
            scene.card(corner, texture, UvTransform { offset, rotation: 0.0, scale: [scale; 2] });
        }
    }
    scene.view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 0.6, (384, 288));
    scene
}

/// A card with a normal map of dents that are steep on one side, to the left, and its mirror image, by an instance with a
/// negative determinant, to the right; lit from between them.
pub(super) fn mirrored_maps() -> Scene {
    let mut scene = Scene { environment: Some(sky(16, |d| [0.3 + 0.2 * d.y; 3])), ..Scene::default() };
    let slope = |x: f32| ((x * 2.0 + 2.0).fract() - 0.2) * 0.9;
    let code = |x: f32| (x * 127.0 + 128.0) as u8;
    let dents = scene.picture("dents", [64, 64], |x, y| [code(slope(x)), code(slope(y)), 230, 255], Filter::Bilinear);
    let card = scene.paint(Material { normal_texture: Some(dents), ..Material::plastic("card", [0.7, 0.5, 0.4], 0.4) });
    scene.place(quad(vec3(-1.6, -0.7, 0.0), Vec3::X * 1.4, vec3(0.0, 1.3, -0.5)), card);
    let mirrored = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    scene.instances.push(Instance { mesh: 0, to_world: mirrored });
    let to_world = DAffine3::from_translation(DVec3::new(0.0, 0.5, 0.7));
    scene.lights.push(Light { name: "lamp".into(), kind: LightKind::Point, intensity: [2.0; 3], to_world });
    scene.view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 0.4, (384, 192));
    scene
}

impl Scene {
    /// Adds an image of texels given for x and y in -1..1 (y downwards), and a repeating texture of it.
    fn picture(
        &mut self,
        name: &str,
        [width, height]: [u32; 2],
        texel: impl Fn(f32, f32) -> [u8; 4],
        filter: Filter,
    ) -> TextureRef {
        let at = |i: u32, n: u32| (i as f32 + 0.5) / n as f32 * 2.0 - 1.0;
        let rgba = (0..width * height).map(|i| texel(at(i % width, width), at(i / width, height))).collect();
        self.images.push(Image { name: name.into(), width, height, rgba });
        let source = TextureSource::Image(self.images.len() - 1);
        self.textures.push(Texture::repeating(name, source, filter));
        TextureRef { texture: self.textures.len() - 1, uv_set: 0, transform: None }
    }

    /// Adds a unit card facing +Z, v = 0 at its top, that shows a texture.
    fn card(&mut self, corner: Vec3, texture: TextureRef, transform: UvTransform) {
        let texture = TextureRef { transform: Some(transform), ..texture };
        let material =
            self.paint(Material { base_color_texture: Some(texture), ..Material::diffuse("card", [1.0; 3]) });
        let mut card = quad(corner, Vec3::X, Vec3::Y);
        card.uvs[0].iter_mut().flatten().for_each(|uv| *uv = Vec2::new(uv.x, 1.0 - uv.y));
        self.place(card, material);
    }
}
