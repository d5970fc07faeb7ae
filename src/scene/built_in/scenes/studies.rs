//! Plain scenes for comparing methods and measuring speed.

use super::super::maps::Relief;
use super::super::meshes;
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, floor, lamp, sky, sun};
use crate::math::LinearRgb;
use crate::scene::Background;

/// Brick paving, 60 m a side, seen along the ground.
pub fn plane() -> Stage {
    let mut palette = Palette::default();
    let paving = palette.relief(Relief::Bricks, 1.5, Finish::MATTE);
    Stage {
        mesh: floor(30.0, 1.5, paving),
        palette,
        camera: camera([0.0, -6.0, 1.25], [0.0, -2.2, 0.0], 40.0),
        lights: vec![
            ambient([0.70, 0.82, 1.0], 0.25),
            sun([0.70, -0.30, -0.45], [1.0, 0.86, 0.66], 5.0),
            lamp("Lamp", [-1.4, -3.2, 0.9], [0.55, 0.72, 1.0], 1.5),
        ],
        background: sky([0.20, 0.38, 0.75], [0.80, 0.74, 0.66]),
        exposure_ev: 0.0,
    }
}

/// A torus of 320 · 160 quads alone in the dark, matte, with a sun, a point light and no ambient light.
///
/// `R = 1`, `r = 0.4`, texture coordinates (7u, 3v), relief 0.027 deep. Small enough to trace fast, dense
/// enough to be a fair test of the tree; frame times are comparable from version to version.
pub fn torus_study() -> Stage {
    /// Tiles of the bricks lie 7 around and 3 up; their widths are 0.90 and 0.84 m in the middle.
    const TILE: f64 = 0.87;
    const DEPTH: f64 = 0.027;
    let mut palette = Palette::default();
    let bricks = palette.relief(Relief::Bricks, TILE, Finish::MATTE);
    palette.materials[usize::from(bricks)].default_amplitude = DEPTH;
    Stage {
        mesh: meshes::torus([1.0, 0.4], [320, 160], [7.0, 3.0], bricks),
        palette,
        camera: camera([0.0, -4.6, 2.6], [0.0; 3], 30.0),
        lights: vec![
            sun([0.70, -0.30, -0.65], [1.0; 3], 2.0),
            lamp("Point", [1.5, -2.5, 2.5], [1.0; 3], 8.0),
        ],
        background: Background::plain(LinearRgb::BLACK),
        exposure_ev: 1.0,
    }
}
