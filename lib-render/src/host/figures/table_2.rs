//! Table 2: samples per second of whole renders, by what is known of the scene, and those of a peer.
//!
//! All levels render the same samples on the same device with the same cut, so the images are the same, which is checked.
//! The rules are those of the peers (section "Rules of fair play" of their comparison): the same largest depth, roulette from
//! the fifth scattering on with at most 0.95, one light and one BSDF sample at each vertex, independent samples, shading
//! normals free. Wall time of rendering alone; a render beforehand is not counted.
//!
//! Beside the speeds stand the rays of a sample, and the *variance* of one: N independent renders of s samples per pixel have
//! a variance of luminance in each pixel; s times its mean over the pixels, over the square of the mean luminance. A peer
//! that computes the same integral with the same samples has the same.

use std::time::Duration;

use jerboa_scenes::Scene;

use super::peer::{Peer, Setting};
use super::{Group, LEVELS, in_turn};
use crate::host::error::Error;
use crate::host::film::Film;
use crate::host::image_io::{Image, luminance};
use crate::host::renderer::{Handle, Options, Render, Renderer, Stats};
use crate::host::tables::Choices;

/// What is rendered of each scene.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// Size of the film, pixels.
    pub size: [u32; 2],
    /// Samples per pixel in each round.
    pub spp: u32,
    /// Rounds that count.
    pub rounds: u32,
    /// Largest number of path edges.
    pub max_depth: u32,
}

impl Job {
    /// The same by the peer, `lanes` wide.
    pub fn of_peer(&self, lanes: Option<u32>) -> Setting {
        let Job { size, spp, max_depth, .. } = *self;
        Setting { size, spp, max_depth, rr_depth: RR_DEPTH, sampler: "independent".into(), lanes }
    }
}

/// Scattering from which on roulette may end a path, with the peers.
pub const RR_DEPTH: u32 = 5;

/// Largest probability with which roulette lets a path go on, with the peers.
pub const RR_CAP: f32 = 0.95;

/// How many times quicker level `structure` is than level `nothing`, and than the peer.
const GAINS: [&str; 2] = ["gain by structure", "gain over peer"];

/// The rules of comparison.
pub fn fair(max_depth: u32) -> Choices {
    Choices {
        max_depth: Some(max_depth),
        rr_depth: Some(RR_DEPTH),
        rr_cap: RR_CAP,
        consistent_normals: false,
        ..Choices::default()
    }
}

/// What takes turns.
enum Variant<'p> {
    /// Ours.
    Level(Box<Renderer>),
    /// The other one.
    Peer(&'p mut Peer),
}

/// Measures a scene: a bar for each level of knowledge, and one for the peer if there is one.
///
/// # Errors
/// As [`Renderer::new`] and [`Renderer::render_with`]; when the images of two levels differ, a fault of Jerboa; when the peer
/// fails.
pub fn measure(scene: &Scene, job: &Job, mut peer: Option<&mut Peer>) -> Result<Group, Error> {
    let camera = scene.camera_or_default();
    let options = |known| Options { known, choices: fair(job.max_depth), ..Options::default() };
    let new = |(known, _)| Ok(Variant::Level(Box::new(Renderer::new(scene, options(known))?)));
    let mut variants = LEVELS.into_iter().map(new).collect::<Result<Vec<_>, Error>>()?;
    variants.extend(peer.as_deref_mut().map(Variant::Peer));

    let samples = f64::from(job.size[0]) * f64::from(job.size[1]) * f64::from(job.spp);
    let (mut ours, mut rays) = (Pictures::default(), 0);
    let mut current: Option<(u32, Film)> = None;
    let mut render = |round: u32, variant: &mut Variant| -> Result<f64, Error> {
        let seconds = match variant {
            Variant::Peer(peer) => peer.render(round)?,
            Variant::Level(renderer) => {
                let mut film = Film::of_size(job.size);
                let work = Render { sample: 0, spp: job.spp, seed: round };
                let Stats { time, closest_rays, shadow_rays, .. } =
                    renderer.render_with(&camera, &mut film, work, &Handle::default())?;
                match &current {
                    Some((of, first)) if *of == round && *first != film => {
                        return Err(Error::new("two levels of knowledge give different images: a fault of Jerboa"));
                    }
                    Some((of, _)) if *of == round => {}
                    _ => {
                        // The first round warms up.
                        if round > 0 {
                            ours.add(&film.mean());
                            rays += closest_rays + shadow_rays;
                        }
                        current = Some((round, film));
                    }
                }
                time.max(Duration::from_nanos(1)).as_secs_f64()
            }
        };
        Ok(samples / seconds / 1e6)
    };
    variants.iter_mut().try_for_each(|v| render(0, v).map(drop))?;
    let speeds = in_turn(job.rounds, &mut variants, |round, v| render(round + 1, v))?;

    drop(variants);
    let mut notes = vec![
        ("rays a sample".into(), rays as f64 / samples / f64::from(job.rounds)),
        ("variance".into(), ours.variance(job.spp)),
    ];
    notes.push((GAINS[0].into(), speeds[1].median / speeds[0].median));
    if let Some(peer) = peer {
        notes.push(("peer's variance".into(), peer.variance()?));
        notes.push((GAINS[1].into(), speeds[1].median / speeds[3].median));
    }
    Ok(Group { name: scene.name.clone(), bars: speeds.into_iter().map(Some).collect(), notes })
}

