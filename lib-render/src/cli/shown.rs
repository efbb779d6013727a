//! Words of `jerboa render` that say what is shown.

use clap::{Args, ValueEnum};

use super::args::finite_not_negative;
use crate::host::aov::Layer;
use crate::host::generate::TracerKind;

/// What a path is traced for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TracerArg {
    /// Light transport, from the camera
    #[default]
    Path,
    /// Light transport, from the lights: good at caustics, blind to emitters, mirrors and glass seen directly
    Light,
    /// Light transport, from both sides: all that either finds
    Bidirectional,
    /// Shading normals at the first hit
    Normals,
    /// Base colour at the first hit
    Albedo,
    /// Distance to the first hit
    Depth,
    /// Ambient occlusion: the share of the sky over a surface that is open
    Ao,
}

impl From<TracerArg> for TracerKind {
    fn from(arg: TracerArg) -> TracerKind {
        match arg {
            TracerArg::Path => TracerKind::Path,
            TracerArg::Light => TracerKind::Light,
            TracerArg::Bidirectional => TracerKind::Bidirectional,
            TracerArg::Normals => TracerKind::Normals,
            TracerArg::Albedo => TracerKind::Albedo,
            TracerArg::Depth => TracerKind::Depth,
            TracerArg::Ao => TracerKind::Occlusion,
        }
    }
}

/// A layer beside the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AovArg {
    /// Base colour of what is seen: albedo.R, .G, .B
    Albedo,
    /// Shading normal, world, facing the camera: normal.X, .Y, .Z
    Normal,
    /// Depth along the viewing direction at the first sample, in metres, infinite where nothing is hit: depth.Z
    Depth,
    /// Number of the material at the first sample, from 1 on, 0 where nothing is hit: material.X
    Material,
    /// Samples in each pixel: samples.X
    Samples,
}

impl From<AovArg> for Layer {
    fn from(arg: AovArg) -> Layer {
        match arg {
            AovArg::Albedo => Layer::Albedo,
            AovArg::Normal => Layer::Normal,
            AovArg::Depth => Layer::Depth,
            AovArg::Material => Layer::Material,
            AovArg::Samples => Layer::Samples,
        }
    }
}

/// What is shown.
#[derive(Clone, Debug, Args)]
pub struct ShownArgs {
    /// What to show
    #[arg(long, value_name = "TRACER", value_enum, default_value_t)]
    pub tracer: TracerArg,
    /// How far ambient occlusion looks, in metres [default: without end]
    #[arg(long, value_name = "M", value_parser = finite_not_negative, allow_negative_numbers = true)]
    pub ao_distance: Option<f32>,
    /// Layers beside the picture in an .exr
    #[arg(long, value_name = "LAYER,...", value_enum, value_delimiter = ',')]
    pub aov: Vec<AovArg>,
}
