//! A material's use of one picture: in which role, and how it is addressed.

use serde::{Deserialize, Serialize};

use super::{NormalAxes, Wrap};

/// What a picture means to a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapRole {
    /// Surface colour, sRGB-encoded unless the file holds floats.
    Albedo,
    /// Heights; white is high.
    Height,
    /// Normals, `n = 2c − 1`, in the slot's [`NormalSpace`].
    Normal,
    /// Slopes, the report's letter: `R = h_x`, `G = h_y`, each stored as `(h + 1) / 2`.
    Slope,
    /// Opacity: below one half there is a hole.
    Opacity,
}

impl MapRole {
    /// Every role, for menus and tests.
    pub const ALL: [Self; 5] = [
        Self::Albedo,
        Self::Height,
        Self::Normal,
        Self::Slope,
        Self::Opacity,
    ];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Height => "height",
            Self::Normal => "normal",
            Self::Slope => "slope",
            Self::Opacity => "opacity",
        }
    }
}

/// Which number of a texel a scalar map (height, opacity) reads; MTL's `-imfchan`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Channel {
    /// Rec. 709 luma of the stored values; the value itself in grey pictures.
    #[default]
    Luma,
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha; 1 everywhere in pictures without.
    Alpha,
}

impl Channel {
    /// Every channel, for menus and tests.
    pub const ALL: [Self; 5] = [Self::Luma, Self::R, Self::G, Self::B, Self::Alpha];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Luma => "luma",
            Self::R => "r",
            Self::G => "g",
            Self::B => "b",
            Self::Alpha => "alpha",
        }
    }
}

/// In which directions a normal map tells its vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NormalSpace {
    /// Along +u, +v and the smooth normal of each point, made perpendicular: the surface-gradient frame.
    #[default]
    Tangent,
    /// The interpolated frame of MikkTSpace, which most bakers write for.
    #[serde(rename = "mikktspace")]
    MikkTSpace,
    /// The axes of the model's file.
    Object,
}

impl NormalSpace {
    /// Every space, for menus and tests.
    pub const ALL: [Self; 3] = [Self::Tangent, Self::MikkTSpace, Self::Object];

    /// Name in scene files and menus.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tangent => "tangent",
            Self::MikkTSpace => "mikktspace",
            Self::Object => "object",
        }
    }
}

/// One picture in one role. Plain numbers that a panel edits; no pixel is touched by a change.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSlot {
    /// Index into the scene's images.
    pub image: usize,
    /// What the picture means.
    pub role: MapRole,
    /// Whether the slot is used at all.
    pub enabled: bool,
    /// Which number of a texel counts, for heights and opacity.
    pub channel: Channel,
    /// Heights and opacity: `1 − stored`.
    pub invert: bool,
    /// Normals and slopes: the green channel grows downwards (DirectX, −Y).
    pub flip_green: bool,
    /// Normals: the directions that they are told in.
    pub space: NormalSpace,
    /// Normals in object space: the axes that the channels tell.
    pub axes: NormalAxes,
    /// Heights: smoothed within half a stored level, see [`destaired`](super::destaired).
    pub destair: bool,
    /// The picture's first row lies at v = 0 instead of v = 1.
    pub flip_v: bool,
    /// Beyond the border.
    pub wrap: Wrap,
    /// `uv · scale + offset` addresses the picture (MTL `-s`).
    pub uv_scale: [f32; 2],
    /// See `uv_scale` (MTL `-o`).
    pub uv_offset: [f32; 2],
    /// `stored · gain + bias` (MTL `-mm bias gain`), before anything else.
    pub gain: f32,
    /// See `gain`.
    pub bias: f32,
    /// Normals and slopes: factor on the slopes (MTL `-bm`), above 0. Already in `baked_amplitude` once that
    /// is known, so only the loader reads it.
    pub strength: f32,
    /// Normals and slopes: the relief's amplitude that is already in them, world units. `None` until
    /// known; the loader fills it in.
    pub baked_amplitude: Option<f64>,
    /// How the picture came here and was recognised, for the panel: "map_Bump; looks like a normal map".
    pub note: String,
}

impl MapSlot {
    /// The picture in the plainest use of `role`.
    #[must_use]
    pub const fn new(image: usize, role: MapRole) -> Self {
        Self {
            image,
            role,
            enabled: true,
            channel: Channel::Luma,
            invert: false,
            flip_green: false,
            space: NormalSpace::Tangent,
            axes: NormalAxes::FILE,
            destair: false,
            flip_v: false,
            wrap: Wrap::Repeat,
            uv_scale: [1.0, 1.0],
            uv_offset: [0.0, 0.0],
            gain: 1.0,
            bias: 0.0,
            strength: 1.0,
            baked_amplitude: None,
            note: String::new(),
        }
    }

    /// What a stored height or opacity means: `stored · gain + bias`, inversion (`1 − value`) folded in.
    #[must_use]
    pub fn gain_and_bias(&self) -> (f32, f32) {
        if self.invert {
            (-self.gain, 1.0 - self.bias)
        } else {
            (self.gain, self.bias)
        }
    }
}
