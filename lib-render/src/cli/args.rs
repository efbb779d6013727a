//! The words of the command line, exactly as scripts use them.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

pub use super::figures::{BatchArgs, BenchDevicesArgs, Figure2Args, Figure5Args, OutputArgs, RenderedArgs, Table2Args};
pub use super::shown::{AovArg, ShownArgs, TracerArg};

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

/// The scene that is rendered when none is named.
pub const DEFAULT_SCENE: &str = "builtin:cornell-box";

/// What a specialization knows about the scene (it never changes the image).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum KnownArg {
    /// Nothing: a generic renderer that dispatches at run time
    Nothing,
    /// Kinds, flags and counts: changing a number needs no compilation
    #[default]
    Structure,
    /// Numbers too: every value becomes a literal
    All,
}

/// Where kernels run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DeviceArg {
    /// `gpu-wavefront` where there is a GPU, `cpu` otherwise
    #[default]
    Auto,
    /// All cores: streams of paths, sorted by shader
    Cpu,
    /// All cores, one path after the other
    CpuScalar,
    /// A GPU, or a driver that stands in for one: all samples of a pixel in one kernel
    GpuMegakernel,
    /// A GPU likewise: streams of paths, sorted by shader
    GpuWavefront,
}

/// Who finds what rays hit on the device `cpu` (it never changes the image).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TraversalArg {
    /// By hand, eight boxes at once, where the processor has AVX-512 and the scene no cut-outs
    #[default]
    Native,
    /// The renderer's own kernel, four boxes at once
    Ir,
}

/// How shading normals may differ from the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ShadingNormalsArg {
    /// A closed mesh never leaks light
    #[default]
    Consistent,
    /// As the reference images have it
    Free,
}

/// What `jerboa dump` shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StageArg {
    /// The renderer before it has seen the scene
    Generic,
    /// What is left of it for this scene
    Residual,
    /// The same, with loops over lanes for what is vectorised
    Lanes,
    /// What Cranelift compiles
    Clif,
    /// The machine code
    Asm,
    /// The control flow of a kernel for GPUs
    Structured,
    /// What naga is given, as WGSL
    Naga,
    /// What a driver is given
    Spirv,
}

/// A pixel: column and row, from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelArg(pub [u32; 2]);

impl std::str::FromStr for PixelArg {
    type Err = String;

    fn from_str(text: &str) -> Result<PixelArg, String> {
        numbers(text).map(PixelArg).ok_or_else(|| "expected X,Y, as in 120,80".into())
    }
}

/// A rectangle of pixels: left column, top row, width and height, both at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CropArg(pub [u32; 4]);

impl std::str::FromStr for CropArg {
    type Err = String;

    fn from_str(text: &str) -> Result<CropArg, String> {
        let crop = numbers(text).filter(|[_, _, width, height]| *width > 0 && *height > 0);
        crop.map(CropArg).ok_or_else(|| "expected X,Y,W,H with W and H at least 1, as in 0,0,64,64".into())
    }
}

/// `N` whole numbers separated by commas.
fn numbers<const N: usize>(text: &str) -> Option<[u32; N]> {
    let numbers = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<Vec<u32>>>()?;
    numbers.try_into().ok()
}

/// `text` as a finite number.
fn finite(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|x: &f32| x.is_finite()).ok_or_else(|| "expected a finite number".into())
}

/// `text` as a finite number that is not negative.
pub(super) fn finite_not_negative(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x >= 0.0).ok_or_else(|| "expected a finite number, 0 or more".into())
}

/// `text` as a probability above 0: a cap of 0 would end every path.
fn probability(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x > 0.0 && *x <= 1.0).ok_or_else(|| "expected a number above 0, at most 1".into())
}

/// `text` as a moment in seconds.
fn moment(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| "expected a finite number of seconds".into())
}

/// `text` as a time in seconds above 0.
fn seconds(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|x| *x > 0.0).ok_or_else(|| "expected a number of seconds above 0".into())
}

/// What to show of a file that holds more than one of it.
#[derive(Clone, Debug, Default, Args)]
pub struct SelectArgs {
    /// A scene of the file, by name or by number from 0 [default: the file's default]
    #[arg(long = "scene", value_name = "NAME|N")]
    pub scene_of_file: Option<String>,
    /// A variant of the materials, by name or number [default: the default materials]
    #[arg(long, value_name = "NAME|N")]
    pub variant: Option<String>,
    /// The moment of the animations to show, in seconds [default: the rest pose]
    #[arg(long, value_name = "SECONDS", value_parser = moment, allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Play this animation only, by name or number [default: all together]
    #[arg(long, value_name = "NAME|N", requires = "time")]
    pub animation: Option<String>,
}

