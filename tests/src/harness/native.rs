//! The native walk, asked what rays hit.

use jerboa_lib_render::host::bvh::{Bounds, Triangle};
use jerboa_lib_render::host::native::{Hit, Native, Ray, Rays, Walkers};
use jerboa_lib_render::schema::NONE;

/// A ray as kernels take it; see [`super::rays::ray`].
pub type Words = [u32; 10];

/// For each ray the words of its hit; `None` where the processor has no native walk.
pub fn hits(triangles: &[Triangle], any_hit: bool, rays: &[Words]) -> Option<Vec<[u32; 4]>> {
    if !Native::is_there() {
        println!("no native walk: this processor has no AVX-512");
        return None;
    }
    // What nobody hands in is no hit that any test expects.
    let mut asked = Asked { rays, next: 0, hits: vec![[NONE - 1; 4]; rays.len()], handed_in: 0 };
    Native::new(triangles, Bounds::EMPTY).0.trace(&mut Walkers::default(), any_hit, &mut asked);
    assert_eq!(asked.handed_in, rays.len(), "each ray has one hit");
    Some(asked.hits)
}

struct Asked<'a> {
    rays: &'a [Words],
    next: usize,
    hits: Vec<[u32; 4]>,
    handed_in: usize,
}

impl Rays for Asked<'_> {
    fn next(&mut self) -> Option<(u32, Ray, Hit)> {
        let words = self.rays.get(self.next)?;
        let float = |k: usize| f32::from_bits(words[k]);
        self.next += 1;
        let ray = Ray {
            org: [float(0), float(1), float(2)],
            dir: [float(3), float(4), float(5)],
            tmax: float(6),
            skip: [words[7], words[8], words[9]],
        };
        Some((self.next as u32 - 1, ray, Hit::miss(ray.tmax)))
    }

    fn done(&mut self, number: u32, hit: Hit) {
        self.hits[number as usize] = [hit.primitive, hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits()];
        self.handed_in += 1;
    }
}
