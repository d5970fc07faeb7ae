//! Planes, boxes, spheres, tori and discs.

use std::f64::consts::FRAC_PI_4;

use glam::{DVec2, DVec3};

use super::{Vertex, WorldMesh, sin_cos_turns};

/// A flat parallelogram from `corner` along two edges; its front is the side of `edge_u × edge_v`.
///
/// Texture coordinates start at 0 in the corner and grow by 1 per `tile` world units.
#[must_use]
pub fn quad(corner: DVec3, [edge_u, edge_v]: [DVec3; 2], tile: f64, material: u16) -> WorldMesh {
    let normal = edge_u.cross(edge_v).normalize_or(DVec3::Z);
    let size = DVec2::new(edge_u.length(), edge_v.length()) / tile;
    let mut mesh = WorldMesh::default();
    mesh.patch([1, 1], material, |s, t| Vertex {
        position: corner + edge_u * s + edge_v * t,
        normal,
        uv: DVec2::new(s, t) * size,
    });
    mesh
}

/// A box of the given half extents around the origin, its edges rounded with radius `bevel`.
///
/// Each side carries its own texture plane, one tile per `tile` world units along the surface, upright on
/// the four walls. `bevel` is limited to the smallest half extent.
#[must_use]
pub fn bevelled_box(half: DVec3, bevel: f64, tile: f64, material: u16) -> WorldMesh {
    /// Segments over half an edge, which turns by 45°.
    const STEPS: u32 = 4;
    let bevel = bevel.min(half.min_element());
    let inner = half - bevel;
    let mut mesh = WorldMesh::default();
    for (normal, right) in [
        (DVec3::NEG_Y, DVec3::X),
        (DVec3::X, DVec3::Y),
        (DVec3::Y, DVec3::NEG_X),
        (DVec3::NEG_X, DVec3::NEG_Y),
        (DVec3::Z, DVec3::X),
        (DVec3::NEG_Z, DVec3::NEG_X),
    ] {
        let up = normal.cross(right);
        let extent = |axis: DVec3| axis.abs().dot(inner);
        let (half_u, half_v) = (extent(right), extent(up));
        // A line across the side: bevel, flat, bevel, in 2·STEPS + 1 segments. Gives the flat coordinate
        // and the angle past the flat part.
        let across = |s: f64, half: f64| {
            let k = s * f64::from(2 * STEPS + 1);
            let steps = f64::from(STEPS);
            let turn = if k <= steps {
                k / steps - 1.0
            } else {
                ((k - steps - 1.0) / steps).max(0.0)
            };
            let side = if k < steps + 0.5 { -half } else { half };
            (side, turn * FRAC_PI_4)
        };
        mesh.patch([2 * STEPS + 1; 2], material, |s, t| {
            let ((x, a), (y, b)) = (across(s, half_u), across(t, half_v));
            let direction = (normal + right * a.tan() + up * b.tan()).normalize_or(normal);
            let middle = right * x + up * y + normal * extent(normal);
            Vertex {
                position: middle + direction * bevel,
                normal: direction,
                uv: DVec2::new(x + a * bevel, y + b * bevel) / tile,
            }
        });
    }
    mesh
}

/// A sphere around the origin with its poles on the z axis: `tiles` whole tiles around and from pole to
/// pole, `segments` quads around and half as many up.
#[must_use]
pub fn sphere(radius: f64, segments: u32, tiles: [f64; 2], material: u16) -> WorldMesh {
    let mut mesh = WorldMesh::default();
    mesh.patch([segments, (segments / 2).max(2)], material, |s, t| {
        let (sin_a, cos_a) = sin_cos_turns(s);
        let (sin_b, cos_b) = sin_cos_turns((t - 0.5) * 0.5);
        let normal = DVec3::new(cos_a * cos_b, sin_a * cos_b, sin_b);
        Vertex {
            position: normal * radius,
            normal,
            uv: DVec2::new(s * tiles[0], t * tiles[1]),
        }
    });
    mesh
}

/// A torus around the z axis: `p = (cos a, sin a, 0)·(R + r cos b) + (0, 0, r sin b)` with `a = 2πu`,
/// `b = 2πv`, for `[R, r] = radii`; texture coordinates are `(u, v)·tiles`.
#[must_use]
pub fn torus(radii: [f64; 2], segments: [u32; 2], tiles: [f64; 2], material: u16) -> WorldMesh {
    let [major, minor] = radii;
    let mut mesh = WorldMesh::default();
    mesh.patch(segments, material, |s, t| {
        let (sin_a, cos_a) = sin_cos_turns(s);
        let (sin_b, cos_b) = sin_cos_turns(t);
        let outwards = DVec3::new(cos_a, sin_a, 0.0);
        let normal = outwards * cos_b + DVec3::Z * sin_b;
        Vertex {
            position: outwards * major + normal * minor,
            normal,
            uv: DVec2::new(s * tiles[0], t * tiles[1]),
        }
    });
    mesh
}

/// A flat disc around the origin that faces +z. One tile covers its bounding square, so a medal's picture
/// lies once on it.
#[must_use]
pub fn disc(radius: f64, segments: u32, material: u16) -> WorldMesh {
    let mut mesh = WorldMesh::default();
    mesh.patch([segments, 1], material, |s, t| {
        let (sin, cos) = sin_cos_turns(s);
        let place = DVec2::new(cos, sin) * t;
        Vertex {
            position: (place * radius).extend(0.0),
            normal: DVec3::Z,
            uv: place * 0.5 + 0.5,
        }
    });
    mesh
}
