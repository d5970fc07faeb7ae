//! The first thing a user sees.

use glam::DVec3;

use super::super::maps::Relief;
use super::super::meshes::{WorldMesh, at, bevelled_box, quad, sphere};
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, lamp, sky, sun};
use crate::math::LinearRgb;

/// A brick wall with a pier and a stone course, a cobbled yard before it, a copper ball on a plinth. A
/// warm, low sun rakes over the bricks from the left; a cool lamp hangs in the shadow of the pier.
pub fn wall() -> Stage {
    const BRICK: f64 = 1.5;
    const COBBLE: f64 = 1.1;
    const STONE: f64 = 0.9;
    // Wall and yard pass through each other, deeper than their reliefs: if they shared corners, true displacement would
    // hold them together there, and lean over all of both.
    const PAST: f64 = 0.06;
    let mut palette = Palette::default();
    let bricks = palette.relief(Relief::Bricks, BRICK, Finish::MATTE);
    let cobble = palette.relief(Relief::Cobble, COBBLE, Finish::glossy(0.04, 18.0));
    let stone = palette.relief(
        Relief::OrangePeel,
        STONE,
        Finish::MATTE.tinted(LinearRgb::new(0.52, 0.47, 0.40)),
    );
    let copper = palette.relief(
        Relief::Hammered,
        0.5,
        Finish::metal(LinearRgb::new(1.0, 0.72, 0.52), 24.0).mirroring(0.12),
    );

    let mut mesh = WorldMesh::default();
    let mut face = quad(
        DVec3::new(-6.0, 0.0, -PAST),
        [DVec3::X * 12.0, DVec3::Z * (4.5 + PAST)],
        BRICK,
        bricks,
    );
    for vertex in &mut face.vertices {
        // A course begins at the ground.
        vertex.uv.y -= PAST / BRICK;
    }
    mesh.append(face);
    mesh.append(quad(
        DVec3::new(-6.0, -8.0, 0.0),
        [DVec3::X * 12.0, DVec3::Y * (8.0 + PAST)],
        COBBLE,
        cobble,
    ));
    let pier = bevelled_box(DVec3::new(0.375, 0.25, 2.25), 0.012, BRICK, bricks);
    mesh.append(pier.placed(at(DVec3::new(1.72, -0.2, 2.25))));
    let course = bevelled_box(DVec3::new(3.65, 0.10, 0.17), 0.025, STONE, stone);
    mesh.append(course.placed(at(DVec3::new(-2.32, -0.04, 0.17))));
    let plinth = bevelled_box(DVec3::new(0.27, 0.27, 0.30), 0.03, STONE, stone);
    mesh.append(plinth.placed(at(DVec3::new(0.55, -1.25, 0.30))));
    let slab = bevelled_box(DVec3::new(0.33, 0.33, 0.045), 0.02, STONE, stone);
    mesh.append(slab.placed(at(DVec3::new(0.55, -1.25, 0.645))));
    let ball = sphere(0.31, 96, [4.0, 2.0], copper);
    mesh.append(ball.placed(at(DVec3::new(0.55, -1.25, 1.0))));

    Stage {
        mesh,
        palette,
        camera: camera([-1.45, -4.25, 1.42], [0.45, -0.3, 0.98], 39.0),
        lights: vec![
            ambient([0.62, 0.78, 1.0], 0.18),
            sun([0.86, 0.26, -0.40], [1.0, 0.84, 0.62], 7.8),
            lamp("Lamp", [2.95, -0.95, 1.75], [0.42, 0.68, 1.0], 2.2),
        ],
        background: sky([0.25, 0.42, 0.75], [0.55, 0.45, 0.36]),
        exposure_ev: 0.0,
    }
}
