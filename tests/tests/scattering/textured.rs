//! Textures of a material's numbers, from the scene through the host's tables to f: a texture of one colour is that number as a
//! factor, to the bit, in the channel and by the curve that glTF's texts name.

use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use jerboa_scenes::{
    Clearcoat, DiffuseTransmission, Filter, Image, Iridescence, Material, Model, Scene, Sheen, Texture, TextureRef,
    TextureSource, Volume,
};
use jerboa_tests::harness::bench::Random;
use jerboa_tests::harness::probe::{Probe, random_direction};

/// One for all tests of textures: each loads what it asks about.
pub fn probe() -> MutexGuard<'static, Probe> {
    static PROBE: LazyLock<Mutex<Probe>> = LazyLock::new(Mutex::default);
    PROBE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A scene of a material alone, and of an image of one texel, which is what its textures show.
pub fn scene(material: Material, texel: [u8; 4]) -> Scene {
    let image = Image { name: "texel".into(), width: 1, height: 1, rgba: vec![texel] };
    let texture = Texture::repeating("texel", TextureSource::Image(0), Filter::Bilinear);
    Scene { materials: vec![material], images: vec![image], textures: vec![texture], ..Scene::default() }
}

/// Of the image.
pub const TEXTURE: Option<TextureRef> = Some(TextureRef { texture: 0, uv_set: 0, transform: None });

/// The colour that a texel stands for, as it is and by the sRGB curve (IEC 61966-2-1).
struct Texel {
    linear: [f32; 4],
    decoded: [f32; 3],
}

impl Texel {
    fn of(codes: [u8; 4]) -> Texel {
        let curve = |s: f64| if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
        let [r, g, b, _] = codes.map(|code| curve(f64::from(code) / 255.0) as f32);
        Texel { linear: codes.map(|code| f32::from(code) / 255.0), decoded: [r, g, b] }
    }
}

fn scale(factor: &mut [f32], by: [f32; 3]) {
    factor.iter_mut().zip(by).for_each(|(x, k)| *x *= k);
}

/// A use of a texture: what shows it, where the material names it, and what it does to the material's numbers.
struct Use {
    name: &'static str,
    ground: fn() -> Material,
    place: fn(&mut Material) -> &mut Option<TextureRef>,
    factor: fn(&mut Material, &Texel),
}

/// Something of everything.
pub fn medley() -> Material {
    let solid =
        Volume { thickness: 1.0, thickness_texture: None, attenuation_distance: 1.0, attenuation_color: [0.5; 3] };
    Material {
        metallic: 0.6,
        transmission: 0.6,
        specular: 0.9,
        specular_color: [0.9, 0.8, 0.7],
        volume: Some(solid),
        ..Material::plastic("medley", [0.8, 0.5, 0.3], 0.7)
    }
}

fn coated() -> Material {
    Material { clearcoat: Some(Clearcoat::new(0.9, 0.8)), ..Material::diffuse("coated", [0.5; 3]) }
}

fn cloth() -> Material {
    Material { sheen: Some(Sheen::new([0.9, 0.8, 0.7], 0.9)), ..Material::diffuse("cloth", [0.5; 3]) }
}

fn leaf() -> Material {
    let lobe = DiffuseTransmission::new(0.9, [0.9, 0.8, 0.7]);
    Material { diffuse_transmission: Some(lobe), ..Material::diffuse("leaf", [0.5; 3]) }
}

fn soap() -> Material {
    let film = Iridescence { thinnest: 150.0, ..Iridescence::new(0.9, 550.0) };
    Material { iridescence: Some(film), ..Material::metal("soap", [0.5, 0.6, 0.7], 0.6) }
}

fn conductor() -> Material {
    Material { model: Some(Model::named("conductor")), ..Material::metal("conductor", [0.5; 3], 0.9) }
}

