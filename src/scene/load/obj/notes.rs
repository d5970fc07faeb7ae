//! Collects what was doubtful in a file without drowning the reader.

use std::path::Path;

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
#[derive(Debug, Default)]
pub(in crate::scene::load) struct Notes {
    list: Vec<Note>,
    about_file: Vec<String>,
    listed: [usize; Kind::ALL.len()],
    /// How many, and the first one's line.
    counted: [(usize, usize); Kind::ALL.len()],
}

#[derive(Debug)]
struct Note {
    kind: Kind,
    line: usize,
    message: String,
}

impl Notes {
    /// Adds a note of its own, as long as there are not too many of its kind. The message is made only
    /// when it is shown.
    pub fn add(&mut self, kind: Kind, line: usize, message: impl FnOnce() -> String) {
        let count = &mut self.listed[kind as usize];
        *count += 1;
        if *count <= LISTED {
            self.list.push(Note {
                kind,
                line,
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
        self.about_file.push(message);
    }

    /// Adds the notes about what follows in the file.
    pub fn append(&mut self, later: Self) {
        let mut room = self.listed.map(|listed| LISTED.saturating_sub(listed));
        self.list.extend(later.list.into_iter().filter(|note| {
            let room = &mut room[note.kind as usize];
            let fits = *room > 0;
            *room = room.saturating_sub(1);
            fits
        }));
        self.about_file.extend(later.about_file);
        for (listed, more) in self.listed.iter_mut().zip(later.listed) {
            *listed += more;
        }
        for ((count, first), (more, later_first)) in self.counted.iter_mut().zip(later.counted) {
            if *count == 0 {
                *first = later_first;
            }
            *count += more;
        }
    }

    /// All notes by line, those about the whole file last.
    pub fn finish(mut self, file: &Path) -> Vec<LoadWarning> {
        for kind in Kind::ALL {
            let (count, line) = self.counted[kind as usize];
            if count > 0 {
                let message = format!("{}; {count} in this file", kind.summary());
                self.list.push(Note {
                    kind,
                    line,
                    message,
                });
            }
        }
        for kind in Kind::ALL {
            let more = self.listed[kind as usize].saturating_sub(LISTED);
            if more > 0 {
                self.about_file(format!("and {more} more: {}", kind.summary()));
            }
        }
        self.list.sort_by_key(|note| note.line);
        let warning = |line, message| LoadWarning {
            file: file.to_owned(),
            line,
            message,
        };
        let of_lines = self
            .list
            .into_iter()
            .map(|n| warning(Some(n.line), n.message));
        let of_file = self.about_file.into_iter().map(|m| warning(None, m));
        of_lines.chain(of_file).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_file_note_what_the_whole_would() {
        let fill = |notes: &mut Notes, lines: std::ops::Range<usize>| {
            for line in lines {
                notes.add(Kind::Number, line, || format!("bad {line}"));
                if line % 3 == 0 {
                    notes.add(Kind::Unknown, line, || format!("unknown {line}"));
                    notes.count(Kind::Point, line);
                }
            }
        };
        let mut whole = Notes::default();
        fill(&mut whole, 1..100);
        let mut joined = Notes::default();
        for lines in [1..4, 4..19, 19..70, 70..100] {
            let mut part = Notes::default();
            fill(&mut part, lines);
            joined.append(part);
        }
        let file = Path::new("a.obj");
        assert_eq!(joined.finish(file), whole.finish(file));
    }
}
