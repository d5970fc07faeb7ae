//! The scenes themselves. World units are metres, z is up.

mod board;
mod courtyard;
mod extremes;
mod mirrors;
mod solids;
mod stage;
mod studies;
mod wall;

pub use board::materials;
pub use courtyard::columns;
pub use extremes::extremes;
pub use mirrors::mirrors;
pub use solids::{sphere, torus};
pub use stage::Stage;
pub use studies::{plane, torus_study};
pub use wall::wall;
