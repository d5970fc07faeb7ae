//! Rays traced together against the same rays one by one: every bit, at every level of this machine.

use glam::Vec3;
use reliefscope::geometry::bvh::{AcceptAll, Bvh, HitFilter};
use reliefscope::geometry::simd::SimdLevel;
use reliefscope::geometry::triangle::{MollerTrumbore, Watertight};
use reliefscope::geometry::{Hit, Ray, TriangleMesh};

use crate::shapes::{
    Random, edge_point, mixed_ray, placed, plane, random_soup, soup, sphere, torus, towards,
};

fn levels() -> Vec<SimdLevel> {
    let all = SimdLevel::ALL.into_iter();
    all.filter(|level| level.is_available()).collect()
}

fn bits(hit: Option<Hit>) -> Option<[u32; 5]> {
    hit.map(|h| [h.t.to_bits(), h.prim, h.sub, h.u.to_bits(), h.v.to_bits()])
}

/// A mesh with its tree at each level.
struct Case {
    name: &'static str,
    mesh: TriangleMesh,
    trees: Vec<(SimdLevel, Bvh)>,
}

impl Case {
    fn new(name: &'static str, mesh: TriangleMesh) -> Self {
        let bvh = Bvh::build(&mesh);
        let at = |level| (level, bvh.clone().with_level(level).unwrap());
        let trees = levels().into_iter().map(at).collect();
        Self { name, mesh, trees }
    }

    fn bvh(&self) -> &Bvh {
        &self.trees[0].1
    }

    /// Closest and any hit agree with single rays at each level; returns how many rays hit something.
    fn agrees_with<F: HitFilter>(&self, rays: &[Ray], t_max: &[f32], filter: &F) -> usize {
        let each = || rays.iter().zip(t_max);
        let closest = |(ray, &t_max)| self.bvh().intersect::<Watertight, F>(ray, t_max, filter);
        let any = |(ray, &t_max)| self.bvh().occluded::<Watertight, F>(ray, t_max, filter);
        let hits: Vec<_> = each().map(closest).collect();
        let shadows: Vec<_> = each().map(any).collect();
        for (level, bvh) in &self.trees {
            // Stale answers that must not survive.
            let stale = hits.iter().flatten().next().copied();
            let mut found = vec![stale; rays.len()];
            let mut occluded = vec![stale.is_some(); rays.len()];
            bvh.intersect_many::<Watertight, F>(rays, t_max, filter, &mut found);
            bvh.occluded_many::<Watertight, F>(rays, t_max, filter, &mut occluded);
            for i in 0..rays.len() {
                let at = || {
                    format!(
                        "{}, {level}, ray {i} to {}: {:?}",
                        self.name, t_max[i], rays[i]
                    )
                };
                assert_eq!(bits(found[i]), bits(hits[i]), "{}", at());
                assert_eq!(occluded[i], shadows[i], "{}", at());
            }
        }
        hits.iter().flatten().count()
    }

    /// [`Self::agrees_with`] for endless rays, rays that end where they hit or just after, and cut-outs.
    fn agrees(&self, rays: &[Ray]) -> usize {
        let endless = vec![f32::INFINITY; rays.len()];
        let holes = |prim: u32, u: f32, v: f32| !prim.is_multiple_of(3) && u + v < 0.8;
        self.agrees_with(rays, &endless, &holes);
        let ends = rays.iter().enumerate().map(|(i, ray)| {
            let hit = self
                .bvh()
                .intersect::<Watertight, _>(ray, f32::INFINITY, &AcceptAll);
            hit.map_or(1.0, |hit| [hit.t, hit.t.next_up(), hit.t * 0.5][i % 3])
        });
        let ends: Vec<_> = ends.collect();
        self.agrees_with(rays, &ends, &AcceptAll);
        self.agrees_with(rays, &ends, &holes);
        self.agrees_with(rays, &endless, &AcceptAll)
    }
}

