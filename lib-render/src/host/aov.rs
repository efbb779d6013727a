//! Layers beside a picture, for denoisers and compositors.
//!
//! A file holds the picture as `R`, `G`, `B` and, in the same part, a channel for each component of a layer, named
//! `layer.component` as OpenEXR's guide asks for. Parts would be tidier, but what reads only the first part, or only flat
//! files, loses all layers then.
//!
//! | layer | channels | what | after |
//! |---|---|---|---|
//! | [`Layer::Albedo`] | `albedo.R`, `.G`, `.B` | mean base colour | Open Image Denoise's input image `albedo` |
//! | [`Layer::Normal`] | `normal.X`, `.Y`, `.Z` | mean shading normal, world, facing the camera | its `normal`; Blender's and Mitsuba's components |
//! | [`Layer::Depth`] | `depth.Z` | depth along the viewing direction, m | Blender's pass `Depth.Z`, planar too |
//! | [`Layer::Material`] | `material.X` | number of the material, from 1 on, in the file's order | Blender's pass `IndexMA.X` |
//! | [`Layer::Samples`] | `samples.X` | samples in the pixel | Blender's pass `Debug Sample Count.X` |
//!
//! Components have one letter, since Blender tells layers apart by that. All channels are 32-bit floats, in which whole numbers
//! below 2^24 are exact: not every reader converts integers. Albedo and normal are means over the very samples of the
//! picture, as a denoiser wants them: they have the picture's edges. They are 0 for samples that see nothing. Depth and
//! material are those of sample 0 alone, as in Blender's Cycles: a mean of two depths is a place where nothing is, a mean of
//! two numbers a third material. Where nothing is hit, depth is infinite and the material 0.

use jerboa_scenes::Camera;

use super::error::Error;
use super::exr::Channel;
use super::film::Film;
use super::generate::TracerKind;
use super::image_io::Image;
use super::renderer::{Handle, Render, Renderer};

/// A layer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Layer {
    /// Base colour.
    Albedo,
    /// Shading normal.
    Normal,
    /// Depth.
    Depth,
    /// Number of the material.
    Material,
    /// Number of samples.
    Samples,
}

/// The channels of these layers, beside a film that has got the samples of a job from this renderer or another one of the
/// same scene.
///
/// # Errors
/// As [`Renderer::showing`] and [`Renderer::render_with`].
pub fn channels(
    renderer: &Renderer,
    camera: &Camera,
    film: &Film,
    job: Render,
    layers: &[Layer],
) -> Result<Vec<Channel>, Error> {
    let show = |tracer: TracerKind, spp: u32| -> Result<Image, Error> {
        let mut shown = Film::try_crop(film.size(), film.window())?;
        let job = Render { spp, ..job };
        renderer.showing(tracer)?.render_with(camera, &mut shown, job, &Handle::default())?;
        Ok(shown.mean())
    };
    // One render of a sample shows depths and materials.
    let is_place = |layer: &Layer| matches!(layer, Layer::Depth | Layer::Material);
    let place = layers.iter().any(is_place).then(|| show(TracerKind::AovPlace, 1)).transpose()?;
    let mut all = Vec::new();
    for layer in layers {
        match (layer, &place) {
            (Layer::Albedo, _) => {
                all.extend(components("albedo", ["R", "G", "B"], &show(TracerKind::Albedo, job.spp)?))
            }
            (Layer::Normal, _) => {
                all.extend(components("normal", ["X", "Y", "Z"], &show(TracerKind::AovNormal, job.spp)?));
            }
            (Layer::Depth, Some(place)) => {
                let depth = |[depth, material, _]: &[f32; 3]| if *material == 0.0 { f32::INFINITY } else { *depth };
                all.push(Channel { name: "depth.Z".into(), values: place.pixels.iter().map(depth).collect() });
            }
            (Layer::Material, Some(place)) => {
                let number = |[_, material, _]: &[f32; 3]| *material;
                all.push(Channel { name: "material.X".into(), values: place.pixels.iter().map(number).collect() });
            }
            _ => all.push(Channel { name: "samples.X".into(), values: counts(film) }),
        }
    }
    Ok(all)
}

/// The channels of an image under these names.
pub fn components(layer: &str, names: [&str; 3], image: &Image) -> impl Iterator<Item = Channel> {
    let channel = |(i, name): (usize, &str)| {
        let name = if layer.is_empty() { name.into() } else { format!("{layer}.{name}") };
        Channel { name, values: image.pixels.iter().map(|p| p[i]).collect() }
    };
    let channels: Vec<Channel> = names.into_iter().enumerate().map(channel).collect();
    channels.into_iter()
}

/// Samples in each pixel.
fn counts(film: &Film) -> Vec<f32> {
    let window = film.window();
    let pixels = (0..window.height).flat_map(|y| (0..window.width).map(move |x| [window.x + x, window.y + y]));
    pixels.map(|pixel| film.count(pixel) as f32).collect()
}
