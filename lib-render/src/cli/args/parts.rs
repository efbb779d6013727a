//! Words of renders in parts: ranges of samples, what is kept of a long render, when it is good enough; and of `jerboa merge`.

use super::values::{finite, positive};
use clap::Args;
use std::path::PathBuf;

/// How much to render, and what to keep.
#[derive(Clone, Debug, Args)]
pub struct PartArgs {
    /// Render samples A to B-1 alone, as a part: an .exr that `jerboa merge` adds up exactly, and that the same words go on from after a kill
    #[arg(long, value_name = "A..B", conflicts_with_all = ["spp", "aov", "checkpoint", "noise"])]
    pub sample_range: Option<RangeArg>,
    /// Keep the film in this file after each pass, and go on from there if it is there
    #[arg(long, value_name = "FILE.exr")]
    pub checkpoint: Option<PathBuf>,
    /// Layers of an .exr: the estimated variance of the image, variance.R, .G, .B. In a part: what this takes
    #[arg(long)]
    pub variance: bool,
    /// Stop when the estimated mean squared error, relative to the image squared, is this small; --spp and --time-limit still end it
    #[arg(long, value_name = "TARGET", value_parser = positive, allow_negative_numbers = true)]
    pub noise: Option<f64>,
}

/// Numbers of samples: from the first on, before the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RangeArg(pub [u32; 2]);

impl std::str::FromStr for RangeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<RangeArg, String> {
        let ends = text.split_once("..").and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
        ends.filter(|[a, b]| a < b).map(RangeArg).ok_or_else(|| "expected A..B with A below B, as in 0..64".into())
    }
}

/// Words of `jerboa merge`.
#[derive(Clone, Debug, Args)]
pub struct MergeArgs {
    /// What `jerboa render --sample-range` wrote for the parts of one image, in any order
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,
    /// Where the image goes: .exr is linear, .png is exposed, clamped to [0, 1] and sRGB-encoded
    #[arg(short, long, value_name = "OUT", default_value = "out.png")]
    pub output: PathBuf,
    /// Write a part again, to be merged with others
    #[arg(long, conflicts_with = "variance")]
    pub part: bool,
    /// Put up with samples that are in none of the parts but between others
    #[arg(long)]
    pub gaps: bool,
    /// Layers of an .exr: the estimated variance of the image, variance.R, .G, .B
    #[arg(long)]
    pub variance: bool,
    /// Exposure of a PNG in stops: its values are multiplied by 2^EV
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    pub exposure: f32,
    /// Print samples, dropped samples and the estimated error as JSON
    #[arg(long)]
    pub json: bool,
}