/// A pinhole's rays in blocks of 8 × 8 pixels. The axis of view is in the middle of a block.
fn camera(eye: Vec3, target: Vec3, [columns, rows]: [u32; 2], field: f32) -> Vec<Ray> {
    let ahead = (target - eye).normalize_or_zero();
    let right = ahead.any_orthonormal_vector();
    let up = right.cross(ahead);
    let blocks = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let pixels = blocks.flat_map(|(x, y)| (0..64).map(move |i| (8 * x + i % 8, 8 * y + i / 8)));
    let ray = |(x, y)| {
        let x = (x as f32 - 4.0 * columns as f32) / (8 * columns) as f32;
        let y = (y as f32 - 4.0 * rows as f32) / (8 * rows) as f32;
        Ray {
            origin: eye,
            dir: (ahead + (right * x + up * y) * field).normalize_or_zero(),
        }
    };
    pixels.map(ray).collect()
}

/// Needles, points, copies and triangles without area.
fn nasty() -> TriangleMesh {
    let mut random = Random::new(31);
    let mut last = [Vec3::ZERO; 3];
    soup(300, || {
        let (at, side) = (random.cube(), random.direction());
        last = match random.below(5) {
            0 => [at; 3],
            1 => [at, at + side, at + side * 0.5],
            2 => [at, at + side, at + side + random.cube() * 1e-6],
            3 => [at + side * 20.0, at - side * 20.0, random.cube() * 20.0],
            _ => last,
        };
        last
    })
}

fn cases() -> Vec<Case> {
    let mut twice = plane(12, 12);
    twice.indices.extend_from_within(..);
    vec![
        Case::new("one quad", plane(1, 1)),
        Case::new("plane", plane(48, 48)),
        Case::new("coincident planes", twice),
        Case::new("sphere", sphere(12)),
        Case::new("small sphere", placed(sphere(6), 1e-6, 0.0)),
        Case::new("far sphere", placed(sphere(6), 1.0, 1e4)),
        Case::new("tiny sphere", placed(sphere(4), 1e-14, 0.0)),
        Case::new("torus", torus(40, 20)),
        Case::new("soup", random_soup(2000, 0.1, 3)),
        Case::new("nasty", nasty()),
        Case::new("nothing", TriangleMesh::default()),
    ]
}

#[test]
fn camera_rays() {
    for case in cases() {
        let bounds = case.bvh().bounds();
        let (center, size) = if case.mesh.is_empty() {
            (Vec3::ZERO, 1.0)
        } else {
            (bounds.center(), bounds.extent().max_element())
        };
        let mut hits = 0;
        // Skew, along axes, through the middle of the mesh, and from inside.
        for from in [
            Vec3::new(0.4, -1.3, 1.1),
            Vec3::Z * 2.0,
            -Vec3::Y * 1.5,
            Vec3::X,
            Vec3::new(0.2, 0.1, 0.05),
        ] {
            for field in [0.02, 0.8] {
                hits += case.agrees(&camera(center + from * size, center, [5, 3], field));
            }
        }
        assert!(
            hits > 500 || case.mesh.is_empty(),
            "{}: {hits} hits",
            case.name
        );
    }
}

#[test]
fn shadow_and_mirror_rays() {
    for case in [
        Case::new("torus", torus(60, 30)),
        Case::new("soup", random_soup(3000, 0.1, 5)),
    ] {
        let eye = Vec3::new(0.3, -2.0, 1.5);
        let light = Vec3::new(1.0, 0.7, 2.0);
        let (mut to_light, mut to_sun, mut from_light, mut mirrored) =
            (vec![], vec![], vec![], vec![]);
        for ray in camera(eye, Vec3::ZERO, [8, 6], 1.2) {
            let hit = case
                .bvh()
                .intersect::<Watertight, _>(&ray, f32::INFINITY, &AcceptAll);
            let Some(hit) = hit else { continue };
            let origin = ray.at(hit.t * 0.999_99);
            let [a, b, c] = case.mesh.corners(hit.prim);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            to_light.push(towards(origin, light));
            from_light.push(towards(light, origin));
            let sun = Vec3::new(0.0, -0.0, 1.0);
            to_sun.push(Ray { origin, dir: sun });
            let dir = ray.dir.reflect(normal).normalize_or_zero();
            mirrored.push(Ray { origin, dir });
        }
        for rays in [to_light, to_sun, from_light, mirrored] {
            assert!(case.agrees(&rays) > 50, "{}", case.name);
        }
    }
}

