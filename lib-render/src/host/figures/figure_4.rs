//! Figure 4: the interfaces between shader and texture, and between shader and attributes, specialised or not.
//!
//! A simple diffuse shader (paper, section 5.4) asks for the surface at a hit and for the colour of its texture there. Both are
//! functions with a filter, and the filter is all that differs: true unfolds the call where everything is known and only the
//! normal, a set of coordinates and a colour are asked for; false leaves a call, of a function that finds out at run time what
//! kind of texture or mesh there is, and gives all that a shader may want to know. Half of the rays hit one kind of mesh, half
//! another with another kind of texture; each has its shader, and both call the same functions.

use glam::{DAffine3, Vec2, Vec3, Vec4};
use jerboa_backend_cranelift as clif;
use jerboa_peval::{Arg, Generic};
use jerboa_scenes::{Filter, Instance, Material, Mesh, Scene, Texture, TextureRef, TextureSource, Wrap};

use super::batch::{Batch, RAYS, anew, compile, texels};
use super::kernels::{INTERFACES, Interfaces, interfaces};
use super::{Chart, Group, Spread};
use crate::host::error::Error;
use crate::host::tables::{Choices, Known, Tables};

/// The devices: with lanes, and without.
const DEVICES: [(&str, bool); 2] = [("in lanes", true), ("not in lanes", false)];

/// Rays before this one hit the first mesh, the others the second.
const MIDDLE: u32 = RAYS / 2;

/// The sphere has so many quads around it, and half as many from pole to pole.
const AROUND: u32 = 32;

/// Shades a batch by code of each combination, in so many rounds.
///
/// # Errors
/// When the evaluator, the code generator or a kernel gives up, or two combinations give different results: a fault of Jerboa.
pub fn measure(rounds: u32) -> Result<Vec<Chart>, Error> {
    let (generic, scene) = (Generic::new(interfaces()), scene());
    let tables = Tables::new(&scene, &Choices::default(), Known::All);
    let triangles = scene.meshes[0].triangles.len() as u32;
    let choose = |ray: u32, random: u32| random % triangles + if ray < MIDDLE { 0 } else { triangles };
    let mut batch = Batch::new(choose, |_| 0);
    let times = anew(rounds, || {
        let (mut codes, mut times, mut first) = (Vec::new(), Vec::new(), None);
        for (Interfaces { name, .. }, (_, lanes)) in INTERFACES.iter().flat_map(|i| DEVICES.map(|d| (i, d))) {
            let usual = clif::Options::default();
            let options = clif::Options { lanes: usual.lanes.filter(|_| lanes), ..usual };
            let code = compile(&generic, name, &[Arg::Unknown; 2], &tables, &options)?;
            batch.run(&code, &tables, &[MIDDLE, RAYS])?;
            if *first.get_or_insert_with(|| batch.shaded.clone()) != batch.shaded {
                return Err(Error::new("two ways of specialisation shade differently: a fault of Jerboa"));
            }
            times.push(batch.time(|batch| batch.run(&code, &tables, &[MIDDLE, RAYS]))?);
            codes.push(code);
        }
        Ok((codes, times))
    })?;
    let neither = [times[0].median, times[1].median];
    let group = |(Interfaces { name, .. }, times): (Interfaces, &[Spread])| Group {
        name: name.into(),
        bars: times.iter().copied().map(Some).collect(),
        notes: DEVICES
            .iter()
            .zip(neither.iter().zip(times))
            .map(|((device, _), (neither, time))| (format!("gain {device}"), neither / time.median))
            .collect(),
    };
    Ok(vec![Chart {
        title: "Interfaces that are specialised".into(),
        unit: "ns a ray",
        stacked: false,
        series: DEVICES.map(|(name, _)| name.to_string()).to_vec(),
        groups: INTERFACES.into_iter().zip(times.chunks(DEVICES.len())).map(group).collect(),
    }])
}

/// A sphere that has every attribute and a filtered texture, and one that has coordinates alone and another kind of texture.
fn scene() -> Scene {
    let texture = |wrap, filter| Texture {
        wrap_s: wrap,
        wrap_t: wrap,
        ..Texture::repeating("texture", TextureSource::Image(0), filter)
    };
    let material = |texture| Material {
        base_color_texture: Some(TextureRef { texture, uv_set: 0, transform: None }),
        ..Material::diffuse("textured", [1.0; 3])
    };
    let rich = sphere();
    let plain = Mesh { normals: None, tangents: None, uvs: [rich.uvs[0].clone(), None], material: 1, ..rich.clone() };
    Scene {
        name: "figure-4".into(),
        materials: vec![material(0), material(1)],
        textures: vec![texture(Wrap::Repeat, Filter::Bilinear), texture(Wrap::Clamp, Filter::Nearest)],
        images: vec![texels()],
        meshes: vec![rich, plain],
        instances: (0..2).map(|mesh| Instance { mesh, to_world: DAffine3::IDENTITY }).collect(),
        ..Scene::default()
    }
}

/// A sphere with normals, tangents and both sets of coordinates.
fn sphere() -> Mesh {
    let (columns, rows) = (AROUND, AROUND / 2);
    let at = |i: u32| Vec2::new((i % (columns + 1)) as f32 / columns as f32, (i / (columns + 1)) as f32 / rows as f32);
    let uvs: Vec<Vec2> = (0..(columns + 1) * (rows + 1)).map(at).collect();
    // The poles are left out: triangles there would be points.
    let angles = |uv: &Vec2| (uv.x * std::f32::consts::TAU, 0.1 + uv.y * (std::f32::consts::PI - 0.2));
    let point = |uv: &Vec2| {
        let (phi, theta) = angles(uv);
        Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    };
    let tangent = |uv: &Vec2| Vec4::new(-angles(uv).0.sin(), angles(uv).0.cos(), 0.0, 1.0);
    let quad = |q: u32| {
        let first = q / columns * (columns + 1) + q % columns;
        let below = first + columns + 1;
        [[first, below, first + 1], [first + 1, below, below + 1]]
    };
    let positions: Vec<Vec3> = uvs.iter().map(point).collect();
    Mesh {
        normals: Some(positions.clone()),
        positions,
        tangents: Some(uvs.iter().map(tangent).collect()),
        triangles: (0..columns * rows).flat_map(quad).collect(),
        uvs: [Some(uvs.clone()), Some(uvs)],
        ..Mesh::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interface_that_is_not_specialised_is_a_function() {
        let (generic, scene) = (Generic::new(interfaces()), scene());
        let tables = Tables::new(&scene, &Choices::default(), Known::All);
        let functions = INTERFACES.map(|Interfaces { name, .. }| {
            let options = clif::Options { lanes: None, ..Default::default() };
            let code = compile(&generic, name, &[Arg::Unknown; 2], &tables, &options).expect(name);
            code.reports().map(|r| r.functions).sum::<usize>()
        });
        let both = functions[3];
        assert_eq!(functions, [both + 2, both + 1, both + 1, both]);
    }
}
