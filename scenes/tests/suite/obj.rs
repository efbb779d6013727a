//! OBJ and MTL.

use crate::common::*;
use jerboa_scenes::{AlphaMode, Error, Material, Scene, UvTransform, Wrap};
use std::path::Path;

/// A triangle and a quadrilateral with everything that a face can name, in two materials.
const SHAPE: &str = "\
# a comment
mtllib some materials.mtl
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
vt 0 0
vt 1 0
vt 0 1
vn 0 0 2
o thing
usemtl red#2
f 1/1/1 2/2/1 3/3/1
usemtl lamp
f -4 -3 \\
  -1 -2
";

const LIBRARY: &str = "\
newmtl red#2
Kd 0.8 0.1 0.1 # crimson
Ks 0.2
Ns 40
newmtl lamp
Kd 0 0 0
Ke 5 5 4
newmtl mirror
illum 5
Ks 0.9 0.8 0.7
newmtl glass
illum 7
Ni 1.33
Tf 0.9 1 1
newmtl modelled
Kd 1 1 1
Pm 1
Pr 0.25
d 0.5
newmtl painted
map_Kd -s 2 4 -o 0.5 0.25 -clamp on picture of\\paint.png
map_d picture of\\paint.png
norm -bm 1 no.png
";

fn load_text(folder: &Path, obj: &str, mtl: &str) -> Result<Scene, Error> {
    write(folder, "some materials.mtl", mtl);
    Scene::load(write(folder, "scene.OBJ", obj))
}

#[test]
fn faces_become_meshes_by_material() {
    let folder = tempfile::tempdir().unwrap();
    let scene = load_text(folder.path(), SHAPE, LIBRARY).unwrap();
    check(&scene);
    assert_eq!(scene.warnings.len(), 2, "{:?}", scene.warnings);
    let [red, lamp] = &scene.meshes[..] else { panic!("{} meshes", scene.meshes.len()) };
    assert_eq!((red.name.as_str(), red.triangles.as_slice()), ("red#2", [[0, 1, 2]].as_slice()));
    assert_eq!(red.uvs[0].as_ref().unwrap()[2].to_array(), [0.0, 0.0], "v runs downwards");
    assert_eq!(red.normals.as_ref().unwrap()[0].to_array(), [0.0, 0.0, 1.0]);
    assert_eq!((lamp.positions.len(), lamp.triangles.as_slice()), (4, [[0, 1, 2], [0, 2, 3]].as_slice()));
    assert_eq!(lamp.positions[2].to_array(), [1.0, 1.0, 0.0]);
    assert!(lamp.uvs[0].is_none() && lamp.normals.is_none());
}

#[test]
fn materials_are_what_their_model_says() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("picture of")).unwrap();
    let mut picture = Vec::new();
    let image = image::RgbaImage::from_pixel(2, 1, image::Rgba([9, 8, 7, 0]));
    image.write_to(&mut std::io::Cursor::new(&mut picture), image::ImageFormat::Png).unwrap();
    write(&folder.path().join("picture of"), "paint.png", picture);
    let scene = load_text(folder.path(), SHAPE, LIBRARY).unwrap();
    let named = |name: &str| scene.materials.iter().find(|m| m.name == name).unwrap_or_else(|| panic!("no {name}"));
    let phong = named("red#2").model.as_ref().unwrap();
    assert_eq!(phong.name, "phong");
    assert_eq!(phong.numbers, [("ks".to_string(), vec![0.2; 3]), ("ns".to_string(), vec![40.0])]);
    assert_eq!(named("lamp"), &Material::emitter("lamp", [5.0, 5.0, 4.0]));
    let mirror = named("mirror");
    assert_eq!((mirror.metallic, mirror.roughness, mirror.base_color), (1.0, 0.0, [0.9, 0.8, 0.7, 1.0]));
    assert_eq!(named("glass"), &Material { base_color: [0.9, 1.0, 1.0, 1.0], ..Material::glass("glass", 1.33) });
    let modelled = named("modelled");
    assert_eq!((modelled.metallic, modelled.roughness, modelled.base_color[3]), (1.0, 0.25, 0.5));
    assert_eq!(modelled.alpha_mode, AlphaMode::Blend);
    let painted = named("painted");
    let paint = painted.base_color_texture.unwrap();
    // v of the file, upwards, times 4, plus 1/4: downwards, 1 - (4 (1 - v) + 1/4) = 4 v - 3.25.
    assert_eq!(paint.transform, Some(UvTransform { offset: [0.5, -3.25], rotation: 0.0, scale: [2.0, 4.0] }));
    assert_eq!((scene.textures.len(), scene.textures[paint.texture].wrap_s), (2, Wrap::Clamp));
    assert_eq!((painted.base_color, painted.alpha_mode), ([1.0; 4], AlphaMode::Mask(0.5)));
    assert!(painted.normal_texture.is_none());
}

