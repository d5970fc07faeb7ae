//! What is known of every shown pixel beside its colour.

use glam::{Vec2, Vec3};

use crate::geometry::{Kernel, OffsetRule};
use crate::scene::{DisplaySettings, View};

/// What first samples leave.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Recording {
    /// Colours alone.
    #[default]
    Nothing,
    /// Records of all pixels.
    Pixels,
    /// Records that also tell where camera and shadow rays would end by this kernel and this offset, which takes
    /// tracing them once more. Only triangles that are not displaced are asked about.
    Suspect(Kernel, OffsetRule),
}

impl Recording {
    /// What a view needs.
    #[must_use]
    pub const fn for_view(display: &DisplaySettings) -> Self {
        match display.view {
            View::Picture => Self::Nothing,
            View::Leaks | View::FalseShadows => Self::Suspect(display.kernel, display.offset_rule),
            _ => Self::Pixels,
        }
    }

    /// Whether what it leaves is enough for the other one.
    #[must_use]
    pub fn serves(self, other: Self) -> bool {
        match other {
            Self::Nothing => true,
            Self::Pixels => self != Self::Nothing,
            Self::Suspect(..) => self == other,
        }
    }
}

/// What the first sample of a pixel (its centre) found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelRecord {
    /// Index of the material; `None` if the camera ray leaves the scene. Then everything about a surface is 0.
    pub material: Option<u16>,
    /// Unit normal that light is computed with, towards the eye, world axes.
    pub normal: Vec3,
    /// Unit normal of the surface before any map, on the same side. Under a displaced surface: that of the base
    /// below it.
    pub smooth_normal: Vec3,
    /// Texture coordinate shown, after the method moved it; `None` where the mesh has none.
    pub uv: Option<Vec2>,
    /// What the material's height map says there: `stored · gain + bias`; `None` without a map.
    pub height: Option<f32>,
    /// How far under the base the place shown lies, along the smooth normal, over the amplitude; negative over it.
    /// 0 for methods that move no place.
    pub depth: f32,
    /// Steps of the search for that place: height samples, nodes and cells, or parts of displaced triangles.
    pub steps: u32,
    /// Rays of all kinds, map look-ups and steps of searches and relief shadows that the sample took, mirrors
    /// included. Nodes of the tree and cut-out decisions are not in it.
    pub cost: u32,
    /// Samples that the pixel has.
    pub samples: u32,
    /// Whether the normal shows a side that cannot be seen from here: turned away from the eye, or under the
    /// horizon of the surface itself. Told before any rule for bent normals mends what it does to light.
    pub invalid_normal: bool,
    /// Whether the sample was not finite and counted as black.
    pub non_finite: bool,
    /// Whether the search took every step it may, so that it may have stopped short.
    pub at_the_cap: bool,
    /// Whether the camera ray sees something else by the [suspect](Recording::Suspect)'s kernel.
    pub leak: bool,
    /// Whether a light's shadow ray says something else by the suspect's kernel and offset.
    pub false_shadow: bool,
}

impl PixelRecord {
    /// A ray that leaves the scene.
    pub const NOTHING: Self = Self {
        material: None,
        normal: Vec3::ZERO,
        smooth_normal: Vec3::ZERO,
        uv: None,
        height: None,
        depth: 0.0,
        steps: 0,
        cost: 0,
        samples: 0,
        invalid_normal: false,
        non_finite: false,
        at_the_cap: false,
        leak: false,
        false_shadow: false,
    };
}

/// How far places on a material are apart, by its height map, else by its normal, slope or colour map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvYardstick {
    /// Texels per unit of u and v; 1 without any map.
    pub texels_per_uv: Vec2,
    /// Pictures per unit of u and v, where the picture repeats; 0 elsewhere.
    pub turns_per_uv: Vec2,
}

impl UvYardstick {
    /// Of a material without maps.
    pub const NONE: Self = Self {
        texels_per_uv: Vec2::ONE,
        turns_per_uv: Vec2::ZERO,
    };

    /// Texels between two places. Where the picture repeats, a whole turn is no distance: charts begin anew there.
    #[must_use]
    pub fn texels(&self, a: Vec2, b: Vec2) -> f32 {
        let way = a - b;
        let turns = (way * self.turns_per_uv).round();
        let whole = Vec2::select(
            turns.cmpeq(Vec2::ZERO),
            Vec2::ZERO,
            turns / self.turns_per_uv,
        );
        ((way - whole) * self.texels_per_uv).length()
    }
}

/// Records of all pixels of a picture, or of a preview of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Records {
    /// Columns and rows.
    pub size: [u32; 2],
    /// In rows.
    pub pixels: Vec<PixelRecord>,
    /// For each material, how far places on it are apart.
    pub yardsticks: Vec<UvYardstick>,
}
