//! Lights that rays see though they have no surface: [spheres](crate::light::sphere), [disks](crate::light::disk) and
//! [suns](crate::light::sun).
//!
//! A ray goes through them, and brings what each of them gives on the way to what it hits. Each is asked by each ray: they are
//! meant for tens, not thousands. In a scene without them nothing of this is in a kernel.

use jerboa_ir::impl_staged;
use jerboa_ir::lang::{Block, Bool, F32, Row, U32};

use crate::components::Components;
use crate::core::color::{Color, black};
use crate::core::vec::Vec3;
use crate::light::{disk, sphere, sun, with_choice};
use crate::schema::*;
use crate::texture::Lookup;

/// A light that a ray meets.
#[derive(Clone, Copy)]
pub struct Met {
    /// Does it? Else nothing of the rest means anything.
    pub is_met: Bool,
    /// Along the ray, towards its origin.
    pub radiance: Color,
    /// Density with which light sampling finds the ray's direction, per steradian, the choice of the light included.
    pub pdf_dir: F32,
    /// From the origin, m; infinite for a sun.
    pub distance: F32,
}
impl_staged!(Met { is_met, radiance, pdf_dir, distance });

impl Met {
    fn nothing() -> Met {
        let zero = F32::from(0.0);
        Met { is_met: false.into(), radiance: black(), pdf_dir: zero, distance: zero }
    }
}

/// What few scenes have, in the order of the rows in [`Models`], after those of what textures ask for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Seen {
    /// A sphere or a disk.
    Shape,
    /// A sun.
    Sun,
}

impl Seen {
    /// All of them.
    pub const ALL: [Seen; 2] = [Seen::Shape, Seen::Sun];

    /// Has the scene one?
    pub fn is_used(self) -> Bool {
        let row = Lookup::Border.row(Components::current().models().len()) + Lookup::ALL.len() + self as usize;
        Row::<Models>::at(row as u32).get(Models::USED)
    }
}

/// What `value` makes of each sphere and each disk that a ray (its direction unit) meets before this distance, in sum.
pub fn sum_of_shapes(
    b: &mut Block,
    org: Vec3,
    dir: Vec3,
    until: F32,
    value: impl Fn(&mut Block, Met) -> Color,
) -> Color {
    sum(b, 0.into(), settings().get(Settings::SHAPES), |b, light| {
        let row = Row::<Lights>::at(light);
        let met = b.dispatch(row, |b, row| {
            let (ball, disk) = (|_: &mut Block| sphere::meet(row, org, dir), |_: &mut Block| disk::meet(row, org, dir));
            b.switch(row.get(Lights::KIND), &[(LIGHT_SPHERE, &ball), (LIGHT_DISK, &disk)], |_| Met::nothing())
        });
        let seen = |b: &mut Block| {
            let pdf_dir = with_choice(b, light, org, met.pdf_dir);
            value(b, Met { pdf_dir, ..met })
        };
        b.if_(met.is_met & met.distance.lt(until), seen, |_| black())
    })
}

/// What `value` makes of each sun in a unit direction, in sum.
pub fn sum_of_suns(b: &mut Block, dir: Vec3, value: impl Fn(&mut Block, Met) -> Color) -> Color {
    sum(b, settings().get(Settings::SHAPES), settings().get(Settings::SUNS), |b, light| {
        let met = sun::meet(Row::at(light), dir);
        b.if_(met.is_met, |b| value(b, met), |_| black())
    })
}

/// Over so many rows of [`SeenLights`] from this one on; each is a row of [`Lights`].
fn sum(b: &mut Block, first: U32, count: U32, term: impl Fn(&mut Block, U32) -> Color) -> Color {
    let end = first + count;
    let step = |b: &mut Block, (i, sum): (U32, Color)| {
        let light = Row::<SeenLights>::at(i).get(SeenLights::LIGHT);
        let sum = sum + term(b, light);
        (i + 1u32, sum)
    };
    b.while_((first, black()), |_, (i, _)| i.lt(end), step).1
}

fn settings() -> Row<Settings> {
    Row::at(0u32)
}
