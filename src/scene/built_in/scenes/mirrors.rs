//! Reflections of and in bumpy surfaces.

use std::f64::consts::FRAC_PI_2;

use glam::{DAffine3, DQuat, DVec3};

use super::super::maps::Relief;
use super::super::meshes::{self, WorldMesh, at, bevelled_box};
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, floor, lamp, sky, sun};
use crate::math::LinearRgb;

/// A hammered, a smooth and a wavy mirror ball before a leaning mirror, with coloured things to reflect.
pub fn mirrors() -> Stage {
    let mut palette = Palette::default();
    let tiles = palette.relief(
        Relief::Tiles,
        2.6,
        Finish::glossy(0.06, 60.0).mirroring(0.10),
    );
    let bricks = palette.relief(Relief::Bricks, 1.5, Finish::MATTE);
    let silver = Finish {
        kd: LinearRgb::gray(0.05),
        ks: LinearRgb::gray(0.5),
        shininess: 400.0,
        reflectivity: 0.88,
    };
    let smooth = palette.plain("mirror", silver);
    let hammered = palette.relief(Relief::Hammered, 0.9, silver);
    let wavy = palette.relief(Relief::Waves, 0.9, silver);
    let lacquer = palette.relief(
        Relief::OrangePeel,
        0.5,
        Finish::glossy(0.08, 60.0)
            .mirroring(0.06)
            .tinted(LinearRgb::new(0.70, 0.10, 0.06)),
    );
    let cane = palette.relief(Relief::Weave, 0.45, Finish::glossy(0.05, 15.0));
    let frame = palette.plain(
        "frame",
        Finish::glossy(0.08, 50.0).tinted(LinearRgb::new(0.10, 0.08, 0.07)),
    );

    let mut mesh = floor(18.0, 2.6, tiles);
    let mut ball = |radius, tiles, material, [x, y]: [f64; 2]| {
        let ball = meshes::sphere(radius, 128, tiles, material);
        let turn = DQuat::from_rotation_y(FRAC_PI_2);
        let place = DVec3::new(x, y, radius);
        mesh.append(ball.placed(DAffine3::from_rotation_translation(turn, place)));
    };
    ball(0.72, [5.0, 2.0], hammered, [-1.75, 0.15]);
    ball(0.72, [5.0, 2.0], smooth, [0.0, -0.2]);
    ball(0.72, [5.0, 2.0], wavy, [1.75, 0.15]);
    ball(0.30, [4.0, 2.0], lacquer, [-0.82, -1.35]);
    ball(0.26, [4.0, 2.0], cane, [0.95, -1.45]);
    let mirror = standing_mirror(smooth, frame);
    mesh.append(mirror.placed(DAffine3::from_rotation_translation(
        DQuat::from_rotation_z(-0.06) * DQuat::from_rotation_x(0.10),
        DVec3::new(0.2, 2.2, 1.27),
    )));
    let block = bevelled_box(DVec3::new(0.375, 0.75, 0.75), 0.015, 1.5, bricks);
    mesh.append(block.placed(at(DVec3::new(-3.2, 0.9, 0.75))));
    let block = bevelled_box(DVec3::new(0.375, 0.375, 0.375), 0.015, 1.5, bricks);
    mesh.append(block.placed(at(DVec3::new(3.0, -0.55, 0.375))));

    Stage {
        mesh,
        palette,
        camera: camera([-0.5, -6.2, 2.3], [0.05, 0.2, 0.80], 34.0),
        lights: vec![
            ambient([0.75, 0.82, 1.0], 0.26),
            sun([0.62, 0.46, -0.55], [1.0, 0.82, 0.60], 5.2),
            lamp("Lamp", [2.8, -2.6, 1.8], [0.55, 0.72, 1.0], 5.0),
        ],
        background: sky([0.06, 0.20, 0.58], [1.30, 0.86, 0.52]),
        exposure_ev: 0.0,
    }
}

/// A framed mirror of 3.4 m by 2.4 m around the origin that faces −y.
fn standing_mirror(glass: u16, frame: u16) -> WorldMesh {
    let mut mesh = bevelled_box(DVec3::new(1.7, 0.05, 1.2), 0.03, 1.0, frame);
    let pane = meshes::quad(
        DVec3::new(-1.6, -0.052, -1.1),
        [DVec3::X * 3.2, DVec3::Z * 2.2],
        1.0,
        glass,
    );
    mesh.append(pane);
    mesh
}
