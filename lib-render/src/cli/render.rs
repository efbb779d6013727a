//! `jerboa render`: a scene to an image.

use std::io::IsTerminal;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::args::{DeviceArg, RenderArgs};
use super::in_pool;
use super::scene::{camera, choices, film_size, lens, load, set_environment};
use crate::host::aov::channels;
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::film::{Film, Window};
use crate::host::generate::TracerKind;
use crate::host::image_io::Image;
use crate::host::renderer::{Handle, Options, Render, Renderer, Stats};

/// How often the progress bar and the time limit are looked at.
const TICK: Duration = Duration::from_millis(20);

/// Most pixels of a film: 2^26, whose sums and a pass over them take 8 GiB.
const MOST_PIXELS: usize = 1 << 26;

/// Renders, writes the image and returns what to print.
pub(super) fn run(args: &RenderArgs) -> Result<String, Error> {
    in_pool(args.threads, || run_here(args))
}

fn run_here(args: &RenderArgs) -> Result<String, Error> {
    Image::check_target(&args.output)?;
    if !args.shown.aov.is_empty() {
        Image::check_layers(&args.output)?;
    }
    let (mut scene, load_time) = load(&args.scene, &args.select)?;
    set_environment(&mut scene, args)?;
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
    let renderer = Renderer::new(&scene, options)?;
    // The renderer has its own tables.
    drop(scene);
    let mut film = Film::try_crop(size, window)?;
    let job = Render { sample: 0, spp: args.spp, seed: args.seed };
    let stats = with_progress(args, window, |handle| renderer.render_with(&camera, &mut film, job, handle))?;
    if args.shown.aov.is_empty() {
        film.mean().write(&args.output, args.exposure)?;
    } else {
        let layers: Vec<_> = args.shown.aov.iter().map(|aov| (*aov).into()).collect();
        let job = Render { spp: stats.spp.max(1), ..job };
        film.mean().write_with(&args.output, channels(&renderer, &camera, &film, job, &layers)?)?;
    }
    let report = Report { args, size, load_time, renderer: &renderer, stats, dropped: film.dropped() };
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
    let Some(crop) = args.crop else { return within_memory(whole) };
    let [x, y, width, height] = crop.0;
    let window = Window { x, y, width, height };
    if !whole.contains(&window) {
        let message =
            format!("--crop {x},{y},{width},{height} reaches beyond the film of {}x{}", whole.width, whole.height);
        return Err(Error::new(message));
    }
    within_memory(window)
}

/// Refuse a film that would not fit into memory: that would end the process without a word.
fn within_memory(window: Window) -> Result<Window, Error> {
    if window.area() > MOST_PIXELS {
        let Window { width, height, .. } = window;
        let message =
            format!("a film of {width}x{height} is too large, at most {MOST_PIXELS} pixels: render parts by --crop");
        return Err(Error::new(message));
    }
    Ok(window)
}

/// Run `render`, with a progress bar on a terminal and within the time limit.
fn with_progress<T: Send>(args: &RenderArgs, window: Window, render: impl FnOnce(&Handle) -> T + Send) -> T {
    let handle = Handle::default();
    let total = window.area() as u64 * u64::from(args.spp);
    let deadline = args.time_limit.map(|s| Instant::now() + Duration::from_secs_f32(s));
    std::thread::scope(|scope| {
        let (done, finished) = mpsc::channel::<()>();
        let handle = &handle;
        scope.spawn(move || {
            let bar = std::io::stderr().is_terminal().then(|| progress_bar(total));
            while finished.recv_timeout(TICK) == Err(mpsc::RecvTimeoutError::Timeout) {
                if let Some(bar) = &bar {
                    bar.set_position(handle.samples_done());
                }
                if deadline.is_some_and(|d| Instant::now() >= d) {
                    handle.cancel();
                }
            }
            if let Some(bar) = bar {
                bar.finish_and_clear();
            }
        });
        let result = render(handle);
        drop(done);
        result
    })
}

fn progress_bar(total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent}% {elapsed} (left {eta})");
    ProgressBar::new(total).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// What a render tells.
struct Report<'a> {
    args: &'a RenderArgs,
    size: [u32; 2],
    load_time: Duration,
    renderer: &'a Renderer,
    stats: Stats,
    dropped: u64,
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
        });
        format!("{object}\n")
    }

    fn text(&self) -> String {
        let rays = self.stats.closest_rays + self.stats.shadow_rays;
        let seconds = self.stats.time.as_secs_f64();
        let phases: Vec<String> = self.phases().iter().map(|(n, s)| format!("{n} {:.0} ms", s * 1e3)).collect();
        let mut text = format!(
            "{}: {}x{}, {} spp, {:.1} million rays, {:.2} million rays/s\n{}\n",
            self.args.output.display(),
            self.size[0],
            self.size[1],
            self.stats.spp,
            rays as f64 / 1e6,
            rays as f64 / 1e6 / seconds.max(f64::MIN_POSITIVE),
            phases.join(", "),
        );
        if self.dropped > 0 {
            text += &format!("{} samples were not finite and were dropped\n", self.dropped);
        }
        text
    }
}
