//! A kernel, ready to launch.

use std::borrow::Cow;
use std::time::{Duration, Instant};

use wgpu::{
    BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType, ComputePipelineDescriptor,
    PassthroughShaderEntryPoint, PipelineCompilationOptions, PipelineLayoutDescriptor, ShaderModuleDescriptor,
    ShaderModuleDescriptorPassthrough, ShaderRuntimeChecks, ShaderSource, ShaderStages,
};

use super::{Error, Gpu, Mode};

/// What a kernel is made from: the same code twice, and how it is launched.
#[derive(Clone, Copy, Debug)]
pub struct Code<'a> {
    /// What errors call it.
    pub name: &'a str,
    /// The code for exact mode.
    pub spirv: &'a [u32],
    /// The code for portable mode.
    pub module: &'a naga::Module,
    /// The entry in both.
    pub entry: &'a str,
    /// Invocations of a workgroup.
    pub workgroup: u32,
    /// Words of arguments.
    pub arguments: u32,
    /// For each buffer of the program the binding that holds it, from 1 on; 0 if the kernel does not bind it.
    pub packing: &'a [u32],
    /// For each binding from 1 on, without the results, whether the kernel writes it.
    pub written: &'a [bool],
    /// Whether one more binding takes results.
    pub results: bool,
}

/// A pipeline and how it is launched.
#[derive(Debug)]
pub struct Kernel {
    pub(super) name: String,
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) workgroup: u32,
    pub(super) arguments: u32,
    pub(super) packing: Vec<u32>,
    pub(super) written: Vec<bool>,
    pub(super) results: bool,
    time: Duration,
}

impl Kernel {
    /// What errors call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How long the driver took to make the pipeline; see [`Gpu::warm`] for what it may have left for later.
    pub fn pipeline_time(&self) -> Duration {
        self.time
    }
}

impl Gpu {
    /// Makes the driver compile a kernel. Several threads may do so at the same time.
    ///
    /// # Errors
    ///
    /// The driver refuses, or the device is lost.
    pub fn kernel(&self, code: &Code) -> Result<Kernel, Error> {
        let start = Instant::now();
        let (pipeline, layout) = self.guarded(&format!("the kernel `{}`", code.name), || {
            let layout = self.layout(code);
            (self.pipeline(code, &layout), layout)
        })?;
        Ok(Kernel {
            name: code.name.into(),
            pipeline,
            layout,
            workgroup: code.workgroup,
            arguments: code.arguments,
            packing: code.packing.into(),
            written: code.written.into(),
            results: code.results,
            time: start.elapsed(),
        })
    }

    /// What it binds: the launch, the program's buffers, the results.
    fn layout(&self, code: &Code) -> wgpu::BindGroupLayout {
        let written = [false].into_iter().chain(code.written.iter().copied()).chain(code.results.then_some(true));
        let entry = |(binding, written): (usize, bool)| BindGroupLayoutEntry {
            binding: binding as u32,
            visibility: ShaderStages::COMPUTE,
            ty: BindingType::Buffer {
                ty: BufferBindingType::Storage { read_only: !written },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let entries: Vec<BindGroupLayoutEntry> = written.enumerate().map(entry).collect();
        self.device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: None, entries: &entries })
    }

    fn pipeline(&self, code: &Code, layout: &wgpu::BindGroupLayout) -> wgpu::ComputePipeline {
        let descriptor =
            PipelineLayoutDescriptor { label: None, bind_group_layouts: &[Some(layout)], immediate_size: 0 };
        self.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(code.name),
            layout: Some(&self.device.create_pipeline_layout(&descriptor)),
            module: &self.shader(code),
            entry_point: Some(code.entry),
            compilation_options: PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..PipelineCompilationOptions::default()
            },
            cache: None,
        })
    }

    fn shader(&self, code: &Code) -> wgpu::ShaderModule {
        match self.mode() {
            Mode::Exact => {
                let entry =
                    PassthroughShaderEntryPoint { name: code.entry.into(), workgroup_size: (code.workgroup, 1, 1) };
                let descriptor = ShaderModuleDescriptorPassthrough {
                    label: Some(code.name),
                    entry_points: Cow::Borrowed(&[entry]),
                    spirv: Some(code.spirv.into()),
                    ..ShaderModuleDescriptorPassthrough::default()
                };
                // SAFETY: naga wrote it from a module that its validator let pass; loads and stores check their rows.
                unsafe { self.device.create_shader_module_passthrough(descriptor) }
            }
            Mode::Portable => {
                let source = ShaderSource::Naga(Cow::Owned(code.module.clone()));
                let descriptor = ShaderModuleDescriptor { label: Some(code.name), source };
                // SAFETY: the code does what the checks would do: it compares rows, divisors and shifts by itself.
                unsafe { self.device.create_shader_module_trusted(descriptor, ShaderRuntimeChecks::unchecked()) }
            }
        }
    }
}