/// The geometric means of what the scenes gain; no bars.
pub fn means(scenes: &[Group]) -> Group {
    let mean = |name: &str| {
        let gains = scenes.iter().flat_map(|g| &g.notes).filter(|(n, _)| n == name);
        let logs: Vec<f64> = gains.map(|(_, gain)| gain.ln()).collect();
        (!logs.is_empty()).then(|| (name.into(), (logs.iter().sum::<f64>() / logs.len() as f64).exp()))
    };
    Group { name: "geometric mean".into(), bars: vec![], notes: GAINS.into_iter().filter_map(mean).collect() }
}

/// Independent pictures of the same size, summed up.
#[derive(Default)]
struct Pictures {
    count: u32,
    /// Sum of the luminance of each pixel, and of its square.
    sums: Vec<[f64; 2]>,
}

impl Pictures {
    fn add(&mut self, picture: &Image) {
        self.count += 1;
        self.sums.resize(picture.pixels.len(), [0.0; 2]);
        for (sums, pixel) in self.sums.iter_mut().zip(&picture.pixels) {
            let y = luminance(*pixel);
            *sums = [sums[0] + y, sums[1] + y * y];
        }
    }

    /// Variance of a sample, in squares of the mean; not a number of a single picture, or of black ones.
    fn variance(&self, spp: u32) -> f64 {
        let (n, pixels) = (f64::from(self.count), self.sums.len() as f64);
        let mean = self.sums.iter().map(|s| s[0]).sum::<f64>() / n / pixels;
        let variance = self.sums.iter().map(|[y, yy]| (yy - y * y / n) / (n - 1.0)).sum::<f64>() / pixels;
        f64::from(spp) * variance / (mean * mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_is_that_of_a_sample() {
        let mut pictures = Pictures::default();
        // One pixel with values 1 and 3, one that is always 2: means 2 and 2, variances 2 and 0, their mean 1.
        for [a, b] in [[1.0, 2.0], [3.0, 2.0]] {
            pictures.add(&Image { width: 2, height: 1, pixels: vec![[a; 3], [b; 3]] });
        }
        assert!((pictures.variance(8) - 8.0 * 1.0 / 4.0).abs() < 1e-12);
    }

    #[test]
    fn means_are_geometric() {
        let group = |gain| Group { name: "a".into(), bars: vec![], notes: vec![(GAINS[0].into(), gain)] };
        let mean = means(&[group(2.0), group(8.0)]);
        assert_eq!((mean.notes.len(), mean.notes[0].0.as_str()), (1, GAINS[0]));
        assert!((mean.notes[0].1 - 4.0).abs() < 1e-12);
    }
}
