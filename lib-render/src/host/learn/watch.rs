//! Follows paths of one thread from vertex to vertex, and when one has ended tells what it had found behind each.

use std::sync::Arc;

use super::Learner;
use crate::host::image_io::luminance;
use crate::host::wave::Stream;
use crate::schema::{NONE, Next};

/// What a path found after a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Luminance, over the throughput that roulette is told.
    pub light: f64,
    /// Rays it took.
    pub rays: u32,
}

/// Where a path went on.
struct Vertex {
    /// Its vertex before; `NONE` for none.
    before: u32,
    /// The row of cells and directions.
    row: u32,
    /// Throughput behind it, as roulette is told: the light counts by it.
    throughput: f32,
    /// Luminance found up to here.
    light: f64,
    /// Rays up to here.
    rays: u32,
}

/// The paths of one thread in one pass.
pub struct Watch {
    learner: Arc<Learner>,
    vertices: Vec<Vertex>,
    /// Places in `vertices` that are free again.
    free: Vec<u32>,
    /// The last vertex of each path, by the number of its item.
    last: Vec<u32>,
    /// Where paths of the first sample were scattered.
    places: Vec<[f32; 3]>,
}

impl Watch {
    /// Who tells that learner.
    pub fn new(learner: Arc<Learner>) -> Watch {
        Watch { learner, vertices: Vec::new(), free: Vec::new(), last: Vec::new(), places: Vec::new() }
    }

    /// Look at paths that were taken one vertex further.
    pub(in crate::host) fn look(&mut self, next: &Stream, rows: usize) {
        for path in (0..rows).map(|row| next.row(row)) {
            let number = |column: u32| path[column as usize];
            let float = |column: u32| f32::from_bits(number(column));
            let is_alive = number(Next::ALIVE.0) != 0;
            let org = [Next::ORG_X, Next::ORG_Y, Next::ORG_Z].map(|c| float(c.0));
            if self.learner.is_first() {
                self.places.extend(is_alive.then_some(org));
                continue;
            }
            let (item, rays) = (number(Next::ITEM.0), number(Next::CLOSEST.0) + number(Next::SHADOW.0));
            let light = luminance([Next::R, Next::G, Next::B].map(|c| float(c.0)));
            if is_alive {
                let dir = [Next::DIR_X, Next::DIR_Y, Next::DIR_Z].map(|c| float(c.0));
                let throughput = [Next::THROUGHPUT_R, Next::THROUGHPUT_G, Next::THROUGHPUT_B].map(|c| float(c.0));
                let throughput = throughput.into_iter().fold(0.0, f32::max) / float(Next::RADIANCE_SCALE.0);
                let row = self.learner.row(org, dir);
                self.push(item, Vertex { before: NONE, row, throughput, light, rays });
            } else {
                self.end(item, light, rays);
            }
        }
    }

    fn push(&mut self, item: u32, vertex: Vertex) {
        let item = item as usize;
        if self.last.len() <= item {
            self.last.resize(item + 1, NONE);
        }
        let vertex = Vertex { before: self.last[item], ..vertex };
        self.last[item] = match self.free.pop() {
            Some(place) => {
                self.vertices[place as usize] = vertex;
                place
            }
            None => {
                self.vertices.push(vertex);
                self.vertices.len() as u32 - 1
            }
        };
    }

    /// A path has ended, with so much light and after so many rays.
    fn end(&mut self, item: u32, light: f64, rays: u32) {
        let Some(last) = self.last.get_mut(item as usize) else { return };
        let mut at = std::mem::replace(last, NONE);
        while at != NONE {
            let vertex = &self.vertices[at as usize];
            let found =
                Found { light: (light - vertex.light) / f64::from(vertex.throughput), rays: rays - vertex.rays };
            self.learner.add_light(vertex.row, found);
            self.free.push(at);
            at = vertex.before;
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.learner.add_places(&mut self.places);
    }
}
