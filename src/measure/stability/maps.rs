//! Maps of all sizes, depths and contents, in every role and under every method.

use super::board::{Album, Board, bumps, grey16};
use super::methods::most_steps;
use super::{Effort, Finding, Plan, Test};
use crate::surface::mapping::Method;
use crate::texture::{MapRole, RawImage, Samples};

/// Views, degrees off the normal.
const ANGLES: [f64; 3] = [20.0, 75.0, 89.9];
/// Amplitudes, tiles.
const AMPLITUDES: [f64; 2] = [0.1, 10.0];

/// Wider maps are rendered at the best level alone: what searches need of them takes too long to make.
const LARGE: u32 = 256;
/// No picture that is read has more columns or rows.
const LARGEST: u32 = 16_384;

/// A line for each map.
pub(super) fn tests(plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for (name, make) in pictures(plan.effort) {
        all.push(Test::new("maps", name, move |plan| {
            everywhere(plan, &make())
        }));
    }
    if plan.effort == Effort::Full {
        let name = format!("{LARGEST} x {LARGEST} texels");
        all.push(Test::new("maps", name, largest));
    }
    all
}

/// Makes a picture when it is its turn.
type Make = Box<dyn Fn() -> RawImage + Send + Sync>;

fn pictures(effort: Effort) -> Vec<(String, Make)> {
    let mut all: Vec<(String, Make)> = Vec::new();
    let mut add = |name: &str, make: Make| all.push((name.to_owned(), make));
    let thin = [(1, 64), (64, 1), (1, LARGEST), (LARGEST, 1)];
    let small = [(1, 1), (2, 2), (3, 7), (255, 257)];
    for (width, height) in small.into_iter().chain(thin) {
        let noise = move || {
            grey16(width, height, |x, y| {
                f64::from((x * 37 + y * 91) % 64) / 63.0
            })
        };
        add(&format!("{width} x {height} texels"), Box::new(noise));
    }
    let large = effort.pick(128, 384, 2048);
    add(
        &format!("{large} x {large} texels"),
        Box::new(move || bumps(large)),
    );
    add("a spike of one texel", Box::new(|| spike(1.0)));
    add("a hole of one texel", Box::new(|| spike(0.0)));
    add(
        "stripes of one texel",
        Box::new(|| grey16(64, 64, |x, _| f64::from(x % 2))),
    );
    for level in [0.0, 0.5, 1.0] {
        let flat = move || grey16(16, 16, |_, _| level);
        add(&format!("constant {level}"), Box::new(flat));
    }
    add("8 bits, colour", Box::new(|| colors(Samples::U8(bytes()))));
    let wide = || bytes().into_iter().map(|b| u16::from(b) * 257).collect();
    add(
        "16 bits, colour",
        Box::new(move || colors(Samples::U16(wide()))),
    );
    for (name, value) in [
        ("NaN", f32::NAN),
        ("infinity", f32::INFINITY),
        ("minus infinity", f32::NEG_INFINITY),
        ("1e30", 1e30),
        ("-1e30", -1e30),
        ("the largest float", f32::MAX),
        ("1e-40", 1e-40),
    ] {
        let name = format!("32 bits, some texels {name}");
        add(&name, Box::new(move || colors(Samples::F32(floats(value)))));
    }
    all
}

/// One texel unlike all others.
fn spike(value: f64) -> RawImage {
    grey16(64, 64, |x, y| {
        if [x, y] == [20, 30] {
            value
        } else {
            1.0 - value
        }
    })
}

const COLOR_SIDE: u32 = 16;

fn colors(samples: Samples) -> RawImage {
    let mut image = RawImage {
        width: COLOR_SIDE,
        height: COLOR_SIDE,
        channels: 3,
        samples,
    };
    // As the loader does.
    image.make_finite();
    image
}

fn bytes() -> Vec<u8> {
    (0..3 * COLOR_SIDE * COLOR_SIDE)
        .map(|i| (i * 83 % 256) as u8)
        .collect()
}

/// Each seventh is `value`.
fn floats(value: f32) -> Vec<f32> {
    let each = |(i, byte): (usize, u8)| {
        if i % 7 == 0 {
            value
        } else {
            f32::from(byte) / 255.0
        }
    };
    bytes().into_iter().enumerate().map(each).collect()
}

fn everywhere(plan: &Plan, image: &RawImage) -> Finding {
    let side = plan.effort.pick(8, 12, 64);
    let mut album = Album::default();
    let maps = MapRole::ALL.map(|role| (role, image.clone()));
    let mut board = Board::with_maps(maps.into());
    if image.width.max(image.height) > LARGE {
        board = board.alone();
    }
    for slot in &mut board.settings.materials[0].maps {
        if slot.role == MapRole::Opacity {
            // Half a picture without surface would show nothing.
            slot.bias = 0.4;
        }
    }
    for method in Method::ALL {
        for (angle, tiles) in ANGLES.into_iter().flat_map(|a| AMPLITUDES.map(|t| (a, t))) {
            board.seen_at(angle);
            board.mapped(method, tiles);
            album.add(&board, side);
        }
    }
    album.finding()
}

/// The largest map there is, as heights of 16 bits: half a GiB, and what searches make of it. The cones of
/// `relaxed-cone` are left out: they would take many minutes to make.
fn largest(_plan: &Plan) -> Finding {
    const SIDE: u32 = 32;
    let mut album = Album::default();
    let mut board = Board::with_maps(vec![(MapRole::Height, bumps(LARGEST))]).alone();
    let (mut too_many, mut most) = (0, 0.0_f64);
    let methods = Method::ALL
        .into_iter()
        .filter(|m| *m != Method::RelaxedCone);
    for method in methods {
        for (angle, tiles) in ANGLES.into_iter().flat_map(|a| AMPLITUDES.map(|t| (a, t))) {
            board.seen_at(angle);
            board.mapped(method, tiles);
            album.add(&board, SIDE);
            if method.searches() {
                board.settings.mapping.search.self_shadow = false;
                let counters = board.render(SIDE).counters;
                board.settings.mapping.search.self_shadow = true;
                let mean = counters.relief_steps as f64 / counters.camera_rays.max(1) as f64;
                most = most.max(mean);
                too_many += u64::from(mean > most_steps(method, &board, angle, LARGEST));
            }
        }
    }
    let wrong = album.non_finite + too_many;
    Finding::none_of(
        album.pixels,
        "non-finite pixels, or views of too many steps",
        wrong,
    )
    .with_note(format!("{most:.1} steps a pixel at the worst view"))
}
