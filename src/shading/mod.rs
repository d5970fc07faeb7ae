//! Light, material and the Phong model.

mod light;
mod material;
mod phong;

pub use light::{Falloff, Light, LightKind};
pub use material::Material;
pub use phong::{mirror_direction, phong_lobe, reflect, softened_horizon, widened_exponent};
