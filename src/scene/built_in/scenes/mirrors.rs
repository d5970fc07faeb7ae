//! Reflections of and in bumpy surfaces.

use std::f64::consts::FRAC_PI_2;

use glam::{DAffine3, DQuat, DVec3};

use super::super::maps::Relief;
use super::super::meshes::{self, WorldMesh, at, bevelled_box};
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, floor, lamp, sky, sun};
use crate::math::LinearRgb;

/// A smooth, a hammered and a wavy mirror ball on cobbles, between a leaning mirror and a brick block.
pub fn mirrors() -> Stage {
    let mut palette = Palette::default();
    let cobble = palette.relief(Relief::Cobble, 1.4, Finish::glossy(0.05, 25.0));
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
    let frame = palette.plain(
        "frame",
        Finish::glossy(0.08, 50.0).tinted(LinearRgb::new(0.10, 0.08, 0.07)),
    );

    let mut mesh = floor(16.0, 1.4, cobble);
    let ball = |tiles, material, place| {
        meshes::sphere(0.7, 128, tiles, material).placed(DAffine3::from_rotation_translation(
            DQuat::from_rotation_y(FRAC_PI_2),
            place,
        ))
    };
    mesh.append(ball([5.0, 2.0], hammered, DVec3::new(-1.65, 0.0, 0.7)));
    mesh.append(ball([5.0, 2.0], smooth, DVec3::new(0.0, -0.35, 0.7)));
    mesh.append(ball([5.0, 2.0], wavy, DVec3::new(1.65, 0.0, 0.7)));
    mesh.append(
        standing_mirror(smooth, frame).placed(DAffine3::from_rotation_translation(
            DQuat::from_rotation_z(-0.10) * DQuat::from_rotation_x(-0.06),
            DVec3::new(0.35, 1.9, 1.2),
        )),
    );
    let block = bevelled_box(DVec3::new(0.375, 0.75, 0.75), 0.015, 1.5, bricks);
    mesh.append(block.placed(at(DVec3::new(-3.1, 1.0, 0.75))));
    let block = bevelled_box(DVec3::new(0.375, 0.375, 0.375), 0.015, 1.5, bricks);
    mesh.append(block.placed(at(DVec3::new(0.85, -1.6, 0.375))));

    Stage {
        mesh,
        palette,
        camera: camera([-0.7, -6.0, 1.9], [0.0, 0.2, 0.85], 35.0),
        lights: vec![
            ambient([0.75, 0.82, 1.0], 0.26),
            sun([0.62, 0.46, -0.55], [1.0, 0.82, 0.60], 5.2),
            lamp("Lamp", [2.8, -2.6, 1.8], [0.55, 0.72, 1.0], 5.0),
        ],
        background: sky([0.10, 0.26, 0.62], [1.0, 0.72, 0.48]),
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
