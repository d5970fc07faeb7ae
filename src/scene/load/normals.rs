//! Vertex normals for faces that bring none.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::LoadMonitor;
use super::obj::{NONE, Obj, Smoothing};
use super::polygon::area_vector;
use crate::math::Groups;
use crate::scene::LoadError;

/// Positions or faces that a thread takes at a time.
const PIECE: usize = 8192;

/// Cosine of the angle between faces from which on an edge stays sharp where the file says nothing about
/// smoothing: 60°. Cubes and prisms with up to five sides keep their edges, scans look smooth.
const SHARP_COS: f32 = 0.5;

/// A corner of a face without normals, listed at its position.
#[derive(Debug, Clone, Copy)]
struct Incident {
    face: u32,
    corner: u32,
}

/// Gives every corner that shall have a normal one of `obj.normals`.
///
/// - Normals of the file stay. One without direction becomes the face's own normal.
/// - `s off`, `s 0`: none; the face is flat.
/// - Within a smoothing group: the mean over the group's faces around the position, weighted by the
///   angle at the corner (Thürmer & Wüthrich 1998), so that it does not depend on how faces are cut.
/// - Where the file has no `s`: the same mean over faces that hang together across edges below 60°.
///
/// Positions count as shared where faces use the same `v`. Corners whose mean vanishes get none.
pub(super) fn complete_normals(obj: &mut Obj, monitor: &LoadMonitor) -> Result<(), LoadError> {
    replace_zero_normals(obj);
    let Some(listed) = Listed::new(obj) else {
        return Ok(());
    };
    let starts: Vec<_> = (0..obj.positions.len()).step_by(PIECE).collect();
    let pieces = starts
        .into_par_iter()
        .map_init(Scratch::default, |scratch, start| {
            monitor.check()?;
            let mut piece = Piece::default();
            for v in start..obj.positions.len().min(start + PIECE) {
                scratch.around_position(obj, &listed, v, &mut piece);
            }
            Ok(piece)
        })
        .collect::<Result<Vec<_>, _>>()?;
    drop(listed);
    for piece in pieces {
        let first = obj.normals.len() as u32;
        obj.normals.extend(piece.normals);
        for (corner, normal) in piece.corners {
            let own = if normal == NONE { NONE } else { first + normal };
            obj.corners[corner as usize].vn = own;
        }
    }
    Ok(())
}

/// Normals made at some positions, and the corners that get them.
#[derive(Default)]
struct Piece {
    normals: Vec<Vec3>,
    /// Corner, and index into `normals` or [`NONE`].
    corners: Vec<(u32, u32)>,
}

fn face_normal(obj: &Obj, face: usize, scratch: &mut Vec<DVec3>) -> Vec3 {
    scratch.clear();
    let corners = &obj.corners[obj.corners_of(face)];
    scratch.extend(corners.iter().map(|c| obj.positions[c.v as usize]));
    area_vector(scratch).normalize_or_zero().as_vec3()
}

fn replace_zero_normals(obj: &mut Obj) {
    if !obj.normals.contains(&Vec3::ZERO) {
        return;
    }
    let mut scratch = Vec::new();
    for face in 0..obj.faces.len() {
        let range = obj.corners_of(face);
        let is_zero = |obj: &Obj, corner: usize| {
            obj.normals.get(obj.corners[corner].vn as usize) == Some(&Vec3::ZERO)
        };
        if !range.clone().any(|c| is_zero(obj, c)) {
            continue;
        }
        let own = obj.normals.len() as u32;
        let normal = face_normal(obj, face, &mut scratch);
        obj.normals.push(normal);
        for corner in range {
            // A face without area is dropped later; until then it must not find a zero normal.
            if is_zero(obj, corner) {
                obj.corners[corner].vn = if normal == Vec3::ZERO { NONE } else { own };
            }
        }
    }
}

/// The corners that want normals, by position.
struct Listed {
    /// Of every face; zero without area.
    face_normals: Vec<Vec3>,
    smoothing: Vec<Smoothing>,
    /// Where each position's incidents start; one more than positions.
    starts: Vec<u32>,
    incidents: Vec<Incident>,
}

