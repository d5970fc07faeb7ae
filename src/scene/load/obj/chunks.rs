//! Cuts a file's text where lines begin, so that its parts can be read at the same time.

use rayon::prelude::*;

use super::lines::{Lines, next_start, split_keyword};

/// Bytes of a chunk, about: a few milliseconds to read, so that a cancelled load stops soon and threads
/// end together.
const CHUNK_BYTES: usize = 1 << 20;

/// How many of what indices and messages count.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Count {
    /// Lines.
    pub lines: usize,
    /// `v`.
    pub positions: usize,
    /// `vt`.
    pub uvs: usize,
    /// `vn`.
    pub normals: usize,
    /// `f`.
    pub faces: usize,
}

impl Count {
    fn of(mut lines: Lines<'_>) -> Self {
        let (mut count, before) = (Self::default(), lines.number());
        while let Some((_, line)) = lines.next() {
            match split_keyword(line).0 {
                b"v" => count.positions += 1,
                b"vt" => count.uvs += 1,
                b"vn" => count.normals += 1,
                b"f" | b"fo" => count.faces += 1,
                _ => {}
            }
        }
        count.lines = lines.number() - before;
        count
    }

    const fn plus(self, other: Self) -> Self {
        Self {
            lines: self.lines + other.lines,
            positions: self.positions + other.positions,
            uvs: self.uvs + other.uvs,
            normals: self.normals + other.normals,
            faces: self.faces + other.faces,
        }
    }
}

/// Whole lines of a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk<'a> {
    text: &'a [u8],
    /// What is before it.
    pub before: Count,
    /// What is in it.
    pub holds: Count,
}

impl<'a> Chunk<'a> {
    /// Its logical lines, numbered as in the file.
    pub fn lines(&self) -> Lines<'a> {
        match self.before.lines {
            0 => Lines::new(self.text),
            lines => Lines::inside(self.text, lines),
        }
    }
}

/// All chunks of a file in order, counted on the current rayon pool.
pub(super) fn chunks(text: &[u8]) -> Vec<Chunk<'_>> {
    let mut cut = Vec::with_capacity(text.len() / CHUNK_BYTES + 1);
    let mut rest = text;
    while !rest.is_empty() {
        let (part, behind) = rest.split_at(next_start(rest, CHUNK_BYTES.min(rest.len())));
        cut.push(part);
        rest = behind;
    }
    let mut chunks: Vec<_> = cut
        .into_par_iter()
        .enumerate()
        .map(|(i, text)| Chunk {
            text,
            before: Count::default(),
            holds: Count::of(match i {
                0 => Lines::new(text),
                _ => Lines::inside(text, 0),
            }),
        })
        .collect();
    let mut before = Count::default();
    for chunk in &mut chunks {
        chunk.before = before;
        before = before.plus(chunk.holds);
    }
    chunks
}
