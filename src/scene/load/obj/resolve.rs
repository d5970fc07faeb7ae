//! Makes every index of a file trustworthy once the whole file is known.

use super::{Corner, Kind, NONE, Obj};

impl Obj {
    /// Empties faces with a vertex index out of range, takes texture coordinates and normals from faces
    /// where an index is out of range or absent at some corner. Corners are packed in place.
    pub(super) fn resolve(&mut self) {
        let mut write = 0;
        let mut start = 0;
        for face in 0..self.faces.len() {
            let end = self.faces[face].end as usize;
            let line = self.faces[face].line as usize;
            if self.positions_in_range(start..end, line) {
                self.settle_uvs(start..end, line);
                self.settle_normals(start..end, line);
                self.corners.copy_within(start..end, write);
                write += end - start;
            }
            self.faces[face].end = write as u32;
            start = end;
        }
        self.corners.truncate(write);
    }

    fn positions_in_range(&mut self, corners: std::ops::Range<usize>, line: usize) -> bool {
        let count = self.positions.len();
        let bad = self.corners[corners].iter().find(|c| c.v as usize >= count);
        if let Some(bad) = bad {
            let index = u64::from(bad.v) + 1;
            self.notes.add(Kind::FaceDropped, line, || {
                format!("face dropped: vertex {index} of {count}")
            });
        }
        bad.is_none()
    }

    fn settle_uvs(&mut self, corners: std::ops::Range<usize>, line: usize) {
        let uvs = &self.uvs;
        let corners = &mut self.corners[corners];
        let usable = |c: &Corner| uvs.get(c.vt as usize).is_some_and(|uv| uv.is_finite());
        if corners.iter().all(usable) {
            return;
        }
        let bad = corners
            .iter()
            .find(|c| c.vt != NONE && c.vt as usize >= uvs.len());
        if let Some(bad) = bad {
            self.notes.add(Kind::UvDropped, line, || {
                let index = u64::from(bad.vt) + 1;
                format!(
                    "face without texture coordinates: number {index} of {}",
                    uvs.len()
                )
            });
        }
        corners.iter_mut().for_each(|c| c.vt = NONE);
    }

    fn settle_normals(&mut self, corners: std::ops::Range<usize>, line: usize) {
        let count = self.normals.len();
        let corners = &mut self.corners[corners];
        if corners.iter().all(|c| (c.vn as usize) < count) {
            return;
        }
        let bad = corners
            .iter()
            .find(|c| c.vn != NONE && c.vn as usize >= count);
        if let Some(bad) = bad {
            self.notes.add(Kind::NormalsDropped, line, || {
                let index = u64::from(bad.vn) + 1;
                format!("face without its normals: number {index} of {count}")
            });
        }
        corners.iter_mut().for_each(|c| c.vn = NONE);
    }
}
