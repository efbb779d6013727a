//! The native walk, asked what rays hit.

use jerboa_lib_render::host::bvh::{Bvh, Triangle};
use jerboa_lib_render::host::native::{Hit, Native, Ray, Rays, Walkers, Wanted};
use jerboa_lib_render::schema::NONE;

/// A ray as kernels take it; see [`super::rays::ray`].
pub type Words = [u32; 10];

/// For each ray the words of its hit; `None` where the processor has no native walk. With a tree and as the walk chooses,
/// and with a tree sixteen at a time, which finds the same.
pub fn hits(triangles: &[Triangle], any_hit: bool, rays: &[Words]) -> Option<Vec<[u32; 4]>> {
    if !Native::is_there() {
        println!("no native walk: this processor has no AVX-512");
        return None;
    }
    let (tree, chosen) = (Native::with_tree(triangles, &[]).0, Native::new(triangles, &[]).0);
    if any_hit {
        let (walk, chosen) = (hits_by(&tree, Wanted::Any, rays), hits_by(&chosen, Wanted::Any, rays));
        for ((walk, chosen), ray) in walk.iter().zip(&chosen).zip(rays) {
            // Of any hit, only whether there is one has a meaning.
            assert_eq!(walk[0] == NONE, chosen[0] == NONE, "{ray:x?}");
        }
        return Some(chosen);
    }
    let walk = hits_by(&tree, Wanted::Nearest, rays);
    let chosen = hits_by(&chosen, Wanted::Nearest, rays);
    for ((walk, chosen), ray) in walk.iter().zip(&chosen).zip(rays) {
        assert_eq!(walk, chosen, "{ray:x?}");
    }
    let bundles: Vec<Words> = rays.iter().step_by(SIXTEEN).flat_map(bundle).collect();
    let [each, together] = [Wanted::Nearest, Wanted::NearestTogether].map(|wanted| hits_by(&tree, wanted, &bundles));
    for ((each, together), ray) in each.iter().zip(&together).zip(&bundles) {
        assert_eq!(each, together, "{ray:x?}");
    }
    Some(chosen)
}

/// So many rays are one bundle.
const SIXTEEN: usize = 16;

/// A ray and others that go much the same way from the same place, some beyond an axis along which it goes.
fn bundle(ray: &Words) -> [Words; SIXTEEN] {
    let dir = [3, 4, 5].map(|k| f32::from_bits(ray[k]));
    let longest = dir.into_iter().fold(0.0, |most: f32, x| most.max(x.abs()));
    std::array::from_fn(|lane| {
        let mut near = *ray;
        for k in 0..3 {
            // Sixteen steps, in another order along each axis.
            let step = (lane * [1, 5, 11][k] % SIXTEEN) as f32 / SIXTEEN as f32;
            near[3 + k] = (dir[k] + step / 32.0 * longest).to_bits();
        }
        near
    })
}

/// The numbers of the rays that the walk says pass by all of these triangles, which lie in the boxes of their tree; `None`
/// where the processor has no native walk.
pub fn outside(triangles: &[Triangle], rays: &[Words]) -> Option<Vec<usize>> {
    if !Native::is_there() {
        return None;
    }
    const NOBODY: [u32; 4] = [NONE - 1; 4];
    let mut asked = Asked { rays, next: 0, hits: vec![NOBODY; rays.len()], handed_in: 0 };
    let (native, _) = Native::new(&[], &Bvh::build(triangles).parts());
    native.outside(&mut Walkers::default(), &mut asked);
    Some((0..rays.len()).filter(|ray| asked.hits[*ray] != NOBODY).collect())
}

fn hits_by(native: &Native, wanted: Wanted, rays: &[Words]) -> Vec<[u32; 4]> {
    // What nobody hands in is no hit that any test expects.
    let mut asked = Asked { rays, next: 0, hits: vec![[NONE - 1; 4]; rays.len()], handed_in: 0 };
    native.trace(&mut Walkers::default(), wanted, &mut asked);
    assert_eq!(asked.handed_in, rays.len(), "each ray has one hit");
    asked.hits
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
