//! No ray leaves a closed scan: the rays of `watertight` in models from a folder of the user's.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::trees::Trees;
use super::watertight::{BUNCH, scattered, together};
use super::{Finding, Plan, Random, Test};
use crate::geometry::TriangleMesh;
use crate::scene::load::{LoadOptions, load_model};

/// Closed models of the folder that the test suite's variable `RELIEFSCOPE_MODELS` names.
const MODELS: [&str; 5] = [
    "classic/armadillo.obj",
    "classic/cow.obj",
    "classic/fandisk.obj",
    "classic/horse_quad.obj",
    "classic/spot/spot_triangulated.obj",
];
/// Places within a scan that rays start from.
const ORIGINS: usize = 16;
/// Places that are tried for that.
const CANDIDATES: usize = 400;

/// A line for each scan of a folder of models, or one that says that there is no folder.
#[must_use]
pub fn scan_tests(models: Option<&Path>) -> Vec<Test> {
    let Some(folder) = models else {
        return vec![Test::new("watertight", "scans", |_| {
            let none = Finding::worst_of(1, "scans traced", 0.0, None);
            none.with_note("RELIEFSCOPE_MODELS names no folder of models".to_owned())
        })];
    };
    let test = |model: &str| {
        let path = folder.join(model);
        let name = format!("scan {model}");
        Test::new("watertight", name.clone(), move |plan| {
            leaks(plan, &name, &path)
        })
    };
    MODELS.into_iter().map(test).collect()
}

/// How many rays from inside get out, or are seen differently by some level.
fn leaks(plan: &Plan, name: &str, path: &Path) -> Finding {
    let nothing = |why: String| Finding::none_of(0, "leaks", 0).with_note(why);
    let scene = match load_model(path, &LoadOptions::default()) {
        Ok(loaded) => loaded.scene,
        Err(error) => return nothing(error.to_string()),
    };
    let mesh = &scene.mesh;
    let open = open_edges(mesh);
    if open > 0 {
        return nothing(format!("{open} edges are open: not a closed body"));
    }
    let mut random = plan.random(name);
    let origins = places_inside(mesh, &mut random);
    if origins.is_empty() {
        return nothing("no place inside was found".to_owned());
    }
    let trees = Trees::new(plan.kernel, &scene.bvh);
    let bunches = plan.effort.pick(2, 40, 20_000);
    let (mut leaks, mut disagreeing) = (0, 0);
    for bunch in 0..bunches {
        let rays = if bunch % 2 == 0 {
            together(mesh, random.pick(&origins), &mut random)
        } else {
            let from = [(); BUNCH].map(|()| random.pick(&origins));
            scattered(mesh, &from, &mut random)
        };
        let traced = trees.trace(&rays);
        leaks += traced.hits.iter().filter(|hit| hit.is_none()).count() as u64;
        disagreeing += traced.disagreeing;
    }
    let note = format!(
        "{} triangles, from {} places; {disagreeing} rays differ between levels",
        mesh.len(),
        origins.len()
    );
    let cases = (bunches * BUNCH) as u64;
    Finding::none_of(cases, "leaks", leaks + disagreeing).with_note(note)
}

/// Edges that are not run through as often one way as the other, corners at one place counted as one.
fn open_edges(mesh: &TriangleMesh) -> usize {
    let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
    // 0 and −0 are one place.
    let place = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    for prim in 0..mesh.len() as u32 {
        let corners = mesh.corners(prim).map(place);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().filter(|&&sum| sum != 0).count()
}

/// Places around which the mesh winds: a little under its triangles.
fn places_inside(mesh: &TriangleMesh, random: &mut Random) -> Vec<Vec3> {
    let bounds = mesh.bounds();
    let extent = f64::from((bounds.max - bounds.min).max_element());
    let mut places = Vec::new();
    for _ in 0..CANDIDATES {
        let [a, b, c] = mesh
            .corners(random.below(mesh.len()) as u32)
            .map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let under = (a + b + c) / 3.0 - normal * (extent * random.between(0.005, 0.05));
        // As it will be traced.
        let under = under.as_vec3();
        if winding(mesh, under.as_dvec3()).abs() > 0.5 {
            places.push(under);
        }
        if places.len() == ORIGINS {
            break;
        }
    }
    places
}

/// How often the mesh winds around a place: a whole number where it is closed, 0 outside.
///
/// Source: van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
fn winding(mesh: &TriangleMesh, place: DVec3) -> f64 {
    let angle = |prim| {
        let [a, b, c] = mesh.corners(prim).map(|p| p.as_dvec3() - place);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let volume = a.dot(b.cross(c));
        let flat = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * volume.atan2(flat)
    };
    (0..mesh.len() as u32).map(angle).sum::<f64>() / (2.0 * TAU)
}

#[cfg(test)]
mod tests {
    use super::super::bodies;
    use super::super::placement::Placement;
    use super::*;

    #[test]
    fn a_closed_body_winds_once_around_what_is_inside() {
        let mesh = Placement::PLAIN.scene(&bodies::sphere(6), false).mesh;
        assert_eq!(open_edges(&mesh), 0);
        assert!((winding(&mesh, DVec3::new(0.1, 0.2, -0.1)) - 1.0).abs() < 1e-9);
        assert!(winding(&mesh, DVec3::new(3.0, 0.0, 0.5)).abs() < 1e-9);
        let mut open = mesh;
        open.indices.pop();
        open.attributes.pop();
        assert_eq!(open_edges(&open), 3);
    }

    #[test]
    fn without_models_there_is_one_line_that_says_so() {
        assert_eq!(scan_tests(None).len(), 1);
        let missing = scan_tests(Some(Path::new("no such folder")));
        assert_eq!(missing.len(), MODELS.len());
    }
}
