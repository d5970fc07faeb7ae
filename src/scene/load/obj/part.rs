//! What a chunk of a file holds, and how chunks become a file again.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec2, Vec3};

use super::{Corner, Face, Notes, Obj, Smoothing, Span};
use crate::scene::LoadError;
use crate::scene::load::LibraryRef;

/// Material indices are `u16`.
const MAX_MATERIALS: usize = u16::MAX as usize;

/// What follows `usemtl`, as written (with a comment, as some names hold a `#`), and its line.
type UseMtl = (Vec<u8>, usize);

/// A chunk of an [`Obj`]: indices count from the beginning of the file, positive ones are unchecked; those
/// into the arrays of faces, corners and materials count from the beginning of the chunk.
#[derive(Debug, Default)]
pub(super) struct Part {
    pub positions: Vec<DVec3>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    pub spans: Vec<PartSpan>,
    pub materials: Vec<UsedMaterial>,
    pub libraries: Vec<LibraryRef>,
    pub notes: Notes,
    /// The last `usemtl`; `None` before the first, where that of an earlier chunk holds.
    pub usemtl: Option<UseMtl>,
    /// The last `s`; `None` before the first.
    pub smoothing: Option<Smoothing>,
}

/// Faces in a row with the same state; `None` is what holds at the chunk's begin.
#[derive(Debug)]
pub(super) struct PartSpan {
    pub first: usize,
    pub material: u32,
    pub smoothing: Option<Smoothing>,
}

/// A material in the order of its first face.
#[derive(Debug)]
pub(super) struct UsedMaterial {
    pub usemtl: Option<UseMtl>,
    /// The face's line.
    pub first_face: usize,
}

/// Joins the parts of a file.
pub(super) struct Joiner {
    pub obj: Obj,
    /// The `usemtl` in force.
    usemtl: UseMtl,
    smoothing: Smoothing,
    index_of: HashMap<Vec<u8>, u16>,
}

impl Joiner {
    /// Makes one file of its parts in order; its positive indices are unchecked.
    pub fn join(path: &Path, parts: Vec<Part>) -> Result<Obj, LoadError> {
        let sum = |length: fn(&Part) -> usize| parts.iter().map(length).sum();
        let mut joiner = Self {
            obj: Obj {
                path: path.to_owned(),
                positions: Vec::with_capacity(sum(|p| p.positions.len())),
                uvs: Vec::with_capacity(sum(|p| p.uvs.len())),
                normals: Vec::with_capacity(sum(|p| p.normals.len())),
                corners: Vec::with_capacity(sum(|p| p.corners.len())),
                faces: Vec::with_capacity(sum(|p| p.faces.len())),
                spans: Vec::new(),
                materials: Vec::new(),
                libraries: Vec::new(),
                notes: Notes::default(),
            },
            usemtl: (Vec::new(), 0),
            smoothing: Smoothing::Unsaid,
            index_of: HashMap::new(),
        };
        for part in parts {
            joiner.append(part)?;
        }
        Ok(joiner.obj)
    }

    fn append(&mut self, part: Part) -> Result<(), LoadError> {
        let (first_corner, first_face) = (self.obj.corners.len(), self.obj.faces.len());
        let materials = part
            .materials
            .into_iter()
            .map(|used| self.material_index(used))
            .collect::<Result<Vec<_>, _>>()?;
        for span in part.spans {
            let material = materials[span.material as usize];
            let smoothing = span.smoothing.unwrap_or(self.smoothing);
            let goes_on = |last: &Span| last.material == material && last.smoothing == smoothing;
            if !self.obj.spans.last().is_some_and(goes_on) {
                self.obj.spans.push(Span {
                    first: (first_face + span.first) as u32,
                    material,
                    smoothing,
                });
            }
        }
        let obj = &mut self.obj;
        for face in part.faces {
            let end = u32::try_from(first_corner + face.end as usize)
                .map_err(|_| too_many_vertices(&obj.path, face.line as usize))?;
            obj.faces.push(Face { end, ..face });
        }
        obj.positions.extend_from_slice(&part.positions);
        obj.uvs.extend_from_slice(&part.uvs);
        obj.normals.extend_from_slice(&part.normals);
        obj.corners.extend_from_slice(&part.corners);
        obj.libraries.extend(part.libraries);
        obj.notes.append(part.notes);
        if let Some(usemtl) = part.usemtl {
            self.usemtl = usemtl;
        }
        self.smoothing = part.smoothing.unwrap_or(self.smoothing);
        Ok(())
    }

    /// Index of a part's material in the file, new or known.
    fn material_index(&mut self, used: UsedMaterial) -> Result<u16, LoadError> {
        let usemtl = used.usemtl.unwrap_or_else(|| self.usemtl.clone());
        if let Some(&known) = self.index_of.get(&usemtl.0) {
            return Ok(known);
        }
        let count = self.obj.materials.len();
        let index = u16::try_from(count)
            .ok()
            .filter(|_| count < MAX_MATERIALS)
            .ok_or_else(|| {
                let what = "materials: 65,535 are the limit";
                too_many(&self.obj.path, used.first_face, what)
            })?;
        self.index_of.insert(usemtl.0.clone(), index);
        self.obj.materials.push(usemtl);
        Ok(index)
    }
}

/// The error of a face that 32-bit indices cannot reach.
pub(super) fn too_many_vertices(path: &Path, line: usize) -> LoadError {
    too_many(path, line, "vertices: 32-bit indices end here")
}

fn too_many(path: &Path, line: usize, what: &str) -> LoadError {
    LoadError::Invalid {
        path: path.to_owned(),
        line: Some(line),
        message: format!("too many {what}"),
    }
}