#[test]
fn faults_name_the_line() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("scene");
    std::fs::create_dir(&folder).unwrap();
    write(root.path(), "secret.mtl", "newmtl a");
    let cases = [
        ("v 0 0", "", "scene.OBJ: line 1: 3 numbers are needed"),
        ("v 0 0 nan", "", "line 1: \"nan\" is not a finite number"),
        ("v 0 0 0\nf 1 1 2", "", "line 2: index 2, but there are 1 positions up to here"),
        ("v 0 0 0\nf 1 1 -9223372036854775808", "", "line 2: index -9223372036854775808, but"),
        ("v 0 0 0\nf 1 1 0", "", "line 2: index 0, but there are 1 positions"),
        ("v 0 0 0\nf 1 1 1/18446744073709551615", "", "line 2: \"18446744073709551615\" is not an index"),
        ("v 0 0 0\nf 1 1 1//1", "", "line 2: index 1, but there are 0 normals"),
        ("v 0 0 0\nf 1 1 1/1/1/1", "", "line 2: index 1, but there are 0 texture coordinates"),
        ("v 0 0 0\nf 1 1", "", "line 2: a face of 2 corners"),
        ("v 0 0 0\nf 1 1 /", "", "line 2: \"/\" is not the corner of a face"),
        ("mtllib ../secret.mtl", "", "line 1: \"../secret.mtl\" is outside the scene's folder"),
        ("mtllib /etc/passwd", "", "line 1: \"/etc/passwd\" is an absolute path"),
        ("mtllib some materials.mtl", "Kd 1 1 1", "some materials.mtl: line 1: `Kd` before any newmtl"),
        ("mtllib some materials.mtl", "newmtl a\nKd 1 2", "some materials.mtl: line 2: 3 numbers are needed"),
        ("mtllib some materials.mtl", "newmtl a\nd 2", "line 2: 2 is outside of 0 to 1"),
        ("mtllib some materials.mtl", "newmtl a\nmap_Kd -x 1 a.png", "line 2: \"-x\" is not an option of a texture"),
        ("mtllib some materials.mtl", "newmtl a\nmap_Kd -s 1", "line 2: a texture without a file"),
    ];
    for (obj, mtl, words) in cases {
        let error = load_text(&folder, obj, mtl).unwrap_err().to_string();
        assert!(error.contains(words), "{obj:?}, {mtl:?}: {error}");
    }
}

#[test]
fn what_can_be_done_without_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "mtllib no.mtl\ncurv 0 1 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl none\nf 1 2 3\nf 3 2 1\n";
    let scene = load_text(folder.path(), obj, "").unwrap();
    let found: Vec<_> = scene.warnings.iter().map(|w| w.to_string()).collect();
    let expected = [
        "line 1: \"no.mtl\" cannot be read",
        "line 2: `curv` is not read",
        "line 7: material \"none\" is in no library",
    ];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    assert!(found.iter().zip(expected).all(|(found, expected)| found.starts_with(expected)), "{found:?}");
    assert_eq!(scene.meshes.iter().map(|m| m.triangles.len()).collect::<Vec<_>>(), [1, 2]);
    assert!(scene.materials.iter().all(|m| m.base_color[0] == 0.5));
}

/// Bytes changed at random: a scene that is sound, or an error, and never a panic.
#[test]
fn no_text_makes_it_panic() {
    let folder = tempfile::tempdir().unwrap();
    let (mut sound, mut state) = (0, 20u64);
    let mut random = |n: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    for _ in 0..1000 {
        let mut texts = [SHAPE, LIBRARY].map(|t| t.as_bytes().to_vec());
        for _ in 0..1 + random(4) {
            let text = &mut texts[random(2)];
            let (from, to, length) = (random(text.len()), random(text.len()), 1 + random(6));
            let piece: Vec<u8> = text[from..].iter().take(length).copied().collect();
            match random(3) {
                0 => text[to] = b"0123456789/-. \n\\#\xff"[random(18)],
                1 => drop(text.splice(to..to, piece)),
                _ => drop(text.drain(to..(to + length).min(text.len()))),
            }
        }
        write(folder.path(), "some materials.mtl", &texts[1]);
        if let Ok(scene) = Scene::load(write(folder.path(), "scene.obj", &texts[0])) {
            check(&scene);
            sound += 1;
        }
    }
    println!("seed 20: {sound} of 1000 are scenes");
    assert!((250..950).contains(&sound), "{sound}");
}
