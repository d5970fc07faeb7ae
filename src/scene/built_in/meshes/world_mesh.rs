//! A mesh under construction, in double precision and world units.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use crate::geometry::TriangleAttributes;

/// One corner of generated geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// World units.
    pub position: DVec3,
    /// Unit normal, on the front side.
    pub normal: DVec3,
    /// Texture coordinates, v up.
    pub uv: DVec2,
}

/// Triangles with one vertex record per corner combination; every triangle is smooth and has uv.
#[derive(Debug, Clone, Default)]
pub struct WorldMesh {
    /// Vertices in the order they were made.
    pub vertices: Vec<Vertex>,
    /// Corner indices, counter-clockwise seen from the front.
    pub indices: Vec<[u32; 3]>,
    /// One per triangle.
    pub attributes: Vec<TriangleAttributes>,
}

impl WorldMesh {
    /// Adds a surface over the unit square, `nu · nv` quads of two triangles each.
    ///
    /// Triangles face the side of their normals, whichever way `at` runs; those without area, at the pole
    /// of a sphere for instance, are left out.
    pub fn patch(&mut self, [nu, nv]: [u32; 2], material: u16, at: impl Fn(f64, f64) -> Vertex) {
        let first = self.vertices.len() as u32;
        for j in 0..=nv {
            for i in 0..=nu {
                let (s, t) = (f64::from(i) / f64::from(nu), f64::from(j) / f64::from(nv));
                self.vertices.push(at(s, t));
            }
        }
        for j in 0..nv {
            for i in 0..nu {
                let a = first + j * (nu + 1) + i;
                let (b, c, d) = (a + 1, a + nu + 2, a + nu + 1);
                self.triangle([a, b, c], material);
                self.triangle([a, c, d], material);
            }
        }
    }

    /// Adds another mesh.
    pub fn append(&mut self, other: Self) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        let moved = other.indices.iter().map(|t| t.map(|i| i + first));
        self.indices.extend(moved);
        self.attributes.extend(other.attributes);
    }

    /// The mesh moved, turned and scaled. The map must keep handedness.
    #[must_use]
    pub fn placed(mut self, by: DAffine3) -> Self {
        let normal_matrix: DMat3 = by.matrix3.inverse().transpose();
        for v in &mut self.vertices {
            v.position = by.transform_point3(v.position);
            v.normal = (normal_matrix * v.normal).normalize_or(v.normal);
        }
        self
    }

    /// Area vector of a triangle: along its front normal, as long as twice its area.
    #[must_use]
    pub fn area_vector(&self, corners: [u32; 3]) -> DVec3 {
        let [a, b, c] = corners.map(|i| self.vertices[i as usize].position);
        (b - a).cross(c - a)
    }

    fn triangle(&mut self, corners: [u32; 3], material: u16) {
        let area = self.area_vector(corners);
        let [a, b, c] = corners.map(|i| self.vertices[i as usize]);
        let edge = (b.position - a.position)
            .length()
            .max((c.position - a.position).length());
        // Corners that should coincide differ by rounding, about 1e-16 of their distance to the origin.
        if area.length() <= 1e-9 * edge * edge || edge == 0.0 {
            return;
        }
        let facing = area.dot(a.normal + b.normal + c.normal);
        let [a, b, c] = corners;
        self.indices
            .push(if facing < 0.0 { [a, c, b] } else { [a, b, c] });
        self.attributes.push(TriangleAttributes {
            material,
            has_uv: true,
            smooth: true,
        });
    }
}
