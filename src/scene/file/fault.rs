//! What is wrong with a scene file, and where.

use std::path::Path;

use crate::scene::LoadError;

/// A key of a scene file that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    /// Byte offset in the text of what is wrong; `None` if the file as a whole is.
    pub at: Option<usize>,
    /// One sentence that names the key.
    pub message: String,
}

/// A value, or why there is none.
pub(super) type Read<T> = Result<T, Fault>;

impl Fault {
    /// A fault at a byte offset.
    pub fn new(at: usize, message: impl Into<String>) -> Self {
        Self {
            at: Some(at),
            message: message.into(),
        }
    }

    /// The fault as callers of the loader see it.
    pub fn in_file(self, path: &Path, text: &str) -> LoadError {
        LoadError::Invalid {
            path: path.to_owned(),
            line: self.at.map(|at| line_of(text, at)),
            message: self.message,
        }
    }
}

/// Line, from 1, of a byte offset.
pub(super) fn line_of(text: &str, at: usize) -> usize {
    let before = &text.as_bytes()[..at.min(text.len())];
    1 + before.iter().filter(|&&b| b == b'\n').count()
}

/// The known name most like `word`, if one is like it at all.
pub(super) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let tolerance = (word.chars().count() / 3).max(2);
    known
        .into_iter()
        .map(|name| (edits(word, name), name))
        .filter(|&(distance, name)| distance <= tolerance && distance < name.chars().count())
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| name)
}

/// Insertions, removals and replacements that turn `a` into `b` (Levenshtein 1966), case ignored.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.to_lowercase().chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_count_from_one() {
        let text = "a\nb\n\nc";
        let lines: Vec<usize> = [0, 1, 2, 4, 5, 99].map(|at| line_of(text, at)).to_vec();
        assert_eq!(lines, [1, 1, 2, 3, 4, 4]);
    }

    #[test]
    fn the_nearest_name_is_found_or_none() {
        let known = ["eye", "target", "up", "vfov_deg"];
        assert_eq!(nearest("vfow_deg", known), Some("vfov_deg"));
        assert_eq!(nearest("Target", known), Some("target"));
        assert_eq!(nearest("fov", known), None);
        assert_eq!(nearest("zz", known), None);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}
