//! The one list of methods that feeds the panel, the keys, the command line, the help and the tests.

use serde::{Deserialize, Serialize};

/// A way of perturbing a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The mesh as it is.
    None,
    /// Normals tilted by a height map's slopes (Blinn 1978).
    #[default]
    Bump,
    /// Slopes read from a slope map, the report's letter.
    Slope,
    /// Normals read from a tangent-space normal map.
    Normal,
    /// Texture coordinates shifted once by the height seen (report 2.17).
    Parallax,
    /// The same without the division that runs away at grazing angles (report 2.18).
    ParallaxLimited,
    /// Parallax repeated with the slope's help (Premecz 2006).
    Iterative,
    /// Equal layers from the top of the relief, the first sample under it (McGuire 2005).
    Steep,
    /// Layers, then the chord between the last two samples (Tatarchuk 2006).
    Occlusion,
    /// Layers, then bisection (Policarpo 2005).
    Relief,
    /// Steps as wide as precomputed cones allow, then bisection (Policarpo & Oliveira 2007).
    RelaxedCone,
    /// Cell by cell through a pyramid of extremes: no step too far (Tevs 2008).
    Exact,
    /// The surface itself moved: silhouettes, shadows and all.
    Displacement,
}

/// What a method gets wrong, after Szirmay-Kalos & Umenhoffer 2008.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorClass {
    /// Nothing is perturbed.
    Flat,
    /// Only shading changes: no parallax, silhouette or relief shadow.
    ShadingOnly,
    /// May miss relief.
    Unsafe,
    /// Samples at distances: may miss what is thinner than a step.
    Sampled,
    /// Right but for stopping short or for features between directions looked through.
    Conservative,
    /// Right to rounding for the bilinear relief over a flat chart.
    Exact,
    /// The displaced surface itself.
    Truth,
}

impl ErrorClass {
    /// One line for help and tooltips.
    #[must_use]
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Flat => "no relief at all",
            Self::ShadingOnly => "shading only: no parallax, no silhouette, no relief shadow",
            Self::Unsafe => "unsafe: may miss relief; no silhouette, no relief shadow",
            Self::Sampled => "unsafe: may miss relief thinner than a step; no silhouette",
            Self::Conservative => "convergent: seldom misses, may stop short; no silhouette",
            Self::Exact => "exact for the relief over a flat chart; no silhouette",
            Self::Truth => "the truth: the displaced surface with its silhouettes and shadows",
        }
    }
}

/// Everything the program says about a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodInfo {
    /// Name in scene files and on the command line.
    pub name: &'static str,
    /// Label in the window.
    pub label: &'static str,
    /// Key that selects it.
    pub key: char,
    /// One sentence.
    pub summary: &'static str,
    /// What it gets wrong.
    pub error_class: ErrorClass,
    /// Where it comes from.
    pub source: &'static str,
}

impl Method {
    /// Every method in the order of the keys.
    pub const ALL: [Self; 13] = [
        Self::None,
        Self::Bump,
        Self::Slope,
        Self::Normal,
        Self::Parallax,
        Self::ParallaxLimited,
        Self::Iterative,
        Self::Steep,
        Self::Occlusion,
        Self::Relief,
        Self::RelaxedCone,
        Self::Exact,
        Self::Displacement,
    ];

