//! Lights without a surface, those with a size among them.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};
use jerboa_scenes::{Light, LightKind};

use super::light_tree::Emission;
use super::memory::RowMut;
use crate::host::image_io::luminance;
use crate::schema::Lights as L;
use crate::schema::*;

/// Smallest angle across a sun, radians: below, single precision tells no direction of it from another.
const SMALLEST_SUN: f32 = 1e-6;
/// Smallest radius over the largest distance: below, the same is true from everywhere, and densities need not reach infinity.
const SMALLEST_RADIUS: f64 = 1e-12;

/// Where a scene is.
#[derive(Clone, Copy)]
pub struct Place {
    /// Subtracted from positions.
    pub origin: DVec3,
    /// Radius of the sphere around all triangles, m.
    pub radius: f32,
}

impl Place {
    /// Of a light, where the tables have it.
    fn of(self, light: &Light) -> Vec3 {
        (light.position() - self.origin).as_vec3()
    }

    /// The kind of a light as kernels have it. A size that is no positive number, or is too small to matter, or has a
    /// radiance beyond single precision, is none: the light is a point, a spot or parallel.
    pub fn kind(self, light: &Light) -> LightKind {
        match light.kind {
            LightKind::Sphere { radius } if !self.has_size(light, radius) => LightKind::Point,
            LightKind::Disk { inner, outer, radius } if !self.has_size(light, radius) => {
                LightKind::Spot { inner, outer }
            }
            LightKind::Sun { angle } if !(SMALLEST_SUN..=std::f32::consts::PI).contains(&angle) => {
                LightKind::Directional
            }
            kind => kind,
        }
    }

    fn has_size(self, light: &Light, radius: f32) -> bool {
        let brightest = light.intensity.into_iter().fold(0.0, f32::max);
        let radiance = (f64::from(brightest) * radiance_of_intensity(radius)) as f32;
        let farthest = self.of(light).as_dvec3().length() + 2.0 * f64::from(self.radius);
        radius > 0.0 && radiance.is_normal() && f64::from(radius) >= SMALLEST_RADIUS * farthest
    }
}

/// Radiance of a ball, or of a disk along its axis, over its intensity, 1/m².
fn radiance_of_intensity(radius: f32) -> f64 {
    1.0 / (PI * f64::from(radius).powi(2))
}

/// Radiance of a sun over what it gives to a plane that faces it, 1/sr.
fn radiance_of_irradiance(angle: f32) -> f64 {
    1.0 / (PI * (f64::from(angle) / 2.0).sin().powi(2))
}

/// 1 − the cosine of half of an angle.
fn opening(angle: f32) -> f64 {
    2.0 * (f64::from(angle) / 4.0).sin().powi(2)
}

/// What leaves a light, W.
pub fn power(light: &Light, place: Place) -> f64 {
    luminance(light.intensity)
        * match light.kind {
            LightKind::Spot { outer, .. } | LightKind::Disk { outer, .. } => 2.0 * PI * (1.0 - f64::from(outer).cos()),
            LightKind::Directional | LightKind::Sun { .. } => PI * f64::from(place.radius).powi(2),
            // One of a user's crate as a point: what shape its light has is not known here.
            LightKind::Point | LightKind::Sphere { .. } | LightKind::Own(_) => 4.0 * PI,
        }
}

/// Where a light is and where it shines; none for one that is infinitely far away, or of a user's crate.
pub fn emission(light: &Light, place: Place, power: f64) -> Option<Emission> {
    let (middle, axis) = (place.of(light).as_dvec3(), light.direction());
    let within = |extent: DVec3, normals, light| {
        Some(Emission { lo: middle - extent, hi: middle + extent, axis, normals, light, power })
    };
    match place.kind(light) {
        LightKind::Point => within(DVec3::ZERO, PI, FRAC_PI_2),
        LightKind::Sphere { radius } => within(DVec3::splat(radius.into()), PI, FRAC_PI_2),
        LightKind::Spot { outer, .. } => within(DVec3::ZERO, 0.0, outer.into()),
        LightKind::Disk { outer, radius, .. } => {
            let across = (DVec3::ONE - axis * axis).max(DVec3::ZERO).map(f64::sqrt);
            within(across * f64::from(radius), 0.0, outer.into())
        }
        LightKind::Directional | LightKind::Sun { .. } | LightKind::Own(_) => None,
    }
}

/// A light's row. One of a user's crate has no kind yet.
pub fn row(row: &mut RowMut<L>, light: &Light, place: Place) {
    let (position, direction) = (place.of(light), light.direction().as_vec3());
    row.set_all([L::P_X, L::P_Y, L::P_Z], position.to_array())
        .set_all([L::E1_X, L::E1_Y, L::E1_Z], direction.to_array());
    let kind = place.kind(light);
    let strength = match kind {
        LightKind::Sphere { radius } | LightKind::Disk { radius, .. } => radiance_of_intensity(radius),
        LightKind::Sun { angle } => radiance_of_irradiance(angle),
        _ => 1.0,
    };
    let strength = light.intensity.map(|c| (f64::from(c) * strength) as f32);
    row.set_all([L::R, L::G, L::B], strength);
    match kind {
        LightKind::Point => row.set(L::KIND, LIGHT_POINT),
        LightKind::Sphere { radius } => row.set(L::KIND, LIGHT_SPHERE).set(L::RADIUS, radius),
        LightKind::Spot { inner, outer } => cone(row.set(L::KIND, LIGHT_SPOT), inner, outer),
        LightKind::Disk { inner, outer, radius } => {
            cone(row.set(L::KIND, LIGHT_DISK).set(L::RADIUS, radius), inner, outer)
        }
        LightKind::Directional => row.set(L::KIND, LIGHT_DIRECTIONAL),
        LightKind::Sun { angle } => row.set(L::KIND, LIGHT_SUN).set(L::OPENING, opening(angle) as f32),
        LightKind::Own(_) => row,
    };
}

fn cone<'a, 'b>(row: &'a mut RowMut<'b, L>, inner: f32, outer: f32) -> &'a mut RowMut<'b, L> {
    let [outer, inner] = [outer, inner].map(|a| f64::from(a).cos() as f32);
    row.set(L::COS_OUTER, outer).set(L::COS_INNER, inner)
}
