//! The traversal as kernels: rays of one stream, hits to another.

use jerboa_backend_cranelift as clif;
use jerboa_ir::lang::{Block, Bool, Fun, U32, build, declare, entry, spec};
use jerboa_peval::{Arg, Generic, specialize};

use crate::core::vec::vec3;
use crate::host::error::Error;
use crate::host::tables::Tables;
use crate::ray::Ray;
use crate::schema::{BUFFERS, NONE};
use crate::traverse::AcceptFn;
use crate::traverse::turns::{self, Question};

jerboa_ir::stream! {
    /// Rays to trace: those of [`Ray`], which skip nothing.
    pub RayQueue {
        /// Origin, m.
        ORG_X: F32;
        /// See [`RayQueue::ORG_X`].
        ORG_Y: F32;
        /// See [`RayQueue::ORG_X`].
        ORG_Z: F32;
        /// Direction.
        DIR_X: F32;
        /// See [`RayQueue::DIR_X`].
        DIR_Y: F32;
        /// See [`RayQueue::DIR_X`].
        DIR_Z: F32;
        /// End of the range.
        TMAX: F32;
    }
}

jerboa_ir::stream! {
    /// What they hit: those of [`Hit`].
    pub HitQueue {
        /// The primitive, or `NONE`.
        PRIMITIVE: U32;
        /// Distance in units of the direction.
        T: F32;
    }
}

/// The kernels `nearest` and `any`: rays of one stream, hits to the other.
pub(super) fn compile(tables: &Tables) -> Result<clif::Code, Error> {
    let program = build(|| {
        declare(&[BUFFERS, &[spec::<RayQueue>(), spec::<HitQueue>()]].concat());
        for (name, any_hit) in [("nearest", false), ("any", true)] {
            entry(name, Fun::<U32, ()>::named(name, move |b, count| trace(b, count, any_hit)));
        }
    });
    let generic = Generic::new(program);
    let residual = |name| {
        specialize(&generic, name, &[Arg::Unknown], &tables.facts, &Default::default())
            .map_err(|e| Error::new(e.to_string()))
    };
    let (nearest, any) = (residual("nearest")?, residual("any")?);
    clif::compile(&[&nearest.program, &any.program], &clif::Options::default()).map_err(|e| Error::new(e.to_string()))
}

fn trace(b: &mut Block, count: U32, any_hit: bool) {
    let ask = |b: &mut Block, i: U32| Question {
        is_asked: true.into(),
        ray: load_ray(b, i),
        accept: AcceptFn::lam(|_, _| Bool::from(true)),
    };
    turns::trace(b, (0.into(), count), any_hit, ask, |b, i, hit| {
        b.store(HitQueue::PRIMITIVE, i, hit.primitive);
        b.store(HitQueue::T, i, hit.t);
    });
}

fn load_ray(b: &mut Block, i: U32) -> Ray {
    let [ox, oy, oz] = [RayQueue::ORG_X, RayQueue::ORG_Y, RayQueue::ORG_Z].map(|c| b.load(c, i));
    let [dx, dy, dz] = [RayQueue::DIR_X, RayQueue::DIR_Y, RayQueue::DIR_Z].map(|c| b.load(c, i));
    let none = U32::from(NONE);
    let tmax = b.load(RayQueue::TMAX, i);
    Ray { org: vec3(ox, oy, oz), dir: vec3(dx, dy, dz), tmax, skip: none, skip1: none, skip2: none }
}
