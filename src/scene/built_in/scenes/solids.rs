//! One curved shape each.

use std::f64::consts::FRAC_PI_2;

use glam::{DAffine3, DQuat, DVec3};

use super::super::maps::Relief;
use super::super::meshes::{self, at};
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, floor, lamp, sky, sun};
use crate::math::LinearRgb;

/// A cobbled torus around a copper ball, on chequered tiles.
pub fn torus() -> Stage {
    let mut palette = Palette::default();
    // Seven tiles around the outside of 2π·1.4 m and three around the tube: about 0.95 m each.
    let cobble = palette.relief(Relief::Cobble, 0.95, Finish::glossy(0.05, 20.0));
    let tiles = palette.relief(
        Relief::Tiles,
        1.8,
        Finish::glossy(0.06, 60.0).mirroring(0.08),
    );
    let copper = palette.relief(
        Relief::Hammered,
        0.6,
        Finish::metal(LinearRgb::new(1.0, 0.72, 0.52), 24.0).mirroring(0.12),
    );
    let mut mesh = floor(14.0, 2.6, tiles);
    let ring = meshes::torus([1.0, 0.42], [160, 80], [7.0, 3.0], cobble);
    mesh.append(ring.placed(at(DVec3::Z * 0.42)));
    mesh.append(lying_ball(0.42, [5.0, 2.0], copper, DVec3::Z * 0.42));
    Stage {
        mesh,
        palette,
        camera: camera([-0.9, -4.3, 2.75], [0.02, -0.08, 0.30], 33.0),
        lights: vec![
            ambient([0.70, 0.82, 1.0], 0.25),
            sun([0.72, 0.28, -0.50], [1.0, 0.84, 0.64], 5.5),
            lamp("Lamp", [2.0, -1.6, 1.6], [0.50, 0.68, 1.0], 4.0),
        ],
        background: sky([0.20, 0.38, 0.80], [0.95, 0.80, 0.62]),
        exposure_ev: 0.0,
    }
}

/// A hammered copper sphere, with a woven and a glazed ball beside it, on chequered tiles.
pub fn sphere() -> Stage {
    let mut palette = Palette::default();
    let tiles = palette.relief(
        Relief::Tiles,
        2.0,
        Finish::glossy(0.06, 60.0).mirroring(0.10),
    );
    let copper = palette.relief(
        Relief::Hammered,
        1.05,
        Finish::metal(LinearRgb::new(1.0, 0.72, 0.52), 26.0).mirroring(0.12),
    );
    let cane = palette.relief(Relief::Weave, 0.62, Finish::glossy(0.05, 15.0));
    let glaze = palette.relief(
        Relief::Waves,
        0.65,
        Finish::glossy(0.10, 120.0).mirroring(0.12),
    );
    let mut mesh = floor(20.0, 2.0, tiles);
    mesh.append(lying_ball(
        1.0,
        [6.0, 3.0],
        copper,
        DVec3::new(0.0, 0.0, 1.0),
    ));
    mesh.append(lying_ball(
        0.40,
        [4.0, 2.0],
        cane,
        DVec3::new(-1.22, -1.05, 0.40),
    ));
    mesh.append(lying_ball(
        0.30,
        [3.0, 1.0],
        glaze,
        DVec3::new(0.92, -1.28, 0.30),
    ));
    Stage {
        mesh,
        palette,
        camera: camera([0.25, -5.4, 1.75], [-0.06, 0.0, 0.78], 32.0),
        lights: vec![
            ambient([0.70, 0.82, 1.0], 0.25),
            sun([0.70, 0.42, -0.58], [1.0, 0.86, 0.68], 5.0),
            lamp("Lamp", [2.6, -2.4, 2.2], [0.55, 0.72, 1.0], 6.0),
        ],
        background: sky([0.05, 0.22, 0.72], [0.95, 0.90, 0.86]),
        exposure_ev: 0.0,
    }
}

/// A ball whose poles point left and right, where the silhouette hides that tiles shrink there.
fn lying_ball(radius: f64, tiles: [f64; 2], material: u16, center: DVec3) -> meshes::WorldMesh {
    let turn = DQuat::from_rotation_y(FRAC_PI_2);
    meshes::sphere(radius, 128, tiles, material)
        .placed(DAffine3::from_rotation_translation(turn, center))
}
