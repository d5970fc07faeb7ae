//! The fast single-precision code against the report's equations in double precision.
//!
//! Tolerances are absolute where the compared numbers are of order one. `f32` rounds to 6·10⁻⁸; a few
//! dozen operations with directions of unit length stay below 2·10⁻⁶.

mod displaced;
mod horizons;
mod mapping;
mod picture;
mod walk;

use glam::{DQuat, DVec2, DVec3, Vec2, Vec3};
use reliefscope::geometry::triangle::{TriangleTest, Watertight};
use reliefscope::geometry::{Hit, Ray, RaySlabs, TriangleAttributes, TriangleMesh};
use reliefscope::math::V3;
use reliefscope::measure::report_equations as report;
use reliefscope::measure::stability::Random;
use reliefscope::shading::{phong_lobe, reflect};
use reliefscope::surface::{SurfaceParts, surface_at};

/// What the tests ask of [`Random`] beside.
trait RandomDirections {
    /// Unit, on the side of `normal`, at least `min_cos` off its plane.
    fn direction_above(&mut self, normal: DVec3, min_cos: f64) -> DVec3;
    /// Any.
    fn rotation(&mut self) -> DQuat;
}

impl RandomDirections for Random {
    fn direction_above(&mut self, normal: DVec3, min_cos: f64) -> DVec3 {
        loop {
            let d = self.direction();
            if d.dot(normal) > min_cos {
                return d;
            }
        }
    }

    fn rotation(&mut self) -> DQuat {
        let angle = self.between(0.0, std::f64::consts::TAU);
        DQuat::from_axis_angle(self.direction(), angle)
    }
}

/// What `f32` makes of a number, for references that start from the same inputs.
fn rounded(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// 2.4–2.8: the watertight test hits and misses what the edge test does, at the same distance.
#[test]
fn triangles_are_hit_where_the_edge_test_says() {
    let mut random = Random::new(1);
    let (mut hits, mut misses) = (0, 0);
    for case in 0..20_000 {
        let corners = [(); 3].map(|()| rounded(random.cube()));
        let origin = rounded(random.cube() * 3.0);
        let weights = [(); 2].map(|()| random.between(-0.3, 0.8));
        let target = corners[0] * (1.0 - weights[0] - weights[1])
            + corners[1] * weights[0]
            + corners[2] * weights[1];
        let ray = Ray {
            origin: origin.as_vec3(),
            dir: (target - origin).as_vec3().normalize_or_zero(),
        };
        let dir = ray.dir.as_dvec3();
        let normal = report::face_normal(&corners);
        let incidence = normal.normalize_or_zero().dot(dir).abs();
        // Needles and grazing views magnify rounding without bound.
        if normal.length() < 0.05 || incidence < 0.05 {
            continue;
        }
        let on_plane = report::plane_parameter(origin, dir, corners[0], normal)
            .and_then(|t| report::barycentrics(report::point_on_ray(origin, dir, t), corners));
        // So near an edge both answers are right.
        if on_plane.is_some_and(|b| b.iter().any(|w| w.abs() < 1e-4)) {
            continue;
        }
        let expected = report::intersect_convex(origin, dir, &corners);
        let slabs = RaySlabs::new(&ray, 1.0);
        let found = Watertight::new(&ray).intersect(&slabs, &corners.map(|c| c.as_vec3()));
        assert_eq!(found.is_some(), expected.is_some(), "case {case}");
        if let (Some(found), Some(t)) = (found, expected) {
            assert!((f64::from(found.t) - t).abs() < 2e-5, "case {case}");
            let [_, u, v] = on_plane.expect("it was hit");
            let off = (f64::from(found.u) - u)
                .abs()
                .max((f64::from(found.v) - v).abs());
            assert!(off < 1e-4, "case {case}: weights are off by {off}");
            hits += 1;
        } else {
            misses += 1;
        }
    }
    assert!(
        hits > 5_000 && misses > 5_000,
        "{hits} hits, {misses} misses"
    );
}

fn one_triangle(corners: [DVec3; 3], uvs: [DVec2; 3]) -> TriangleMesh {
    TriangleMesh {
        positions: corners.iter().map(|c| c.as_vec3()).collect(),
        normals: Vec::new(),
        uvs: uvs.iter().map(|t| t.as_vec2()).collect(),
        indices: vec![[0, 1, 2]],
        attributes: vec![TriangleAttributes {
            material: 0,
            has_uv: true,
            smooth: false,
        }],
    }
}

/// 2.19–2.25: texture coordinates by barycentric weights.
#[test]
fn texture_coordinates_are_the_weighted_ones() {
    let mut random = Random::new(2);
    for case in 0..2_000 {
        let corners = [(); 3].map(|()| rounded(random.cube()));
        let uvs = [(); 3].map(|()| rounded(random.cube() * 4.0).truncate());
        if report::face_normal(&corners).length() < 0.1 {
            continue;
        }
        let u = random.between(0.0, 1.0) as f32;
        let v = random.between(0.0, f64::from(1.0 - u)) as f32;
        let hit = Hit {
            t: 1.0,
            prim: 0,
            sub: 0,
            u,
            v,
        };
        let ray = Ray {
            origin: Vec3::ZERO,
            dir: Vec3::Z,
        };
        let s = surface_at(&one_triangle(corners, uvs), &hit, &ray, SurfaceParts::Uv);
        // The reference finds the weights again, from the point alone.
        let p = corners[0] * f64::from(1.0 - u - v)
            + corners[1] * f64::from(u)
            + corners[2] * f64::from(v);
        let weights = report::barycentrics(p, corners).expect("it has area");
        let expected = report::interpolate_uv(weights, uvs);
        assert!(
            (Vec2::from(s.uv).as_dvec2() - expected).length() < 1e-5,
            "case {case}"
        );
        assert!(
            (Vec3::from(s.p).as_dvec3() - p).length() < 1e-6,
            "case {case}"
        );
    }
}

/// 2.11–2.13: mirrored directions and highlights, up to exponents that the report never tried.
#[test]
fn highlights_are_powers_of_the_cosine() {
    let mut random = Random::new(3);
    for case in 0..20_000 {
        let n = rounded(random.direction());
        let l = rounded(random.direction_above(n, 1e-3));
        let exponent = random.between(-3.0, 20.0).exp2();
        // Close to the mirror image, where there is something to see.
        let spread = (2.0 / (exponent + 1.0)).sqrt();
        let v = rounded((report::reflect(n, l) + random.cube() * spread).normalize());
        let r = reflect(V3::from(n.as_vec3()), l.as_vec3().into());
        assert!((Vec3::from(r).as_dvec3() - report::reflect(n, l)).length() < 1e-6);
        let expected = report::specular_share(n, l, v, exponent);
        let (found, _) = phong_lobe(r, v.as_vec3().into(), exponent as f32);
        // A cosine that is off by a few roundings is magnified by the exponent, until the sharp form takes
        // over.
        let tolerance = (1e-5 + 5e-7 * exponent).min(5e-3);
        assert!(
            (f64::from(found) - expected).abs() < tolerance,
            "case {case}: {found} is not {expected} for s = {exponent}"
        );
    }
}
