//! Scenes that the program generates: nothing to download, nothing to find.
//!
//! A scene is a function that puts [`meshes`] with materials from [`maps`] before a camera. Everything is
//! made at start from a few formulae, the same to the bit on every machine.

mod assemble;
pub mod maps;
pub mod meshes;
mod palette;
mod placement;
mod scenes;

pub use assemble::assemble;
pub use palette::{Finish, Palette};
pub use placement::Placement;

use super::LoadedScene;
use super::load::LoadOptions;

/// What the program says about a generated scene.
#[derive(Debug, Clone, Copy)]
pub struct BuiltInInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// Label in the window.
    pub label: &'static str,
    /// One sentence.
    pub summary: &'static str,
    stage: fn() -> scenes::Stage,
}

/// Every generated scene, in the order of menus. The first is what a user sees who names none.
pub const SCENES: [BuiltInInfo; 9] = [
    BuiltInInfo {
        name: "wall",
        label: "Brick wall",
        summary: "A brick wall and a cobbled yard in raking evening light.",
        stage: scenes::wall,
    },
    BuiltInInfo {
        name: "torus",
        label: "Cobbled torus",
        summary: "Cobbles around a torus: relief on a curved surface and at its silhouette.",
        stage: scenes::torus,
    },
    BuiltInInfo {
        name: "sphere",
        label: "Hammered sphere",
        summary: "A hammered copper sphere among smaller ones on chequered tiles.",
        stage: scenes::sphere,
    },
    BuiltInInfo {
        name: "columns",
        label: "Columns",
        summary: "Fluted columns, a vase and a riveted crate: many materials on many shapes.",
        stage: scenes::columns,
    },
    BuiltInInfo {
        name: "mirrors",
        label: "Mirrors",
        summary: "Smooth, wavy and hammered mirrors: reflections follow the perturbed normals.",
        stage: scenes::mirrors,
    },
    BuiltInInfo {
        name: "materials",
        label: "Material board",
        summary: "All twelve generated materials on one board.",
        stage: scenes::materials,
    },
    BuiltInInfo {
        name: "plane",
        label: "Paved plane",
        summary: "One flat plane to the horizon: what each method does as the view grazes.",
        stage: scenes::plane,
    },
    BuiltInInfo {
        name: "torus-study",
        label: "Torus for timings",
        summary: "A torus of 102,400 triangles alone, matte, with two lights: for comparing speed.",
        stage: scenes::torus_study,
    },
    BuiltInInfo {
        name: "extremes",
        label: "Extremes",
        summary: "Closed bodies in hard light: put them where numbers run out (extremes@1e6,1e4).",
        stage: scenes::extremes,
    },
];

/// The scene that opens when none is named.
#[must_use]
pub const fn default_name() -> &'static str {
    SCENES[0].name
}

/// Builds a generated scene by name, put where the name says (see [`Placement`]); `None` if there is none of that
/// name.
#[must_use]
pub fn built_in(name: &str, options: &LoadOptions) -> Option<LoadedScene> {
    let (scene, placement) = Placement::split(name)?;
    let info = SCENES.iter().find(|info| info.name == scene)?;
    Some((info.stage)().finish(info, placement, options))
}
