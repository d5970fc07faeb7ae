//! Charts without area, normals without length, triangles without sense.

use glam::{DVec2, DVec3};

use super::board::{Album, Board, bumps, plane, tilts};
use super::convex::differing;
use super::{Finding, Plan, Test};
use crate::scene::built_in::meshes::{Vertex, WorldMesh};
use crate::surface::mapping::Method;

/// What is done to each vertex.
type Change = fn(usize, &mut Vertex);

const CHARTS: [(&str, Change); 6] = [
    ("all coordinates alike", |_, v| v.uv = DVec2::splat(0.3)),
    ("collapsed to a line", |_, v| v.uv.y = v.uv.x),
    ("mirrored", |_, v| v.uv.x = -v.uv.x),
    ("1e-30 wide", |_, v| v.uv *= 1e-30),
    ("1e10 wide", |_, v| v.uv *= 1e10),
    ("1e37 wide", |_, v| v.uv *= 1e35),
];

const NORMALS: [(&str, Change); 6] = [
    ("of length 0", |_, v| v.normal = DVec3::ZERO),
    ("one of length 0", |i, v| {
        if i == 0 {
            v.normal = DVec3::ZERO;
        }
    }),
    ("opposite to each other", |i, v| {
        v.normal *= if i % 2 == 0 { 1.0 } else { -1.0 };
    }),
    ("all turned over", |_, v| v.normal = -v.normal),
    ("in the plane", |_, v| v.normal = DVec3::X),
    ("1e-30 long", |_, v| v.normal *= 1e-30),
];

/// Lines for charts, normals and triangles.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for (kind, changes) in [("charts", CHARTS), ("normals", NORMALS)] {
        for (name, change) in changes {
            all.push(Test::new("faces", format!("{kind} {name}"), move |plan| {
                changed(plan, change)
            }));
        }
    }
    all.push(Test::new("faces", "no chart, no bumps", no_chart));
    all.push(Test::new("faces", "triangles without area", |plan| {
        unchanged(plan, with_rubbish)
    }));
    all.push(Test::new("faces", "every triangle twice", |plan| {
        unchanged(plan, |mesh| mesh.append(mesh.clone()))
    }));
    all.push(Test::new(
        "faces",
        "coincident planes, one turned over",
        |plan| unchanged(plan, with_back),
    ));
    all
}

fn board(mesh: &WorldMesh) -> Board {
    let mut board = Board::new(bumps(64), tilts(64)).on(mesh);
    board.seen_at(50.0);
    board
}

/// Every method on a plane whose vertices are not what they should be.
fn changed(plan: &Plan, change: Change) -> Finding {
    let mut mesh = plane();
    for (i, vertex) in mesh.vertices.iter_mut().enumerate() {
        change(i, vertex);
    }
    let mut board = board(&mesh);
    let mut album = Album::default();
    for method in Method::ALL {
        for (angle, tiles) in [(0.0, 0.1), (60.0, 0.1), (89.0, 10.0)] {
            board.seen_at(angle);
            board.mapped(method, tiles);
            album.add(&board, plan.effort.pick(8, 24, 128));
        }
    }
    album.finding()
}

/// Bumps on a chart without area are none.
fn no_chart(plan: &Plan) -> Finding {
    let mut mesh = plane();
    mesh.vertices
        .iter_mut()
        .for_each(|v| v.uv = DVec2::splat(0.3));
    let mut board = board(&mesh);
    let side = plan.effort.pick(16, 64, 256);
    let mut render = |method| {
        board.mapped(method, 0.1);
        board.render(side).picture
    };
    let (bumped, none) = (render(Method::Bump), render(Method::None));
    let pixels = none.pixels.len() as u64;
    Finding::none_of(pixels, "pixels changed", differing(&bumped, &none))
}

/// What is added to the plane must not show.
fn unchanged(plan: &Plan, add: fn(&mut WorldMesh)) -> Finding {
    let mut mesh = plane();
    let before = board(&mesh);
    add(&mut mesh);
    let after = board(&mesh);
    let side = plan.effort.pick(8, 32, 192);
    let (mut album, mut wrong) = (Album::default(), 0);
    for method in Method::ALL {
        for angle in [0.0, 60.0, 89.0] {
            let [mut before, mut after] = [before.clone(), after.clone()];
            for board in [&mut before, &mut after] {
                board.seen_at(angle);
                board.mapped(method, 0.1);
            }
            let rendered = album.add(&after, side);
            wrong += differing(&rendered.picture, &before.render(side).picture);
        }
    }
    let finding = album.finding();
    Finding {
        what: "pixels changed",
        figure: finding.figure + wrong as f64,
        ..finding
    }
}

/// Points, needles and lines across the view, none of them with area.
fn with_rubbish(mesh: &mut WorldMesh) {
    let first = mesh.vertices.len() as u32;
    let at = |x: f64, y: f64, z: f64| Vertex {
        position: DVec3::new(x, y, z),
        normal: DVec3::Z,
        uv: DVec2::new(x, y),
    };
    for i in 0..64 {
        let x = f64::from(i) / 32.0 - 1.0;
        // In the plane, so that the box around all of it stays.
        mesh.vertices
            .extend([at(x, -1.0, 0.0), at(x, 0.0, 0.0), at(x, 1.0, 0.0)]);
        let [a, b, c] = [0, 1, 2].map(|j| first + 3 * i + j);
        for corners in [[a, b, c], [a, a, b], [c, c, c]] {
            mesh.indices.push(corners);
            mesh.attributes.push(mesh.attributes[0]);
        }
    }
}

/// The same plane once more, seen from behind.
fn with_back(mesh: &mut WorldMesh) {
    let mut back = mesh.clone();
    for corners in &mut back.indices {
        corners.swap(1, 2);
    }
    mesh.append(back);
}
