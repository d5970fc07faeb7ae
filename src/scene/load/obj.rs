//! OBJ text, read line by line: one bad line costs one note, never the file.
//!
//! Large files are cut into chunks of whole lines. A quick count of each tells at which line, vertex and
//! so on it begins; then all are parsed at the same time, and joined in their order. The result is that of
//! reading from top to bottom.

mod chunks;
mod keywords;
mod lines;
mod notes;
mod number;
mod parser;
mod part;
mod resolve;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::{LibraryRef, LoadMonitor, Stage};
use crate::scene::LoadError;
use chunks::chunks;
pub(super) use notes::{Kind, Notes};
use parser::Parser;
use part::Joiner;

/// A corner without this attribute.
pub(super) const NONE: u32 = u32::MAX;

/// One corner of a face: indices from 0 into positions, texture coordinates and normals, or [`NONE`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Corner {
    /// Position.
    pub v: u32,
    /// Texture coordinate.
    pub vt: u32,
    /// Normal.
    pub vn: u32,
}

/// A polygon: the corners from the previous face's end up to `end`; no corners once dropped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Face {
    /// One behind its last corner.
    pub end: u32,
    /// Line in the file.
    pub line: u32,
}

/// The `s` statement in force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Smoothing {
    /// None so far: smooth across gentle edges.
    Unsaid,
    /// `s off`, `s 0`.
    Off,
    /// Smooth within the group.
    Group(u32),
}

/// Faces in a row with the same state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Span {
    /// Index of its first face.
    pub first: u32,
    /// Index into [`Obj::materials`].
    pub material: u16,
    /// Smoothing.
    pub smoothing: Smoothing,
}

/// An OBJ file. Every index in it is in range; a face has its texture coordinates (normals) at all
/// corners or at none.
#[derive(Debug)]
pub(super) struct Obj {
    /// The file.
    pub path: PathBuf,
    /// `v`, world units; NaN where the statement had no three numbers.
    pub positions: Vec<DVec3>,
    /// `vt`, v up; NaN where bad.
    pub uvs: Vec<Vec2>,
    /// `vn`, unit length; zero where bad.
    pub normals: Vec<Vec3>,
    /// Corners of all faces.
    pub corners: Vec<Corner>,
    /// Faces in the order of the file.
    pub faces: Vec<Face>,
    /// Material and smoothing of the faces.
    pub spans: Vec<Span>,
    /// What follows `usemtl`, as written, and the line, in the order of their first face. Empty and 0 for
    /// faces before any.
    pub materials: Vec<(Vec<u8>, usize)>,
    /// `mtllib` in the order of the file.
    pub libraries: Vec<LibraryRef>,
    /// What was doubtful.
    pub notes: Notes,
}

impl Obj {
    /// Reads text that came from `path`, on the current rayon pool.
    pub fn parse(text: &[u8], path: &Path, monitor: &LoadMonitor) -> Result<Self, LoadError> {
        let parsed = AtomicUsize::new(0);
        let chunks = chunks(text);
        let parts = chunks
            .par_iter()
            .with_max_len(1)
            .map(|chunk| {
                let share = parsed.fetch_add(1, Ordering::Relaxed) as f32 / chunks.len() as f32;
                monitor.reached(Stage::Parsing, share)?;
                Parser::read(path, chunk)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut obj = Joiner::join(path, parts)?;
        obj.resolve();
        Ok(obj)
    }

    /// Material and smoothing with the faces they hold for.
    pub fn spans(&self) -> impl Iterator<Item = (Span, std::ops::Range<usize>)> {
        let ends = self
            .spans
            .iter()
            .skip(1)
            .map(|s| s.first as usize)
            .chain([self.faces.len()]);
        self.spans
            .iter()
            .zip(ends)
            .map(|(span, end)| (*span, span.first as usize..end))
    }

    /// Corner numbers of a face.
    pub fn corners_of(&self, face: usize) -> std::ops::Range<usize> {
        let start = face.checked_sub(1).map_or(0, |f| self.faces[f].end);
        start as usize..self.faces[face].end as usize
    }
}
