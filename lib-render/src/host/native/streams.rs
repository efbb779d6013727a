//! The kernels `trace` and `shadow` of [`crate::device::stream`], by the native walk: their rows as rays.

use std::ops::Range;

use jerboa_ir::lang::Buf;

use super::{Hit, Native, Ray, Rays, Walkers, Wanted};
use crate::host::tables::Tables;
use crate::host::wave::Stream;
use crate::schema::{Geometries, Hits, NONE, Next, Paths, Primitives, Shadows, binding};

/// Finds the nearest hits of paths, and who shades them. `begun`: the kernel has found those on cut-outs before.
pub(in crate::host) fn trace(
    native: &Native,
    walkers: &mut Walkers,
    wanted: Wanted,
    tables: &Tables,
    rows: Range<u32>,
    begun: bool,
    (paths, hits): (&Stream, &mut Stream),
) {
    let words = |binding: usize| &tables.memory[binding].words[..];
    let (primitives, geometries) = (words(binding::<Primitives>()), words(binding::<Geometries>()));
    native.trace(walkers, wanted, &mut Trace { rows, begun, paths, hits, primitives, geometries });
}

/// Hides from the kernel, which asks cut-outs, the paths whose rays pass them by: they hit nothing there. Gives their rows
/// and what [`show`] puts back.
pub(in crate::host) fn hide(
    native: &Native,
    walkers: &mut Walkers,
    rows: Range<u32>,
    paths: &mut Stream,
    hits: &mut Stream,
) -> Vec<(u32, u32)> {
    let mut hide = Hide { rows, paths, hits, hidden: Vec::new() };
    native.outside(walkers, &mut hide);
    hide.hidden
}

/// Shows hidden paths again.
pub(in crate::host) fn show(paths: &mut Stream, hidden: &[(u32, u32)]) {
    for (row, alive) in hidden {
        paths.row_mut(*row as usize)[Paths::ALIVE.0 as usize] = *alive;
    }
}

/// Adds the light of shadow rays that no triangle blocks. Of those that may meet cut-outs it leaves the light to the kernel,
/// which asks them.
pub(in crate::host) fn shadow(
    native: &Native,
    walkers: &mut Walkers,
    rows: Range<u32>,
    shadows: &mut Stream,
    next: &mut Stream,
) {
    let mut all = Shadow { rows: rows.clone(), goes_on: !native.is_all(), shadows, next };
    native.trace(walkers, Wanted::Any, &mut all);
    if all.goes_on {
        native.outside(walkers, &mut Shadow { rows, goes_on: false, ..all });
    }
}

/// The record `Ray` of a row, which begins with it.
#[inline(always)]
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

/// The next row of a path that goes on.
#[inline(always)]
fn live(rows: &mut Range<u32>, paths: &Stream) -> Option<u32> {
    rows.find(|row| paths.row(*row as usize)[Paths::ALIVE.0 as usize] != 0)
}

/// Notes what a path hits.
#[inline(always)]
fn put(hits: &mut Stream, row: u32, hit: Hit, class: u32) {
    let row = hits.row_mut(row as usize);
    let words = [
        (Hits::PRIMITIVE.0, hit.primitive),
        (Hits::T.0, hit.t.to_bits()),
        (Hits::U.0, hit.u.to_bits()),
        (Hits::V.0, hit.v.to_bits()),
        (Hits::CLASS.0, class),
    ];
    words.into_iter().for_each(|(column, word)| row[column as usize] = word);
}

struct Hide<'a> {
    rows: Range<u32>,
    paths: &'a mut Stream,
    hits: &'a mut Stream,
    hidden: Vec<(u32, u32)>,
}

impl Rays for Hide<'_> {
    #[inline(always)]
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        let row = live(&mut self.rows, self.paths)?;
        let ray = ray(self.paths.row(row as usize));
        Some((row, ray, Hit::miss(ray.tmax)))
    }

    #[inline(always)]
    fn done(&mut self, row: u32, hit: Hit) {
        put(self.hits, row, hit, NONE);
        let alive = &mut self.paths.row_mut(row as usize)[Paths::ALIVE.0 as usize];
        self.hidden.push((row, std::mem::take(alive)));
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
        let geometry = self.primitives[geometry_of(primitive)] as usize;
        self.geometries[geometry * Geometries::COLUMNS.len() + Geometries::CLASS.0 as usize]
    }
}

impl Rays for Trace<'_> {
    #[inline(always)]
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        let row = live(&mut self.rows, self.paths)?;
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

    #[inline(always)]
    fn done(&mut self, row: u32, hit: Hit) {
        let class = if hit.primitive == NONE { NONE } else { self.class(hit.primitive) };
        put(self.hits, row, hit, class);
    }

    #[inline(always)]
    fn needs(&self, primitive: u32) -> *const u32 {
        self.primitives.as_ptr().wrapping_add(geometry_of(primitive))
    }
}

/// Where the geometry of a primitive is, in their table.
#[inline(always)]
fn geometry_of(primitive: u32) -> usize {
    primitive as usize * Primitives::COLUMNS.len() + Primitives::GEOMETRY.0 as usize
}

struct Shadow<'a> {
    rows: Range<u32>,
    goes_on: bool,
    shadows: &'a Stream,
    next: &'a mut Stream,
}

impl Rays for Shadow<'_> {
    #[inline(always)]
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        let row = self.rows.find(|row| self.next.row(*row as usize)[Next::ASKED.0 as usize] != 0)?;
        let ray = ray(self.shadows.row(row as usize));
        Some((row, ray, Hit::miss(ray.tmax)))
    }

    #[inline(always)]
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
