//! What several subcommands share: scene, camera, renderer from the words of the command line.

use std::path::Path;
use std::time::{Duration, Instant};

use jerboa_scenes::{Camera, Environment, Limits, Scene, Selection, Sky};

use super::args::{
    DeviceArg, KnownArg, RenderArgs, RouletteArg, SamplerArg, SamplingArgs, SelectArgs, ShadingNormalsArg, TraversalArg,
};
use super::goal::Goal;
use crate::host::device::{DeviceKind, Traversal};
use crate::host::error::Error;
use crate::host::gpu;
use crate::host::library::Library;
use crate::host::tables::models::check_models;
use crate::host::tables::{CameraKind, Choices, Known, SamplerKind};

impl From<KnownArg> for Known {
    fn from(arg: KnownArg) -> Known {
        match arg {
            KnownArg::Nothing => Known::Nothing,
            KnownArg::Structure => Known::Structure,
            KnownArg::All => Known::All,
        }
    }
}

impl From<TraversalArg> for Traversal {
    fn from(arg: TraversalArg) -> Traversal {
        match arg {
            TraversalArg::Native => Traversal::Native,
            TraversalArg::Ir => Traversal::Ir,
        }
    }
}

impl From<DeviceArg> for DeviceKind {
    /// May have to look whether there is a GPU.
    fn from(arg: DeviceArg) -> DeviceKind {
        match arg {
            DeviceArg::Auto if gpu::is_there() => DeviceKind::GpuWavefront,
            DeviceArg::Auto | DeviceArg::Cpu => DeviceKind::Cpu,
            DeviceArg::CpuScalar => DeviceKind::CpuScalar,
            DeviceArg::GpuMegakernel => DeviceKind::GpuMegakernel,
            DeviceArg::GpuWavefront => DeviceKind::GpuWavefront,
        }
    }
}

/// Load what is asked for of a file whose models are all there, say its warnings on stderr, and how long it took.
pub fn load(path: &str, select: &SelectArgs) -> Result<(Scene, Duration), Error> {
    let (scene, time) = load_silently(path, select)?;
    say_warnings(&scene);
    Ok((scene, time))
}

/// Say on stderr what was wrong with a file and what its scene lacks now.
pub fn say_warnings(scene: &Scene) {
    for warning in scene.all_warnings() {
        eprintln!("jerboa: warning: {warning}");
    }
}

/// As [`load`], of a scene that is yet to get its environment: whether it lacks light is not known before.
pub fn load_silently(path: &str, select: &SelectArgs) -> Result<(Scene, Duration), Error> {
    let SelectArgs { scene_of_file, variant, time, animation } = select.clone();
    let selection = Selection { scene: scene_of_file, variant, time, animation };
    let start = Instant::now();
    let scene = Scene::load_selected(path, &selection, &Limits::default()).map_err(|e| Error::new(e.to_string()))?;
    check_models(&scene, Library::standard().components())?;
    Ok((scene, start.elapsed()))
}

/// Put the environment of the command line in place of the scene's, or change the scene's own.
pub fn set_environment(scene: &mut Scene, args: &RenderArgs) -> Result<(), Error> {
    let RenderArgs { env, env_rotation, env_strength, .. } = args;
    if let Some(sky) = env.as_deref().and_then(Path::to_str).and_then(|name| name.strip_prefix("sky:")) {
        let environment = sky_of(sky)?.environment().map_err(|e| Error::new(format!("--env sky:{sky}: {e}")))?;
        let (intensity, rotation_deg) = (env_strength.unwrap_or(1.0), env_rotation.unwrap_or(0.0));
        scene.environment = Some(Environment { intensity, rotation_deg, ..environment });
        return Ok(());
    }
    if let Some(file) = env {
        return scene
            .set_environment(Path::new(file), env_strength.unwrap_or(1.0), env_rotation.unwrap_or(0.0))
            .map_err(|e| Error::new(e.to_string()));
    }
    match &mut scene.environment {
        Some(e) => {
            e.intensity *= env_strength.unwrap_or(1.0);
            e.rotation_deg += env_rotation.unwrap_or(0.0);
            Ok(())
        }
        None if env_rotation.is_some() || env_strength.is_some() => {
            Err(Error::new("the scene has no environment to turn or scale: name one by --env FILE"))
        }
        None => Ok(()),
    }
}

/// A sky by `ELEVATION[,AZIMUTH[,TURBIDITY]]`.
fn sky_of(text: &str) -> Result<Sky, Error> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|word| word.trim().parse::<f64>()).collect();
    let sky = match numbers.as_deref() {
        Ok([elevation_deg]) => Sky { elevation_deg: *elevation_deg, ..Sky::default() },
        Ok([elevation_deg, azimuth_deg]) => {
            Sky { elevation_deg: *elevation_deg, azimuth_deg: *azimuth_deg, ..Sky::default() }
        }
        Ok([elevation_deg, azimuth_deg, turbidity]) => {
            let turbidity = *turbidity as f32;
            Sky { elevation_deg: *elevation_deg, azimuth_deg: *azimuth_deg, turbidity, ..Sky::default() }
        }
        _ => return Err(Error::new(format!("--env sky:{text}: a sky is sky:ELEVATION[,AZIMUTH[,TURBIDITY]]"))),
    };
    Ok(sky)
}

