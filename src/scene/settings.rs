//! What a slider can move. Three plain structs by cost: display, render, source.

use serde::{Deserialize, Serialize};

use super::{Camera, View};
use crate::geometry::{Kernel, OffsetRule};
use crate::math::LinearRgb;
use crate::shading::{Light, Material};
use crate::surface::mapping::MappingSettings;

/// Changes of these re-encode the picture; nothing is traced or shaded, unless a view needs what was not noted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DisplaySettings {
    /// Exposure in stops: the picture is multiplied by `2^exposure_ev` before sRGB encoding.
    pub exposure_ev: f32,
    /// What is shown. Some views need records of the pixels, which are made from the first sample on.
    pub view: View,
    /// The ray–triangle test that the views `leaks` and `false-shadows` compare with the program's own.
    pub kernel: Kernel,
    /// The offset of leaving rays that `false-shadows` compares with the program's own.
    pub offset_rule: OffsetRule,
}

/// Which reflection model turns light into colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShadingModel {
    /// Energy-conserving: Lambert `k_d/π` and modified Phong `k_s (s+2)/2π` (Lafortune & Willems 1994).
    #[default]
    Normalized,
    /// The report's letter: `k_d` and `k_s` as they are (2.10–2.14 corrected).
    Report,
}

impl ShadingModel {
    /// Both, for menus and tests.
    pub const ALL: [Self; 2] = [Self::Normalized, Self::Report];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Normalized => "normalized",
            Self::Report => "report",
        }
    }
}

/// What is done about normals that maps have bent away from the surface under them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BentNormals {
    /// Nothing: mirror rays may run into the surface, and light ends abruptly at its horizon.
    Textbook,
    /// Mirror rays that would run into the surface are lifted until they leave it (Keller et al. 2017).
    #[default]
    Lifted,
    /// Lifted, and light fades out towards the horizon of the surface (Chiang et al. 2019).
    Softened,
}

impl BentNormals {
    /// All, for menus and tests.
    pub const ALL: [Self; 3] = [Self::Textbook, Self::Lifted, Self::Softened];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Textbook => "textbook",
            Self::Lifted => "lifted",
            Self::Softened => "softened",
        }
    }
}

/// How maps are read where a ray's cone covers many texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TextureFilter {
    /// At points, bilinear: many samples per pixel do the filtering.
    #[default]
    Bilinear,
    /// As means over the cone, from maps halved again and again: calm with few samples, a little blurred.
    Mip,
}

impl TextureFilter {
    /// Both, for menus and tests.
    pub const ALL: [Self; 2] = [Self::Bilinear, Self::Mip];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bilinear => "bilinear",
            Self::Mip => "mip",
        }
    }
}

/// What rays see that leave the scene: a vertical gradient along the camera's up direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// Towards `up`.
    pub top: LinearRgb,
    /// Away from `up`. Equal to `top` for a plain colour.
    pub bottom: LinearRgb,
}

impl Background {
    /// One colour everywhere.
    #[must_use]
    pub const fn plain(color: LinearRgb) -> Self {
        Self {
            top: color,
            bottom: color,
        }
    }
}

/// How light is gathered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadingSettings {
    /// Reflection model.
    pub model: ShadingModel,
    /// Normals bent by maps.
    pub bent_normals: BentNormals,
    /// How maps of colour, and those that tilt normals, are read.
    pub filter: TextureFilter,
    /// Whether highlights widen where a cone covers slopes that differ. Asks for [`TextureFilter::Mip`].
    pub specular_antialiasing: bool,
    /// Whether shadow rays are traced.
    pub shadows: bool,
    /// Whether light ends where interpolated normals say, not at the edges of facets. Meshes without such normals look
    /// the same and cost the same.
    pub smooth_terminator: bool,
    /// Mirror bounces at the most; 0 shows no reflections.
    pub max_bounces: u32,
    /// Behind everything.
    pub background: Background,
}

impl Default for ShadingSettings {
    fn default() -> Self {
        Self {
            model: ShadingModel::Normalized,
            bent_normals: BentNormals::Lifted,
            filter: TextureFilter::Bilinear,
            specular_antialiasing: false,
            shadows: true,
            smooth_terminator: false,
            max_bounces: 3,
            background: Background::plain(LinearRgb::BLACK),
        }
    }
}

/// Changes of these render again.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderSettings {
    /// Camera, world units.
    pub camera: Camera,
    /// Lights, world units; at most one of them ambient.
    pub lights: Vec<Light>,
    /// One per material index of the mesh.
    pub materials: Vec<Material>,
    /// Reflection model, shadows, mirrors, background.
    pub shading: ShadingSettings,
    /// Method and amplitude.
    pub mapping: MappingSettings,
    /// Samples a pixel gets before the picture counts as converged, at least 1.
    pub samples: u32,
}