/// Words of `jerboa render`.
#[derive(Clone, Debug, Args)]
pub struct RenderArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: String,
    /// Of a file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// Where the image goes: .exr is linear, .png is exposed, clamped to [0, 1] and sRGB-encoded
    #[arg(short, long, value_name = "OUT", default_value = "out.png")]
    pub output: PathBuf,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: u32,
    /// Width in pixels [default: the camera's extras.width, else 1280]
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub width: Option<u32>,
    /// Height in pixels [default: the camera's extras.height, else by its aspect]
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub height: Option<u32>,
    /// Longest path in edges: 1 sees lights, 2 adds direct light [default: unlimited]
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_depth: Option<u32>,
    /// Another seed gives another, independent image
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub seed: u32,
    /// What the renderer is specialised for
    #[arg(long, value_name = "LEVEL", value_enum, default_value_t)]
    pub known: KnownArg,
    /// Where to render
    #[arg(long, value_name = "DEVICE", value_enum, default_value_t)]
    pub device: DeviceArg,
    /// Who finds what rays hit on the device cpu
    #[arg(long, value_name = "WALK", value_enum, default_value_t)]
    pub traversal: TraversalArg,
    /// What is shown.
    #[command(flatten)]
    pub shown: ShownArgs,
    /// A camera of the scene, by name or by number from 0 [default: the first]
    #[arg(long, value_name = "NAME|N")]
    pub camera: Option<String>,
    /// Diameter of the lens in units of the scene; 0 is a pinhole [default: the camera's extras.aperture, else 0]
    #[arg(long, value_name = "D", value_parser = finite_not_negative, allow_negative_numbers = true)]
    pub aperture: Option<f32>,
    /// Depth of the plane that the lens shows sharp, in units of the scene [default: the camera's extras.focus]
    #[arg(long, value_name = "F", value_parser = finite_not_negative, allow_negative_numbers = true)]
    pub focus: Option<f32>,
    /// How shading normals may differ from the surface
    #[arg(long, value_name = "MODE", value_enum, default_value_t)]
    pub shading_normals: ShadingNormalsArg,
    /// Move rays off surfaces by X (1 + largest coordinate) more, as renderers with an epsilon do, to compare with them
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = finite_not_negative, allow_negative_numbers = true)]
    pub ray_offset: f32,
    /// Sample lamps by solid angle in place of area: less noise where they are near and large, at up to 1.2 times the time
    #[arg(long)]
    pub solid_angle: bool,
    /// Light the scene by this .hdr or .exr environment map, or by `sky:ELEVATION[,AZIMUTH[,TURBIDITY]]`, sun included
    #[arg(long, value_name = "FILE")]
    pub env: Option<PathBuf>,
    /// Turn the environment about the vertical axis, in degrees
    #[arg(long, value_name = "DEG", value_parser = finite, allow_negative_numbers = true)]
    pub env_rotation: Option<f32>,
    /// Multiply the environment's radiance
    #[arg(long, value_name = "X", value_parser = finite_not_negative, allow_negative_numbers = true)]
    pub env_strength: Option<f32>,
    /// Russian roulette may end a path from its N-th scattering on
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub rr_depth: u32,
    /// Largest probability with which roulette lets a path go on
    #[arg(long, value_name = "C", default_value_t = 1.0, value_parser = probability)]
    pub rr_cap: f32,
    /// Render these pixels only, exactly as they are in the full image
    #[arg(long, value_name = "X,Y,W,H")]
    pub crop: Option<CropArg>,
    /// Exposure of a PNG in stops: its values are multiplied by 2^EV
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    pub exposure: f32,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Stop after this time and write what is there
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f32>,
    /// Print spp, rays, seconds by phase and dropped samples as JSON
    #[arg(long)]
    pub json: bool,
}

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
}

/// Words of `jerboa time`.
#[derive(Clone, Debug, Args)]
pub struct TimeArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    pub scene: String,
    /// For which device
    #[arg(long, value_name = "DEVICE", value_enum, default_value_t = DeviceArg::Cpu)]
    pub device: DeviceArg,
    /// Print the times as JSON
    #[arg(long)]
    pub json: bool,
}

/// Words of `jerboa explain`.
#[derive(Clone, Debug, Args)]
pub struct ExplainArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    pub scene: String,
    /// This kernel only [default: all]
    #[arg(long, value_name = "NAME")]
    pub kernel: Option<String>,
}