    /// What the program says about it.
    #[must_use]
    pub const fn info(self) -> MethodInfo {
        match self {
            Self::None => MethodInfo {
                name: "none",
                label: "None",
                key: '1',
                summary: "The mesh with its smooth normals; maps of relief are not read.",
                error_class: ErrorClass::Flat,
                source: "the base line",
            },
            Self::Bump => MethodInfo {
                name: "bump",
                label: "Bump",
                key: '2',
                summary: "Tilts the normal by the slope of the height map.",
                error_class: ErrorClass::ShadingOnly,
                source: "Blinn 1978; report 2.15-2.16 in physical units",
            },
            Self::Slope => MethodInfo {
                name: "slope",
                label: "Slope map",
                key: '3',
                summary: "Tilts the normal by slopes stored in red and green; without such a map, by central differences of the height map.",
                error_class: ErrorClass::ShadingOnly,
                source: "report 2.4.2; derivative maps, Mikkelsen 2010",
            },
            Self::Normal => MethodInfo {
                name: "normal",
                label: "Normal map",
                key: '4',
                summary: "Takes the normal from a tangent-space normal map.",
                error_class: ErrorClass::ShadingOnly,
                source: "Cohen et al. 1998; report 2.4.2",
            },
            Self::Parallax => MethodInfo {
                name: "parallax",
                label: "Parallax",
                key: '5',
                summary: "Shifts the texture coordinate once, by the height it first sees.",
                error_class: ErrorClass::Unsafe,
                source: "Kaneko et al. 2001; report 2.17",
            },
            Self::ParallaxLimited => MethodInfo {
                name: "parallax-limited",
                label: "Parallax, limited",
                key: '6',
                summary: "Parallax whose shift never exceeds the height; flattens towards the horizon.",
                error_class: ErrorClass::Unsafe,
                source: "Welsh 2004; report 2.18",
            },
            Self::Iterative => MethodInfo {
                name: "iterative",
                label: "Iterative",
                key: '7',
                summary: "Repeats the parallax step along the view ray, shorter where the relief is steep.",
                error_class: ErrorClass::Unsafe,
                source: "Premecz 2006",
            },
            Self::Steep => MethodInfo {
                name: "steep",
                label: "Steep parallax",
                key: '8',
                summary: "Walks down in equal layers to the first sample under the relief.",
                error_class: ErrorClass::Sampled,
                source: "McGuire & McGuire 2005",
            },
            Self::Occlusion => MethodInfo {
                name: "occlusion",
                label: "Occlusion",
                key: '9',
                summary: "Parallax occlusion mapping: layers, more of them at grazing views, then the chord between the last two samples.",
                error_class: ErrorClass::Sampled,
                source: "Tatarchuk 2006",
            },
            Self::Relief => MethodInfo {
                name: "relief",
                label: "Relief search",
                key: '0',
                summary: "Relief mapping: layers, then bisection between the last two samples.",
                error_class: ErrorClass::Sampled,
                source: "Policarpo et al. 2005",
            },
            Self::RelaxedCone => MethodInfo {
                name: "relaxed-cone",
                label: "Relaxed cones",
                key: '-',
                summary: "Steps as wide as a precomputed map of cones allows, then bisection. The map takes seconds to make.",
                error_class: ErrorClass::Conservative,
                source: "Policarpo & Oliveira 2007",
            },
            Self::Exact => MethodInfo {
                name: "exact",
                label: "Exact relief",
                key: '=',
                summary: "Walks through a pyramid of the map's extremes to the first meeting of ray and bilinear relief, in double precision.",
                error_class: ErrorClass::Exact,
                source: "maximum mipmaps, Tevs et al. 2008",
            },
            Self::Displacement => MethodInfo {
                name: "displacement",
                label: "Displacement",
                key: '\\',
                summary: "Moves the surface itself along its normal by the height map: traced as geometry, with silhouettes and shadows.",
                error_class: ErrorClass::Truth,
                source: "Cook 1984; traced after Tevs et al. 2008 where flat, Thonat et al. 2021 where curved",
            },
        }
    }

    /// Name in scene files and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.info().name
    }

    /// The method with this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    /// Whether it moves texture coordinates.
    #[must_use]
    pub const fn shifts_uv(self) -> bool {
        matches!(self, Self::Parallax | Self::ParallaxLimited) || self.searches()
    }

    /// Whether it looks for the place on the relief that the eye sees, so that lights can be asked from
    /// there.
    #[must_use]
    pub const fn searches(self) -> bool {
        matches!(
            self,
            Self::Iterative
                | Self::Steep
                | Self::Occlusion
                | Self::Relief
                | Self::RelaxedCone
                | Self::Exact
        )
    }
}

/// Which kinds of map a method can make use of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodReads {
    /// Height maps.
    pub height: bool,
    /// Tangent-space normal maps.
    pub normal: bool,
    /// Slope maps.
    pub slope: bool,
}

impl Method {
    /// Which kinds of map it can make use of; the others need not exist.
    #[must_use]
    pub const fn reads(self, lookup: super::Lookup) -> MethodReads {
        match self {
            Self::None => MethodReads {
                height: false,
                normal: false,
                slope: false,
            },
            Self::Bump | Self::Displacement => MethodReads {
                height: true,
                normal: false,
                slope: false,
            },
            Self::Slope => MethodReads {
                height: true,
                normal: false,
                slope: true,
            },
            Self::Normal => MethodReads {
                height: false,
                normal: true,
                slope: false,
            },
            Self::Parallax
            | Self::ParallaxLimited
            | Self::Iterative
            | Self::Steep
            | Self::Occlusion
            | Self::Relief
            | Self::RelaxedCone
            | Self::Exact => MethodReads {
                height: true,
                normal: matches!(lookup, super::Lookup::Normal),
                slope: false,
            },
        }
    }
}
