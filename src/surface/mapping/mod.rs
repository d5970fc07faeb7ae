//! The ways of perturbing a surface: one list, one door.
//!
//! [`Method`] is the list that feeds every menu; [`MaterialMapping::choose`] decides once per material
//! what it means there; [`MaterialMapping::apply`] runs it over a tile's points.

mod apply;
mod bound;
mod method;
pub mod relief;
mod settings;
mod tilt;

pub use apply::{MaterialMapping, MaterialMaps, parallax, parallax_limited};
pub use bound::{BoundHeight, BoundNormal};
pub use method::{ErrorClass, Method, MethodInfo, MethodReads};
pub use settings::{Derivative, Lookup, MappingSettings, SearchSettings};
pub use tilt::bumped;
