//! Sources of light, in world units.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::math::LinearRgb;

/// How a point light fades with distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Falloff {
    /// Not at all, the report's letter: the intensity is the irradiance on a facing surface.
    None,
    /// `1 / d²`, d in world units.
    #[default]
    InverseSquare,
}

/// Where the light comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// From everywhere alike; casts no shadow.
    Ambient,
    /// From one place, equally in all directions.
    Point {
        /// World units.
        position: DVec3,
        /// Fading.
        falloff: Falloff,
    },
    /// From infinitely far away.
    Directional {
        /// The way the light travels; any length but zero.
        direction: DVec3,
    },
}

/// One source of light.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Shown in the panel.
    pub name: String,
    /// A light that is off costs nothing.
    pub enabled: bool,
    /// Kind and place.
    pub kind: LightKind,
    /// Linear colour, multiplied by `intensity`.
    pub color: LinearRgb,
    /// Directional: irradiance on a facing surface. Point: the same at distance 1. Ambient: radiance
    /// arriving from every direction. At least 0.
    pub intensity: f32,
}

impl Light {
    /// A white light that is on.
    #[must_use]
    pub fn new(name: impl Into<String>, kind: LightKind, intensity: f32) -> Self {
        Self {
            name: name.into(),
            enabled: true,
            kind,
            color: LinearRgb::WHITE,
            intensity,
        }
    }

    /// Colour times intensity; black when switched off.
    #[must_use]
    pub fn emitted(&self) -> LinearRgb {
        if self.enabled {
            self.color * self.intensity.max(0.0)
        } else {
            LinearRgb::BLACK
        }
    }
}
