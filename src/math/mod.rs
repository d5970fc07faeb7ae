//! Numbers: rounding bounds, colours and vectors that every other room uses, for one point or for as many as
//! the machine has lanes ([`Real`]).

mod color;
mod false_color;
pub(crate) mod fetch;
mod float;
mod groups;
mod hash;
pub mod lanes;
mod normalize;
mod power;
mod real;
pub(crate) mod rows;
pub mod simd;
mod vector;
pub(crate) mod wide;

pub use color::{LinearRgb, SrgbEncoder, linear_from_srgb, srgb_from_linear, srgb8_from_linear};
pub use false_color::false_color;
pub use fetch::Words;
pub use float::{EPS, gamma, next_down, next_up};
pub use groups::Groups;
pub use hash::{hash, unit_interval};
pub use normalize::normalize_or;
pub use power::power_below_one;
pub use real::{Bits, Mask, Real};
pub use vector::{V2, V3, angle};
