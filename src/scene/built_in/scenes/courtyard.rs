//! Many materials on many shapes.

use std::f64::consts::FRAC_PI_2;

use glam::{DAffine3, DQuat, DVec3};

use super::super::maps::Relief;
use super::super::meshes::{Curve, WorldMesh, at, bevelled_box, disc, fluted_shaft, quad, revolve};
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, floor, lamp, sky, sun};
use crate::math::LinearRgb;

const STONE_TILE: f64 = 1.2;

/// Three fluted columns before a brick wall with a medallion, a vase on a riveted crate, a basket.
pub fn columns() -> Stage {
    let mut palette = Palette::default();
    let stone = palette.relief(
        Relief::OrangePeel,
        STONE_TILE,
        Finish::glossy(0.03, 20.0).tinted(LinearRgb::new(0.95, 0.90, 0.80)),
    );
    let tiles = palette.relief(
        Relief::Tiles,
        2.4,
        Finish::glossy(0.06, 60.0).mirroring(0.08),
    );
    let bricks = palette.relief(Relief::Bricks, 1.5, Finish::MATTE);
    let steel = palette.relief(Relief::Rivets, 0.9, Finish::glossy(0.10, 35.0));
    let glaze = palette.relief(
        Relief::Waves,
        0.40,
        Finish::glossy(0.12, 140.0).mirroring(0.12),
    );
    let cane = palette.relief(Relief::Weave, 0.55, Finish::glossy(0.05, 15.0));
    let bronze = palette.relief(
        Relief::Medallion,
        1.2,
        Finish::metal(LinearRgb::new(1.0, 0.80, 0.50), 40.0).mirroring(0.10),
    );

    let mut mesh = floor(9.0, 2.4, tiles);
    mesh.append(quad(
        DVec3::new(-9.0, 2.2, 0.0),
        [DVec3::X * 18.0, DVec3::Z * 4.5],
        1.5,
        bricks,
    ));
    for x in [-2.1, 0.0, 2.1] {
        mesh.append(column(stone).placed(at(DVec3::new(x, 1.0, 0.0))));
    }
    let beam = bevelled_box(DVec3::new(3.2, 0.42, 0.30), 0.03, STONE_TILE, stone);
    mesh.append(beam.placed(at(DVec3::new(0.0, 1.0, 3.42))));
    let upright = DQuat::from_rotation_x(FRAC_PI_2);
    let medal = disc(0.60, 96, bronze);
    mesh.append(medal.placed(DAffine3::from_rotation_translation(
        upright,
        DVec3::new(0.56, 2.19, 1.42),
    )));
    let crate_box = bevelled_box(DVec3::splat(0.45), 0.02, 0.9, steel);
    mesh.append(crate_box.placed(DAffine3::from_rotation_translation(
        DQuat::from_rotation_z(0.42),
        DVec3::new(0.95, -0.75, 0.45),
    )));
    mesh.append(vase(glaze).placed(at(DVec3::new(0.95, -0.75, 0.90))));
    mesh.append(basket(cane).placed(at(DVec3::new(-0.75, -1.0, 0.0))));

    Stage {
        mesh,
        palette,
        camera: camera([-1.9, -5.6, 1.95], [0.12, 0.4, 1.28], 36.0),
        lights: vec![
            ambient([0.70, 0.82, 1.0], 0.24),
            sun([0.66, 0.50, -0.40], [1.0, 0.84, 0.62], 5.0),
            lamp("Lamp", [2.9, -0.6, 2.4], [0.55, 0.70, 1.0], 4.5),
        ],
        background: sky([0.22, 0.40, 0.75], [0.70, 0.62, 0.52]),
        exposure_ev: 0.0,
    }
}

/// A column of 3.12 m: square plinth, torus and scotia, fluted shaft, echinus and abacus.
fn column(material: u16) -> WorldMesh {
    let mut mesh = WorldMesh::default();
    let plinth = bevelled_box(DVec3::new(0.42, 0.42, 0.07), 0.015, STONE_TILE, material);
    mesh.append(plinth.placed(at(DVec3::Z * 0.07)));
    let base = [
        Curve::line([0.0, 0.14], [0.36, 0.14]),
        Curve::bulge([0.36, 0.14], 0.25, 0.05),
        Curve::line([0.36, 0.25], [0.345, 0.25]),
        Curve::line([0.345, 0.25], [0.345, 0.27]),
        Curve::quarter([0.345, 0.27], [0.30, 0.27], [0.30, 0.33]),
        Curve::line([0.30, 0.33], [0.0, 0.33]),
    ];
    mesh.append(revolve(&base, 64, [2.0, STONE_TILE], material));
    let shaft = fluted_shaft(2.45, [0.29, 0.235], 20, STONE_TILE, material);
    mesh.append(shaft.placed(at(DVec3::Z * 0.33)));
    let capital = [
        Curve::line([0.0, 2.78], [0.25, 2.78]),
        Curve::bulge([0.25, 2.78], 2.84, 0.025),
        Curve::line([0.25, 2.84], [0.25, 2.86]),
        Curve::quarter([0.25, 2.86], [0.37, 2.87], [0.38, 2.99]),
        Curve::line([0.38, 2.99], [0.0, 2.99]),
    ];
    mesh.append(revolve(&capital, 64, [2.0, STONE_TILE], material));
    let abacus = bevelled_box(DVec3::new(0.41, 0.41, 0.065), 0.012, STONE_TILE, material);
    mesh.append(abacus.placed(at(DVec3::Z * 3.055)));
    mesh
}

/// A vase of 0.62 m with an open mouth.
fn vase(material: u16) -> WorldMesh {
    let p = |r: f64, z: f64| glam::DVec2::new(r, z);
    let chain = [
        Curve::line([0.0, 0.0], [0.12, 0.0]),
        Curve([p(0.12, 0.0), p(0.145, 0.02), p(0.10, 0.035), p(0.11, 0.06)]),
        Curve([p(0.11, 0.06), p(0.30, 0.14), p(0.31, 0.34), p(0.13, 0.44)]),
        Curve([p(0.13, 0.44), p(0.075, 0.47), p(0.08, 0.54), p(0.15, 0.62)]),
        Curve::bulge([0.15, 0.62], 0.632, -0.008),
        Curve([
            p(0.145, 0.632),
            p(0.07, 0.54),
            p(0.065, 0.47),
            p(0.11, 0.42),
        ]),
        Curve([p(0.11, 0.42), p(0.27, 0.34), p(0.26, 0.16), p(0.0, 0.06)]),
    ];
    revolve(&chain, 96, [3.0, 0.40], material)
}

/// A woven basket of 0.5 m.
fn basket(material: u16) -> WorldMesh {
    let p = |r: f64, z: f64| glam::DVec2::new(r, z);
    let chain = [
        Curve::line([0.0, 0.0], [0.30, 0.0]),
        Curve([p(0.30, 0.0), p(0.43, 0.08), p(0.45, 0.32), p(0.38, 0.46)]),
        Curve([
            p(0.38, 0.46),
            p(0.375, 0.52),
            p(0.345, 0.52),
            p(0.345, 0.46),
        ]),
        Curve([p(0.345, 0.46), p(0.41, 0.32), p(0.39, 0.08), p(0.27, 0.03)]),
        Curve::line([0.27, 0.03], [0.0, 0.03]),
    ];
    revolve(&chain, 96, [4.0, 0.55], material)
}
