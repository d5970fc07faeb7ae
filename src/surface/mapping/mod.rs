//! The ways of perturbing a surface.

mod method;
mod settings;

pub use method::{ErrorClass, Method, MethodInfo};
pub use settings::{Derivative, Lookup, MappingSettings};
