//! Single precision under stress: leaks, self-hits and the accuracy of distances.

use glam::{DVec3, Vec3};
use reliefscope::geometry::bvh::{AcceptAll, Bvh};
use reliefscope::geometry::triangle::{MollerTrumbore, ReportEdges, TriangleTest, Watertight};
use reliefscope::geometry::{OriginRule, Ray, RaySlabs, TriangleMesh, offset_origin};
use reliefscope::math::{EPS, gamma};

use crate::shapes::{Random, edge_point, placed, sphere, torus, towards};

/// A closed mesh and a way to find points inside.
struct Closed {
    name: String,
    mesh: TriangleMesh,
    inside: fn(&mut Random) -> DVec3,
    scale: f64,
    offset: f64,
}

fn inside_sphere(random: &mut Random) -> DVec3 {
    (random.cube() * 0.5).as_dvec3()
}

fn inside_torus(random: &mut Random) -> DVec3 {
    let (sin, cos) = (random.unit() * std::f32::consts::TAU).sin_cos();
    (Vec3::new(cos, sin, 0.0) + random.cube() * 0.15).as_dvec3()
}

fn closed_meshes() -> Vec<Closed> {
    let scales = (-6..=6).map(|k| (10.0_f64.powi(k), 0.0));
    let placements: Vec<_> = scales.chain([(1.0, 1e4)]).collect();
    let shapes = [
        (
            "sphere",
            sphere(16),
            inside_sphere as fn(&mut Random) -> DVec3,
        ),
        ("torus", torus(64, 24), inside_torus),
    ];
    let mut all = Vec::new();
    for (name, mesh, inside) in shapes {
        for &(scale, offset) in &placements {
            all.push(Closed {
                name: format!("{name} × {scale:e} + {offset:e}"),
                mesh: placed(mesh.clone(), scale, offset),
                inside,
                scale,
                offset,
            });
        }
    }
    all
}

/// How many of `rays` rays aimed at edges and vertices from inside leave without a hit.
fn leaks<T: TriangleTest>(closed: &Closed, rays: usize) -> usize {
    let bvh = Bvh::build(&closed.mesh);
    let mut random = Random::new(23);
    (0..rays)
        .filter(|_| {
            let origin = (closed.inside)(&mut random) * closed.scale + closed.offset;
            let target = edge_point(&closed.mesh, &mut random);
            let ray = towards(origin.as_vec3(), target);
            bvh.intersect::<T, _>(&ray, f32::INFINITY, &AcceptAll)
                .is_none()
        })
        .count()
}

#[test]
fn no_ray_leaks_through_an_edge_or_a_vertex() {
    for closed in closed_meshes() {
        assert_eq!(leaks::<Watertight>(&closed, 50_000), 0, "{}", closed.name);
    }
}

#[test]
fn textbook_tests_leak_on_the_same_rays() {
    for closed in closed_meshes() {
        if closed.scale != 1.0 {
            continue;
        }
        let rays = 20_000;
        let moller_trumbore = leaks::<MollerTrumbore>(&closed, rays);
        let report = leaks::<ReportEdges>(&closed, rays);
        let watertight = leaks::<Watertight>(&closed, rays);
        let name = &closed.name;
        assert_eq!(watertight, 0);
        assert!(
            moller_trumbore > rays / 200,
            "{name}: Möller–Trumbore leaks {moller_trumbore}"
        );
        assert!(
            report > rays / 200,
            "{name}: the report's test leaks {report}"
        );
    }
}

#[test]
fn aimed_at_a_sphere_from_outside_nothing_gets_past_the_front() {
    let mesh = sphere(16);
    let bvh = Bvh::build(&mesh);
    let mut random = Random::new(29);
    let mut front = 0;
    for i in 0..200_000 {
        let target = edge_point(&mesh, &mut random);
        let origin = random.direction() * (2.0 + 8.0 * random.unit());
        let ray = towards(origin, target);
        // Not at the silhouette, where passing by is right.
        if ray.dir.dot(target) > -0.15 {
            continue;
        }
        front += 1;
        let distance = target.distance(origin);
        let hit = bvh.intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll);
        let t = hit.map_or(f32::INFINITY, |h| h.t);
        assert!(
            (t - distance).abs() < 1e-5 * distance,
            "ray {i}: {t} instead of {distance}"
        );
    }
    assert!(front > 50_000);
}

