//! OBJ text, read line by line: one bad line costs one note, never the file.

mod lines;
mod notes;
mod number;
mod parser;
mod resolve;

use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2, Vec3};

use super::{LibraryRef, LoadMonitor};
use crate::scene::LoadError;
use lines::Lines;
pub(super) use notes::{Kind, Notes};
use parser::Parser;

/// A corner without this attribute.
pub(super) const NONE: u32 = u32::MAX;

/// Lines between two looks at the monitor.
const LINES_PER_REPORT: usize = 16_384;

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
    /// Reads text that came from `path`. The monitor is told fractions from `start` to `end`.
    pub fn parse(
        text: &[u8],
        path: &Path,
        (monitor, [start, end]): (&LoadMonitor, [f32; 2]),
    ) -> Result<Self, LoadError> {
        let mut parser = Parser::new(path, text.len());
        let mut lines = Lines::new(text);
        let mut until_report = LINES_PER_REPORT;
        while let Some((number, line)) = lines.next() {
            parser.statement(number, line)?;
            until_report -= 1;
            if until_report == 0 {
                until_report = LINES_PER_REPORT;
                let done = lines.position() as f32 / text.len() as f32;
                monitor.reached(start + (end - start) * done)?;
            }
        }
        monitor.reached(end)?;
        parser.obj.resolve();
        Ok(parser.obj)
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