/// Words of `jerboa trace`.
#[derive(Clone, Debug, Args)]
pub struct TraceArgs {
    /// A .gltf, .glb or .obj file, or builtin:NAME
    pub scene: String,
    /// Column and row of the pixel, from the top left
    #[arg(long, value_name = "X,Y")]
    pub pixel: PixelArg,
    /// Number of the sample, from 0
    #[arg(long, value_name = "N")]
    pub sample: u32,
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

/// Words of `jerboa bench stability`.
#[derive(Clone, Debug, Args)]
pub struct StabilityArgs {
    /// These scenes of the gallery only [default: all]
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub scene: Vec<String>,
    /// Samples per pixel, rounded up to a multiple of 4
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=1 << 30))]
    pub spp: u32,
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A command line that consists of the words of one subcommand.
    #[derive(Debug, Parser)]
    struct Only<A: Args> {
        #[command(flatten)]
        args: A,
    }

    fn parse<A: Args>(words: &str) -> Result<A, clap::Error> {
        Only::<A>::try_parse_from(["jerboa"].into_iter().chain(words.split_whitespace())).map(|only| only.args)
    }

    #[test]
    fn clap_finds_no_fault_in_the_declarations() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
        Only::<RenderArgs>::command().debug_assert();
        Only::<DumpArgs>::command().debug_assert();
        Only::<TimeArgs>::command().debug_assert();
        Only::<ExplainArgs>::command().debug_assert();
        Only::<TraceArgs>::command().debug_assert();
        Only::<StabilityArgs>::command().debug_assert();
        Only::<EditsArgs>::command().debug_assert();
        Only::<Table2Args>::command().debug_assert();
        Only::<Figure2Args>::command().debug_assert();
    }

    #[test]
    fn render_alone_renders_the_default_scene() {
        let args: RenderArgs = parse("").unwrap();
        assert_eq!((args.scene.as_str(), args.output, args.spp), (DEFAULT_SCENE, "out.png".into(), 64));
        assert_eq!((args.known, args.shown.tracer), (KnownArg::Structure, TracerArg::Path));
        assert_eq!((args.rr_depth, args.rr_cap, args.max_depth), (3, 1.0, None));
        assert_eq!(args.shading_normals, ShadingNormalsArg::Consistent);
    }

    #[test]
    fn every_word_of_render_is_understood() {
        let args: RenderArgs = parse(
            "a.glb -o b.exr --spp 16 --width 40 --height 30 --max-depth 16 --seed 7 --known all --device cpu \
             --tracer depth --camera Main --shading-normals free --env sky.hdr --env-rotation -90 --env-strength 2 \
             --scene 1 --variant night --time -0.5 --animation walk --aperture 0.5 --focus 3 --rr-depth 5 --rr-cap 0.95 --crop 1,2,3,4 --exposure -1.5 --threads 2 --time-limit 10 --json",
        )
        .unwrap();
        assert_eq!((args.scene.as_str(), args.output), ("a.glb", "b.exr".into()));
        assert_eq!((args.spp, args.width, args.height, args.max_depth), (16, Some(40), Some(30), Some(16)));
        assert_eq!((args.seed, args.known, args.shown.tracer), (7, KnownArg::All, TracerArg::Depth));
        assert_eq!((args.env_rotation, args.env_strength, args.exposure), (Some(-90.0), Some(2.0), -1.5));
        assert_eq!((args.crop, args.threads, args.time_limit), (Some(CropArg([1, 2, 3, 4])), Some(2), Some(10.0)));
        assert_eq!((args.aperture, args.focus), (Some(0.5), Some(3.0)));
        let select = args.select;
        assert_eq!((select.scene_of_file.as_deref(), select.variant.as_deref()), (Some("1"), Some("night")));
        assert_eq!((select.time, select.animation.as_deref()), (Some(-0.5), Some("walk")));
        assert!(args.json && args.camera.as_deref() == Some("Main"));
    }

    #[test]
    fn the_other_subcommands_parse() {
        let dump: DumpArgs = parse("a.glb --stage residual --kernel shade --known nothing").unwrap();
        assert_eq!((dump.stage, dump.known), (StageArg::Residual, KnownArg::Nothing));
        assert!(parse::<TimeArgs>("a.glb --json").unwrap().json);
        assert_eq!(parse::<ExplainArgs>("a.glb --kernel shade").unwrap().kernel.as_deref(), Some("shade"));
        let trace: TraceArgs = parse("a.glb --pixel 120,80 --sample 3").unwrap();
        assert_eq!((trace.pixel, trace.sample), (PixelArg([120, 80]), 3));
        let compare: CompareArgs = parse("a.exr b.exr ref.exr --ref-variance v.exr --diff d.png").unwrap();
        assert_eq!(compare.images.len(), 3);
        let bench: StabilityArgs = parse("--scene huge tiny --scene empty --spp 8 -o sheet.png").unwrap();
        assert_eq!((bench.scene.len(), bench.spp, bench.output), (3, 8, Some("sheet.png".into())));
    }

    #[test]
    fn values_without_a_meaning_are_refused() {
        for words in [
            "--spp 0",
            "--width 0",
            "--crop 1,2,3",
            "--crop 1,2,0,4",
            "--rr-cap 0",
            "--rr-cap 1.1",
            "--env-strength -1",
            "--exposure nan",
            "--time-limit 0",
            "--known some",
            "--threads 0",
            "--rr-depth 0",
            "--max-depth 0",
            "--time inf",
            "--animation walk",
        ] {
            assert!(parse::<RenderArgs>(words).is_err(), "{words}");
        }
        assert!(parse::<TraceArgs>("a.glb --pixel 1 --sample 0").is_err());
        assert!(parse::<CompareArgs>("ref.exr").is_err());
    }
}
