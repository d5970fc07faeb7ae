//! A camera that moves by fractions of a pixel changes the picture continuously.
//!
//! What is measured is how far all pixels travel together while the camera crosses one pixel. Taken in more
//! and more steps that comes to a limit for anything continuous (and for edges, which each pixel crosses once);
//! flicker would make it grow with the number of steps.

use glam::DVec3;

use super::board::{Board, bumps, tilts};
use super::placement::Placement;
use super::{Finding, Plan, Test, bodies};
use crate::math::LinearRgb;
use crate::render::Picture;
use crate::scene::Camera;
use crate::shading::{Light, LightKind, Material};
use crate::surface::mapping::Method;

/// The way in fine steps may be this much longer than in coarse ones, `FINE / COARSE` if it were flicker.
const BAR: f64 = 1.5;
/// Steps over one pixel: more than there are texels in it.
const COARSE: u32 = 16;
/// Texels along a side of the map.
const SIDE: u32 = 8;

/// A line for each method, and one for each extreme placement.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for method in Method::ALL {
        for angle in [45.0, 85.0] {
            let name = format!("{}, {angle} degrees", method.name());
            all.push(Test::new("sweep", name, move |plan| {
                let mut board = Board::new(bumps(SIDE), tilts(SIDE));
                board.seen_at(angle);
                board.mapped(method, 0.1);
                swept(plan, &board)
            }));
        }
    }
    for placement in Placement::extremes() {
        let name = format!("flat sphere, {}", placement.name());
        all.push(Test::new("sweep", name, move |plan| {
            swept(plan, &sphere(&placement))
        }));
    }
    all
}

/// How much longer the way gets in fine steps.
fn swept(plan: &Plan, board: &Board) -> Finding {
    let side = plan.effort.pick(12, 24, 96);
    let fine = plan.effort.pick(48, 64, 256);
    let pixels = u64::from(side * side * fine);
    let (coarse, way) = (travel(board, side, COARSE), travel(board, side, fine));
    Finding::worst_of(pixels, "times as far", way / coarse, Some(BAR))
        .with_note(format!("{fine} steps a pixel against {COARSE}"))
}

/// How far all pixels travel while the camera crosses one pixel to the right.
fn travel(board: &Board, side: u32, steps: u32) -> f64 {
    let camera = board.settings.camera;
    let at = |step: u32| {
        let mut board = board.clone();
        let pixel = f64::from(step) / f64::from(steps * side);
        let mut moved = camera;
        moved.pan(pixel, 0.3 * pixel);
        board.settings.camera = moved;
        board.render(side).picture
    };
    let mut last = at(0);
    let mut way = 0.0;
    for step in 1..=steps {
        let next = at(step);
        way += distance(&last, &next);
        last = next;
    }
    way
}

/// Sum of the differences of all channels.
fn distance(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.pixels.iter().zip(&b.pixels);
    let differences = pairs.flat_map(|(a, b)| {
        let [a, b] = [a, b].map(|c: &LinearRgb| c.to_array());
        [0, 1, 2].map(|i| f64::from((a[i] - b[i]).abs()))
    });
    differences.sum()
}

/// A flat-shaded sphere in the sun, far from anything.
fn sphere(placement: &Placement) -> Board {
    let mut settings = Board::with_maps(Vec::new()).settings;
    let sun = LightKind::Directional {
        direction: DVec3::new(-0.6, 0.8, -0.3),
    };
    settings.lights = vec![Light::new("sun", sun, 1.0)];
    settings.materials = vec![Material::matte("clay", LinearRgb::new(0.7, 0.6, 0.5))];
    settings.mapping.method = Method::None;
    settings.camera = Camera {
        eye: placement.world(DVec3::new(0.5, -2.6, 0.8)),
        target: placement.world(DVec3::ZERO),
        up: DVec3::Z,
        vfov: 45_f64.to_radians(),
    };
    Board::of(placement.scene(&bodies::sphere(16), false), settings)
}
