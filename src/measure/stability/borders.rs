//! Nothing is fatter than it is: rays that pass open borders and silhouettes miss, and wherever `f64` leaves no
//! doubt the triangle and the distance are its own.

use glam::{DVec3, Vec3};

use super::oracle::{Verdict, judge, margin};
use super::placement::Placement;
use super::trees::Trees;
use super::watertight::towards;
use super::{Finding, Plan, Random, Test, bodies};
use crate::geometry::bvh::Bvh;
use crate::geometry::{Hit, Ray, TriangleMesh};
use crate::math::EPS;

/// How many margins beside a border rays are aimed; below 0 they hit.
const BESIDE: [f64; 8] = [1.01, 1.5, 4.0, 64.0, 1e4, -1.01, -4.0, -64.0];

/// Up to this incidence distances have a bar.
const STEEPEST_COS: f64 = 0.087; // 85°

/// A line for each mesh and placement.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for (name, mesh) in meshes() {
        for (place, scale, offset) in places() {
            let name = format!("{name}{place}");
            let mesh = moved(&mesh, scale, offset);
            all.push(Test::new("borders", name.clone(), move |plan| {
                wrong(plan, &name, &mesh)
            }));
        }
    }
    all
}

/// Placements in the units of the tracer, as normalising or not leaves them.
fn places() -> [(&'static str, f64, f64); 5] {
    [
        ("", 1.0, 0.0),
        (", x 1e-12", 1e-12, 0.0),
        (", x 1e12", 1e12, 0.0),
        (", 1e2 radii away", 1.0, 1e2),
        (", 1e4 radii away", 1.0, 1e4),
    ]
}

fn moved(mesh: &TriangleMesh, scale: f64, offset: f64) -> TriangleMesh {
    let place = |p: &Vec3| (p.as_dvec3() * scale + DVec3::new(1.0, -0.75, 0.5) * offset).as_vec3();
    TriangleMesh {
        positions: mesh.positions.iter().map(place).collect(),
        ..mesh.clone()
    }
}

/// Small enough to test every triangle in `f64`.
fn meshes() -> [(&'static str, TriangleMesh); 4] {
    let triangle = [
        Vec3::ZERO,
        Vec3::new(1.0, 0.1, 0.2),
        Vec3::new(0.3, 0.9, -0.1),
    ];
    let needle = [
        Vec3::new(-1.0, 0.1, 0.2),
        Vec3::new(1.0, 0.101, 0.2),
        Vec3::new(0.3, 0.1005, 0.2003),
    ];
    let ball = Placement::PLAIN.scene(&bodies::sphere(3), false).mesh;
    [
        ("one triangle", soup(&[triangle])),
        ("one needle", soup(&[needle])),
        ("open grid", grid(5)),
        ("silhouette of a sphere", ball),
    ]
}

fn soup(triangles: &[[Vec3; 3]]) -> TriangleMesh {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    TriangleMesh {
        positions: triangles.concat(),
        indices: indices.collect(),
        attributes: vec![Default::default(); triangles.len()],
        ..TriangleMesh::default()
    }
}

/// A waved square of `n × n` cells.
fn grid(n: u32) -> TriangleMesh {
    let vertex = |i: u32| {
        let [x, y] = [i % (n + 1), i / (n + 1)].map(|i| i as f32 / n as f32 * 2.0 - 1.0);
        Vec3::new(x, y, 0.2 * (3.0 * x).sin() * (2.0 * y).cos())
    };
    let cells = (0..n * n).map(|i| i / n * (n + 1) + i % n);
    let indices: Vec<_> = cells
        .flat_map(|a| [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]])
        .collect();
    TriangleMesh {
        positions: (0..(n + 1) * (n + 1)).map(vertex).collect(),
        attributes: vec![Default::default(); indices.len()],
        indices,
        ..TriangleMesh::default()
    }
}

/// What was counted.
#[derive(Default)]
struct Tally {
    certain: u64,
    misses: u64,
    fat: u64,
    lost: u64,
    other: u64,
    far: u64,
}

impl Tally {
    /// Compares one answer with a verdict.
    fn add(&mut self, ray: &Ray, verdict: Verdict, hit: Option<Hit>) {
        match (verdict, hit) {
            (Verdict::Doubtful, _) => return,
            (Verdict::Miss, None) => self.misses += 1,
            (Verdict::Miss, Some(_)) => {
                self.misses += 1;
                self.fat += 1;
            }
            (Verdict::Hit { .. }, None) => self.lost += 1,
            (Verdict::Hit { prim, .. }, Some(hit)) if hit.prim != prim => self.other += 1,
            (Verdict::Hit { t, cos, .. }, Some(hit)) => {
                let unit = f64::from(EPS) * (ray.origin.as_dvec3().length() + t);
                let is_far = (f64::from(hit.t) - t).abs() > 16.0 * unit;
                self.far += u64::from(is_far && cos > STEEPEST_COS);
            }
        }
        self.certain += 1;
    }

    fn finding(&self, disagreeing: u64) -> Finding {
        let wrong = self.fat + self.lost + self.other + self.far + disagreeing;
        let mut note = format!("{} must miss", self.misses);
        let counts = [
            (self.fat, "hit what they pass"),
            (self.lost, "miss what they hit"),
            (self.other, "hit another triangle"),
            (self.far, "are off by more than 16 roundings"),
            (disagreeing, "differ between levels"),
        ];
        for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
            note += &format!("; {count} {what}");
        }
        Finding::none_of(self.certain, "wrong answers", wrong).with_note(note)
    }
}

