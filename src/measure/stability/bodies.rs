//! Closed meshes whose vertices are shared: what may leak is the triangle test alone.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::DVec3;

use super::Random;
use crate::geometry::TriangleAttributes;
use crate::scene::built_in::meshes::{Vertex, WorldMesh};

/// A closed surface about the origin, of radius about 1.
#[derive(Debug, Clone)]
pub(super) struct Body {
    /// Name in tables.
    pub name: &'static str,
    /// Vertices.
    pub vertices: Vec<DVec3>,
    /// Corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// A point well inside.
    pub inside: fn(&mut Random) -> DVec3,
}

impl Body {
    /// The body as a mesh, with normals that point away from its middle and texture coordinates that follow from
    /// places. Flat-shaded unless `smooth`.
    pub fn mesh(&self, smooth: bool) -> WorldMesh {
        let vertex = |&p: &DVec3| Vertex {
            position: p,
            normal: p.normalize_or(DVec3::Z),
            uv: p.truncate(),
        };
        let attributes = TriangleAttributes {
            material: 0,
            has_uv: true,
            smooth,
        };
        WorldMesh {
            vertices: self.vertices.iter().map(vertex).collect(),
            indices: self.triangles.clone(),
            attributes: vec![attributes; self.triangles.len()],
        }
    }
}

impl Body {
    /// All of them.
    pub fn all() -> [Self; 4] {
        [sphere(16), torus(64, 24), slivers(), fan(20_000)]
    }
}

/// A cube of `n × n` quads a face, its vertices pushed to the unit sphere and each quad cut along its ridge:
/// convex, and no poles.
pub(super) fn sphere(n: i32) -> Body {
    let mut vertices: Vec<DVec3> = Vec::new();
    let mut triangles = Vec::new();
    let mut shared = HashMap::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, n), (axis, -n)]) {
        for (x, y) in (0..n * n).map(|i| (i % n, i / n)) {
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            let mut quad = corners.map(|(x, y)| {
                let mut key = [side; 3];
                key[(axis + 1) % 3] = 2 * x - n;
                key[(axis + 2) % 3] = 2 * y - n;
                *shared.entry(key).or_insert_with(|| {
                    vertices.push(DVec3::from_array(key.map(f64::from)).normalize_or_zero());
                    vertices.len() as u32 - 1
                })
            });
            if side < 0 {
                quad.reverse();
            }
            triangles.extend(cut(&vertices, quad));
        }
    }
    Body {
        name: "sphere",
        vertices,
        triangles,
        inside: |random| random.cube() * 0.5,
    }
}

/// Two triangles of a quad that meet in a ridge, not in a valley.
fn cut(vertices: &[DVec3], [a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    let [p, q, r, s] = [a, b, c, d].map(|i| vertices[i as usize]);
    if (q - p).cross(r - p).dot(s - p) <= 0.0 {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    }
}

/// Radii 1 and 0.4 around z.
fn torus(columns: u32, rows: u32) -> Body {
    let at = |i: u32, n: u32| (f64::from(i) / f64::from(n) * TAU).sin_cos();
    let vertex = |i: u32| {
        let ((sin_a, cos_a), (sin_b, cos_b)) = (at(i % columns, columns), at(i / columns, rows));
        let r = 1.0 + 0.4 * cos_b;
        DVec3::new(r * cos_a, r * sin_a, 0.4 * sin_b)
    };
    let place = |x: u32, y: u32| (y % rows) * columns + x % columns;
    let cells = (0..rows * columns).map(|i| (i % columns, i / columns));
    let triangles = cells.flat_map(|(x, y)| {
        let [a, b, c, d] = [
            place(x, y),
            place(x + 1, y),
            place(x + 1, y + 1),
            place(x, y + 1),
        ];
        [[a, b, c], [a, c, d]]
    });
    Body {
        name: "torus",
        vertices: (0..rows * columns).map(vertex).collect(),
        triangles: triangles.collect(),
        inside: |random| {
            let (sin, cos) = (random.unit() * TAU).sin_cos();
            DVec3::new(cos, sin, 0.0) + random.cube() * 0.15
        },
    }
}

/// A tall prism whose corners are 10⁰ to 10⁻⁷ of a step apart: walls up to 10⁸ times as high as wide.
fn slivers() -> Body {
    let gaps: Vec<f64> = (0..96).map(|i| 0.1_f64.powi(i % 8)).collect();
    let whole: f64 = gaps.iter().sum();
    let mut angle = 0.0;
    let corners = gaps.iter().map(|gap| {
        angle += gap / whole * TAU;
        DVec3::new(angle.cos(), angle.sin(), 0.0) * 0.2
    });
    Body {
        name: "slivers",
        inside: |random| random.cube() * DVec3::new(0.08, 0.08, 0.9),
        ..prism(&corners.collect::<Vec<_>>())
    }
}

/// A prism over a polygon around the origin, from z = −1 to 1, with fans at both ends.
fn prism(polygon: &[DVec3]) -> Body {
    let n = polygon.len() as u32;
    let mut vertices = vec![DVec3::NEG_Z, DVec3::Z];
    for z in [DVec3::NEG_Z, DVec3::Z] {
        vertices.extend(polygon.iter().map(|&p| p + z));
    }
    let triangles = (0..n).flat_map(|i| {
        let next = (i + 1) % n;
        let [a, b, c, d] = [2 + i, 2 + next, 2 + n + next, 2 + n + i];
        [[0, b, a], [1, d, c], [a, b, c], [a, c, d]]
    });
    Body {
        name: "prism",
        triangles: triangles.collect(),
        vertices,
        inside: |random| random.cube() * 0.1,
    }
}

/// Two cones, each a fan of `n` needles around its tip.
fn fan(n: u32) -> Body {
    let mut vertices = vec![DVec3::Z, DVec3::NEG_Z];
    vertices.extend((0..n).map(|i| {
        let (sin, cos) = (f64::from(i) / f64::from(n) * TAU).sin_cos();
        DVec3::new(cos, sin, 0.0)
    }));
    let triangles = (0..n).flat_map(|i| {
        let (a, b) = (2 + i, 2 + (i + 1) % n);
        [[0, a, b], [1, b, a]]
    });
    Body {
        name: "fan",
        vertices,
        triangles: triangles.collect(),
        inside: |random| random.cube() * 0.2,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn spheres_are_convex() {
        for n in [3, 16] {
            let body = sphere(n);
            for t in &body.triangles {
                let [a, b, c] = t.map(|i| body.vertices[i as usize]);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let above = body.vertices.iter().map(|p| normal.dot(*p - a));
                assert!(above.fold(0.0, f64::max) < 1e-14);
            }
        }
    }

    #[test]
    fn bodies_are_closed_and_face_outwards() {
        for body in Body::all() {
            let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
            for t in &body.triangles {
                for i in 0..3 {
                    let (a, b) = (t[i], t[(i + 1) % 3]);
                    *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
                }
            }
            assert!(edges.values().all(|&sum| sum == 0), "{}", body.name);
            let corners = body
                .triangles
                .iter()
                .map(|t| t.map(|i| body.vertices[i as usize]));
            let volume: f64 = corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
            assert!(volume > 0.1, "{}: {volume}", body.name);
        }
    }
}
