//! CPU and GPU side by side: samples per second of whole renders on each device, and how far its images are from the CPU's.
//!
//! All devices render the same samples of the same scene and are specialised for the same. Wall time of rendering alone, from
//! the words of the frame to sums on the host, after a render that warms up, for drivers compile at the first launch. A speed
//! without an error says nothing, so beside each stands how far the image is *off*: the root mean square, over pixels and
//! channels, of its difference from the image of the device `cpu`, over the mean of that one. It is 0 only of equal images,
//! which is what all devices promise where a GPU computes as IEEE 754 says.

use std::time::Duration;

use jerboa_scenes::Scene;

use super::table_2::Job;
use super::{Group, Spread, in_turn};
use crate::host::device::DeviceKind;
use crate::host::error::Error;
use crate::host::film::Film;
use crate::host::image_io::Image;
use crate::host::renderer::{Handle, Options, Render, Renderer};
use crate::host::tables::Choices;

/// The devices, by the names of the command line; the first one's images are the measure.
pub const DEVICES: [(DeviceKind, &str); 4] = [
    (DeviceKind::Cpu, "cpu"),
    (DeviceKind::CpuScalar, "cpu-scalar"),
    (DeviceKind::GpuMegakernel, "gpu-megakernel"),
    (DeviceKind::GpuWavefront, "gpu-wavefront"),
];

/// A device with its renderer, and how far its images were off.
struct Contender {
    renderer: Renderer,
    off: f64,
}

/// What one scene showed.
#[derive(Clone, PartialEq, Debug)]
pub struct Outcome {
    /// A bar for each device, none where it cannot run; how far each but the first was off.
    pub group: Group,
    /// Why a device could not run.
    pub missing: Vec<String>,
}

/// Measures a scene on every device that can run it. The first must.
///
/// # Errors
/// As [`Renderer::new`] of the first device, and [`Renderer::render_with`].
pub fn measure(scene: &Scene, job: &Job) -> Result<Outcome, Error> {
    let choices = Choices { max_depth: Some(job.max_depth), ..Choices::default() };
    let (mut contenders, mut places, mut missing) = (Vec::new(), Vec::new(), Vec::new());
    for (place, (device, name)) in DEVICES.into_iter().enumerate() {
        match Renderer::new(scene, Options { device, choices, ..Options::default() }) {
            Ok(renderer) => {
                contenders.push(Contender { renderer, off: 0.0 });
                places.push(place);
            }
            Err(error) if place == 0 => return Err(error),
            Err(error) => missing.push(format!("{name}: {error}")),
        }
    }
    let (camera, mut expected) = (scene.camera_or_default(), None);
    let samples = f64::from(job.size[0]) * f64::from(job.size[1]) * f64::from(job.spp);
    let mut render = |round: u32, contender: &mut Contender| {
        let mut film = Film::of_size(job.size);
        let work = Render { sample: 0, spp: job.spp, seed: round };
        let stats = contender.renderer.render_with(&camera, &mut film, work, &Handle::default())?;
        let image = film.mean();
        match &expected {
            Some((of, first)) if *of == round => contender.off = contender.off.max(off(&image, first)),
            _ => expected = Some((round, image)),
        }
        Ok(samples / stats.time.max(Duration::from_nanos(1)).as_secs_f64() / 1e6)
    };
    contenders.iter_mut().try_for_each(|c| render(0, c).map(drop))?;
    let speeds = in_turn(job.rounds, &mut contenders, |round, c| render(round + 1, c))?;

    let mut bars: Vec<Option<Spread>> = vec![None; DEVICES.len()];
    places.iter().zip(speeds).for_each(|(place, speed)| bars[*place] = Some(speed));
    let notes = places.iter().zip(&contenders).skip(1).map(|(place, c)| (format!("{} off", DEVICES[*place].1), c.off));
    Ok(Outcome { group: Group { name: scene.name.clone(), bars, notes: notes.collect() }, missing })
}

/// The root mean square difference of two images over the mean of the second; 0 only if they are equal.
fn off(image: &Image, expected: &Image) -> f64 {
    if image.pixels == expected.pixels {
        return 0.0;
    }
    let pairs = || image.pixels.as_flattened().iter().zip(expected.pixels.as_flattened());
    let count = pairs().count() as f64;
    let square = pairs().map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2)).sum::<f64>() / count;
    let mean = pairs().map(|(_, b)| f64::from(*b)).sum::<f64>() / count;
    square.sqrt() / mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_images_are_not_off() {
        let image = |x: f32| Image { width: 1, height: 1, pixels: vec![[x, 2.0, 3.0]] };
        assert_eq!(off(&image(1.0), &image(1.0)), 0.0);
        let black = Image { width: 1, height: 1, pixels: vec![[0.0; 3]] };
        assert_eq!(off(&black, &black), 0.0);
        assert!((off(&image(2.5), &image(1.0)) - (1.5 * 1.5 / 3.0_f64).sqrt() / 2.0).abs() < 1e-12);
    }

    #[test]
    fn every_device_has_a_name() {
        assert_eq!(DEVICES.map(|(device, _)| device), DeviceKind::ALL);
    }
}