fn wrong(plan: &Plan, name: &str, mesh: &TriangleMesh) -> Finding {
    let bvh = Bvh::build(mesh);
    let (bounds, reach) = (bvh.bounds(), bvh.reach());
    let trees = Trees::new(plan.kernel, &bvh);
    let mut random = plan.random(name);
    let center = bounds.center().as_dvec3();
    let radius = f64::from(bounds.extent().max_element()) * 0.5;
    let (mut tally, mut disagreeing) = (Tally::default(), 0);
    for _ in 0..plan.effort.pick(8, 150, 15_000) {
        // Half of all bunches come from one place, as bundles do.
        let origin = eye(&mut random, center, radius);
        let scatter = random.below(2) == 0;
        let rays: Vec<_> = (0..64)
            .map(|_| {
                let origin = if scatter {
                    eye(&mut random, center, radius)
                } else {
                    origin
                };
                beside(mesh, reach, origin, &mut random)
            })
            .collect();
        let traced = trees.trace(&rays);
        disagreeing += traced.disagreeing;
        for (ray, hit) in rays.iter().zip(traced.hits) {
            tally.add(ray, judge(ray, mesh, reach), hit);
        }
    }
    tally.finding(disagreeing)
}

fn eye(random: &mut Random, center: DVec3, radius: f64) -> Vec3 {
    let away = radius * random.between(2.0, 6.0);
    (center + random.direction() * away).as_vec3()
}

/// A ray that passes an edge of a random triangle by a few margins.
fn beside(mesh: &TriangleMesh, reach: f32, origin: Vec3, random: &mut Random) -> Ray {
    let corners = mesh
        .corners(random.below(mesh.len()) as u32)
        .map(|c| c.as_dvec3());
    let first = random.below(3);
    let [a, b, c] = [0, 1, 2].map(|i| corners[(first + i) % 3]);
    let target = a.lerp(b, random.unit());
    let dir = (target - origin.as_dvec3()).normalize_or(DVec3::Z);
    let across = (b - a).cross(dir).normalize_or(DVec3::X);
    let outward = if across.dot(c - a) > 0.0 {
        -across
    } else {
        across
    };
    let aside = margin(reach, origin) * random.pick(&BESIDE);
    towards(origin, target + outward * aside)
}
