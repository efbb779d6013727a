//! Lights without a surface (KHR_lights_punctual), and those with a size that `extras` give it.

use glam::{DAffine3, DVec3};

/// The shape of a light's emission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Equal in all directions; intensity in candela (W·sr⁻¹ up to the scene's scale).
    Point,
    /// A point light within a cone about its axis; intensity in candela on the axis. The falloff between the two angles
    /// is the extension's: `t²`, `t = saturate((cos θ − cos outer) / (cos inner − cos outer))`.
    Spot {
        /// Half angle up to which the intensity is full, radians.
        inner: f32,
        /// Half angle from which it is zero, radians; inner < outer ≤ π/2.
        outer: f32,
    },
    /// From infinitely far; intensity in lux (irradiance on a plane facing it, W·m⁻² up to the scene's scale).
    Directional,
    /// A ball that shines equally from each point in each direction; intensity as of [`LightKind::Point`], which is what it looks
    /// like from afar: radiance = intensity / (π radius²). It is seen, and blocks nothing; nothing of it is seen from within.
    Sphere {
        /// World, m; not scaled with the node. Above 0.
        radius: f32,
    },
    /// A disk about the light's place, across its axis, that shines to the front; intensity as of [`LightKind::Spot`], in each
    /// direction, which is what it looks like from afar: radiance = intensity / (π radius² cos θ). It is seen from its front, and
    /// blocks nothing.
    Disk {
        /// See [`LightKind::Spot`].
        inner: f32,
        /// See [`LightKind::Spot`].
        outer: f32,
        /// World, m; not scaled with the node. Above 0.
        radius: f32,
    },
    /// A disk of equal radiance infinitely far away: the sun. Intensity as of [`LightKind::Directional`]. It is seen where a ray
    /// hits nothing.
    Sun {
        /// Angle across, radians; above 0, at most π.
        angle: f32,
    },
    /// A light of a user's crate, by its place in [`Scene::own`](crate::Scene::own).
    Own(usize),
}

/// A light without a surface. The extension's `range` is ignored: light falls off with the inverse square and nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The author's name, for messages.
    pub name: String,
    /// Shape and unit.
    pub kind: LightKind,
    /// Linear RGB × intensity, in the unit of the kind. Finite, not negative.
    pub intensity: [f32; 3],
    /// Light to world. Only the origin and the direction of −Z matter; the accessors below return those.
    pub to_world: DAffine3,
}

impl Light {
    /// Where it stands, world frame.
    pub fn position(&self) -> DVec3 {
        self.to_world.translation
    }

    /// Unit vector along which it shines, world frame.
    pub fn direction(&self) -> DVec3 {
        -self.to_world.matrix3.z_axis.normalize()
    }
}
