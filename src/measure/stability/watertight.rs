//! No ray leaves a closed mesh: rays from inside, aimed at edges and vertices, where leaks are.

use glam::{DVec3, Vec3};

use super::bodies::Body;
use super::placement::Placement;
use super::trees::{Trees, levels};
use super::{Finding, Kernel, Plan, Random, Test};
use crate::geometry::{Ray, TriangleMesh};

/// Rays of one bunch: what bundles are made of.
pub(super) const BUNCH: usize = 64;

/// A line for each body and placement.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for body in Body::all() {
        for placement in Placement::all() {
            let name = format!("{}, {}", body.name, placement.name());
            let body = body.clone();
            all.push(Test::new("watertight", name.clone(), move |plan| {
                leaks(plan, &name, &body, placement)
            }));
        }
    }
    all
}

/// How many rays get out, or are seen differently by some level.
fn leaks(plan: &Plan, name: &str, body: &Body, placement: Placement) -> Finding {
    let scene = placement.scene(body, false);
    let trees = Trees::new(plan.kernel, &scene.bvh);
    let mut random = plan.random(name);
    let bunches = plan.effort.pick(8, 160, 10_600) / share(body);
    let bunches = bunches.max(1);
    let (mut leaks, mut disagreeing) = (0, 0);
    for bunch in 0..bunches {
        let mut from = || placement.internal(&scene.normalization, (body.inside)(&mut random));
        let rays = if bunch % 2 == 0 {
            let origin = from();
            together(&scene.mesh, origin, &mut random)
        } else {
            let origins = [(); BUNCH].map(|()| from());
            scattered(&scene.mesh, &origins, &mut random)
        };
        let traced = trees.trace(&rays);
        leaks += traced.hits.iter().filter(|hit| hit.is_none()).count() as u64;
        disagreeing += traced.disagreeing;
    }
    let ways = match plan.kernel {
        Kernel::Watertight => levels().len() + 1,
        _ => 1,
    };
    let note = if disagreeing > 0 {
        format!("{disagreeing} rays differ between levels")
    } else {
        format!("{ways} kernels alike")
    };
    let cases = (bunches * BUNCH) as u64;
    Finding::none_of(cases, "leaks", leaks + disagreeing).with_note(note)
}

/// Bodies with many triangles at a corner get fewer rays: each ray at the corner meets them all.
const fn share(body: &Body) -> usize {
    if body.triangles.len() > 10_000 { 80 } else { 1 }
}

/// Rays from one point to neighbouring triangles.
pub(super) fn together(mesh: &TriangleMesh, origin: Vec3, random: &mut Random) -> Vec<Ray> {
    let first = random.below(mesh.len());
    let near = |random: &mut Random| (first + random.below(12)) % mesh.len();
    (0..BUNCH)
        .map(|_| {
            let prim = near(random);
            towards(origin, edge_point(mesh, prim, random))
        })
        .collect()
}

/// Rays to anywhere.
pub(super) fn scattered(mesh: &TriangleMesh, origins: &[Vec3], random: &mut Random) -> Vec<Ray> {
    let ray = |&origin: &Vec3| {
        let prim = random.below(mesh.len());
        towards(origin, edge_point(mesh, prim, random))
    };
    origins.iter().map(ray).collect()
}

/// A corner, the middle of an edge, or anywhere on one.
pub(super) fn edge_point(mesh: &TriangleMesh, prim: usize, random: &mut Random) -> DVec3 {
    point_on_edges(mesh.corners(prim as u32), random)
}

/// The same of three corners.
pub(super) fn point_on_edges(corners: [Vec3; 3], random: &mut Random) -> DVec3 {
    let corners = corners.map(|c| c.as_dvec3());
    let first = random.below(3);
    let along = match random.below(3) {
        0 => 0.0,
        1 => 0.5,
        _ => random.unit(),
    };
    corners[first].lerp(corners[(first + 1) % 3], along)
}

/// The ray through a point, as well as `f32` can aim; any direction if they coincide.
pub(super) fn towards(origin: Vec3, target: DVec3) -> Ray {
    let dir = target - origin.as_dvec3();
    // Scaled first: lengths of 10⁻³⁰ must not vanish when they are squared.
    let dir = dir / dir.abs().max_element().max(f64::MIN_POSITIVE);
    Ray {
        origin,
        dir: dir.normalize_or(DVec3::Z).as_vec3(),
    }
}
