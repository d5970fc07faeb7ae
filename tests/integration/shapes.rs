//! Meshes and random rays for the geometry tests. Everything follows from a fixed seed.

use std::f32::consts::TAU;

use glam::Vec3;
use reliefscope::geometry::{Aabb, Ray, TriangleMesh};
use reliefscope::math::{hash, unit_interval};

/// Random numbers from a counter.
pub struct Random(u32);

impl Random {
    pub fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9))
    }

    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(1);
        hash(self.0)
    }

    /// In `[0, 1)`.
    pub fn unit(&mut self) -> f32 {
        unit_interval(self.bits())
    }

    /// In `[-1, 1)` on each axis.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }

    pub fn below(&mut self, n: usize) -> usize {
        self.bits() as usize % n
    }

    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        let z = self.unit() * 2.0 - 1.0;
        let (sin, cos) = (self.unit() * TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * cos, r * sin, z).normalize_or_zero()
    }

    /// A positive or negative unit axis, with zeros of either sign.
    pub fn axis(&mut self) -> Vec3 {
        let mut dir = [0.0_f32; 3].map(|zero| if self.bits() & 1 == 0 { zero } else { -zero });
        dir[self.below(3)] = if self.bits() & 1 == 0 { 1.0 } else { -1.0 };
        Vec3::from_array(dir)
    }
}

pub fn mesh(positions: Vec<Vec3>, indices: Vec<[u32; 3]>) -> TriangleMesh {
    TriangleMesh {
        attributes: vec![Default::default(); indices.len()],
        positions,
        indices,
        ..Default::default()
    }
}

/// Triangles that share nothing.
pub fn soup(count: u32, mut triangle: impl FnMut() -> [Vec3; 3]) -> TriangleMesh {
    let positions = (0..count).flat_map(|_| triangle()).collect();
    mesh(
        positions,
        (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
    )
}

pub fn random_soup(count: u32, size: f32, seed: u32) -> TriangleMesh {
    let mut random = Random::new(seed);
    soup(count, || {
        let at = random.cube();
        [(); 3].map(|()| at + random.cube() * size)
    })
}

/// A grid of `columns × rows` quads over `[-1, 1]²` in the plane `z = 0`.
pub fn plane(columns: u32, rows: u32) -> TriangleMesh {
    grid([columns, rows], [columns + 1, rows + 1], |u, v| {
        Vec3::new(u * 2.0 - 1.0, v * 2.0 - 1.0, 0.0)
    })
}

/// A closed torus around `z`; radii 1 and 0.4.
pub fn torus(columns: u32, rows: u32) -> TriangleMesh {
    grid([columns, rows], [columns, rows], |u, v| {
        let ((sin_u, cos_u), (sin_v, cos_v)) = ((u * TAU).sin_cos(), (v * TAU).sin_cos());
        let r = 1.0 + 0.4 * cos_v;
        Vec3::new(r * cos_u, r * sin_u, 0.4 * sin_v)
    })
}

/// Quads of two triangles; vertices wrap around where there are only as many as quads.
fn grid(
    [columns, rows]: [u32; 2],
    [across, up]: [u32; 2],
    point: impl Fn(f32, f32) -> Vec3,
) -> TriangleMesh {
    let at = |x: u32, y: u32| (y % up) * across + x % across;
    let positions = (0..up * across)
        .map(|i| {
            point(
                (i % across) as f32 / columns as f32,
                (i / across) as f32 / rows as f32,
            )
        })
        .collect();
    let indices = (0..rows * columns)
        .flat_map(|i| {
            let (x, y) = (i % columns, i / columns);
            let (a, b, c, d) = (at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    mesh(positions, indices)
}

/// A closed unit sphere: a cube of `n × n` quads per face, its vertices shared and pushed outwards.
pub fn sphere(n: u32) -> TriangleMesh {
    let mut shared = std::collections::HashMap::new();
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    let mut vertex = |face: usize, x: u32, y: u32| {
        let n = n as i32;
        let mut key = [0; 3];
        key[face % 3] = if face < 3 { n } else { -n };
        key[(face + 1) % 3] = 2 * x as i32 - n;
        key[(face + 2) % 3] = 2 * y as i32 - n;
        *shared.entry(key).or_insert_with(|| {
            positions.push(Vec3::from_array(key.map(|k| k as f32)).normalize_or_zero());
            positions.len() as u32 - 1
        })
    };
    for face in 0..6 {
        for (x, y) in (0..n * n).map(|i| (i % n, i / n)) {
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            let mut quad = corners.map(|(x, y)| vertex(face, x, y));
            if face >= 3 {
                quad.reverse();
            }
            let [a, b, c, d] = quad;
            indices.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh(positions, indices)
}

/// `p · scale + offset` of each vertex, in `f64`, then rounded.
pub fn placed(mut mesh: TriangleMesh, scale: f64, offset: f64) -> TriangleMesh {
    for p in &mut mesh.positions {
        *p = (p.as_dvec3() * scale + offset).as_vec3();
    }
    mesh
}

/// A point on an edge of a random triangle: a corner, the middle, or anywhere between.
pub fn edge_point(mesh: &TriangleMesh, random: &mut Random) -> Vec3 {
    let corners = mesh.corners(random.below(mesh.len()) as u32);
    let first = random.below(3);
    let (a, b) = (
        corners[first].as_dvec3(),
        corners[(first + 1) % 3].as_dvec3(),
    );
    let along = match random.below(3) {
        0 => 0.0,
        1 => 0.5,
        _ => f64::from(random.unit()),
    };
    a.lerp(b, along).as_vec3()
}

/// The ray from `origin` through `target`, as well as `f32` can aim; any direction if they coincide.
pub fn towards(origin: Vec3, target: Vec3) -> Ray {
    let dir = (target.as_dvec3() - origin.as_dvec3()).normalize_or(glam::DVec3::Z);
    Ray {
        origin,
        dir: dir.as_vec3(),
    }
}

/// Rays that are hard on a hierarchy as well as ordinary ones. `bounds` are the mesh's.
pub fn mixed_ray(mesh: &TriangleMesh, bounds: Aabb, random: &mut Random) -> Ray {
    let size = bounds.extent().max_element().max(1e-30);
    let vertex = |random: &mut Random| random.pick(&mesh.positions);
    let anywhere = |random: &mut Random| bounds.center() + random.cube() * size;
    match random.below(6) {
        // Parallel to an axis, through a vertex: in the planes of boxes.
        0 => {
            let dir = random.axis();
            Ray {
                origin: vertex(random) - dir * random.pick(&[0.0, size, -size]),
                dir,
            }
        }
        // From a vertex to another: along edges and inside faces.
        1 => towards(vertex(random), vertex(random)),
        // In a plane of a box, at any angle.
        2 => {
            let mut dir = random.direction();
            let mut origin = anywhere(random);
            let axis = random.below(3);
            dir[axis] = 0.0;
            origin[axis] = vertex(random)[axis];
            Ray {
                origin,
                dir: dir.normalize_or(Vec3::X),
            }
        }
        3 => towards(anywhere(random), edge_point(mesh, random)),
        4 => towards(anywhere(random), vertex(random)),
        _ => Ray {
            origin: anywhere(random),
            dir: random.direction(),
        },
    }
}
