//! Scenes that the program generates.
