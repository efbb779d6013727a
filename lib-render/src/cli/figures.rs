//! `jerboa bench table-2` and `figure-2` to `figure-5`: the paper's experiments.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use jerboa_scenes::Scene;
use serde_json::{Map, Value, json};

use super::args::SelectArgs;
use super::{in_pool, scene};
use crate::host::error::Error;
use crate::host::figures::peer::Peer;
use crate::host::figures::plot::{plot, short};
use crate::host::figures::{Chart, Group, LEVELS, Spread, figure_2, figure_3, figure_4, figure_5, table_2};
use crate::host::image_io::write_atomic;

/// Built-in scenes that have what the paper's scenes have: rooms, textures, glass and metal, many lights.
const SCENES: [&str; 5] =
    ["builtin:cornell-box", "builtin:material-balls", "builtin:textures", "builtin:glass", "builtin:many-lights"];

/// How the charts are told.
#[derive(Debug, Args)]
pub struct OutputArgs {
    /// Print a list of charts as JSON: title, unit, groups, each with its name, bars (series, median, least, most) and notes
    #[arg(long)]
    pub json: bool,
    /// Draw the charts
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,
}

/// What is rendered.
#[derive(Debug, Args)]
pub struct RenderedArgs {
    /// .gltf or .glb files, or builtin:NAME [default: some built-in scenes]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Of each file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// Width of the film in pixels [default: the camera's extras.width, else 1280]
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub width: Option<u32>,
    /// Height of the film in pixels [default: by the camera's aspect]
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub height: Option<u32>,
    /// Samples per pixel in each round
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub spp: u32,
    /// Longest path in edges
    #[arg(long, value_name = "D", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub max_depth: u32,
    /// Rounds in which all take turns
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,
}

