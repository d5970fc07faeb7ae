//! The lines of each part of the table.

use serde_json::json;

use super::report::{Row, ms, put_ms};
use crate::measure::bench::{FrameTimes, GrowthPoint, RaySpeed, Spread};
use crate::render::RayKind;
use crate::surface::mapping::Method;

/// Over the lines of [`frame`].
pub(super) const FRAME: &str = "ms, median (least-greatest); trace to resolve: where a full pass spends its time, ms summed over threads, and the share of it that they explain; millions of rays and of texture fetches in it";
/// Over the lines of [`scaling`].
pub(super) const SCALING: &str = "full pass by threads, the scene's own method";
/// Over the lines of [`rays`].
pub(super) const RAYS: &str =
    "millions a second, median (best) of passes over all rays of a picture";

/// A scene by a method.
pub(super) fn frame(scene: &str, method: Method, threads: usize, times: &FrameTimes) -> Row {
    let (counters, stages, method) = (&times.counters, &times.stages, method.name());
    let millions = |n: u64| n as f64 / 1e6;
    let text = format!(
        "{scene:14} {method:16} start {}  preview {}  full {}  re-shade {}  re-light {}  encode {}  trace {:.2}  perturb {:.2}  shade {:.2}  resolve {:.2} ({:.0} %)  rays {:.2}  fetches {:.2}",
        ms(times.start),
        ms(times.preview),
        ms(times.full),
        ms(times.reshade),
        ms(times.relight),
        ms(times.encode),
        stages.trace.median,
        stages.perturb.median,
        stages.shade.median,
        stages.resolve.median,
        1e2 * stages.share.median,
        millions(counters.rays()),
        millions(counters.texture_fetches),
    );
    let mut value = json!({
        "scene": scene,
        "method": method,
        "threads": threads,
        "counters": counters,
        "rays": counters.rays(),
        "stages_share": stages.share.median,
    });
    for (name, spread) in [
        ("start", times.start),
        ("preview", times.preview),
        ("full", times.full),
        ("reshade", times.reshade),
        ("relight", times.relight),
        ("encode", times.encode),
        ("trace", stages.trace),
        ("perturb", stages.perturb),
        ("shade", stages.shade),
        ("resolve", stages.resolve),
    ] {
        put_ms(&mut value, name, spread);
    }
    (text, value)
}

/// A full pass by so many threads, against that by the fewest.
pub(super) fn scaling(
    scene: &str,
    method: Method,
    (threads, full): (usize, Spread),
    (fewest, reference): (usize, Spread),
) -> Row {
    let method = method.name();
    let speedup = reference.median / full.median.max(f64::MIN_POSITIVE);
    let text = format!(
        "{scene:14} {method:16} {threads:3} threads {}  {speedup:.2} times {fewest}",
        ms(full)
    );
    let mut value = json!({
        "scene": scene,
        "method": method,
        "threads": threads,
        "speedup": speedup,
        "speedup_over_threads": fewest,
    });
    put_ms(&mut value, "full", full);
    (text, value)
}

/// One kind of ray by so many threads.
pub(super) fn rays(scene: &str, kind: RayKind, rays: usize, speed: &RaySpeed) -> Row {
    let kind = kind.name();
    let text = format!(
        "{scene:14} {kind:13} {:3} threads {:8.2} ({:.2})  of {:.2} million",
        speed.threads,
        speed.median,
        speed.best,
        rays as f64 / 1e6
    );
    let value = json!({
        "scene": scene,
        "kind": kind,
        "rays": rays,
        "threads": speed.threads,
        "mrays_per_s": speed.median,
        "mrays_per_s_min": speed.worst,
        "mrays_per_s_max": speed.best,
    });
    (text, value)
}

/// One step of a study.
pub(super) fn growth(point: &GrowthPoint, threads: usize) -> Row {
    let study = point.study.name();
    let fps = 1e3 / point.full.median.max(f64::MIN_POSITIVE);
    let [width, height] = point.size;
    let mut text = format!(
        "{study:8} {:5}  {fps:8.2} frames/s  full {}  {width}x{height}, {} triangles, {:.2} million rays",
        point.n,
        ms(point.full),
        point.triangles,
        point.rays as f64 / 1e6,
    );
    let mut value = json!({
        "study": study,
        "n": point.n,
        "size": point.size,
        "triangles": point.triangles,
        "threads": threads,
        "rays": point.rays,
        "fps": fps,
    });
    put_ms(&mut value, "full", point.full);
    if let Some(mesh) = &point.mesh {
        let mib = |bytes: usize| bytes as f64 / f64::from(1 << 20);
        let bytes = mesh.mesh_bytes + mesh.tree_bytes;
        let per_triangle = bytes as f64 / point.triangles.max(1) as f64;
        text += &format!(
            ", tree built in {}, mesh {:.1} + tree {:.1} MiB, {per_triangle:.1} bytes a triangle",
            ms(mesh.build),
            mib(mesh.mesh_bytes),
            mib(mesh.tree_bytes),
        );
        value["mesh_bytes"] = json!(mesh.mesh_bytes);
        value["tree_bytes"] = json!(mesh.tree_bytes);
        value["bytes_per_triangle"] = json!(per_triangle);
        put_ms(&mut value, "build", mesh.build);
    }
    (text, value)
}