/// The camera that is asked for, the first, or one that frames the scene.
pub fn camera(scene: &Scene, name: Option<&str>) -> Result<Camera, Error> {
    match name {
        Some(name) => scene.camera_named(name).cloned().map_err(|e| Error::new(e.to_string())),
        None => Ok(scene.camera_or_default()),
    }
}

/// A camera with the lens that is asked for.
pub fn lens(camera: Camera, args: &RenderArgs) -> Result<Camera, Error> {
    if args.aperture.is_none() && args.focus.is_none() {
        return Ok(camera);
    }
    let (aperture, focus) = (args.aperture.map(f64::from), args.focus.map(f64::from));
    let with_lens = camera.with_lens(aperture, focus).filter(|c| aperture.is_some() || c.lens != camera.lens);
    with_lens.ok_or_else(|| Error::new("a lens takes a camera of perspective, --aperture, and --focus above 0"))
}

/// Film size: what is asked for; one side alone keeps the camera's aspect.
pub fn film_size(camera: &Camera, width: Option<u32>, height: Option<u32>) -> [u32; 2] {
    let (w, h) = camera.film_or_default();
    let scaled = |side: u32, from: u32, to: u32| {
        (f64::from(side) * f64::from(to) / f64::from(from)).round().clamp(1.0, 65536.0) as u32
    };
    match (width, height) {
        (Some(width), Some(height)) => [width, height],
        (Some(width), None) => [width, scaled(width, w, h)],
        (None, Some(height)) => [scaled(height, h, w), height],
        (None, None) => [w, h],
    }
}

/// The choices that a kernel sees.
pub fn choices(args: &RenderArgs, camera: &Camera) -> Choices {
    Choices {
        max_depth: args.max_depth,
        rr_depth: Some(args.rr_depth),
        rr_cap: args.rr_cap,
        learned_roulette: learns(&args.sampling),
        consistent_normals: args.shading_normals == ShadingNormalsArg::Consistent,
        ray_offset: args.ray_offset,
        occlusion_distance: args.shown.ao_distance.unwrap_or(f32::INFINITY),
        camera: Some(CameraKind::of(camera)),
        solid_angle: args.solid_angle,
        sampler: sampler(&args.sampling, Goal::is_grouped(args)),
        cull_back_faces: args.cull_back_faces,
        ..Choices::default()
    }
}

/// The choices of a command that has words for sampling alone: those of `jerboa render` without other words.
pub fn choices_of(sampling: &SamplingArgs) -> Choices {
    Choices { sampler: sampler(sampling, false), learned_roulette: learns(sampling), ..Choices::default() }
}

fn learns(args: &SamplingArgs) -> bool {
    args.roulette == RouletteArg::Learned
}

/// The sampler that is asked for. Where nothing is said of sequences there is one, or as many as it takes for an image that is to
/// tell its error.
fn sampler(args: &SamplingArgs, tells_error: bool) -> SamplerKind {
    match (args.sampler, args.scrambles) {
        (SamplerArg::Independent, _) => SamplerKind::Independent,
        (SamplerArg::Sobol, Some(scrambles)) => SamplerKind::Sobol { log_scrambles: scrambles.ilog2() },
        (SamplerArg::Sobol, None) if tells_error => SamplerKind::SOBOL,
        (SamplerArg::Sobol, None) => SamplerKind::Sobol { log_scrambles: 0 },
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::cli::args::{Cli, Command};

    fn rendered(words: &str) -> Choices {
        let words = format!("jerboa render {words}");
        let Command::Render(args) = Cli::try_parse_from(words.split_whitespace()).expect("words").command else {
            panic!("another command")
        };
        Choices { camera: None, ..choices(&args, &Camera::look_at("", glam::DVec3::Z, glam::DVec3::ZERO, 1.0)) }
    }

    #[test]
    fn who_asks_for_the_error_gets_sequences_that_tell_it() {
        let sobol = |log_scrambles| SamplerKind::Sobol { log_scrambles };
        let expected = [sobol(0), sobol(3), sobol(3), sobol(1), SamplerKind::Independent];
        let words = ["", "--noise 0.01", "--variance", "--variance --scrambles 2", "--noise 1 --sampler independent"];
        assert_eq!(words.map(|words| rendered(words).sampler), expected);
    }

    /// What the other commands show is what is rendered.
    #[test]
    fn what_is_not_said_is_one_for_all_commands() {
        assert_eq!(choices_of(&SamplingArgs::default()), rendered(""));
        let independent = SamplingArgs { sampler: SamplerArg::Independent, ..SamplingArgs::default() };
        assert_eq!(choices_of(&independent), rendered("--sampler independent"));
        assert_eq!(
            choices_of(&SamplingArgs { scrambles: Some(4), ..SamplingArgs::default() }),
            rendered("--scrambles 4")
        );
    }
}
