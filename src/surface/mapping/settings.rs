//! What a user can say about mapping, for all materials at once.

use serde::{Deserialize, Serialize};

use super::Method;

/// Where the normal comes from once a parallax method has moved the texture coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lookup {
    /// From the height map's slopes.
    #[default]
    Bump,
    /// From the normal map.
    Normal,
}

impl Lookup {
    /// Both, for menus and tests.
    pub const ALL: [Self; 2] = [Self::Bump, Self::Normal];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bump => "bump",
            Self::Normal => "normal",
        }
    }
}

/// How slopes are taken from a height map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Derivative {
    /// Exact derivative of the bilinear height.
    #[default]
    Analytic,
    /// The report's central differences (2.15).
    Central,
}

impl Derivative {
    /// Both, for menus and tests.
    pub const ALL: [Self; 2] = [Self::Analytic, Self::Central];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Analytic => "analytic",
            Self::Central => "central",
        }
    }
}

/// Mapping for the whole scene. A material's own amplitude or midlevel goes before these.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MappingSettings {
    /// The method.
    pub method: Method,
    /// Normals at moved coordinates.
    pub lookup: Lookup,
    /// Slopes of `bump` and of parallax with bump look-up.
    pub derivative: Derivative,
    /// World units from stored height 0 to stored height 1, at least 0; `None` leaves each material its
    /// default.
    pub amplitude: Option<f64>,
    /// Stored height that lies on the mesh: 1 cuts the relief inwards, 0 raises it.
    pub midlevel: f32,
    /// Whether height maps tilt normals.
    pub use_height: bool,
    /// Whether normal and slope maps tilt normals.
    pub use_normal: bool,
    /// Whether parallax methods move texture coordinates.
    pub use_parallax: bool,
    /// Whether there is no surface where a method moves the texture coordinate out of its chart, so that the relief ends
    /// in a silhouette.
    pub cut_at_border: bool,
    /// Whether true displacement takes the mean height along edges at which texture coordinates jump, so that
    /// no crack opens there.
    pub weld_seams: bool,
    /// Most mebibytes for the micro-triangles of displaced surfaces, 0…1,048,576: they are kept only if all of them
    /// fit. Without them tracing is slower and no pixel changes.
    pub displacement_memory: u32,
    /// What searches take.
    pub search: SearchSettings,
}

/// How far searches go. Each method reads what it has a use for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SearchSettings {
    /// Most layers, or most cone steps, from the top of the relief to its bottom: 1…4096.
    pub layers: u32,
    /// Layers of `occlusion` for a view along the normal, at most `layers`: 1…4096.
    pub min_layers: u32,
    /// Bisections after the layers: 0…32.
    pub bisections: u32,
    /// Steps of `iterative`: 1…64.
    pub iterations: u32,
    /// Whether the relief shadows itself.
    pub self_shadow: bool,
}

impl SearchSettings {
    /// Most layers.
    pub const MAX_LAYERS: u32 = 4096;
    /// Most bisections; more than a float has bits would change nothing.
    pub const MAX_BISECTIONS: u32 = 32;
    /// Most steps of `iterative`.
    pub const MAX_ITERATIONS: u32 = 64;
}

impl Default for SearchSettings {
    fn default() -> Self {
        Self {
            layers: 32,
            min_layers: 8,
            bisections: 8,
            iterations: 4,
            self_shadow: true,
        }
    }
}

impl MappingSettings {
    /// Most mebibytes that `displacement_memory` may be.
    pub const MAX_DISPLACEMENT_MEMORY: u32 = 1 << 20;

    /// Whether height maps are geometry of their own.
    #[must_use]
    pub const fn displaces(&self) -> bool {
        self.use_height && matches!(self.method, Method::Displacement)
    }

    /// Whether the extremes of height maps are asked for: the exact walk, every relief that shadows itself,
    /// and displaced surfaces.
    #[must_use]
    pub const fn needs_pyramid(&self) -> bool {
        self.displaces()
            || self.use_parallax && matches!(self.method, Method::Exact)
            || self.shadows_itself()
    }

    /// Whether places that are searched for lie in each other's shadow.
    #[must_use]
    pub const fn shadows_itself(&self) -> bool {
        self.use_parallax && self.method.searches() && self.search.self_shadow
    }

    /// Whether cones over height maps are asked for.
    #[must_use]
    pub const fn needs_cones(&self) -> bool {
        self.use_parallax && matches!(self.method, Method::RelaxedCone)
    }
}

impl Default for MappingSettings {
    fn default() -> Self {
        Self {
            method: Method::Bump,
            lookup: Lookup::Bump,
            derivative: Derivative::Analytic,
            amplitude: None,
            midlevel: 1.0,
            use_height: true,
            use_normal: true,
            use_parallax: true,
            cut_at_border: false,
            weld_seams: true,
            displacement_memory: 256,
            search: SearchSettings::default(),
        }
    }
}