/// Words of `jerboa bench table-2`.
#[derive(Debug, Args)]
pub struct Table2Args {
    /// What is rendered.
    #[command(flatten)]
    pub rendered: RenderedArgs,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Compare with Mitsuba 3, which this Python has (.glb files only)
    #[arg(long, value_name = "PYTHON", conflicts_with_all = ["scene_of_file", "variant", "time"])]
    pub peer: Option<PathBuf>,
    /// Width of the peer's vectors [default: its best]
    #[arg(long, value_name = "4|8|16", requires = "peer", value_parser = lanes)]
    pub peer_lanes: Option<u32>,
    /// How the charts are told.
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Words of `jerboa bench devices`.
#[derive(Debug, Args)]
pub struct BenchDevicesArgs {
    /// What is rendered.
    #[command(flatten)]
    pub rendered: RenderedArgs,
    /// Threads of the CPU [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Print an object as JSON: the chart, and remarks on what it shows
    #[arg(long)]
    pub json: bool,
}

/// Words of `jerboa bench figure-2`.
#[derive(Debug, Args)]
pub struct Figure2Args {
    /// What is rendered.
    #[command(flatten)]
    pub rendered: RenderedArgs,
    /// How the charts are told.
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Words of `jerboa bench figure-3` and `figure-4`.
#[derive(Debug, Args)]
pub struct BatchArgs {
    /// Rounds in which all take turns
    #[arg(long, value_name = "N", default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,
    /// How the charts are told.
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Words of `jerboa bench figure-5`.
#[derive(Debug, Args)]
pub struct Figure5Args {
    /// .gltf or .glb files, or builtin:NAME [default: some built-in scenes]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Of each file that holds more than one.
    #[command(flatten)]
    pub select: SelectArgs,
    /// Rounds in which all take turns
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,
    /// Threads [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// How the charts are told.
    #[command(flatten)]
    pub output: OutputArgs,
}

/// A width of vectors.
fn lanes(text: &str) -> Result<u32, String> {
    text.parse().ok().filter(|n| [4, 8, 16].contains(n)).ok_or_else(|| "expected 4, 8 or 16".into())
}

/// Table 2.
pub(super) fn table_2(args: &Table2Args) -> Result<String, Error> {
    tell(&args.output, || {
        let mut groups = Vec::new();
        for path in names(&args.rendered.scenes) {
            let scene = scene::load(path, &args.rendered.select)?.0;
            let job = args.rendered.job(&scene);
            let python = args.peer.as_ref().filter(|_| path.ends_with(".glb"));
            let mut peer =
                python.map(|python| Peer::start(python, Path::new(path), &job.of_peer(args.peer_lanes))).transpose()?;
            peer.as_mut().map(Peer::load).transpose()?;
            groups.push(in_pool(args.threads, || table_2::measure(&scene, &job, peer.as_mut()))?);
        }
        groups.push(table_2::means(&groups));
        let lanes = args.peer_lanes.map_or(String::new(), |n| format!(", {n} lanes"));
        let peer = args.peer.as_ref().map(|_| format!("Mitsuba 3{lanes}"));
        let series: Vec<String> = LEVELS.iter().map(|(_, name)| name.to_string()).chain(peer).collect();
        groups.iter_mut().for_each(|g| g.bars.resize(series.len(), None));
        Ok(vec![Chart { title: "Whole renders".into(), unit: "Msamples/s", stacked: false, series, groups }])
    })
}

/// Figure 2.
pub(super) fn figure_2(args: &Figure2Args) -> Result<String, Error> {
    tell(&args.output, || {
        let load = |path| {
            let scene = scene::load(path, &args.rendered.select)?.0;
            let job = args.rendered.job(&scene);
            Ok((scene, job))
        };
        let scenes = names(&args.rendered.scenes).into_iter().map(load).collect::<Result<Vec<_>, Error>>()?;
        figure_2::measure(&scenes)
    })
}

/// Figure 3.
pub(super) fn figure_3(args: &BatchArgs) -> Result<String, Error> {
    tell(&args.output, || figure_3::measure(args.rounds))
}

/// Figure 4.
pub(super) fn figure_4(args: &BatchArgs) -> Result<String, Error> {
    tell(&args.output, || figure_4::measure(args.rounds))
}

/// Figure 5.
pub(super) fn figure_5(args: &Figure5Args) -> Result<String, Error> {
    tell(&args.output, || {
        let scenes = names(&args.scenes).into_iter().map(|path| Ok(scene::load(path, &args.select)?.0));
        let scenes = scenes.collect::<Result<Vec<_>, Error>>()?;
        in_pool(args.threads, || figure_5::measure(&scenes, args.rounds))
    })
}

impl RenderedArgs {
    /// What is rendered of a scene.
    pub(super) fn job(&self, scene: &Scene) -> table_2::Job {
        let RenderedArgs { spp, rounds, max_depth, .. } = *self;
        let size = scene::film_size(&scene.camera_or_default(), self.width, self.height);
        table_2::Job { size, spp, rounds, max_depth }
    }
}

/// These scenes, or the usual ones.
pub(super) fn names(scenes: &[String]) -> Vec<&str> {
    if scenes.is_empty() { SCENES.to_vec() } else { scenes.iter().map(String::as_str).collect() }
}

/// Measures, draws and prints. What cannot be written is found out before.
fn tell(output: &OutputArgs, measure: impl FnOnce() -> Result<Vec<Chart>, Error>) -> Result<String, Error> {
    if let Some(path) = output.plot.as_ref().filter(|p| p.extension().is_none_or(|e| e != "svg")) {
        return Err(Error::new(format!("cannot write {}: its name must end in .svg", path.display())));
    }
    let charts = measure()?;
    if let Some(path) = &output.plot {
        write_atomic(path, |file| std::io::Write::write_all(file, plot(&charts).as_bytes()))?;
    }
    Ok(if output.json { format!("{}\n", json_of(&charts)) } else { as_text(&charts) })
}

/// A list of charts.
pub(super) fn json_of(charts: &[Chart]) -> Value {
    let bar = |(name, bar): (&String, &Option<Spread>)| {
        bar.map(|s| json!({ "series": name, "median": s.median, "least": s.least, "most": s.most }))
    };
    let group = |chart: &Chart, group: &Group| {
        json!({
            "name": group.name,
            "bars": chart.series.iter().zip(&group.bars).filter_map(bar).collect::<Vec<_>>(),
            "notes": group.notes.iter().map(|(name, x)| (name.clone(), (*x).into())).collect::<Map<_, _>>(),
        })
    };
    let chart = |c: &Chart| {
        let groups: Vec<_> = c.groups.iter().map(|g| group(c, g)).collect();
        json!({ "title": c.title, "unit": c.unit, "groups": groups })
    };
    Value::Array(charts.iter().map(chart).collect())
}

/// A table for each chart: a line for each group, with its bars and then its notes.
pub(super) fn as_text(charts: &[Chart]) -> String {
    let tables: Vec<String> = charts.iter().map(|chart| aligned(&rows(chart))).collect();
    tables.join("\n")
}

/// The cells of a chart's table, line by line, the head first.
fn rows(chart: &Chart) -> Vec<Vec<String>> {
    let mut notes: Vec<&String> = Vec::new();
    for (name, _) in chart.groups.iter().flat_map(|g| &g.notes) {
        if !notes.contains(&name) {
            notes.push(name);
        }
    }
    let title = format!("{}, {}", chart.title, chart.unit);
    let head = [title].into_iter().chain(chart.series.iter().cloned()).chain(notes.iter().map(|n| n.to_string()));
    let line = |group: &Group| {
        let bars = group.bars.iter().map(|bar| bar.map_or("-".into(), cell));
        let note = |name: &&String| group.notes.iter().find(|(n, _)| n == *name).map_or("-".into(), |(_, x)| short(*x));
        [group.name.clone()].into_iter().chain(bars).chain(notes.iter().map(note)).collect()
    };
    [head.collect()].into_iter().chain(chart.groups.iter().map(line)).collect()
}

/// The median, and half of the range in per cent of it.
fn cell(Spread { median, least, most }: Spread) -> String {
    let percent = 50.0 * (most - least) / median;
    if least == most { short(median) } else { format!("{} ±{percent:.0}%", short(median)) }
}

/// Columns as wide as their widest cell, the first to the left, the others to the right.
fn aligned(rows: &[Vec<String>]) -> String {
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows.first().map_or(0, Vec::len)).map(width).collect();
    let mut text = String::new();
    for row in rows {
        write!(text, "{:<1$}", row[0], widths[0]).expect("a string takes it");
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            write!(text, "  {cell:>width$}").expect("a string takes it");
        }
        text.push('\n');
    }
    text
}
