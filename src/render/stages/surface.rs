//! Hits → surfaces → mapped surfaces: one material and one method at a time.

use super::super::{Counters, Frame};
use super::{RayQueue, SurfaceBatch};
use crate::geometry::Hit;
use crate::surface::{SurfaceParts, surface_at};

/// Fills the batch with the surfaces that the rays hit, perturbed by their materials' maps and turned
/// towards the eye.
pub fn mapped_surfaces(
    frame: &Frame<'_>,
    queue: &RayQueue,
    hits: &[Option<Hit>],
    batch: &mut SurfaceBatch,
    counters: &mut Counters,
) {
    sort_by_material(frame, hits, batch);
    batch.points.clear();
    batch.diffuse.clear();
    batch.runs.clear();
    let mut start = 0;
    while start < batch.ray.len() {
        let key = run_key(frame, hits, batch.ray[start]);
        let len = batch.ray[start..]
            .iter()
            .take_while(|&&r| run_key(frame, hits, r) == key)
            .count();
        let (material, has_uv) = (usize::from(key.0), key.1);
        let parts = frame.materials[material].parts(has_uv);
        for &r in &batch.ray[start..start + len] {
            if let Some(hit) = &hits[r as usize] {
                batch
                    .points
                    .push(surface_at(frame.mesh, hit, &queue.rays[r as usize], parts));
            }
        }
        let run = start..start + len;
        map_run(frame, material, parts, run.clone(), batch, counters);
        batch.runs.push((material, run));
        start += len;
    }
}

/// Material, and whether its texture coordinates can be used: what is the same for a whole run.
fn run_key(frame: &Frame<'_>, hits: &[Option<Hit>], ray: u32) -> (u16, bool) {
    hits[ray as usize].map_or((0, false), |hit| {
        let a = frame.mesh.attributes[hit.prim as usize];
        (a.material, a.has_uv)
    })
}

fn sort_by_material(frame: &Frame<'_>, hits: &[Option<Hit>], batch: &mut SurfaceBatch) {
    batch.ray.clear();
    batch
        .ray
        .extend((0..hits.len() as u32).filter(|&r| hits[r as usize].is_some()));
    let key = |&r: &u32| run_key(frame, hits, r);
    if !batch.ray.is_sorted_by_key(key) {
        // Stable, so that points of one material stay in the order of their pixels.
        batch.ray.sort_by_key(key);
    }
}

fn map_run(
    frame: &Frame<'_>,
    material: usize,
    parts: SurfaceParts,
    run: std::ops::Range<usize>,
    batch: &mut SurfaceBatch,
    counters: &mut Counters,
) {
    let material = &frame.materials[material];
    let points = &mut batch.points[run];
    let count = points.len() as u64;
    if parts == SurfaceParts::Gradients {
        material.mapping.apply(points);
        counters.perturbations += count;
        counters.texture_fetches += count * material.mapping.fetches_per_point();
    }
    match &material.albedo {
        Some(albedo) if parts >= SurfaceParts::Uv => {
            counters.texture_fetches += count;
            batch
                .diffuse
                .extend(points.iter().map(|s| material.kd * albedo.color(s.uv)));
        }
        _ => batch
            .diffuse
            .extend(std::iter::repeat_n(material.kd, points.len())),
    }
    for s in points {
        // Perturbed on the front side; an eye behind it sees the other side of the same relief.
        if s.wo.dot(s.n_geo) < 0.0 {
            s.n_geo = -s.n_geo;
            s.n_shade = -s.n_shade;
        }
    }
    debug_assert_eq!(
        batch.diffuse.len(),
        batch.points.len(),
        "one colour per point"
    );
}
