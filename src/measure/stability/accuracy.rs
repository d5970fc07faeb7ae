//! How far distances, weights, points, texture coordinates and normals are from `f64`, by how slanted the view is.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::watertight::towards;
use super::{Finding, Plan, Random, Test};
use crate::geometry::triangle::TriangleHit;
use crate::geometry::{Hit, Ray, TriangleAttributes, TriangleMesh};
use crate::math::EPS;
use crate::surface::{SurfaceParts, surface_at};

/// Unit of all errors: half a unit in the last place of 1.
const U: f64 = EPS as f64;

/// Angles between the ray and the normal, degrees; beyond 85° errors are only reported.
const INCIDENCES: [[f64; 2]; 4] = [[0.0, 60.0], [60.0, 85.0], [85.0, 89.0], [89.0, 89.9]];
const STEEPEST: f64 = 85.0;

/// Roundings of a distance, by `U (|O| + t)`.
const T_BAR: f64 = 16.0;
/// Roundings of a weight, by `U (1 + S / (h cos θ))`: `S` is the largest coordinate, `h` the least altitude.
const WEIGHT_BAR: f64 = 8.0;
/// Roundings of interpolated texture coordinates, by the largest corner's; and of normals, by `1 / |Σ b n|`.
const ATTRIBUTE_BAR: f64 = 8.0;

/// What is measured.
#[derive(Debug, Clone, Copy)]
enum Quantity {
    Distance,
    Weights,
    Plane,
    Uv,
    Normal,
}

/// A line for each quantity and range of angles.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let quantities = [
        (Quantity::Distance, "t", "roundings", T_BAR),
        (Quantity::Weights, "u and v", "roundings", WEIGHT_BAR),
        (Quantity::Plane, "point off its plane", "bounds", 1.0),
        (
            Quantity::Uv,
            "texture coordinates",
            "roundings",
            ATTRIBUTE_BAR,
        ),
        (
            Quantity::Normal,
            "smooth normals",
            "roundings",
            ATTRIBUTE_BAR,
        ),
    ];
    let mut all = Vec::new();
    for (quantity, label, what, bar) in quantities {
        for angles in INCIDENCES {
            let name = format!("{label}, {}-{} degrees", angles[0], angles[1]);
            let bar = (angles[1] <= STEEPEST || !depends_on_ray(quantity)).then_some(bar);
            all.push(Test::new("accuracy", name.clone(), move |plan| {
                worst(plan, &name, quantity, angles, what, bar)
            }));
        }
    }
    all
}

/// Whether the view's angle matters for what is claimed.
const fn depends_on_ray(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Distance | Quantity::Weights)
}

fn worst(
    plan: &Plan,
    name: &str,
    quantity: Quantity,
    angles: [f64; 2],
    what: &'static str,
    bar: Option<f64>,
) -> Finding {
    let mut random = plan.random(name);
    let (mut worst, mut cases) = (0.0_f64, 0);
    for _ in 0..plan.effort.pick(2_000_u64, 60_000, 4_000_000) {
        let Some(case) = Case::new(&mut random, angles) else {
            continue;
        };
        let Some(hit) = plan.kernel.triangle(&case.ray, &case.corners) else {
            continue;
        };
        let error = case.error(quantity, &hit, &mut random);
        worst = if error.is_nan() {
            error
        } else {
            worst.max(error)
        };
        cases += 1;
    }
    Finding::worst_of(cases, what, worst, bar)
}

/// A ray aimed well inside a triangle.
struct Case {
    ray: Ray,
    corners: [Vec3; 3],
    /// Unit.
    normal: DVec3,
    /// Least altitude.
    height: f64,
}

impl Case {
    /// A triangle of scale 10⁻⁶…10⁶, sometimes flat on an axis or far away, no thinner than 1 : 50; `None` for
    /// one that turned out otherwise once rounded.
    fn new(random: &mut Random, [low, high]: [f64; 2]) -> Option<Self> {
        let scale = 10.0_f64.powi(random.below(13) as i32 - 6);
        let size = scale * random.pick(&[0.01, 0.1, 1.0]);
        let at = random.cube() * scale;
        let mut corners = [(); 3].map(|()| at + random.cube() * size);
        if random.below(2) == 0 {
            let axis = random.below(3);
            corners
                .iter_mut()
                .for_each(|corner| corner[axis] = at[axis]);
        }
        let corners = corners.map(|corner| corner.as_vec3());
        let [a, b, c] = corners.map(|c| c.as_dvec3());
        let area = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        let height = area.length() / longest;
        if !(height > 0.02 * longest) {
            return None;
        }
        let normal = area / area.length();
        let (u, v) = (random.between(0.1, 0.45), random.between(0.1, 0.45));
        let target = a + (b - a) * u + (c - a) * v;
        let angle = random.between(low, high).to_radians();
        let aside = normal.cross(random.direction()).normalize_or(DVec3::X);
        let from = normal * angle.cos() + aside * angle.sin();
        let away = size * 10.0_f64.powf(random.between(-1.0, 3.0));
        let origin = (target + from * away).as_vec3();
        let ray = towards(origin, target);
        let cos = ray.dir.as_dvec3().dot(normal).abs().min(1.0);
        let inside = (low..=high).contains(&cos.acos().to_degrees());
        inside.then_some(Self {
            ray,
            corners,
            normal,
            height,
        })
    }

