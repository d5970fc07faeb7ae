//! Writes files of rays and of hits: a file is there whole or not at all.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::{FileRay, MAGIC, RayFileError};
use crate::geometry::TriangleMesh;
use crate::measure::bench::Answers;
use crate::render::{RayKind, RayList, RayQuery};
use crate::scene::save_picture::temporary_beside;

/// Writes triangles and rays, in the mesh's own units.
///
/// # Errors
/// [`RayFileError::Io`] if the system refuses.
pub fn write_rays(
    path: &Path,
    kind: RayKind,
    mesh: &TriangleMesh,
    list: &RayList,
) -> Result<(), RayFileError> {
    let query = match kind.query() {
        RayQuery::Closest => "closest",
        RayQuery::Any => "any",
    };
    let (triangles, rays, kind) = (mesh.len(), list.rays.len(), kind.name());
    write_whole(path, |out| {
        writeln!(
            out,
            "{MAGIC} kind={kind} query={query} triangles={triangles} rays={rays}"
        )?;
        for corners in &mesh.indices {
            for &corner in corners {
                write_floats(out, &mesh.positions[corner as usize].to_array())?;
            }
        }
        for (ray, &t_max) in list.rays.iter().zip(&list.t_max) {
            let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin.to_array(), ray.dir.to_array());
            write_floats(out, &[ox, oy, oz, 0.0, dx, dy, dz, t_max])?;
        }
        Ok(())
    })
}

/// Writes what was found for each ray, in the units of the file that the rays are from.
///
/// A hit is `t`, triangle, `u` and `v`, and lies at `(1−u−v)·v0 + u·v1 + v·v2`. No hit is `∞`, `0xffffffff`, 0,
/// 0. Where only whether there is a hit was asked, a hit is all zeros.
///
/// # Errors
/// [`RayFileError::Io`] if the system refuses.
pub fn write_hits(path: &Path, rays: &[FileRay], answers: &Answers) -> Result<(), RayFileError> {
    const MISS: (f32, u32, [f32; 2]) = (f32::INFINITY, u32::MAX, [0.0; 2]);
    let record = |place: usize, ray: &FileRay| match answers {
        Answers::Closest(hits) => {
            hits[place].map_or(MISS, |hit| (ray.file_t(hit.t), hit.prim, [hit.u, hit.v]))
        }
        Answers::Any(hits) if hits[place] => (0.0, 0, [0.0; 2]),
        Answers::Any(_) => MISS,
    };
    write_whole(path, |out| {
        for (place, ray) in rays.iter().enumerate() {
            let (t, triangle, uv) = record(place, ray);
            write_floats(out, &[t])?;
            out.write_all(&triangle.to_le_bytes())?;
            write_floats(out, &uv)?;
        }
        Ok(())
    })
}

fn write_floats(out: &mut dyn Write, floats: &[f32]) -> io::Result<()> {
    floats
        .iter()
        .try_for_each(|x| out.write_all(&x.to_le_bytes()))
}

/// Writes into a temporary file beside `path`, then renames it.
fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), RayFileError> {
    let write = || {
        let file = temporary_beside(path)?;
        let mut out = BufWriter::new(file.as_file());
        content(&mut out)?;
        out.flush()?;
        drop(out);
        file.persist(path).map_err(|e| e.error)?;
        Ok(())
    };
    write().map_err(|source| RayFileError::Io {
        path: path.to_owned(),
        source,
    })
}
