//! `jerboa bench error`: speed against error, our levels and devices beside each other and beside a peer.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::args::SelectArgs;
use super::scene;
use crate::host::efficiency::contestant::{Contestant, Ours};
use crate::host::efficiency::page::page;
use crate::host::efficiency::table::{Metric, csv, from_csv, gain};
use crate::host::efficiency::{Job, Measurement, measure, short_name};
use crate::host::error::Error;
use crate::host::figures::peer::Setting;
use crate::host::image_io::write_atomic;

/// Words of `jerboa bench error`.
#[derive(Debug, Args)]
pub struct ErrorArgs {
    /// .gltf, .glb or .obj files, or builtin:NAME
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<String>,
    /// A contestant of ours, by words of `jerboa render`; may be given again [default: the levels structure and nothing]
    #[arg(long, value_name = "WORDS", allow_hyphen_values = true)]
    pub ours: Vec<String>,
    /// Compare with Mitsuba 3, which this Python has (.glb files only)
    #[arg(long, value_name = "PYTHON")]
    pub peer: Option<PathBuf>,
    /// Samplers of the peer, a contestant each
    #[arg(long, value_name = "NAME", value_delimiter = ',', default_value = "independent", requires = "peer")]
    pub peer_sampler: Vec<String>,
    /// Scatterings from which on roulette may end the peer's paths, a contestant each
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "5", requires = "peer")]
    pub peer_rr_depth: Vec<u32>,
    /// Wall times from the opening of the file to the finished film, seconds
    #[arg(long, value_name = "SECONDS", value_delimiter = ',', default_value = "2,8", value_parser = super::args::seconds)]
    pub budget: Vec<f32>,
    /// Renders with other seeds for each of them
    #[arg(long, value_name = "K", default_value_t = 16, value_parser = clap::value_parser!(u32).range(2..=1024))]
    pub runs: u32,
    /// The first seed
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u32,
    /// Width of the films in pixels [default: the camera's extras.width, else 1280]
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub width: Option<u32>,
    /// Height of the films in pixels [default: by the camera's aspect]
    #[arg(long, value_name = "H", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub height: Option<u32>,
    /// Longest path in edges, of all contestants
    #[arg(long, value_name = "D", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
    pub max_depth: u32,
    /// Write the report, a page that holds all it shows
    #[arg(short, long, value_name = "REPORT.html")]
    pub output: Option<PathBuf>,
    /// Write a line for each run; what the file has already is not measured again
    #[arg(long, value_name = "RUNS.csv")]
    pub csv: Option<PathBuf>,
}

/// What stands in the report for somebody who gave no words.
const LEVELS: [&str; 2] = ["--known structure", "--known nothing"];

/// Measures what the file of runs has not yet, writes the files that are asked for after each scene and budget, and gives a
/// table.
pub(super) fn run(args: &ErrorArgs) -> Result<String, Error> {
    for (path, ending) in [(&args.output, "html"), (&args.csv, "csv")] {
        if let Some(path) = path.as_ref().filter(|p| p.extension().is_none_or(|e| e != ending)) {
            return Err(Error::new(format!("cannot write {}: its name must end in .{ending}", path.display())));
        }
    }
    let mut measurements = before(args)?;
    for path in &args.scenes {
        // For its size. What of the file is shown is for the words of each contestant to say.
        let (scene, _) = scene::load(path, &SelectArgs::default())?;
        let size = scene::film_size(&scene.camera_or_default(), args.width, args.height);
        drop(scene);
        let name = short_name(path);
        let at = measurements.iter().position(|m| m.scene == name && m.size == size).unwrap_or_else(|| {
            measurements.push(Measurement { scene: name.clone(), size, outcomes: Vec::new() });
            measurements.len() - 1
        });
        // To the microsecond: 0.3 is 0.3 then, not the next number in single precision.
        for budget in args.budget.iter().map(|b| (f64::from(*b) * 1e6).round() / 1e6) {
            let known = &measurements[at].outcomes;
            if known.iter().any(|o| o.budget == budget) {
                eprintln!("{name}, {budget} s: measured before");
                continue;
            }
            let mut contestants = contestants(args, path, size)?;
            let first = known.first().map(|o| o.budget);
            let before = known.iter().filter(|o| Some(o.budget) == first).map(|o| o.contestant.as_str());
            if first.is_some() && !before.eq(contestants.iter().map(Contestant::name)) {
                let file = args.csv.as_deref().unwrap_or(Path::new("the runs")).display();
                return Err(Error::new(format!("{file} has {name} by other contestants: choose another file")));
            }
            let job = Job { size, budgets: vec![budget], runs: args.runs, seed: args.seed };
            let measured = measure(&name, &job, &mut contestants, |doing| eprintln!("{doing}"))?;
            measurements[at].outcomes.extend(measured.outcomes);
            write(args, &measurements)?;
        }
    }
    write(args, &measurements)?;
    Ok(measurements.iter().map(as_text).collect())
}

