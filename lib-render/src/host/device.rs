//! Which kernels a device has, and what is known of their parameters.

use jerboa_peval::Arg;

use super::generate::{Request, TracerKind};
use super::tables::Tables;
use crate::device::stream::kernel_name;
use crate::schema::{Geometries, binding};

/// Where paths are traced. The image is the same.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum DeviceKind {
    /// Streams of paths on the CPU, sorted by shader: see [`super::wave`].
    #[default]
    Cpu,
    /// One path after the other on the CPU, in one kernel.
    CpuScalar,
}

/// Who walks the tree on [`DeviceKind::Cpu`]. The image is the same.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Traversal {
    /// The native walk, where the processor has its instructions and the scene no cut-outs; see [`super::native`].
    #[default]
    Native,
    /// A kernel, as on other devices; see [`crate::traverse`].
    Ir,
}

/// Most kernels that shade. If there are more classes of shaders, the last kernel shades all of those that have none of their
/// own, so that the time of specialisation does not grow with the scene.
pub const MOST_CLASSES: u32 = 64;

impl DeviceKind {
    /// All of them.
    pub const ALL: [DeviceKind; 2] = [DeviceKind::Cpu, DeviceKind::CpuScalar];

    /// The kernels that show what a tracer shows. Those of [`DeviceKind::Cpu`] are `generate`, `trace`, `miss`, `shadow` and
    /// a `shade` for each class, in this order; beyond [`MOST_CLASSES`] one that reads from tables what it needs to know.
    pub fn requests(self, tables: &Tables, tracer: TracerKind) -> Vec<Request> {
        let entry = |name: &str, unknown: usize| Request {
            name: name.into(),
            entry: name.into(),
            args: vec![Arg::Unknown; unknown],
        };
        if self == DeviceKind::CpuScalar {
            return vec![entry(tracer.kernel(), 2)];
        }
        let of_tracer = |stage: &str| kernel_name(tracer.kernel(), stage);
        let mut requests =
            vec![entry(&of_tracer("generate"), 4), entry("trace", 2), entry(&of_tracer("miss"), 2), entry("shadow", 2)];
        let shade = entry(&of_tracer("shade"), 3);
        let shaders = tables.facts.tables.get(binding::<Geometries>()).map_or(1, |t| t.classes.max(1));
        let own = if shaders > MOST_CLASSES { MOST_CLASSES - 1 } else { shaders };
        requests.extend((0..own).map(|class| Request {
            name: format!("{}.{class}", shade.name),
            args: vec![Arg::Class(class), Arg::Unknown, Arg::Unknown],
            entry: shade.entry.clone(),
        }));
        requests.extend((own < shaders).then_some(shade));
        requests
    }
}
