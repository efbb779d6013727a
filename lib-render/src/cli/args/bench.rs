//! The words of `jerboa bench`.

use super::values::TraversalArg;
use super::{DEFAULT_SCENE, SamplingArgs, SelectArgs};
use crate::cli::efficiency::ErrorArgs;
use crate::cli::figures::{BatchArgs, BenchDevicesArgs, Figure2Args, Figure5Args, Table2Args};
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// The subcommands of `jerboa bench`.
#[derive(Debug, Subcommand)]
pub enum BenchCommand {
    /// Render the gallery of hard cases: speed, and error beside the reference values
    ///
    /// A line for each scene: how fast it rendered, how far its mean luminance is from the reference value, relatively and in
    /// standard errors, how many samples were dropped, and how many pixels are not finite. A scene passes if it is within 4
    /// standard errors and has neither. The exit code is 0 if all pass. `--json` adds what each scene is for, and what a naive
    /// renderer does there.
    Stability(StabilityArgs),
    /// Render within budgets of wall time, and say what error is left: our levels and devices, and beside Mitsuba 3
    ///
    /// The clock runs from the opening of the scene's file to the finished film. The error is the variance between renders with
    /// other seeds, relative to the picture; so no reference is needed, and nobody is charged for what a file means to him. All
    /// contestants take turns, seed by seed; the first is compared with each other one. `-o` writes a page, `--csv` each run.
    Error(ErrorArgs),
    /// Trace rays without shading: millions a second
    ///
    /// A line for each set of rays: from the camera, diffuse from where those hit, diffuse from where these hit, the same in
    /// random order, and to lights. `--write` leaves the sets in files, for other tracers: per ray eight 32-bit floats, origin, 0,
    /// direction, end.
    Rays(RaysArgs),
    /// Render on each device, CPU and GPU: millions of samples a second, and how far the images are from the CPU's
    ///
    /// All take turns in each round, after one that warms up. Says on which GPU, and whether it is one: a software driver's speed
    /// is no GPU's.
    Devices(BenchDevicesArgs),
    /// Edit a material while the scene is rendered: milliseconds until it is seen
    ///
    /// A line for each kind of edit, in milliseconds, the first one and the median: the work of making the new renderer, the time
    /// until it was made, and until a whole pass showed it, a sample for each pixel; then how many kernels were specialised anew,
    /// and how many of them compiled, by the first. From a value, which needs nothing made, to the first coloured glass of a scene,
    /// which concerns every kernel.
    Edits(EditsArgs),
    /// Count lines of code and Halstead's effort of the renderer and its devices (the paper's Table 3)
    #[command(name = "table-3")]
    Table3(Table3Args),
    /// Render by what is known of the scene, and beside Mitsuba 3: millions of samples a second (the paper's Table 2)
    ///
    /// Under the rules that the peer has too: the same largest depth, roulette from the 5th scattering on with at most 0.95,
    /// shading normals free. Wall time; all take turns in each round.
    #[command(name = "table-2")]
    Table2(Table2Args),
    /// Share out the time of a render, and say what shading a path vertex takes (the paper's Figure 2)
    ///
    /// On one thread, by the time that it ran for. The rest is new paths, sorting, compaction and the film.
    #[command(name = "figure-2")]
    Figure2(Figure2Args),
    /// Shade 4,096 rays by a Phong shader of constants or textures, specialised or not (the paper's Figure 3)
    #[command(name = "figure-3")]
    Figure3(BatchArgs),
    /// Shade 4,096 rays with the interfaces of textures and attributes specialised or not (the paper's Figure 4)
    #[command(name = "figure-4")]
    Figure4(BatchArgs),
    /// Specialise and compile the kernels of each scene, device and level of knowledge (the paper's Figure 5)
    #[command(name = "figure-5")]
    Figure5(Figure5Args),
}

/// Words of `jerboa bench stability`.
#[derive(Clone, Debug, Args)]
pub struct StabilityArgs {
    /// These scenes of the gallery only [default: all]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub scene: Vec<String>,
    /// Samples per pixel, rounded up to a multiple of 4
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=1 << 30))]
    pub spp: u32,
    /// How random numbers are drawn.
    #[command(flatten)]
    pub sampling: SamplingArgs,
    /// Another seed gives other, independent images
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u32,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Print a list of objects as JSON
    #[arg(long)]
    pub json: bool,
    /// Write a contact sheet of the pictures, each exposed to the same mean; the names of scenes that fail are red
    #[arg(short, long, value_name = "SHEET.png")]
    pub output: Option<PathBuf>,
}

/// Words of `jerboa bench rays`.
#[derive(Debug, Args)]
pub struct RaysArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Of a file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// Who traces them
    #[arg(long, value_name = "WALK", value_enum, default_value_t)]
    pub traversal: TraversalArg,
    /// Side of the square film in pixels, a camera ray each
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(4..=8192))]
    pub side: u32,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Print an object as JSON
    #[arg(long)]
    pub json: bool,
    /// Write each set of rays to NAME.rays in this folder
    #[arg(long, value_name = "FOLDER")]
    pub write: Option<PathBuf>,
}

/// Words of `jerboa bench edits`.
#[derive(Debug, Args)]
pub struct EditsArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Of a file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// Edits of each kind
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,
    /// Columns of the film
    #[arg(long, value_name = "W", default_value_t = 320, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub width: u32,
    /// Rows of the film
    #[arg(long, value_name = "H", default_value_t = 180, value_parser = clap::value_parser!(u32).range(1..=8192))]
    pub height: u32,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Print a list of objects as JSON
    #[arg(long)]
    pub json: bool,
}

/// Words of `jerboa bench table-3`.
#[derive(Debug, Args)]
pub struct Table3Args {
    /// Sources of the renderer, in a checkout of Jerboa
    #[arg(default_value = "lib-render/src")]
    pub folder: PathBuf,
    /// Print an object as JSON
    #[arg(long)]
    pub json: bool,
}
