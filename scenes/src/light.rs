//! Lights without a surface (KHR_lights_punctual).

use glam::{DAffine3, DVec3};

/// The shape of a punctual light's emission.
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
    /// A light of a user's crate, by its place in [`Scene::own`](crate::Scene::own).
    Own(usize),
}

/// A punctual light. The extension's `range` is ignored: light falls off with the inverse square and nothing else.
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
