//! A kernel, ready to launch.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use wgpu::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType, ComputePipelineDescriptor,
    PassthroughShaderEntryPoint, PipelineCompilationOptions, PipelineLayoutDescriptor, ShaderModuleDescriptor,
    ShaderModuleDescriptorPassthrough, ShaderRuntimeChecks, ShaderSource, ShaderStages,
};

use super::{Error, Gpu, Mode};
use crate::{Binding, Grid, Module, WORKGROUP};

/// A pipeline and how it is launched.
#[derive(Debug)]
pub struct Kernel {
    pub(super) name: String,
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
    /// Invocations of a workgroup.
    pub(super) workgroup: u32,
    /// Words of arguments.
    pub(super) arguments: u32,
    /// Words of results.
    pub(super) results: u32,
    pub(super) bindings: Vec<Binding>,
    time: Duration,
}

impl Kernel {
    /// What errors call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How many buffers the program has.
    pub(super) fn buffers(&self) -> usize {
        let held = self.bindings.iter().map(|binding| match binding {
            Binding::Tables(group) | Binding::Streams(group) => group.len(),
            Binding::Launch | Binding::Results => 0,
        });
        held.sum()
    }

    /// How long the driver took to make the pipeline; see [`Gpu::warm`] for what it may have left for later.
    pub fn pipeline_time(&self) -> Duration {
        self.time
    }
}

impl Gpu {
    /// Makes the driver compile what [`crate::emit`] made. Several threads may do so at the same time.
    ///
    /// # Errors
    ///
    /// The driver refuses, or the device is lost.
    pub fn kernel(&self, module: &Module) -> Result<Kernel, Error> {
        let start = Instant::now();
        let workgroup = match module.grid() {
            Grid::Items => WORKGROUP,
            Grid::Single => 1,
        };
        let (pipeline, layout) = self.guarded(&format!("the kernel `{}`", module.name()), || {
            let layout = self.layout(module.bindings());
            (self.pipeline(module, workgroup, &layout), layout)
        })?;
        Ok(Kernel {
            name: module.name().into(),
            pipeline,
            layout,
            workgroup,
            arguments: module.arguments(),
            results: module.results(),
            bindings: module.bindings().into(),
            time: start.elapsed(),
        })
    }

    /// What a kernel binds: the launch, the program's buffers, the results.
    fn layout(&self, bindings: &[Binding]) -> wgpu::BindGroupLayout {
        let entry = |(number, binding): (usize, &Binding)| BindGroupLayoutEntry {
            binding: number as u32,
            visibility: ShaderStages::COMPUTE,
            ty: BindingType::Buffer {
                ty: BufferBindingType::Storage { read_only: !binding.is_written() },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<BindGroupLayoutEntry> = bindings.iter().enumerate().map(entry).collect();
        self.device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: None, entries: &entries })
    }

    fn pipeline(&self, module: &Module, workgroup: u32, layout: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
        let descriptor =
            PipelineLayoutDescriptor { label: None, bind_group_layouts: &[Some(layout)], immediate_size: 0 };
        self.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(module.name()),
            layout: Some(&self.device.create_pipeline_layout(&descriptor)),
            module: &self.shader(module, workgroup),
            entry_point: Some(module.name()),
            compilation_options: PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..PipelineCompilationOptions::default()
            },
            cache: None,
        })
    }

    fn shader(&self, module: &Module, workgroup: u32) -> wgpu::ShaderModule {
        let name = module.name();
        match self.mode() {
            Mode::Exact => {
                let entry = PassthroughShaderEntryPoint { name: name.into(), workgroup_size: (workgroup, 1, 1) };
                let descriptor = ShaderModuleDescriptorPassthrough {
                    label: Some(name),
                    entry_points: Cow::Borrowed(&[entry]),
                    spirv: Some(module.spirv().into()),
                    ..ShaderModuleDescriptorPassthrough::default()
                };
                // SAFETY: naga wrote it from a module that its validator let pass; loads and stores check their rows.
                unsafe { self.device.create_shader_module_passthrough(descriptor) }
            }
            Mode::Portable => {
                let source = ShaderSource::Naga(Cow::Owned(module.ir().clone()));
                let descriptor = ShaderModuleDescriptor { label: Some(name), source };
                // SAFETY: the code does what the checks would do: it compares rows, divisors and shifts by itself.
                unsafe { self.device.create_shader_module_trusted(descriptor, ShaderRuntimeChecks::unchecked()) }
            }
        }
    }
}
