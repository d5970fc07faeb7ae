//! Reads a file of rays; everything is checked here.

use std::path::Path;

use glam::Vec3;

use super::{FileRay, KINDS, MAGIC, RAY_BYTES, RayFile, RayFileError, TRIANGLE_BYTES};
use crate::geometry::{TriangleAttributes, TriangleMesh};
use crate::render::RayQuery;

/// A first line is not longer, bytes.
const MAX_HEADER: usize = 1024;

/// Reads a file of rays.
///
/// # Errors
/// [`RayFileError`] if the file cannot be read; if its first line is not as it should be; if it is longer or
/// shorter than that line says; if a corner is not finite; if a ray starts before its origin or at an
/// infinite or NaN point, or has no direction.
pub fn read_rays(path: &Path) -> Result<RayFile, RayFileError> {
    let bytes = std::fs::read(path).map_err(|source| RayFileError::Io {
        path: path.to_owned(),
        source,
    })?;
    let refused = |message: String| RayFileError::Header {
        path: path.to_owned(),
        message,
    };
    let (line, begin) = first_line(&bytes).map_err(refused)?;
    let header = parse_header(line).map_err(refused)?;
    let data = Data {
        path,
        begin,
        bytes: &bytes,
    };
    let rays_begin = data.check_length(&header)?;
    let mesh = data.mesh(&bytes[begin..rays_begin])?;
    let rays = data.rays(&bytes[rays_begin..], rays_begin)?;
    Ok(RayFile {
        kind: header.kind,
        query: header.query,
        mesh,
        rays,
    })
}

struct Header {
    kind: String,
    query: RayQuery,
    triangles: u64,
    rays: u64,
}

/// The first line, and where what follows it begins.
fn first_line(bytes: &[u8]) -> Result<(&str, usize), String> {
    let start = &bytes[..bytes.len().min(MAX_HEADER)];
    let end = start.iter().position(|&b| b == b'\n');
    let line = end.and_then(|end| Some((std::str::from_utf8(&start[..end]).ok()?, end + 1)));
    line.filter(|(line, _)| line.starts_with(MAGIC))
        .ok_or_else(|| format!("is not a file of rays: it does not begin with a line `{MAGIC} …`"))
}

fn parse_header(line: &str) -> Result<Header, String> {
    let mut values: [Option<&str>; 4] = [None; 4];
    const KEYS: [&str; 4] = ["kind", "query", "triangles", "rays"];
    for word in line[MAGIC.len()..].split_whitespace() {
        let (key, value) = word.split_once('=').unwrap_or((word, ""));
        let slot = KEYS.iter().position(|k| *k == key);
        let slot = slot.ok_or_else(|| format!("`{word}` is unknown"))?;
        if values[slot].replace(value).is_some() {
            return Err(format!("`{key}` is there twice"));
        }
    }
    let value = |slot: usize| values[slot].ok_or_else(|| format!("`{}` is missing", KEYS[slot]));
    let count = |slot: usize| {
        let text = value(slot)?;
        let bad = |_| format!("`{}={text}` is not a count", KEYS[slot]);
        text.parse::<u64>().map_err(bad)
    };
    let kind = value(0)?;
    if !KINDS.contains(&kind) {
        return Err(format!("`kind={kind}` is none of {}", KINDS.join(", ")));
    }
    let query = match value(1)? {
        "closest" => RayQuery::Closest,
        "any" => RayQuery::Any,
        other => return Err(format!("`query={other}` is neither closest nor any")),
    };
    Ok(Header {
        kind: kind.to_owned(),
        query,
        triangles: count(2)?,
        rays: count(3)?,
    })
}

/// What follows the first line.
struct Data<'a> {
    path: &'a Path,
    begin: usize,
    bytes: &'a [u8],
}

impl Data<'_> {
    fn fault(&self, offset: usize, message: String) -> RayFileError {
        RayFileError::Data {
            path: self.path.to_owned(),
            offset: offset as u64,
            message,
        }
    }

    /// Whether there is as much as the first line says; returns where the rays begin.
    fn check_length(&self, header: &Header) -> Result<usize, RayFileError> {
        // Neither product nor sum of 64-bit counts overflows here.
        let begin = self.begin as u128;
        let rays_begin = begin + u128::from(header.triangles) * TRIANGLE_BYTES as u128;
        let end = rays_begin + u128::from(header.rays) * RAY_BYTES as u128;
        let length = self.bytes.len();
        if end != length as u128 {
            let message = format!(
                "the file ends here, but {} triangles and {} rays end at byte {end}",
                header.triangles, header.rays
            );
            return Err(self.fault(length, message));
        }
        // Corners are not shared: three of them per triangle have 32-bit numbers.
        if header.triangles > u64::from(u32::MAX / 3) {
            let message = format!("{} triangles are too many", header.triangles);
            return Err(self.fault(self.begin, message));
        }
        Ok(rays_begin as usize)
    }

    fn mesh(&self, bytes: &[u8]) -> Result<TriangleMesh, RayFileError> {
        let mut mesh = TriangleMesh::default();
        for (i, triangle) in bytes.chunks_exact(TRIANGLE_BYTES).enumerate() {
            let x = floats::<9>(triangle);
            if !x.iter().all(|x| x.is_finite()) {
                let offset = self.begin + i * TRIANGLE_BYTES;
                return Err(self.fault(
                    offset,
                    format!("triangle {i} has a corner that is not finite"),
                ));
            }
            let first = mesh.positions.len() as u32;
            let corners = [0, 3, 6].map(|at| Vec3::new(x[at], x[at + 1], x[at + 2]));
            mesh.positions.extend(corners);
            mesh.indices.push([first, first + 1, first + 2]);
        }
        mesh.attributes = vec![TriangleAttributes::default(); mesh.indices.len()];
        Ok(mesh)
    }

    fn rays(&self, bytes: &[u8], begin: usize) -> Result<Vec<FileRay>, RayFileError> {
        let read = |(i, bytes): (usize, &[u8])| {
            let [ox, oy, oz, t_min, dx, dy, dz, t_max] = floats::<8>(bytes);
            let ray = FileRay {
                origin: Vec3::new(ox, oy, oz),
                t_min,
                dir: Vec3::new(dx, dy, dz),
                t_max,
            };
            match fault_of(&ray) {
                Some(what) => Err(self.fault(begin + i * RAY_BYTES, format!("ray {i} {what}"))),
                None => Ok(ray),
            }
        };
        bytes
            .chunks_exact(RAY_BYTES)
            .enumerate()
            .map(read)
            .collect()
    }
}

/// Why a ray cannot be traced.
fn fault_of(ray: &FileRay) -> Option<&'static str> {
    if !ray.is_active() {
        None
    } else if !ray.origin.is_finite() {
        Some("has an origin that is not finite")
    } else if !ray.dir.is_finite() || ray.dir == Vec3::ZERO {
        Some("has no direction")
    } else if !(ray.t_min >= 0.0 && ray.t_min.is_finite()) {
        Some("begins before its origin or nowhere: tmin must be finite and at least 0")
    } else {
        None
    }
}

fn floats<const N: usize>(bytes: &[u8]) -> [f32; N] {
    let (words, _) = bytes.as_chunks::<4>();
    std::array::from_fn(|i| f32::from_le_bytes(words[i]))
}
