//! Numbers: rounding bounds, colours and small vector helpers that every other room uses.

mod color;
mod float;
mod frame;
mod hash;

pub use color::{LinearRgb, SrgbEncoder, linear_from_srgb, srgb_from_linear, srgb8_from_linear};
pub use float::{EPS, gamma, next_down, next_up};
pub use frame::{TangentFrame, normalize_or, orthonormal_basis};
pub use hash::{hash_u32, unit_f32_from_bits};