#[test]
fn rays_without_anything_in_common() {
    for case in cases().into_iter().filter(|case| !case.mesh.is_empty()) {
        let mut random = Random::new(37);
        let bounds = case.bvh().bounds();
        let rays: Vec<_> = (0..3000)
            .map(|_| mixed_ray(&case.mesh, bounds, &mut random))
            .collect();
        case.agrees(&rays);
        // Each repeated, so that neighbours are alike though nearly parallel to axes and in planes of boxes.
        let alike = rays.iter().take(300).flat_map(|&ray| {
            let mut random = Random::new(ray.dir.x.to_bits());
            [(); 16].map(|()| {
                let dir =
                    (ray.dir + random.cube() * 1e-3 * random.unit().round()).normalize_or_zero();
                Ray { dir, ..ray }
            })
        });
        case.agrees(&alike.collect::<Vec<_>>());
    }
}

#[test]
fn any_number_of_rays() {
    let case = Case::new("sphere", sphere(8));
    let rays = camera(Vec3::new(0.5, 1.0, 3.0), Vec3::ZERO, [2, 2], 0.5);
    for length in 0..=200 {
        let endless = vec![f32::INFINITY; length];
        case.agrees_with(&rays[..length], &endless, &AcceptAll);
    }
}

#[test]
fn rays_that_are_no_rays_among_others() {
    let case = Case::new("torus", torus(20, 10));
    let mut rays = camera(Vec3::new(0.2, -2.0, 1.0), Vec3::ZERO, [6, 4], 1.0);
    let mut t_max = vec![f32::INFINITY; rays.len()];
    let mut random = Random::new(41);
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        0.0,
        -0.0,
        1e30,
        1e-40,
    ];
    for _ in 0..rays.len() / 10 {
        let at = random.below(rays.len());
        match random.below(5) {
            0 => rays[at].dir = Vec3::ZERO,
            1 => rays[at].dir[random.below(3)] = random.pick(&odd),
            2 => rays[at].origin[random.below(3)] = random.pick(&odd),
            3 => rays[at].dir *= random.pick(&[3.0, 0.1, -1.0]),
            _ => t_max[at] = random.pick(&[f32::NAN, 0.0, -1.0, f32::MIN_POSITIVE]),
        }
    }
    assert!(case.agrees_with(&rays, &t_max, &AcceptAll) > 300);
    case.agrees(&rays);
}

#[test]
fn bundles_do_not_leak() {
    for (name, mesh, scale, offset) in [
        ("sphere", sphere(16), 1.0, 0.0),
        ("small sphere", sphere(16), 1e-5, 0.0),
        ("far sphere", sphere(16), 1.0, 1e4),
        ("fine sphere", sphere(60), 1.0, 0.0),
    ] {
        let case = Case::new(name, placed(mesh, scale, offset));
        let mut random = Random::new(43);
        for start in (0..case.mesh.len()).step_by(16).cycle().take(400) {
            let origin = (random.cube().as_dvec3() * 0.5 * scale + offset).as_vec3();
            // Neighbours in the list are neighbours in space.
            let near = TriangleMesh {
                indices: case.mesh.indices[start..case.mesh.len().min(start + 16)].to_vec(),
                ..case.mesh.clone()
            };
            let rays: Vec<_> = (0..128)
                .map(|_| towards(origin, edge_point(&near, &mut random)))
                .collect();
            let endless = vec![f32::INFINITY; rays.len()];
            let found = case.agrees_with(&rays, &endless, &AcceptAll);
            assert_eq!(found, rays.len(), "{name} leaks");
        }
    }
}

#[test]
fn other_triangle_tests_keep_their_answers() {
    let case = Case::new("sphere", sphere(8));
    let rays = camera(Vec3::new(0.5, 1.0, 3.0), Vec3::ZERO, [2, 2], 0.5);
    let t_max = vec![f32::INFINITY; rays.len()];
    let mut hits = vec![None; rays.len()];
    for (level, bvh) in &case.trees {
        bvh.intersect_many::<MollerTrumbore, _>(&rays, &t_max, &AcceptAll, &mut hits);
        for (ray, &hit) in rays.iter().zip(&hits) {
            let single = bvh.intersect::<MollerTrumbore, _>(ray, f32::INFINITY, &AcceptAll);
            assert_eq!(bits(hit), bits(single), "{level}: {ray:?}");
        }
    }
}
