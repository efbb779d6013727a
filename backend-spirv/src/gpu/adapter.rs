//! What could run kernels here.

use wgpu::{Backends, DeviceType, DownlevelFlags, Features, InstanceDescriptor, InstanceFlags, Limits};

use super::{Error, Mode};
use crate::{STORAGE_BUFFERS, WORKGROUP};

/// What there is to say where [`adapters`] finds none.
pub const NONE: &str = "no GPU and no driver of one was found: install the GPU's Vulkan driver; on Debian and Ubuntu the \
                        package mesa-vulkan-drivers has those of AMD and Intel, and one that runs on the CPU";

/// What an adapter is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Kind {
    /// A GPU with memory of its own.
    Discrete,
    /// A GPU that shares the CPU's memory.
    Integrated,
    /// A GPU that is handed through to a virtual machine.
    Virtual,
    /// Its driver does not say.
    Unknown,
    /// No GPU: a driver that runs on the CPU, as Mesa's lavapipe.
    Software,
}

impl Kind {
    /// Whether it is hardware, as far as its driver says.
    pub fn is_gpu(self) -> bool {
        matches!(self, Kind::Discrete | Kind::Integrated | Kind::Virtual)
    }

    /// A word or two for a table.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Discrete => "discrete GPU",
            Kind::Integrated => "integrated GPU",
            Kind::Virtual => "virtual GPU",
            Kind::Unknown => "unknown",
            Kind::Software => "software",
        }
    }
}

/// Which adapter is asked for.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default)]
pub enum Choice {
    /// The best that can run kernels, a software driver if there is nothing else.
    #[default]
    Any,
    /// The best GPU; no software driver.
    RealOnly,
    /// The best whose name has this in it, without regard to case.
    Named(String),
}

/// A GPU, or a driver that stands in for one.
#[derive(Clone, Debug)]
pub struct Adapter {
    pub(super) inner: wgpu::Adapter,
    name: String,
    kind: Kind,
    driver: String,
    system: &'static str,
    limits: Limits,
    exact: bool,
    unfit: Option<String>,
}

/// All adapters, the best first: by [`Kind`], those of Vulkan before those of other systems. None is no error.
pub fn adapters() -> Vec<Adapter> {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
    // No layers for debugging. The grids of indirect launches are our own kernels' and need no check, but Direct3D counts
    // workgroups in the checking kernel alone.
    descriptor.flags = if cfg!(windows) { InstanceFlags::VALIDATION_INDIRECT_CALL } else { InstanceFlags::empty() };
    let instance = wgpu::Instance::new(descriptor);
    let mut found: Vec<Adapter> =
        pollster::block_on(instance.enumerate_adapters(Backends::all())).into_iter().map(Adapter::new).collect();
    found.sort_by_key(|a| (a.kind, a.system != "Vulkan"));
    found
}

impl Adapter {
    fn new(inner: wgpu::Adapter) -> Adapter {
        let (info, limits) = (inner.get_info(), inner.limits());
        let vulkan = info.backend == wgpu::Backend::Vulkan;
        Adapter {
            name: info.name,
            kind: match info.device_type {
                DeviceType::DiscreteGpu => Kind::Discrete,
                DeviceType::IntegratedGpu => Kind::Integrated,
                DeviceType::VirtualGpu => Kind::Virtual,
                DeviceType::Cpu => Kind::Software,
                DeviceType::Other => Kind::Unknown,
            },
            driver: [info.driver, info.driver_info].into_iter().filter(|s| !s.is_empty()).collect::<Vec<_>>().join(" "),
            system: match info.backend {
                wgpu::Backend::Vulkan => "Vulkan",
                wgpu::Backend::Metal => "Metal",
                wgpu::Backend::Dx12 => "Direct3D 12",
                _ => "another system",
            },
            exact: vulkan && inner.features().contains(Features::PASSTHROUGH_SHADERS),
            unfit: unfit(&limits, inner.get_downlevel_capabilities().flags),
            limits,
            inner,
        }
    }

    /// The adapter that is asked for.
    pub fn choose(choice: &Choice) -> Result<Adapter, Error> {
        let all = adapters();
        let wanted = |a: &&Adapter| match choice {
            Choice::Any => true,
            Choice::RealOnly => a.kind.is_gpu(),
            Choice::Named(name) => a.name.to_lowercase().contains(&name.to_lowercase()),
        };
        let best = all.iter().filter(wanted).min_by_key(|a| a.unfit.is_some());
        let Some(best) = best else { return Err(Error::NoAdapter(missing(&all, choice))) };
        match &best.unfit {
            Some(why) => Err(Error::Unfit { adapter: best.name.clone(), why: why.clone() }),
            None => Ok(best.clone()),
        }
    }