/// What the file of runs has, if there is one.
fn before(args: &ErrorArgs) -> Result<Vec<Measurement>, Error> {
    let Some(path) = args.csv.as_ref().filter(|path| path.exists()) else { return Ok(Vec::new()) };
    let fault = |e: &dyn std::fmt::Display| Error::new(format!("{}: {e}", path.display()));
    from_csv(&std::fs::read_to_string(path).map_err(|e| fault(&e))?).map_err(|e| fault(&e))
}

/// Ours, then the peer with each sampler and roulette. The rules are the references': shading normals free.
fn contestants(args: &ErrorArgs, path: &str, size: [u32; 2]) -> Result<Vec<Contestant>, Error> {
    let program =
        std::env::current_exe().map_err(|e| Error::new(format!("where this program lies is unknown: {e}")))?;
    let ours = if args.ours.is_empty() { LEVELS.map(String::from).to_vec() } else { args.ours.clone() };
    let rules = ["--shading-normals", "free", "--max-depth", &args.max_depth.to_string()].map(String::from);
    let one = |words: &String| {
        let words_of_all = rules.iter().cloned().chain(words.split_whitespace().map(String::from)).collect();
        let name = format!("Jerboa {words}").trim().to_string();
        Contestant::Ours(Ours { name, program: program.clone(), scene: path.into(), words: words_of_all })
    };
    let mut all: Vec<Contestant> = ours.iter().map(one).collect();
    if let Some(python) = args.peer.as_ref().filter(|_| path.ends_with(".glb")) {
        for sampler in &args.peer_sampler {
            for rr_depth in &args.peer_rr_depth {
                let (max_depth, rr_depth) = (args.max_depth, *rr_depth);
                let setting = Setting { size, spp: 1, max_depth, rr_depth, sampler: sampler.clone(), lanes: None };
                let name = format!("Mitsuba 3 {sampler}, roulette from {rr_depth}");
                all.push(Contestant::peer(name, python, Path::new(path), &setting)?);
            }
        }
    }
    Ok(all)
}

/// Writes the files that are asked for.
fn write(args: &ErrorArgs, measurements: &[Measurement]) -> Result<(), Error> {
    let put = |path: &Option<PathBuf>, text: &dyn Fn() -> String| match path {
        Some(path) => write_atomic(path, |file| std::io::Write::write_all(file, text().as_bytes())),
        None => Ok(()),
    };
    put(&args.csv, &|| csv(measurements))?;
    put(&args.output, &|| page(&about(args), measurements))
}

/// What was measured, and where.
fn about(args: &ErrorArgs) -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!(
        "{} renders with other seeds for each budget, interleaved; longest path {} edges, shading normals free. {}, {cores} cores, {}.",
        args.runs,
        args.max_depth,
        std::env::consts::ARCH,
        std::env::consts::OS,
    )
}

/// A line for each contestant and budget.
fn as_text(measurement: &Measurement) -> String {
    let Measurement { scene, size: [width, height], outcomes } = measurement;
    let mut text = format!("{scene}, {width}x{height}\n");
    for outcome in outcomes {
        let first = outcomes.iter().find(|r| r.budget == outcome.budget).expect("this one, if no other");
        let error = Metric::Relative.of(&outcome.runs);
        let seconds = outcome.mean(|run| run.seconds);
        let mut line = format!(
            "  {:<44} {:>6} s: {:>6} spp in {seconds:.2} s, relMSE {error:.3e}",
            outcome.contestant, outcome.budget, outcome.spp
        );
        if outcome.contestant != first.contestant {
            let by = gain(first, outcome, Metric::Relative);
            line += &format!(", the first gains {:.2} [{:.2}, {:.2}]", by.value, by.least, by.most);
            line += &format!(", trimmed {:.2}", gain(first, outcome, Metric::Trimmed).value);
        }
        writeln!(text, "{line}").expect("a string takes it");
    }
    text
}
