//! `jerboa render`: a scene to an image.

use std::path::Path;
use std::time::Duration;

use super::args::{DeviceArg, RenderArgs};
use super::goal::Goal;
use super::in_pool;
use super::progress::with_progress;
use super::scene::{camera, choices, film_size, lens, load_silently, say_warnings, set_environment};
use crate::host::aov::{channels, components};
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::exr::Channel;
use crate::host::film::{Film, GROUPS, Window};
use crate::host::generate::TracerKind;
use crate::host::image_io::Image;
use crate::host::renderer::{Options, Render, Renderer, Stats};
use crate::host::variance::{relative_error, variance};

/// Most pixels of a film: 2^26, whose sums and a pass over them take 8 GiB; where samples come in groups, an eighth.
const MOST_PIXELS: usize = 1 << 26;

/// Renders, writes the image and returns what to print.
pub(super) fn run(args: &RenderArgs) -> Result<String, Error> {
    in_pool(args.threads, || run_here(args))
}

fn run_here(args: &RenderArgs) -> Result<String, Error> {
    Image::check_target(&args.output)?;
    if !args.shown.aov.is_empty() || args.part.variance {
        Image::check_layers(&args.output)?;
    }
    let (mut scene, load_time) = load_silently(&args.scene, &args.select)?;
    set_environment(&mut scene, args)?;
    say_warnings(&scene);
    let camera = lens(camera(&scene, args.camera.as_deref())?, args)?;
    let size = film_size(&camera, args.width, args.height);
    let window = window(args, size)?;

    let options = Options {
        known: args.known.into(),
        tracer: args.shown.tracer.into(),
        choices: choices(args, &camera),
        device: device(args),
        traversal: args.traversal.into(),
        ..Options::default()
    };
    let goal = Goal::new(args, &scene, &camera, &options)?;
    let (mut film, done) = goal.film(size, window)?;
    let renderer = Renderer::new(&scene, options)?;
    // The renderer has its own tables.
    drop(scene);
    let job = if goal.is_reached(&film, done) { Render { spp: done, ..goal.job } } else { goal.job };
    let samples = window.area() as u64 * u64::from(job.spp - done);
    let stats = with_progress(samples, args.time_limit, |handle| {
        renderer.render_on(&camera, &mut film, job, done, handle, &mut |film, done| goal.after(film, done))
    })?;
    if args.part.sample_range.is_none() {
        let layers: Vec<_> = args.shown.aov.iter().map(|aov| (*aov).into()).collect();
        let job = Render { spp: stats.spp.max(1), ..job };
        let layers = if layers.is_empty() { Vec::new() } else { channels(&renderer, &camera, &film, job, &layers)? };
        write_image(&film, &args.output, args.exposure, args.part.variance, layers)?;
    } else if stats.spp == 0 {
        return Err(Error::new("no pass came to its end within --time-limit: there is no part"));
    }
    let error = estimated_error(&film);
    let report = Report { args, size, load_time, renderer: &renderer, stats, dropped: film.dropped(), error };
    Ok(if args.json { report.json() } else { report.text() })
}

/// The device that is asked for; where any will do, one that has the tracer.
fn device(args: &RenderArgs) -> DeviceKind {
    let is_any = args.device == DeviceArg::Auto;
    if is_any && TracerKind::from(args.shown.tracer).is_splatting() { DeviceKind::Cpu } else { args.device.into() }
}

/// The pixels that are asked for.
fn window(args: &RenderArgs, [width, height]: [u32; 2]) -> Result<Window, Error> {
    let whole = Window { x: 0, y: 0, width, height };
    let Some(crop) = args.crop else { return within_memory(args, whole) };
    let [x, y, width, height] = crop.0;
    let window = Window { x, y, width, height };
    if !whole.contains(&window) {
        let message =
            format!("--crop {x},{y},{width},{height} reaches beyond the film of {}x{}", whole.width, whole.height);
        return Err(Error::new(message));
    }
    within_memory(args, window)
}

/// Refuse a film that would not fit into memory: that would end the process without a word.
fn within_memory(args: &RenderArgs, window: Window) -> Result<Window, Error> {
    let most = if Goal::is_grouped(args) { MOST_PIXELS / GROUPS as usize } else { MOST_PIXELS };
    if window.area() > most {
        let Window { width, height, .. } = window;
        let message = format!("a film of {width}x{height} is too large, at most {most} pixels: render parts by --crop");
        return Err(Error::new(message));
    }
    Ok(window)
}

/// Writes the image of a film: with layers beside it, its variance and others, where there are any.
pub(super) fn write_image(
    film: &Film,
    path: &Path,
    exposure: f32,
    with_variance: bool,
    mut layers: Vec<Channel>,
) -> Result<(), Error> {
    if with_variance {
        layers.extend(components("variance", ["R", "G", "B"], &variance(film)));
    }
    if layers.is_empty() { film.mean().write(path, exposure) } else { film.mean().write_with(path, layers) }
}

/// What is said of the noise, if it is known.
pub(super) fn noise_line(error: Option<f64>) -> String {
    error.map_or_else(String::new, |e| format!("estimated relMSE {e:.3e}\n"))
}

/// What is said of samples that were dropped, if any were.
pub(super) fn dropped_line(dropped: u64) -> String {
    if dropped == 0 { String::new() } else { format!("{dropped} samples were not finite and were dropped\n") }
}

/// The estimated error of a film that tells it.
pub(super) fn estimated_error(film: &Film) -> Option<f64> {
    (film.groups() == GROUPS).then(|| relative_error(film)).filter(|e| e.is_finite())
}

/// What a render tells.
struct Report<'a> {
    args: &'a RenderArgs,
    size: [u32; 2],
    load_time: Duration,
    renderer: &'a Renderer,
    stats: Stats,
    dropped: u64,
    /// Estimated relative mean squared error.
    error: Option<f64>,
}

impl Report<'_> {
    /// Phases and their times, s.
    fn phases(&self) -> [(&'static str, f64); 6] {
        [
            ("load", self.load_time),
            ("tables", self.renderer.tables_time),
            ("bvh", self.renderer.tables().bvh_time),
            ("specialize", self.renderer.specialize_time),
            ("codegen", self.renderer.codegen_time),
            ("render", self.stats.time),
        ]
        .map(|(name, time)| (name, time.as_secs_f64()))
    }

    fn json(&self) -> String {
        let seconds: serde_json::Map<_, _> = self.phases().iter().map(|(n, s)| (n.to_string(), (*s).into())).collect();
        let object = serde_json::json!({
            "output": self.args.output,
            "width": self.size[0],
            "height": self.size[1],
            "spp": self.stats.spp,
            "rays": { "closest": self.stats.closest_rays, "shadow": self.stats.shadow_rays },
            "seconds": seconds,
            "dropped_samples": self.dropped,
            "estimated_relmse": self.error,
        });
        format!("{object}\n")
    }

    fn text(&self) -> String {
        let rays = self.stats.closest_rays + self.stats.shadow_rays;
        let seconds = self.stats.time.as_secs_f64();
        let phases: Vec<String> = self.phases().iter().map(|(n, s)| format!("{n} {:.0} ms", s * 1e3)).collect();
        let first = format!(
            "{}: {}x{}, {} spp, {:.1} million rays, {:.2} million rays/s\n{}\n",
            self.args.output.display(),
            self.size[0],
            self.size[1],
            self.stats.spp,
            rays as f64 / 1e6,
            rays as f64 / 1e6 / seconds.max(f64::MIN_POSITIVE),
            phases.join(", "),
        );
        first + &noise_line(self.error) + &dropped_line(self.dropped)
    }
}
