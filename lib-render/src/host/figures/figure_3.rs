//! Figure 3: a physically corrected Phong shader whose parameters are constants or textures, specialised or not.
//!
//! As in the paper (section 5.3), each of 4,096 rays has a number S: with S = 0 `kd`, `ks` and the exponent are constants, with
//! S = 1 `kd` is a texture, with S = 2 `ks`, with S = 3 both. Four batches have the rays of one S. In the others all four are
//! mixed, either as they come, so that lanes disagree, or sorted by S, so that the specialised code is four kernels.

use jerboa_backend_cranelift as clif;
use jerboa_peval::{Arg, Generic};
use jerboa_scenes::{Filter, Material, Model, Scene, Texture, TextureRef, TextureSource};

use super::batch::{Batch, RAYS, anew, compile, texels};
use super::kernels::phong;
use super::{Chart, Group, LEVELS, Spread};
use crate::host::error::Error;
use crate::host::tables::{Choices, Known, Tables};

/// Values of S.
const SHADERS: u32 = 4;

/// A batch: its name, the S of each ray, and the ranges of rays whose S is the same, if it has any.
type Order = (&'static str, fn(u32) -> u32, Option<&'static [u32]>);

/// The batches.
const ORDERS: [Order; 6] = [
    ("S = 0", |_| 0, Some(&[0])),
    ("S = 1", |_| 1, Some(&[1])),
    ("S = 2", |_| 2, Some(&[2])),
    ("S = 3", |_| 3, Some(&[3])),
    ("all S, as they come", |i| i % SHADERS, None),
    ("all S, sorted", |i| i / (RAYS / SHADERS), Some(&[0, 1, 2, 3])),
];

/// What is known of the scene: its tables, a kernel for each S, and one for any.
struct Level {
    tables: Tables,
    of: Vec<clif::Code>,
    any: clif::Code,
}

impl Level {
    fn new(generic: &Generic, scene: &Scene, known: Known) -> Result<Level, Error> {
        let tables = Tables::new(scene, &Choices::default(), known);
        let kernel =
            |class| compile(generic, "shade", &[class, Arg::Unknown, Arg::Unknown], &tables, &clif::Options::default());
        // With nothing known there is one class, and one kernel.
        let classes = if known == Known::Nothing { 0 } else { SHADERS };
        let of = (0..classes).map(|s| kernel(Arg::Class(s))).collect::<Result<Vec<_>, Error>>()?;
        let any = kernel(Arg::Unknown)?;
        Ok(Level { of, any, tables })
    }

    /// Shades a batch.
    fn shade(&self, batch: &mut Batch, ranges: Option<&[u32]>) -> Result<(), Error> {
        let Some(ranges) = ranges.filter(|_| !self.of.is_empty()) else {
            return batch.run(&self.any, &self.tables, &[0, 0, RAYS]);
        };
        let rays = RAYS / ranges.len() as u32;
        ranges.iter().zip(0..).try_for_each(|(s, range)| {
            batch.run(&self.of[*s as usize], &self.tables, &[0, range * rays, (range + 1) * rays])
        })
    }
}

/// Shades each batch by code of each level, in so many rounds.
///
/// # Errors
/// When the evaluator, the code generator or a kernel gives up, or two levels give different results: a fault of Jerboa.
pub fn measure(rounds: u32) -> Result<Vec<Chart>, Error> {
    let (generic, scene) = (Generic::new(phong()), scene());
    let mut batches = ORDERS.map(|(_, material, ranges)| (Batch::new(|_, _| 0, material), ranges));
    let times = anew(rounds, || {
        let levels = LEVELS.map(|(known, _)| Level::new(&generic, &scene, known));
        let levels = levels.into_iter().collect::<Result<Vec<Level>, Error>>()?;
        let mut times = Vec::new();
        for (batch, ranges) in &mut batches {
            let mut first: Option<Vec<u32>> = None;
            for level in &levels {
                level.shade(batch, *ranges)?;
                if *first.get_or_insert_with(|| batch.shaded.clone()) != batch.shaded {
                    return Err(Error::new("two levels of knowledge shade differently: a fault of Jerboa"));
                }
                times.push(batch.time(|batch| level.shade(batch, *ranges))?);
            }
        }
        Ok((levels, times))
    })?;
    let group = |((name, ..), times): (Order, &[Spread])| Group {
        name: name.into(),
        bars: times.iter().copied().map(Some).collect(),
        notes: vec![("gain by structure".into(), times[0].median / times[1].median)],
    };
    Ok(vec![Chart {
        title: "Phong with constants and textures".into(),
        unit: "ns a ray",
        stacked: false,
        series: LEVELS.map(|(_, name)| name.to_string()).to_vec(),
        groups: ORDERS.into_iter().zip(times.chunks(LEVELS.len())).map(group).collect(),
    }])
}

/// Four materials, S the number of each.
fn scene() -> Scene {
    let texture = Texture::repeating("texture", TextureSource::Image(0), Filter::Bilinear);
    let use_ = |yes: bool| yes.then_some(TextureRef { texture: 0, uv_set: 0, transform: None });
    let material = |s: u32| Material {
        base_color_texture: use_(s & 1 != 0),
        specular_color_texture: use_(s & 2 != 0),
        model: Some(Model::named("phong").with("ks", &[0.4, 0.3, 0.2]).with("ns", &[40.0])),
        ..Material::diffuse(&format!("S = {s}"), [0.5, 0.6, 0.7])
    };
    Scene {
        name: "figure-3".into(),
        materials: (0..SHADERS).map(material).collect(),
        textures: vec![texture],
        images: vec![texels()],
        ..Scene::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_s_has_a_shader_of_its_own() {
        let (generic, scene) = (Generic::new(phong()), scene());
        let level = Level::new(&generic, &scene, Known::Structure).expect("it compiles");
        let shaded = ORDERS.map(|(name, s, ranges)| {
            let mut batch = Batch::new(|_, _| 0, s);
            level.shade(&mut batch, ranges).expect(name);
            let specialised = batch.shaded.clone();
            level.shade(&mut batch, None).expect(name);
            assert!(specialised == batch.shaded, "{name}: the kernel of one S and that of all differ");
            specialised
        });
        for s in 0..ORDERS.len() {
            assert!(shaded[..s].iter().all(|other| *other != shaded[s]), "{}: as another batch", ORDERS[s].0);
        }
    }
}
