//! Animations: where nodes are, and how meshes are morphed, at one moment.

use super::json::Json;
use super::schema::{ComponentType, Interpolation};
use super::{Loader, chosen};
use crate::error::warn;
use crate::{Error, Selection};
use glam::{DQuat, DVec3};

/// What animations set of a node; the rest is the node's own.
#[derive(Default)]
pub(super) struct Pose {
    pub translation: Option<DVec3>,
    /// Unit.
    pub rotation: Option<DQuat>,
    pub scale: Option<DVec3>,
    pub weights: Option<Vec<f32>>,
}

/// A sampler's keyframes of `N` numbers.
struct Curve<const N: usize> {
    times: Vec<f32>,
    /// For each key: the in-tangents where there are tangents, the values, the out-tangents.
    values: Vec<[f32; N]>,
    interpolation: Interpolation,
    /// Values of each key: 1, or the number of morph targets.
    each: usize,
}

impl<'a> Loader<'a> {
    /// Plays the animations up to the moment that is asked for.
    pub fn animate(&mut self, selection: &Selection) -> Result<(), Error> {
        let all = self.root.list("animations")?;
        let Some(time) = selection.time else {
            if !all.is_empty() {
                let message = "animations are not played: the scene is shown at rest, since no time is asked for";
                warn(&mut self.scene.warnings, "animations", message);
            }
            return Ok(());
        };
        if all.is_empty() {
            warn(&mut self.scene.warnings, "", "the file has no animation: every moment of it is the same");
        }
        let one = selection.animation.as_ref().map(|asked| chosen("animation", asked, &all)).transpose()?;
        for (_, animation) in all.iter().enumerate().filter(|(i, _)| one.is_none_or(|one| one == *i)) {
            for channel in animation.list("channels")? {
                self.play(animation, &channel, time)?;
            }
        }
        Ok(())
    }

    /// Sets what one channel says of its node.
    fn play(&mut self, animation: &Json<'a>, channel: &Json<'a>, time: f64) -> Result<(), Error> {
        let target = channel.need("target")?;
        let Some(node) = target.get("node") else {
            return Ok(()); // The target is an extension's, which is unknown here.
        };
        let (node, _) = node.refer(&self.root, "nodes", "nodes")?;
        let (_, sampler) = channel.need("sampler")?.refer(animation, "samplers", "samplers")?;
        let path = target.need("path")?;
        let taken = match path.text()? {
            "translation" => {
                let [at] = self.vectors(&sampler, time)?;
                self.poses.entry(node).or_default().translation.replace(at).is_some()
            }
            "scale" => {
                let [at] = self.vectors(&sampler, time)?;
                self.poses.entry(node).or_default().scale.replace(at).is_some()
            }
            "rotation" => {
                let at = self.rotation(&sampler, time)?;
                self.poses.entry(node).or_default().rotation.replace(at).is_some()
            }
            "weights" => {
                let at = self.curve::<1>(&sampler, true)?.at(time, lerp);
                let at = at.into_iter().map(|[w]| w as f32).collect();
                self.poses.entry(node).or_default().weights.replace(at).is_some()
            }
            _ => {
                warn(&mut self.scene.warnings, &path.path, "an unknown path of animation is ignored");
                false
            }
        };
        if taken {
            let message = "several animations move the same: the last one counts; ask for one of them";
            warn(&mut self.scene.warnings, &target.path, message);
        }
        Ok(())
    }

    fn vectors(&mut self, sampler: &Json<'a>, time: f64) -> Result<[DVec3; 1], Error> {
        let values = self.curve::<3>(sampler, false)?.at(time, lerp);
        Ok([DVec3::from_array(values[0])])
    }

    fn rotation(&mut self, sampler: &Json<'a>, time: f64) -> Result<DQuat, Error> {
        let values = self.curve::<4>(sampler, false)?.at(time, slerp);
        let rotation = DQuat::from_array(values[0]);
        if rotation.length_squared() < 1e-12 {
            return Err(sampler.fault("a quaternion of length 0"));
        }
        Ok(rotation.normalize())
    }

    /// Reads a sampler; `many`: a key may have any number of values, the same for all keys.
    fn curve<const N: usize>(&mut self, sampler: &Json<'a>, many: bool) -> Result<Curve<N>, Error> {
        let interpolation = sampler.word_or("interpolation", Interpolation::Linear)?;
        let place = sampler.need("input")?;
        let input = self.accessor(&place)?;
        if input.width != 1 || input.component != ComponentType::F32 {
            return Err(place.fault("times must be scalar floats"));
        }
        let times: Vec<f32> = self.floats::<1>(&input, 0.0)?.into_iter().flatten().collect();
        if !times.iter().all(|t| t.is_finite()) || times.windows(2).any(|w| w[0] >= w[1]) {
            return Err(place.fault("times must be finite and increase"));
        }
        let place = sampler.need("output")?;
        let output = self.accessor(&place)?;
        let fraction = output.normalized && output.component != ComponentType::U32 && N != 3;
        if output.width != N || !(output.component == ComponentType::F32 || fraction) {
            return Err(place.fault(format!("values must be of {N} floats or, but for vectors, normalised integers")));
        }
        let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let keys = times.len() * parts;
        let each = output.count / keys;
        if output.count != keys * each || each == 0 || (each > 1 && !many) {
            return Err(place.fault(format!("{} values for {} keyframes", output.count, times.len())));
        }
        let values = self.floats::<N>(&output, 0.0)?;
        if !values.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(place.fault("values must be finite"));
        }
        Ok(Curve { times, values, interpolation, each })
    }
}

impl<const N: usize> Curve<N> {
    /// The values at a time; `mix` is the interpolation that is called linear.
    fn at(&self, time: f64, mix: fn([f64; N], [f64; N], f64) -> [f64; N]) -> Vec<[f64; N]> {
        let after = self.times.partition_point(|t| f64::from(*t) <= time);
        let (a, b) = (after.saturating_sub(1), after.min(self.times.len() - 1));
        let (from, to) = (f64::from(self.times[a]), f64::from(self.times[b]));
        let t = if a == b { 0.0 } else { (time - from) / (to - from) };
        let parts = self.values.len() / (self.times.len() * self.each);
        let get = |key: usize, part: usize, i: usize| -> [f64; N] {
            self.values[(key * parts + part) * self.each + i].map(f64::from)
        };
        let value = |i: usize| match self.interpolation {
            Interpolation::Step => get(a, 0, i),
            Interpolation::Linear => mix(get(a, 0, i), get(b, 0, i), t),
            Interpolation::CubicSpline => {
                // Hermite's cubic (glTF 2.0, appendix C.5): tangents are per second.
                let [p, m, q, n] = [get(a, 1, i), get(a, 2, i), get(b, 1, i), get(b, 0, i)];
                let (t2, t3, span) = (t * t, t * t * t, to - from);
                let weights =
                    [2.0 * t3 - 3.0 * t2 + 1.0, span * (t3 - 2.0 * t2 + t), 3.0 * t2 - 2.0 * t3, span * (t3 - t2)];
                std::array::from_fn(|c| [p, m, q, n].iter().zip(weights).map(|(value, weight)| value[c] * weight).sum())
            }
        };
        (0..self.each).map(value).collect()
    }
}

fn lerp<const N: usize>(a: [f64; N], b: [f64; N], t: f64) -> [f64; N] {
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t)
}

/// Along the shorter arc between the two rotations.
fn slerp(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    let unit = |q| DQuat::from_array(q).normalize();
    let mixed = unit(a).slerp(unit(b), t);
    if mixed.is_finite() { mixed.to_array() } else { [0.0; 4] }
}
