//! Rays and triangles in `f64`, every triangle tested, with a margin of doubt.

use glam::{DVec3, Vec3};

use crate::geometry::{Ray, TriangleMesh};
use crate::math::EPS;

/// What can be said for certain about a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// It passes every triangle by more than the margin.
    Miss,
    /// It hits this triangle, well inside, and nothing else is near.
    Hit {
        /// Index of the triangle.
        prim: u32,
        /// Distance.
        t: f64,
        /// Cosine between the ray and the triangle's normal, at least 0.
        cos: f64,
    },
    /// Both answers are right.
    Doubtful,
}

/// A ray against one triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Passage {
    Outside,
    Behind,
    Inside { t: f64, cos: f64 },
    Doubtful { nearest: f64 },
}

/// Four units in the last place of the largest coordinate that the ray's arithmetic meets: `4 · 2⁻²³ · (reach + max |O|)`.
///
/// The watertight test may be wrong within 6 roundings (`6 · 2⁻²⁴` of the same), see
/// [`RaySlabs`](crate::geometry::RaySlabs).
pub(super) fn margin(reach: f32, origin: Vec3) -> f64 {
    8.0 * f64::from(EPS) * size(reach, origin)
}

/// The largest coordinate that the ray's arithmetic meets.
fn size(reach: f32, origin: Vec3) -> f64 {
    f64::from(reach) + f64::from(origin.abs().max_element())
}

/// What every triangle of a mesh says together.
pub(super) fn judge(ray: &Ray, mesh: &TriangleMesh, reach: f32) -> Verdict {
    let margin = margin(reach, ray.origin);
    let passages =
        (0..mesh.len() as u32).map(|prim| (prim, pass(ray, &mesh.corners(prim), margin)));
    let (mut best, mut second, mut doubt) = (None, f64::INFINITY, f64::INFINITY);
    for (prim, passage) in passages {
        match passage {
            Passage::Outside | Passage::Behind => {}
            Passage::Doubtful { nearest } => doubt = doubt.min(nearest),
            Passage::Inside { t, cos } => match best {
                Some((_, nearest, _)) if nearest <= t => second = second.min(t),
                _ => {
                    second = best.map_or(second, |(_, t, _)| t);
                    best = Some((prim, t, cos));
                }
            },
        }
    }
    let Some((prim, t, cos)) = best else {
        return if doubt < f64::INFINITY {
            Verdict::Doubtful
        } else {
            Verdict::Miss
        };
    };
    // Within this the order of two hits is not certain.
    let near = 64.0 * margin / cos;
    if doubt.min(second) > t + near && t > near {
        Verdict::Hit { prim, t, cos }
    } else {
        Verdict::Doubtful
    }
}

/// Which side of each edge the ray passes, and how far from it.
fn pass(ray: &Ray, corners: &[Vec3; 3], margin: f64) -> Passage {
    let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let [a, b, c] = corners.map(|c| c.as_dvec3() - origin);
    let area = (b - a).cross(c - a);
    let ahead = [a, b, c].map(|p| p.dot(dir));
    let nearest = ahead.into_iter().fold(f64::INFINITY, f64::min);
    if ahead.into_iter().all(|t| t < -margin) {
        return Passage::Behind;
    }
    let facing = area.dot(dir);
    // Distance from the ray's line to the edge's, positive on the inner side for a triangle that faces so.
    let distance = |p: DVec3, q: DVec3| {
        let across = (q - p).cross(dir);
        p.dot(across) / across.length().max(f64::MIN_POSITIVE)
    };
    let sides = [distance(a, b), distance(b, c), distance(c, a)].map(|d| d * facing.signum());
    if sides.iter().any(|&d| d < -margin) {
        return Passage::Outside;
    }
    let cos = facing.abs() / area.length().max(f64::MIN_POSITIVE);
    let t = area.dot(a) / facing;
    if !sides.iter().all(|&d| d > margin) || !t.is_finite() {
        return Passage::Doubtful { nearest };
    }
    if t < -64.0 * margin / cos {
        return Passage::Behind;
    }
    Passage::Inside { t, cos }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn certain_only_off_the_edges() {
        let mesh = TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            indices: vec![[0, 1, 2], [0, 2, 1]],
            ..TriangleMesh::default()
        };
        let one = TriangleMesh {
            indices: vec![[0, 1, 2]],
            ..mesh.clone()
        };
        for z in [2.0_f32, -2.0] {
            let from = |x: f32, y: f32| Ray {
                origin: Vec3::new(x, y, z),
                dir: Vec3::Z * -z.signum(),
            };
            let hit = |x, y| judge(&from(x, y), &one, 1.0);
            assert!(matches!(hit(0.2, 0.2), Verdict::Hit { prim: 0, t, .. } if t == 2.0));
            assert_eq!(hit(1e-7, 0.5), Verdict::Doubtful);
            assert_eq!(hit(-1e-7, 0.5), Verdict::Doubtful);
            assert_eq!(hit(-1e-5, 0.5), Verdict::Miss);
            assert_eq!(hit(0.7, 0.7), Verdict::Miss);
            let twice = judge(&from(0.2, 0.2), &mesh, 1.0);
            assert_eq!(twice, Verdict::Doubtful, "two at the same place");
            let away = Ray {
                dir: Vec3::Z * z.signum(),
                ..from(0.2, 0.2)
            };
            assert_eq!(judge(&away, &one, 1.0), Verdict::Miss);
        }
    }
}
