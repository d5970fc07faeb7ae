//! What a scene file says, as plain data: only the keys that it has.

use glam::DVec3;

use crate::geometry::{Kernel, OffsetRule};
use crate::math::LinearRgb;
use crate::scene::{Background, BentNormals, ShadingModel, TextureFilter, View};
use crate::shading::Light;
use crate::surface::mapping::{Derivative, Lookup, Method};
use crate::texture::{Channel, MapRole, NormalAxes, NormalSpace, Wrap};

/// A value and the byte offset of its key, for faults that show only once the model is known.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placed<T> {
    /// The value.
    pub value: T,
    /// The key in full, as messages name it.
    pub key: String,
    /// Byte offset of the key.
    pub at: usize,
}

/// What is rendered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ModelName {
    /// A model's path as written.
    File(String),
    /// A built-in scene.
    BuiltIn(String),
}

/// A number that may be given back to its default by the word "default".
pub(super) type OrDefault<T> = Option<T>;

/// A whole file. `None` is a key that is not there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Document {
    /// `model` or `built_in`.
    pub model: Placed<ModelName>,
    /// `normalize`.
    pub normalize: Option<bool>,
    /// `[camera]`.
    pub camera: CameraKeys,
    /// `[[light]]`, all of them or none.
    pub lights: Option<Vec<Light>>,
    /// `[shading]`.
    pub shading: ShadingKeys,
    /// `[mapping]`.
    pub mapping: MappingKeys,
    /// `[[material]]`, in file order.
    pub materials: Vec<MaterialKeys>,
    /// `[render] size`, pixels.
    pub size: Option<[u32; 2]>,
    /// `[render] samples`.
    pub samples: Option<u32>,
    /// `[display]`.
    pub display: DisplayKeys,
}

/// `[display]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct DisplayKeys {
    /// `exposure_ev`, stops.
    pub exposure_ev: Option<f32>,
    /// `view`.
    pub view: Option<View>,
    /// `kernel`.
    pub kernel: Option<Kernel>,
    /// `offset_rule`.
    pub offset_rule: Option<OffsetRule>,
}

/// `[camera]`, world units and degrees.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct CameraKeys {
    /// `eye`.
    pub eye: Option<DVec3>,
    /// `target`.
    pub target: Option<DVec3>,
    /// `up`.
    pub up: Option<DVec3>,
    /// `vfov_deg`, degrees.
    pub vfov_deg: Option<f64>,
}

/// `[shading]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ShadingKeys {
    /// `model`.
    pub model: Option<ShadingModel>,
    /// `bent_normals`.
    pub bent_normals: Option<BentNormals>,
    /// `filter`.
    pub filter: Option<TextureFilter>,
    /// `specular_antialiasing`.
    pub specular_antialiasing: Option<bool>,
    /// `smooth_terminator`.
    pub smooth_terminator: Option<bool>,
    /// `shadows`.
    pub shadows: Option<bool>,
    /// `max_bounces`.
    pub max_bounces: Option<u32>,
    /// `background`.
    pub background: Option<Background>,
}

/// `[mapping]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct MappingKeys {
    /// `method`.
    pub method: Option<Method>,
    /// `lookup`.
    pub lookup: Option<Lookup>,
    /// `derivative`.
    pub derivative: Option<Derivative>,
    /// `amplitude`, world units.
    pub amplitude: Option<OrDefault<f64>>,
    /// `midlevel`.
    pub midlevel: Option<f32>,
    /// `use_height`.
    pub use_height: Option<bool>,
    /// `use_normal`.
    pub use_normal: Option<bool>,
    /// `use_parallax`.
    pub use_parallax: Option<bool>,
    /// `cut_at_border`.
    pub cut_at_border: Option<bool>,
    /// `weld_seams`.
    pub weld_seams: Option<bool>,
    /// `displacement_memory`, mebibytes.
    pub displacement_memory: Option<u32>,
    /// `layers`.
    pub layers: Option<u32>,
    /// `min_layers`.
    pub min_layers: Option<u32>,
    /// `bisections`.
    pub bisections: Option<u32>,
    /// `iterations`.
    pub iterations: Option<u32>,
    /// `self_shadow`.
    pub self_shadow: Option<bool>,
}

/// Which materials of the model an entry means.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Which {
    /// `name = "*"`.
    Every,
    /// Every material of this name.
    Named(String),
    /// The one with this number, for names that are not unique.
    Numbered(usize),
}

/// One `[[material]]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MaterialKeys {
    /// `name` or `index`.
    pub which: Placed<Which>,
    /// `kd`.
    pub kd: Option<LinearRgb>,
    /// `ks`.
    pub ks: Option<LinearRgb>,
    /// `shininess`.
    pub shininess: Option<f32>,
    /// `reflectivity`.
    pub reflectivity: Option<f32>,
    /// `amplitude`, world units.
    pub amplitude: Option<OrDefault<f64>>,
    /// `midlevel`.
    pub midlevel: Option<OrDefault<f32>>,
    /// `default_amplitude`, world units.
    pub default_amplitude: Option<f64>,
    /// `[[material.map]]`: all of the material's maps.
    pub maps: Option<Vec<MapKeys>>,
    /// `albedo_map` and its like: the material's one map in a role, or none if the name is empty.
    pub simple_maps: Vec<(MapRole, Placed<String>)>,
    /// `normal_y`: whether green grows downwards.
    pub normal_down: Option<Placed<bool>>,
    /// `normal_space`.
    pub normal_space: Option<Placed<NormalSpace>>,
    /// `normal_axes`.
    pub normal_axes: Option<Placed<NormalAxes>>,
    /// `destair`.
    pub destair: Option<Placed<bool>>,
    /// `normal_amplitude`, world units.
    pub normal_amplitude: Option<Placed<OrDefault<f64>>>,
}

/// One `[[material.map]]`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MapKeys {
    /// `image`: a path, or the name of a generated picture.
    pub image: Placed<String>,
    /// `role`.
    pub role: MapRole,
    /// `enabled`.
    pub enabled: Option<bool>,
    /// `channel`.
    pub channel: Option<Channel>,
    /// `invert`.
    pub invert: Option<bool>,
    /// `flip_green`.
    pub flip_green: Option<bool>,
    /// `space`.
    pub space: Option<NormalSpace>,
    /// `axes`.
    pub axes: Option<NormalAxes>,
    /// `destair`.
    pub destair: Option<bool>,
    /// `flip_v`.
    pub flip_v: Option<bool>,
    /// `wrap`.
    pub wrap: Option<Wrap>,
    /// `uv_scale`.
    pub uv_scale: Option<[f32; 2]>,
    /// `uv_offset`.
    pub uv_offset: Option<[f32; 2]>,
    /// `gain`.
    pub gain: Option<f32>,
    /// `bias`.
    pub bias: Option<f32>,
    /// `strength`.
    pub strength: Option<f32>,
    /// `baked_amplitude`, world units.
    pub baked_amplitude: Option<OrDefault<f64>>,
    /// `note`.
    pub note: Option<String>,
}
