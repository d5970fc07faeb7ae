//! Collects what was doubtful in a file without drowning the reader.

use std::path::{Path, PathBuf};

use crate::scene::LoadWarning;

/// Notes of one kind that are listed one by one.
const LISTED: usize = 20;

/// What a note is about. Each kind is counted by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::scene::load) enum Kind {
    /// A face that cannot be used.
    FaceDropped,
    /// A face that lost its texture coordinates.
    UvDropped,
    /// A face that lost its normals.
    NormalsDropped,
    /// A statement with bad numbers.
    Number,
    /// A statement that OBJ does not know.
    Unknown,
    /// A face that is folded or crosses itself.
    Crossed,
    /// `l`.
    Line,
    /// `p`.
    Point,
    /// Curves and surfaces.
    Freeform,
    /// Colours behind a vertex.
    VertexColor,
    /// `vn` without a direction.
    ZeroNormal,
}

impl Kind {
    const ALL: [Self; 11] = [
        Self::FaceDropped,
        Self::UvDropped,
        Self::NormalsDropped,
        Self::Number,
        Self::Unknown,
        Self::Crossed,
        Self::Line,
        Self::Point,
        Self::Freeform,
        Self::VertexColor,
        Self::ZeroNormal,
    ];

    /// What "and N more" counts, or all that is said of a kind that is only counted.
    const fn summary(self) -> &'static str {
        match self {
            Self::FaceDropped => "faces dropped",
            Self::UvDropped => "faces without their texture coordinates",
            Self::NormalsDropped => "faces without their normals",
            Self::Number => "statements with bad numbers",
            Self::Unknown => "unknown statements skipped",
            Self::Crossed => "faces that are folded or cross themselves",
            Self::Line => "line statements (l) skipped, lines have no surface",
            Self::Point => "point statements (p) skipped, points have no surface",
            Self::Freeform => "free-form statements skipped, only polygons are read",
            Self::VertexColor => "vertex colours are not shown",
            Self::ZeroNormal => "normals (vn) without a direction, the face's own is used",
        }
    }
}

/// Notes about one file, in the order of its lines.
#[derive(Debug)]
pub(in crate::scene::load) struct Notes {
    file: PathBuf,
    list: Vec<LoadWarning>,
    listed: [usize; Kind::ALL.len()],
    counted: [(usize, usize); Kind::ALL.len()],
}

impl Notes {
    /// No notes about a file yet.
    pub fn new(file: &Path) -> Self {
        Self {
            file: file.to_owned(),
            list: Vec::new(),
            listed: [0; _],
            counted: [(0, 0); _],
        }
    }

    /// Adds a note of its own, as long as there are not too many of its kind. The message is made only
    /// when it is shown.
    pub fn add(&mut self, kind: Kind, line: usize, message: impl FnOnce() -> String) {
        let count = &mut self.listed[kind as usize];
        *count += 1;
        if *count <= LISTED {
            self.list.push(LoadWarning {
                file: self.file.clone(),
                line: Some(line),
                message: message(),
            });
        }
    }

    /// Counts something that gets one note however often it occurs.
    pub const fn count(&mut self, kind: Kind, line: usize) {
        let (count, first) = &mut self.counted[kind as usize];
        *count += 1;
        if *count == 1 {
            *first = line;
        }
    }

    /// Adds a note about the whole file.
    pub fn about_file(&mut self, message: String) {
        self.list.push(LoadWarning {
            file: self.file.clone(),
            line: None,
            message,
        });
    }

    /// All notes by line, those about the whole file last.
    pub fn finish(mut self) -> Vec<LoadWarning> {
        for kind in Kind::ALL {
            let (count, first) = self.counted[kind as usize];
            if count > 0 {
                self.list.push(LoadWarning {
                    file: self.file.clone(),
                    line: Some(first),
                    message: format!("{}; {count} in this file", kind.summary()),
                });
            }
        }
        for kind in Kind::ALL {
            let more = self.listed[kind as usize].saturating_sub(LISTED);
            if more > 0 {
                self.about_file(format!("and {more} more: {}", kind.summary()));
            }
        }
        self.list
            .sort_by_key(|note| note.line.unwrap_or(usize::MAX));
        self.list
    }
}
