//! Which kernels a device has, and what is known of their parameters.

use jerboa_ir::Lit;
use jerboa_peval::{Arg, ColumnFacts};

use super::generate::{Request, TracerKind};
use super::gpu::wavefront;
use super::tables::Tables;
use crate::device::stream::kernel_name;
use crate::device::wavefront::entry_name;
use crate::schema::{Geometries, Settings, binding};

/// Where paths are traced. The image is the same.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum DeviceKind {
    /// Streams of paths on the CPU, sorted by shader: see [`super::wave`].
    #[default]
    Cpu,
    /// One path after the other on the CPU, in one kernel.
    CpuScalar,
    /// All samples of a pixel on a GPU, in one kernel: see [`super::gpu`].
    GpuMegakernel,
    /// Streams of paths on a GPU, sorted by shader: see [`super::gpu`].
    GpuWavefront,
}

/// Who walks the tree on [`DeviceKind::Cpu`]. The image is the same.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Traversal {
    /// The native walk, where the processor has its instructions and no instances of the scene share triangles; see
    /// [`super::native`].
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
    pub const ALL: [DeviceKind; 4] =
        [DeviceKind::Cpu, DeviceKind::CpuScalar, DeviceKind::GpuMegakernel, DeviceKind::GpuWavefront];

    /// Those that every machine has.
    pub const CPU: [DeviceKind; 2] = [DeviceKind::Cpu, DeviceKind::CpuScalar];

    /// Does it run on a GPU?
    pub fn is_gpu(self) -> bool {
        !DeviceKind::CPU.contains(&self)
    }

    /// The kernels that show what a tracer shows, in an order that the host half of the device goes by:
    /// * [`DeviceKind::Cpu`]: `generate`, `trace`, `miss`, `shadow`, then a `shade` for each class,
    /// * [`DeviceKind::GpuWavefront`]: those of [`wavefront::STAGES`], then a `shade` for each class, then `shadow`,
    /// * the others: one.
    ///
    /// There is no `shadow` where it is known that no vertex asks for light.
    ///
    /// A tracer that this device cannot run has none, and on [`DeviceKind::Cpu`] the one of [`TracerKind::device`].
    ///
    /// Beyond [`MOST_CLASSES`] there is one `shade` that reads from tables what it needs to know.
    pub fn requests(self, tables: &Tables, tracer: TracerKind) -> Vec<Request> {
        let entry = |entry: String, unknown: usize| Request {
            device: self,
            tracer,
            name: entry.clone(),
            entry,
            args: vec![Arg::Unknown; unknown],
        };
        let of_tracer = |stage: &str| kernel_name(tracer.kernel(), stage);
        if tracer.is_splatting() {
            let scalar = Request { device: DeviceKind::CpuScalar, ..entry(tracer.kernel().into(), 2) };
            return if self.is_gpu() { Vec::new() } else { vec![scalar] };
        }
        match self {
            DeviceKind::Cpu => {
                let mut requests = vec![entry(of_tracer("generate"), 4), entry("trace".into(), 2)];
                requests.push(entry(of_tracer("miss"), 2));
                requests.extend(may_ask(tracer, tables).then(|| entry("shadow".into(), 2)));
                requests.extend(shaders(entry(of_tracer("shade"), 3), 0, tables));
                requests
            }
            DeviceKind::CpuScalar => vec![entry(tracer.kernel().into(), 2)],
            DeviceKind::GpuMegakernel => vec![entry(of_tracer("megakernel"), 4)],
            DeviceKind::GpuWavefront => {
                let named = |stage: &str, traced| if traced { of_tracer(stage) } else { stage.into() };
                let stages = wavefront::STAGES.iter();
                let stages = stages.map(|(stage, traced, params)| entry(entry_name(&named(stage, *traced)), *params));
                let shade = shaders(entry(entry_name(&of_tracer("shade")), 3), 1, tables);
                let shadow = may_ask(tracer, tables).then(|| entry(entry_name("shadow"), 1));
                stages.chain(shade).chain(shadow).collect()
            }
        }
    }
}

/// May a vertex ask for light?
fn may_ask(tracer: TracerKind, tables: &Tables) -> bool {
    match tracer {
        TracerKind::Path => {
            let settings = tables.facts.tables.get(binding::<Settings>());
            let has_lights = settings.and_then(|t| t.columns.get(Settings::HAS_LIGHTS.0 as usize));
            has_lights != Some(&ColumnFacts::Known(vec![Lit::Bool(false)]))
        }
        TracerKind::Normals | TracerKind::Albedo | TracerKind::Depth => false,
        TracerKind::AovNormal | TracerKind::AovPlace => false,
        TracerKind::Light | TracerKind::Bidirectional | TracerKind::Occlusion | TracerKind::Own(_) => true,
    }
}

/// A kernel for each class of shaders, whose parameter of this number is the class.
fn shaders(shade: Request, parameter: usize, tables: &Tables) -> impl Iterator<Item = Request> {
    let classes = tables.facts.tables.get(binding::<Geometries>()).map_or(1, |t| t.classes.max(1));
    let own = if classes > MOST_CLASSES { MOST_CLASSES - 1 } else { classes };
    let rest = (own < classes).then(|| shade.clone());
    let of_class = move |class| {
        let mut request = Request { name: format!("{}.{class}", shade.name), ..shade.clone() };
        request.args[parameter] = Arg::Class(class);
        request
    };
    (0..own).map(of_class).chain(rest)
}