/// Every texture but those of normals, emission and directions; each with its channel as the text of glTF or of the extension has it.
const USES: [Use; 14] = [
    Use {
        name: "base colour, sRGB",
        ground: medley,
        place: |m| &mut m.base_color_texture,
        factor: |m, t| scale(&mut m.base_color[..3], t.decoded),
    },
    Use {
        name: "roughness in green, metallic in blue",
        ground: medley,
        place: |m| &mut m.metallic_roughness_texture,
        factor: |m, t| (m.roughness, m.metallic) = (m.roughness * t.linear[1], m.metallic * t.linear[2]),
    },
    Use {
        name: "roughness of another model, in green",
        ground: conductor,
        place: |m| &mut m.metallic_roughness_texture,
        factor: |m, t| m.roughness *= t.linear[1],
    },
    Use {
        name: "specular in alpha",
        ground: medley,
        place: |m| &mut m.specular_texture,
        factor: |m, t| m.specular *= t.linear[3],
    },
    Use {
        name: "specular colour, sRGB",
        ground: medley,
        place: |m| &mut m.specular_color_texture,
        factor: |m, t| scale(&mut m.specular_color, t.decoded),
    },
    Use {
        name: "transmission in red",
        ground: medley,
        place: |m| &mut m.transmission_texture,
        factor: |m, t| m.transmission *= t.linear[0],
    },
    Use {
        name: "clearcoat in red",
        ground: coated,
        place: |m| &mut m.clearcoat.as_mut().expect("it is there").texture,
        factor: |m, t| m.clearcoat.as_mut().expect("it is there").factor *= t.linear[0],
    },
    Use {
        name: "clearcoat roughness in green",
        ground: coated,
        place: |m| &mut m.clearcoat.as_mut().expect("it is there").roughness_texture,
        factor: |m, t| m.clearcoat.as_mut().expect("it is there").roughness *= t.linear[1],
    },
    Use {
        name: "sheen colour, sRGB",
        ground: cloth,
        place: |m| &mut m.sheen.as_mut().expect("it is there").color_texture,
        factor: |m, t| scale(&mut m.sheen.as_mut().expect("it is there").color, t.decoded),
    },
    Use {
        name: "sheen roughness in alpha",
        ground: cloth,
        place: |m| &mut m.sheen.as_mut().expect("it is there").roughness_texture,
        factor: |m, t| m.sheen.as_mut().expect("it is there").roughness *= t.linear[3],
    },
    Use {
        name: "diffuse transmission in alpha",
        ground: leaf,
        place: |m| &mut m.diffuse_transmission.as_mut().expect("it is there").texture,
        factor: |m, t| m.diffuse_transmission.as_mut().expect("it is there").factor *= t.linear[3],
    },
    Use {
        name: "diffuse transmission colour, sRGB",
        ground: leaf,
        place: |m| &mut m.diffuse_transmission.as_mut().expect("it is there").color_texture,
        factor: |m, t| scale(&mut m.diffuse_transmission.as_mut().expect("it is there").color, t.decoded),
    },
    Use {
        name: "iridescence in red",
        ground: soap,
        place: |m| &mut m.iridescence.as_mut().expect("it is there").texture,
        factor: |m, t| m.iridescence.as_mut().expect("it is there").factor *= t.linear[0],
    },
    Use {
        name: "iridescence thickness in green",
        ground: soap,
        place: |m| &mut m.iridescence.as_mut().expect("it is there").thickness_texture,
        factor: |m, t| {
            let (film, k) = (m.iridescence.as_mut().expect("it is there"), t.linear[1]);
            film.thickest = film.thinnest * (1.0 - k) + film.thickest * k;
        },
    },
];

/// The bits of f and pdf for some pairs of directions, and of some samples.
fn bits(probe: &mut Probe) -> Vec<u32> {
    let mut random = Random(0x7e57);
    let mut all = Vec::new();
    for key in 0..40 {
        let (wi, wo) = (random_direction(&mut random), random_direction(&mut random));
        let (f, pdf, _) = probe.eval(wi, wo);
        let s = probe.sample(wo, key);
        all.extend([f, [pdf, s.pdf, s.scale], s.wi, s.weight].concat().into_iter().map(f32::to_bits));
    }
    all
}

#[test]
fn a_texture_of_one_colour_is_a_factor() {
    let mut probe = probe();
    // Four channels that differ, and then in another order.
    for codes in [[100, 150, 200, 240], [200, 240, 100, 150]] {
        for Use { name, ground, place, factor } in &USES {
            let (mut textured, mut plain) = (ground(), ground());
            *place(&mut textured) = TEXTURE;
            factor(&mut plain, &Texel::of(codes));
            let mut bits_of = |material: Material| bits(probe.load(&scene(material, codes)));
            let (found, expected, without) = (bits_of(textured), bits_of(plain), bits_of(ground()));
            assert!(expected != without, "{name}: nobody would see it");
            assert!(found == expected, "{name}, {codes:?}");
        }
    }
}

/// KHR_materials_volume has a texture of thickness for those who do not trace the inside.
#[test]
fn a_texture_of_thickness_changes_nothing() {
    let mut probe = probe();
    let mut textured = medley();
    textured.volume.as_mut().expect("it is there").thickness_texture = TEXTURE;
    for texel in [[0; 4], [100, 150, 200, 240]] {
        let [found, expected] = [&textured, &medley()].map(|m| bits(probe.load(&scene(m.clone(), texel))));
        assert!(found == expected, "{texel:?}");
    }
}
