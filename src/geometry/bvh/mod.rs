//! Bounding volume hierarchy (contract; implemented by the geometry work).