/// A triangle somewhere, of any size and shape short of a needle.
fn random_triangle(random: &mut Random) -> [Vec3; 3] {
    let scale = 10.0_f32.powi(random.below(13) as i32 - 6);
    let size = scale * random.pick(&[0.01, 0.1, 1.0]);
    let at = random.cube() * scale;
    let mut corners = [(); 3].map(|()| at + random.cube() * size);
    // Floors and walls are what people model.
    if random.below(2) == 0 {
        let axis = random.below(3);
        for corner in &mut corners {
            corner[axis] = at[axis];
        }
    }
    corners
}

fn normal(corners: &[Vec3; 3]) -> Option<Vec3> {
    let [a, b, c] = corners.map(|c| c.as_dvec3());
    let n = (b - a).cross(c - a);
    let well_shaped = n.length() > 0.02 * (b - a).length() * (c - a).length();
    well_shaped.then(|| n.normalize().as_vec3())
}

fn reach(corners: &[Vec3; 3]) -> f32 {
    corners
        .iter()
        .fold(0.0, |reach, c| c.abs().max_element().max(reach))
}

fn inside_point([a, b, c]: &[Vec3; 3], random: &mut Random) -> Vec3 {
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    a + (b - a) * u + (c - a) * v
}

#[test]
fn leaving_rays_never_rehit() {
    let mut random = Random::new(31);
    let mut left = 0;
    while left < 1_000_000 {
        let corners = random_triangle(&mut random);
        let (Some(n_geo), reach) = (normal(&corners), reach(&corners)) else {
            continue;
        };
        let size = corners[0].distance(corners[1]);
        let target = inside_point(&corners, &mut random);
        let ray = towards(target + random.direction() * size * 3.0, target);
        let slabs = RaySlabs::new(&ray, reach);
        let Some(hit) = Watertight::new(&ray).intersect(&slabs, &corners) else {
            continue;
        };
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let parts = [0, 1, 2].map(|i| corners[i] * weights[i]);
        let p = parts[0] + parts[1] + parts[2];
        let p_error = gamma(7) * (parts[0].abs() + parts[1].abs() + parts[2].abs());
        for i in 0..8 {
            let mut dir = random.direction();
            if i % 2 == 0 {
                // Almost in the plane.
                dir = (dir - n_geo * dir.dot(n_geo) * random.pick(&[0.9, 0.999, 0.99999]))
                    .normalize_or_zero();
            }
            let origin = offset_origin(p, p_error, n_geo, dir, OriginRule::Bound);
            let leaving = Ray { origin, dir };
            let again =
                Watertight::new(&leaving).intersect(&RaySlabs::new(&leaving, reach), &corners);
            assert_eq!(again, None, "{leaving:?} from {corners:?}, ray {left}");
            left += 1;
        }
    }
}

/// Distance along `ray` to the plane of the triangle, from the same `f32` input.
fn exact_distance(ray: &Ray, corners: &[Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|c| c.as_dvec3());
    let n = (b - a).cross(c - a);
    n.dot(a - ray.origin.as_dvec3()) / n.dot(ray.dir.as_dvec3())
}

#[test]
fn distance_error_is_bounded() {
    let mut random = Random::new(37);
    let (mut worst, mut tested) = (0.0_f64, 0);
    while tested < 300_000 {
        let corners = random_triangle(&mut random);
        let Some(n_geo) = normal(&corners) else {
            continue;
        };
        let size = corners[0].distance(corners[1]);
        let target = inside_point(&corners, &mut random);
        let away = size * 10.0_f32.powf(random.unit() * 4.0 - 1.0);
        let ray = towards(target + random.direction() * away, target);
        if ray.dir.dot(n_geo).abs() < 85.0_f32.to_radians().cos() {
            continue;
        }
        let slabs = RaySlabs::new(&ray, reach(&corners));
        let Some(hit) = Watertight::new(&ray).intersect(&slabs, &corners) else {
            continue;
        };
        let exact = exact_distance(&ray, &corners);
        let error = (f64::from(hit.t) - exact).abs();
        let unit = f64::from(EPS) * (ray.origin.as_dvec3().length() + exact);
        worst = worst.max(error / unit);
        tested += 1;
    }
    assert!(worst <= 16.0, "{worst} roundings");
}
