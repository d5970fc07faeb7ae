//! Light, material and the Phong model.

mod light;
mod material;

pub use light::{Falloff, Light, LightKind};
pub use material::Material;