    /// As its driver calls it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it is.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The driver's name and version; empty where it does not say.
    pub fn driver(&self) -> &str {
        &self.driver
    }

    /// Through what it is reached: Vulkan, Metal or Direct3D 12.
    pub fn system(&self) -> &'static str {
        self.system
    }

    /// Whether kernels can run in exact mode.
    pub fn exact(&self) -> bool {
        self.exact
    }

    /// The mode that it runs in unless another is forced.
    pub fn mode(&self) -> Mode {
        if self.exact { Mode::Exact } else { Mode::Portable }
    }

    /// Most bytes of one buffer.
    pub fn most_bytes(&self) -> u64 {
        // Whole words, whose numbers are 32 bits wide.
        let addressed = 4 * u64::from(u32::MAX);
        self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size).min(addressed) & !3
    }

    /// Why it cannot run kernels, if it cannot.
    pub fn unfit(&self) -> Option<&str> {
        self.unfit.as_deref()
    }

    /// What tells it from other adapters of this machine.
    pub(super) fn identity(&self) -> String {
        let info = self.inner.get_info();
        format!("{} {} {} {} {}", info.name, info.vendor, info.device, info.device_pci_bus_id, self.system)
    }

    /// What a device asks for: what kernels need, and buffers as large as there are.
    pub(super) fn needs(&self) -> Limits {
        Limits {
            max_storage_buffers_per_shader_stage: STORAGE_BUFFERS as u32,
            max_storage_buffer_binding_size: self.limits.max_storage_buffer_binding_size,
            max_buffer_size: self.limits.max_buffer_size,
            ..Limits::downlevel_defaults().or_worse_values_from(&self.limits)
        }
    }
}

/// What an adapter of such limits lacks.
fn unfit(limits: &Limits, flags: DownlevelFlags) -> Option<String> {
    let lacks = [
        (DownlevelFlags::COMPUTE_SHADERS, "compute shaders"),
        (DownlevelFlags::INDIRECT_EXECUTION, "indirect dispatch"),
    ];
    if let Some((_, what)) = lacks.iter().find(|(flag, _)| !flags.contains(*flag)) {
        return Some(format!("it has no {what}"));
    }
    let asks = [
        ("storage buffers in a shader", STORAGE_BUFFERS as u32, limits.max_storage_buffers_per_shader_stage),
        ("invocations in a workgroup", WORKGROUP, limits.max_compute_invocations_per_workgroup),
        ("invocations along a workgroup", WORKGROUP, limits.max_compute_workgroup_size_x),
        ("workgroups along a grid", super::MOST_GROUPS, limits.max_compute_workgroups_per_dimension),
    ];
    let (what, asked, most) = asks.into_iter().find(|(_, asked, most)| asked > most)?;
    Some(format!("it allows {most} {what}, {asked} are needed"))
}

/// What to tell somebody who asked for an adapter that is not there.
fn missing(all: &[Adapter], choice: &Choice) -> String {
    if all.is_empty() {
        return NONE.into();
    }
    let names: Vec<String> = all.iter().map(|a| format!("`{}` ({})", a.name, a.kind.name())).collect();
    let wanted = match choice {
        Choice::Named(name) => format!("no GPU has `{name}` in its name"),
        _ => "no GPU was found".into(),
    };
    format!(
        "{wanted}; there is {}; another may lack its Vulkan driver (mesa-vulkan-drivers on Debian)",
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_that_are_too_small_are_named() {
        let all = DownlevelFlags::all();
        assert_eq!(unfit(&Limits::defaults(), all), None);
        let few = Limits { max_storage_buffers_per_shader_stage: 4, ..Limits::defaults() };
        assert_eq!(unfit(&few, all).unwrap(), "it allows 4 storage buffers in a shader, 8 are needed");
        let none = all - DownlevelFlags::COMPUTE_SHADERS;
        assert_eq!(unfit(&Limits::defaults(), none).unwrap(), "it has no compute shaders");
    }

    #[test]
    fn without_an_adapter_the_package_is_named() {
        assert!(missing(&[], &Choice::Any).contains("mesa-vulkan-drivers"));
    }
}
