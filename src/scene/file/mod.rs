//! The scene file, TOML.
