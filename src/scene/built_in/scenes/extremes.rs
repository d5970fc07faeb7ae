//! Closed bodies with relief in hard light: something to put where numbers run out.

use glam::DVec3;

use super::super::maps::Relief;
use super::super::meshes::{self, at};
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, floor, lamp, sky, sun};
use crate::math::LinearRgb;

/// A dented ball, a riveted box and a woven ring on a tiled floor.
pub fn extremes() -> Stage {
    let mut palette = Palette::default();
    let tiles = palette.relief(Relief::Tiles, 1.0, Finish::MATTE);
    let copper = palette.relief(
        Relief::Hammered,
        0.6,
        Finish::metal(LinearRgb::new(1.0, 0.72, 0.52), 24.0),
    );
    let plates = palette.relief(Relief::Rivets, 0.5, Finish::glossy(0.06, 40.0));
    let cane = palette.relief(Relief::Weave, 0.5, Finish::MATTE);
    let mut mesh = floor(3.0, 1.0, tiles);
    let ball = meshes::sphere(0.6, 64, [6.0, 3.0], copper);
    mesh.append(ball.placed(at(DVec3::new(-0.75, 0.1, 0.6))));
    let crate_box = meshes::bevelled_box(DVec3::splat(0.4), 0.06, 0.5, plates);
    mesh.append(crate_box.placed(at(DVec3::new(0.75, 0.35, 0.4))));
    let ring = meshes::torus([0.45, 0.16], [64, 32], [6.0, 2.0], cane);
    mesh.append(ring.placed(at(DVec3::new(0.35, -0.85, 0.16))));
    Stage {
        mesh,
        palette,
        camera: camera([0.4, -4.6, 2.3], [0.0, -0.1, 0.35], 33.0),
        lights: vec![
            ambient([0.75, 0.85, 1.0], 0.12),
            sun([0.75, 0.30, -0.42], [1.0, 0.90, 0.75], 5.5),
            lamp("Lamp", [-1.8, -1.8, 1.4], [0.55, 0.72, 1.0], 3.0),
        ],
        background: sky([0.10, 0.14, 0.24], [0.45, 0.45, 0.50]),
        exposure_ev: 0.0,
    }
}
