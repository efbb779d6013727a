//! The words of `jerboa render`.

use super::values::*;
use super::{DEFAULT_SCENE, PartArgs, SamplingArgs, ShownArgs};
use clap::Args;
use clap::builder::ArgPredicate;
use std::path::PathBuf;

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
    /// Samples per pixel; 65536 with --noise, if nothing else is said
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..))]
    #[arg(default_value_if("noise", ArgPredicate::IsPresent, "65536"))]
    pub spp: u32,
    /// How much to render, and what to keep.
    #[command(flatten)]
    pub part: PartArgs,
    /// Width in pixels [default: the camera's extras.width, else 1280]
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub width: Option<u32>,
    /// Height in pixels [default: the camera's extras.height, else by its aspect]
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub height: Option<u32>,
    /// Longest path in edges: 1 sees lights, 2 adds direct light [default: unlimited]
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u32).range(1..))]
    pub max_depth: Option<u32>,
    /// How random numbers are drawn.
    #[command(flatten)]
    pub sampling: SamplingArgs,
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
    /// Let rays through the backs of single-sided materials, as glTF asks of rasterisers [default: a surface is one from both sides]
    #[arg(long)]
    pub cull_back_faces: bool,
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
    /// Print spp, rays, seconds by phase, dropped samples and the estimated error as JSON
    #[arg(long)]
    pub json: bool,
}
