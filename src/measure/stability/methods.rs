//! Every method at every angle and amplitude: finite pixels, bounded steps, nothing at amplitude 0.

use super::board::{Album, Board, TILE, bumps, tilts};
use super::convex::differing;
use super::{Finding, Plan, Test};
use crate::surface::mapping::{Lookup, Method};

/// Views, degrees off the normal.
const ANGLES: [f64; 9] = [0.0, 30.0, 60.0, 80.0, 85.0, 88.0, 89.0, 89.9, 89.99];
/// Amplitudes, tiles.
const AMPLITUDES: [f64; 5] = [1e-6, 0.05, 0.5, 2.0, 10.0];
/// Texels along a side of the map.
const SIDE: u32 = 64;

/// A line for each method and angle, then one for each method's steps and one for its amplitude 0.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for method in Method::ALL {
        for angle in ANGLES {
            let name = format!("{}, {angle} degrees", method.name());
            all.push(Test::new("methods", name, move |plan| {
                finite(plan, method, angle)
            }));
        }
    }
    for method in Method::ALL.into_iter().filter(|method| method.searches()) {
        let name = format!("{}, steps", method.name());
        all.push(Test::new("methods", name, move |plan| steps(plan, method)));
    }
    for method in Method::ALL {
        let name = format!("{}, amplitude 0", method.name());
        all.push(Test::new("methods", name, move |plan| flat(plan, method)));
    }
    all
}

fn board() -> Board {
    Board::new(bumps(SIDE), tilts(SIDE))
}

fn finite(plan: &Plan, method: Method, angle: f64) -> Finding {
    let side = plan.effort.pick(8, 16, 96);
    let mut album = Album::default();
    let mut board = board();
    board.seen_at(angle);
    for tiles in AMPLITUDES {
        for lookup in Lookup::ALL {
            board.mapped(method, tiles);
            board.settings.mapping.lookup = lookup;
            album.add(&board, side);
        }
    }
    album.finding()
}

/// Most steps that a search may need from top to bottom of a map `texels` wide, self-shadow left out.
pub(super) fn most_steps(method: Method, board: &Board, angle: f64, texels: u32) -> f64 {
    let mapping = &board.settings.mapping;
    if method == Method::Exact {
        // As far as the most slanted ray runs within the relief, in tiles; texel by texel at the worst.
        let steepest = (0.2 * (90.0 - angle)).to_radians().tan();
        let tiles = mapping.amplitude.unwrap_or(0.0) / TILE / steepest;
        return 64.0 + 4.0 * f64::from(2 * texels) * (tiles + 2.0);
    }
    f64::from(mapping.search.layers + mapping.search.bisections + mapping.search.iterations + 2)
}

fn steps(plan: &Plan, method: Method) -> Finding {
    let side = plan.effort.pick(8, 24, 96);
    let (mut pixels, mut worst, mut most) = (0, 0.0_f64, 0.0_f64);
    let mut board = board();
    board.settings.mapping.search.self_shadow = false;
    for angle in ANGLES {
        for tiles in AMPLITUDES {
            board.seen_at(angle);
            board.mapped(method, tiles);
            let rendered = board.render(side);
            let rays = rendered.counters.camera_rays;
            pixels += rays;
            let mean = rendered.counters.relief_steps as f64 / rays.max(1) as f64;
            worst = worst.max(mean / most_steps(method, &board, angle, SIDE));
            most = most.max(mean);
        }
    }
    Finding::worst_of(pixels, "of the most steps", worst, Some(1.0))
        .with_note(format!("{most:.1} steps a pixel at the worst view"))
}

/// Pixels that a relief without height changes.
fn flat(plan: &Plan, method: Method) -> Finding {
    let side = plan.effort.pick(16, 48, 192);
    let (mut pixels, mut wrong) = (0, 0);
    let mut board = board();
    // Normal maps keep their own relief whatever the amplitude says, unless they hold none.
    board.settings.mapping.use_normal = !matches!(method, Method::Normal | Method::Slope);
    for angle in ANGLES {
        board.seen_at(angle);
        board.mapped(Method::None, 0.0);
        let none = board.render(side).picture;
        board.mapped(method, 0.0);
        let picture = board.render(side).picture;
        pixels += picture.pixels.len() as u64;
        wrong += differing(&picture, &none);
    }
    Finding::none_of(pixels, "pixels changed", wrong)
}
