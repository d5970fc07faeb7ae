//! Scenes that the program generates.

pub mod maps;