impl Listed {
    /// `None` if there are none.
    fn new(obj: &Obj) -> Option<Self> {
        let wants = |face: usize| {
            obj.corners[obj.corners_of(face)]
                .first()
                .is_some_and(|c| c.vn == NONE)
        };
        let wanting = || {
            obj.spans()
                .filter(|(span, _)| span.smoothing != Smoothing::Off)
                .flat_map(|(_, faces)| faces)
                .filter(|&face| wants(face))
        };
        wanting().next()?;
        let mut starts = vec![0_u32; obj.positions.len() + 1];
        for corner in wanting().flat_map(|face| obj.corners_of(face)) {
            starts[obj.corners[corner].v as usize] += 1;
        }
        // Counts become ends, and filling from the back turns ends into starts.
        let mut total = 0;
        for start in &mut starts {
            total += *start;
            *start = total;
        }
        let blank = Incident { face: 0, corner: 0 };
        let mut incidents = vec![blank; total as usize];
        for face in wanting() {
            for corner in obj.corners_of(face) {
                let slot = &mut starts[obj.corners[corner].v as usize];
                *slot -= 1;
                incidents[*slot as usize] = Incident {
                    face: face as u32,
                    corner: corner as u32,
                };
            }
        }
        let mut smoothing = vec![Smoothing::Off; obj.faces.len()];
        for (span, faces) in obj.spans() {
            smoothing[faces].fill(span.smoothing);
        }
        Some(Self {
            face_normals: (0..obj.faces.len())
                .into_par_iter()
                .with_min_len(PIECE)
                .map_init(Vec::new, |scratch, face| face_normal(obj, face, scratch))
                .collect(),
            smoothing,
            starts,
            incidents,
        })
    }

    fn smoothing(&self, incident: Incident) -> Smoothing {
        self.smoothing[incident.face as usize]
    }

    fn face_normal(&self, incident: Incident) -> Vec3 {
        self.face_normals[incident.face as usize]
    }
}

/// Memory that is used again at every position.
#[derive(Default)]
struct Scratch {
    around: Vec<Incident>,
    /// Those of `around` that share a normal.
    pieces: Groups,
    /// (neighbouring position, index into `around`).
    spokes: Vec<(u32, u32)>,
    sums: Vec<DVec3>,
    /// Index of the normal of each root.
    made: Vec<u32>,
}

impl Scratch {
    fn around_position(&mut self, obj: &Obj, listed: &Listed, v: usize, piece: &mut Piece) {
        let range = listed.starts[v] as usize..listed.starts[v + 1] as usize;
        if range.is_empty() {
            return;
        }
        self.around.clear();
        self.around.extend_from_slice(&listed.incidents[range]);
        // The stable order by face makes sums independent of how corners were listed.
        self.around
            .sort_unstable_by_key(|i| (listed.smoothing(*i), i.face, i.corner));
        self.pieces.restart(self.around.len());
        self.join_groups(listed);
        self.join_across_gentle_edges(obj, listed);
        self.store_means(obj, listed, v, piece);
    }

    fn join_groups(&mut self, listed: &Listed) {
        for i in 1..self.around.len() {
            let [before, this] = [i - 1, i].map(|i| listed.smoothing(self.around[i]));
            if before == this && this != Smoothing::Unsaid {
                self.pieces.join(i as u32 - 1, i as u32);
            }
        }
    }

    fn join_across_gentle_edges(&mut self, obj: &Obj, listed: &Listed) {
        self.spokes.clear();
        for (i, incident) in self.around.iter().enumerate() {
            if listed.smoothing(*incident) == Smoothing::Unsaid {
                let [before, after] = neighbours(obj, *incident);
                self.spokes.push((obj.corners[before].v, i as u32));
                self.spokes.push((obj.corners[after].v, i as u32));
            }
        }
        self.spokes.sort_unstable();
        for i in 1..self.spokes.len() {
            let [(p, a), (q, b)] = [self.spokes[i - 1], self.spokes[i]];
            if p != q {
                continue;
            }
            let [m, n] = [a, b].map(|i| listed.face_normal(self.around[i as usize]));
            if m.dot(n) > SHARP_COS {
                self.pieces.join(a, b);
            }
        }
    }

    fn store_means(&mut self, obj: &Obj, listed: &Listed, v: usize, piece: &mut Piece) {
        self.sums.clear();
        self.sums.resize(self.around.len(), DVec3::ZERO);
        for i in 0..self.around.len() {
            let incident = self.around[i];
            let [before, after] = neighbours(obj, incident)
                .map(|c| obj.positions[obj.corners[c].v as usize] - obj.positions[v]);
            let angle = before.angle_between(after);
            let normal = listed.face_normal(incident).as_dvec3();
            let root = self.pieces.root(i as u32) as usize;
            if angle.is_finite() {
                self.sums[root] += normal * angle;
            }
        }
        self.made.clear();
        self.made.resize(self.around.len(), NONE);
        for i in 0..self.around.len() {
            let root = self.pieces.root(i as u32) as usize;
            let mean = self.sums[root].normalize_or_zero().as_vec3();
            if self.made[root] == NONE && mean != Vec3::ZERO {
                self.made[root] = piece.normals.len() as u32;
                piece.normals.push(mean);
            }
            piece.corners.push((self.around[i].corner, self.made[root]));
        }
    }
}

/// Corners before and after this one in its face.
fn neighbours(obj: &Obj, incident: Incident) -> [usize; 2] {
    let range = obj.corners_of(incident.face as usize);
    let corner = incident.corner as usize;
    let before = if corner == range.start {
        range.end - 1
    } else {
        corner - 1
    };
    let after = if corner + 1 == range.end {
        range.start
    } else {
        corner + 1
    };
    [before, after]
}
