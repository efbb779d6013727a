//! The words of the command line, exactly as scripts use them.

mod bench;
mod parts;
mod render;
mod sampling;
#[cfg(test)]
mod tests;
mod values;

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

pub use super::efficiency::ErrorArgs;
pub use super::figures::{BatchArgs, BenchDevicesArgs, Figure2Args, Figure5Args, OutputArgs, RenderedArgs, Table2Args};
pub use super::shown::{AovArg, ShownArgs, TracerArg};
pub use bench::*;
pub use parts::*;
pub use render::*;
pub use sampling::*;
pub use values::*;

/// A path tracer that specialises itself for the scene it is given. Of a word given twice, the last counts.
#[derive(Debug, Parser)]
#[command(name = "jerboa", version, args_override_self = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to an image
    Render(Box<RenderArgs>),
    /// Add up partial renders, to the very bits of the whole
    Merge(MergeArgs),
    /// Show what the renderer becomes for a scene, stage by stage
    Dump(DumpArgs),
    /// Measure loading, specialization and code generation
    Time(TimeArgs),
    /// Say what was specialised, what was not, and why
    Explain(ExplainArgs),
    /// Follow one path, step by step
    Trace(TraceArgs),
    /// Measure how far images are from a reference
    Compare(CompareArgs),
    /// List where this machine can render: CPU, GPUs, and what would run on them
    Devices(DevicesArgs),
    /// Measure speed and error
    Bench {
        /// What to measure.
        #[command(subcommand)]
        command: BenchCommand,
    },
}

/// The scene that is rendered when none is named.
pub const DEFAULT_SCENE: &str = "builtin:cornell-box";

/// Words of `jerboa dump`.
#[derive(Clone, Debug, Args)]
pub struct DumpArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    pub scene: String,
    /// Of a file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// What to show
    #[arg(long, value_enum)]
    pub stage: StageArg,
    /// This kernel only [default: all]
    #[arg(long, value_name = "NAME")]
    pub kernel: Option<String>,
    /// What the renderer is specialised for
    #[arg(long, value_name = "LEVEL", value_enum, default_value_t)]
    pub known: KnownArg,
    /// How random numbers are drawn.
    #[command(flatten)]
    pub sampling: SamplingArgs,
}

/// Words of `jerboa time`.
#[derive(Clone, Debug, Args)]
pub struct TimeArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    pub scene: String,
    /// Of a file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// For which device
    #[arg(long, value_name = "DEVICE", value_enum, default_value_t = DeviceArg::Cpu)]
    pub device: DeviceArg,
    /// How random numbers are drawn.
    #[command(flatten)]
    pub sampling: SamplingArgs,
    /// Print the times as JSON
    #[arg(long)]
    pub json: bool,
}

/// Words of `jerboa explain`.
#[derive(Clone, Debug, Args)]
pub struct ExplainArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    pub scene: String,
    /// Of a file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// This kernel only [default: all]
    #[arg(long, value_name = "NAME")]
    pub kernel: Option<String>,
    /// How random numbers are drawn.
    #[command(flatten)]
    pub sampling: SamplingArgs,
}

/// Words of `jerboa trace`.
#[derive(Clone, Debug, Args)]
pub struct TraceArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    pub scene: String,
    /// Of a file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// Column and row of the pixel, from the top left
    #[arg(long, value_name = "X,Y")]
    pub pixel: PixelArg,
    /// Number of the sample, from 0
    #[arg(long, value_name = "N")]
    pub sample: u32,
    /// How random numbers are drawn.
    #[command(flatten)]
    pub sampling: SamplingArgs,
    /// The seed of the image
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u32,
}

/// Words of `jerboa compare`.
#[derive(Clone, Debug, Args)]
#[command(override_usage = "jerboa compare [OPTIONS] <A>... <REF>")]
pub struct CompareArgs {
    /// The images whose mean is compared and, last, the reference (.exr, .hdr or .png)
    #[arg(value_name = "IMAGE", num_args = 2.., required = true)]
    pub images: Vec<PathBuf>,
    /// Variance of the reference's mean: an image (per pixel and channel) or a number
    #[arg(long, value_name = "V")]
    pub ref_variance: Option<String>,
    /// Print the figures as JSON
    #[arg(long)]
    pub json: bool,
    /// Write a picture of the difference: red where A is brighter, blue where it is darker
    #[arg(long, value_name = "OUT.png")]
    pub diff: Option<PathBuf>,
}

/// Words of `jerboa devices`.
#[derive(Clone, Debug, Args)]
pub struct DevicesArgs {
    /// Print an object as JSON
    #[arg(long)]
    pub json: bool,
}
