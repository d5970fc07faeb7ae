//! Every generated material side by side.

use glam::DVec3;

use super::super::maps::Relief;
use super::super::meshes::{WorldMesh, at, bevelled_box, quad};
use super::super::{Finish, Palette};
use super::stage::{Stage, ambient, camera, lamp, sky, sun};
use crate::math::LinearRgb;

/// Distance between the middles of two panels, metres; a panel is one tile of 1 m.
const SPACING: f64 = 1.12;

/// Four columns and three rows of panels on a dark board.
pub fn materials() -> Stage {
    let mut palette = Palette::default();
    let board = palette.plain(
        "board",
        Finish::glossy(0.04, 20.0).tinted(LinearRgb::new(0.060, 0.055, 0.050)),
    );
    let back = bevelled_box(DVec3::new(2.36, 0.05, 1.80), 0.03, 1.0, board);
    let mut mesh = WorldMesh::default();
    mesh.append(back.placed(at(DVec3::new(0.0, 0.09, 0.0))));
    for (i, relief) in Relief::ALL.into_iter().enumerate() {
        let material = palette.relief(relief, 1.0, finish(relief));
        let x = ((i % 4) as f64 - 1.5) * SPACING;
        let z = (1.0 - (i / 4) as f64) * SPACING;
        mesh.append(panel(material).placed(at(DVec3::new(x, 0.0, z))));
    }
    Stage {
        mesh,
        palette,
        camera: camera([-0.9, -5.6, 0.25], [0.02, 0.0, -0.02], 36.5),
        lights: vec![
            ambient([0.80, 0.88, 1.0], 0.26),
            sun([0.66, 0.62, -0.46], [1.0, 0.90, 0.76], 4.2),
            lamp("Lamp", [2.6, -1.6, -0.6], [0.60, 0.75, 1.0], 3.0),
        ],
        background: sky([0.20, 0.24, 0.30], [0.09, 0.08, 0.08]),
        exposure_ev: 0.0,
    }
}

/// A panel of 1 m, its face towards −y carrying exactly one tile.
fn panel(material: u16) -> WorldMesh {
    quad(
        DVec3::new(-0.5, 0.0, -0.5),
        [DVec3::X, DVec3::Z],
        1.0,
        material,
    )
}

fn finish(relief: Relief) -> Finish {
    match relief {
        Relief::Bricks | Relief::Terrain => Finish::MATTE,
        Relief::Cobble | Relief::Weave => Finish::glossy(0.05, 18.0),
        Relief::Tiles => Finish::glossy(0.06, 60.0).mirroring(0.06),
        Relief::Waves | Relief::Ripple => Finish::glossy(0.12, 120.0).mirroring(0.10),
        Relief::OrangePeel => Finish::glossy(0.08, 60.0).tinted(LinearRgb::new(0.62, 0.08, 0.06)),
        Relief::Rivets => Finish::glossy(0.10, 35.0),
        Relief::Hammered => Finish::metal(LinearRgb::new(1.0, 0.72, 0.52), 24.0).mirroring(0.08),
        Relief::Tread => Finish::metal(LinearRgb::gray(0.95), 40.0).mirroring(0.12),
        Relief::Medallion => Finish::metal(LinearRgb::new(1.0, 0.80, 0.50), 40.0).mirroring(0.10),
    }
}
