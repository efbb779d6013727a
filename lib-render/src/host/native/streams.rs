//! The kernels `trace` and `shadow` of [`crate::device::stream`], by the native walk: their rows as rays.

use std::ops::Range;

use jerboa_ir::lang::Buf;

use super::{Hit, Native, Ray, Rays, Walkers};
use crate::host::tables::Tables;
use crate::host::wave::Stream;
use crate::schema::{Geometries, Hits, NONE, Next, Paths, Primitives, Shadows, binding};

/// Finds the nearest hits of paths, and who shades them. `begun`: the kernel has found those on cut-outs before.
pub(in crate::host) fn trace(
    native: &Native,
    walkers: &mut Walkers,
    tables: &Tables,
    rows: Range<u32>,
    begun: bool,
    paths: &Stream,
    hits: &mut Stream,
) {
    let words = |binding: usize| &tables.memory[binding].words[..];
    let (primitives, geometries) = (words(binding::<Primitives>()), words(binding::<Geometries>()));
    native.trace(walkers, false, &mut Trace { rows, begun, paths, hits, primitives, geometries });
}

/// Adds the light of shadow rays that no triangle blocks. `goes_on`: of those that are not blocked it leaves the light to the
/// kernel, which asks cut-outs.
pub(in crate::host) fn shadow(
    native: &Native,
    walkers: &mut Walkers,
    rows: Range<u32>,
    goes_on: bool,
    shadows: &mut Stream,
    next: &mut Stream,
) {
    native.trace(walkers, true, &mut Shadow { rows, goes_on, shadows, next });
}

/// The record `Ray` of a row, which begins with it.
#[inline]
fn ray(row: &[u32]) -> Ray {
    const { assert!(Paths::ORG_X.0 == 0 && Shadows::ORG_X.0 == 0) };
    let record: &[u32; 10] = row.first_chunk().expect("a ray has ten words");
    let float = |k: usize| f32::from_bits(record[k]);
    Ray {
        org: [float(0), float(1), float(2)],
        dir: [float(3), float(4), float(5)],
        tmax: float(6),
        skip: [record[7], record[8], record[9]],
    }
}

struct Trace<'a> {
    rows: Range<u32>,
    begun: bool,
    paths: &'a Stream,
    hits: &'a mut Stream,
    primitives: &'a [u32],
    geometries: &'a [u32],
}

impl Trace<'_> {
    /// The class of the geometry of a primitive.
    fn class(&self, primitive: u32) -> u32 {
        let place = |row: u32, columns: usize, column: u32| row as usize * columns + column as usize;
        let geometry = self.primitives[place(primitive, Primitives::COLUMNS.len(), Primitives::GEOMETRY.0)];
        self.geometries[place(geometry, Geometries::COLUMNS.len(), Geometries::CLASS.0)]
    }
}

impl Rays for Trace<'_> {
    #[inline]
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        let row = self.rows.find(|row| self.paths.row(*row as usize)[Paths::ALIVE.0 as usize] != 0)?;
        let ray = ray(self.paths.row(row as usize));
        let before = || {
            let row = self.hits.row(row as usize);
            let float = |column: u32| f32::from_bits(row[column as usize]);
            Hit {
                primitive: row[Hits::PRIMITIVE.0 as usize],
                t: float(Hits::T.0),
                u: float(Hits::U.0),
                v: float(Hits::V.0),
            }
        };
        Some((row, ray, if self.begun { before() } else { Hit::miss(ray.tmax) }))
    }

    #[inline]
    fn done(&mut self, row: u32, hit: Hit) {
        let class = if hit.primitive == NONE { NONE } else { self.class(hit.primitive) };
        let row = self.hits.row_mut(row as usize);
        let words = [
            (Hits::PRIMITIVE.0, hit.primitive),
            (Hits::T.0, hit.t.to_bits()),
            (Hits::U.0, hit.u.to_bits()),
            (Hits::V.0, hit.v.to_bits()),
            (Hits::CLASS.0, class),
        ];
        words.into_iter().for_each(|(column, word)| row[column as usize] = word);
    }
}

struct Shadow<'a> {
    rows: Range<u32>,
    goes_on: bool,
    shadows: &'a Stream,
    next: &'a mut Stream,
}

impl Rays for Shadow<'_> {
    #[inline]
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        let row = self.rows.find(|row| self.next.row(*row as usize)[Next::ASKED.0 as usize] != 0)?;
        let ray = ray(self.shadows.row(row as usize));
        Some((row, ray, Hit::miss(ray.tmax)))
    }

    #[inline]
    fn done(&mut self, row: u32, hit: Hit) {
        let (shadow, next) = (self.shadows.row(row as usize), self.next.row_mut(row as usize));
        let is_free = hit.primitive == NONE;
        if is_free && self.goes_on {
            return;
        }
        next[Next::ASKED.0 as usize] = 0;
        for (sum, light) in [(Next::R, Shadows::R), (Next::G, Shadows::G), (Next::B, Shadows::B)] {
            let (sum, light) = (&mut next[sum.0 as usize], f32::from_bits(shadow[light.0 as usize]));
            // Black is added too, as the kernel does: it makes −0 a 0.
            *sum = (f32::from_bits(*sum) + if is_free { light } else { 0.0 }).to_bits();
        }
    }
}
