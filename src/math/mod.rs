//! Numbers: rounding bounds, colours and small vector helpers that every other room uses.

mod color;
mod float;
mod hash;
mod normalize;

pub use color::{LinearRgb, SrgbEncoder, linear_from_srgb, srgb_from_linear, srgb8_from_linear};
pub use float::{EPS, gamma, next_down, next_up};
pub use hash::{hash_u32, unit_f32_from_bits};
pub use normalize::normalize_or;