    /// Distance and weights in `f64` from the very numbers that the kernel got: the plane, then areas.
    fn exact(&self) -> (f64, DVec2) {
        let [a, b, c] = self
            .corners
            .map(|c| c.as_dvec3() - self.ray.origin.as_dvec3());
        let dir = self.ray.dir.as_dvec3();
        let area = (b - a).cross(c - a);
        let volumes = [c.cross(a), a.cross(b)].map(|side| side.dot(dir));
        let weights = DVec2::from_array(volumes) / area.dot(dir);
        (area.dot(a) / area.dot(dir), weights)
    }

    /// In units of the quantity's own bound.
    fn error(&self, quantity: Quantity, hit: &TriangleHit, random: &mut Random) -> f64 {
        let (t, weights) = self.exact();
        let origin = self.ray.origin.as_dvec3();
        match quantity {
            Quantity::Distance => {
                (f64::from(hit.t) - t).abs()
                    / (U * (origin.length() + t * self.ray.dir.as_dvec3().length()))
            }
            Quantity::Weights => {
                let off = DVec2::new(hit.u.into(), hit.v.into()) - weights;
                let reach = self.corners.map(|c| c.abs().max_element());
                let reach =
                    reach.into_iter().fold(0.0, f32::max) + self.ray.origin.abs().max_element();
                let cos = self.ray.dir.as_dvec3().dot(self.normal).abs();
                off.abs().max_element() / (U * (1.0 + f64::from(reach) / (self.height * cos)))
            }
            Quantity::Plane => self.off_plane(hit),
            Quantity::Uv => self.uv_error(hit, random),
            Quantity::Normal => self.normal_error(hit, random),
        }
    }

    /// Distance of the surface point from the plane, over the bound that the program reckons with.
    fn off_plane(&self, hit: &TriangleHit) -> f64 {
        let surface = surface_at(&self.mesh(), &whole(hit), &self.ray, SurfaceParts::Plain);
        let p = Vec3::from(surface.p).as_dvec3();
        let bound = Vec3::from(surface.p_error).as_dvec3();
        let off = self.normal.dot(p - self.corners[0].as_dvec3()).abs();
        off / self.normal.abs().dot(bound)
    }

    fn uv_error(&self, hit: &TriangleHit, random: &mut Random) -> f64 {
        let scale = 10.0_f64.powi(random.below(7) as i32 - 3);
        let uvs = [(); 3].map(|()| (random.cube().truncate() * scale).as_vec2());
        let mesh = TriangleMesh {
            uvs: uvs.to_vec(),
            ..self.mesh()
        };
        let found = surface_at(&mesh, &whole(hit), &self.ray, SurfaceParts::Uv).uv;
        let exact: DVec2 = weights(hit)
            .iter()
            .zip(uvs)
            .map(|(w, uv)| uv.as_dvec2() * *w)
            .sum();
        let largest = uvs.map(|uv| f64::from(uv.abs().max_element()));
        let largest = largest.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        (Vec2::from(found).as_dvec2() - exact).abs().max_element() / (U * largest)
    }

    fn normal_error(&self, hit: &TriangleHit, random: &mut Random) -> f64 {
        let normals = [(); 3].map(|()| {
            let n = self.normal + random.cube() * 0.9;
            n.normalize_or(self.normal).as_vec3()
        });
        let mesh = TriangleMesh {
            normals: normals.to_vec(),
            ..self.mesh()
        };
        let mesh = with_attributes(mesh, true);
        let surface = surface_at(&mesh, &whole(hit), &self.ray, SurfaceParts::Plain);
        let sum: DVec3 = weights(hit)
            .iter()
            .zip(normals)
            .map(|(w, n)| n.as_dvec3() * *w)
            .sum();
        let off = (Vec3::from(surface.n_shade).as_dvec3() - sum.normalize_or(self.normal)).length();
        off * sum.length() / U
    }

    fn mesh(&self) -> TriangleMesh {
        let mesh = TriangleMesh {
            positions: self.corners.to_vec(),
            indices: vec![[0, 1, 2]],
            ..TriangleMesh::default()
        };
        with_attributes(mesh, false)
    }
}

fn with_attributes(mesh: TriangleMesh, smooth: bool) -> TriangleMesh {
    TriangleMesh {
        attributes: vec![TriangleAttributes {
            material: 0,
            has_uv: true,
            smooth,
        }],
        ..mesh
    }
}

/// The weights as the kernel gave them: what follows is measured from there.
fn weights(hit: &TriangleHit) -> [f64; 3] {
    let (u, v) = (f64::from(hit.u), f64::from(hit.v));
    [1.0 - u - v, u, v]
}

fn whole(hit: &TriangleHit) -> Hit {
    Hit {
        t: hit.t,
        prim: 0,
        sub: 0,
        u: hit.u,
        v: hit.v,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_put_in_is_found() {
        let mut random = Random::new(5);
        let case = std::iter::repeat_with(|| Case::new(&mut random, [0.0, 60.0]))
            .flatten()
            .next()
            .expect("there are such triangles");
        let (t, weights) = case.exact();
        let hit = TriangleHit {
            t: (t * (1.0 + 1e-3)) as f32,
            u: weights.x as f32 + 1e-2,
            v: weights.y as f32,
        };
        let mut random = Random::new(6);
        assert!(case.error(Quantity::Distance, &hit, &mut random) > T_BAR);
        assert!(case.error(Quantity::Weights, &hit, &mut random) > WEIGHT_BAR);
    }
}
