//! What a surface does with light, and which maps lie on it.

use crate::math::LinearRgb;
use crate::texture::{MapRole, MapSlot};

/// Numbers and maps of one material. Everything a slider can move; cheap to copy.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in the MTL or scene file.
    pub name: String,
    /// Diffuse colour, linear; multiplies the albedo map.
    pub kd: LinearRgb,
    /// Specular colour, linear. Black marks a matte surface: no highlight is computed.
    pub ks: LinearRgb,
    /// Phong exponent `s`, at least 0.
    pub shininess: f32,
    /// Share of mirror reflection in `[0, 1]`; 0 sends no reflection ray.
    pub reflectivity: f32,
    /// World units from stored height 0 to stored height 1, if this material has its own.
    pub amplitude: Option<f64>,
    /// Stored height that lies on the mesh, if this material has its own.
    pub midlevel: Option<f32>,
    /// Amplitude where neither the material nor the mapping settings give one: MTL's `-bm`, or 2 % of
    /// the tile's median world width. World units.
    pub default_amplitude: f64,
    /// Pictures on the surface. The first enabled slot of a role counts.
    pub maps: Vec<MapSlot>,
}

impl Material {
    /// A matte material without maps.
    #[must_use]
    pub fn matte(name: impl Into<String>, kd: LinearRgb) -> Self {
        Self {
            name: name.into(),
            kd,
            ks: LinearRgb::BLACK,
            shininess: 10.0,
            reflectivity: 0.0,
            amplitude: None,
            midlevel: None,
            default_amplitude: 0.0,
            maps: Vec::new(),
        }
    }

    /// The first enabled slot with this role.
    #[must_use]
    pub fn map(&self, role: MapRole) -> Option<&MapSlot> {
        self.maps
            .iter()
            .find(|slot| slot.enabled && slot.role == role)
    }
}
