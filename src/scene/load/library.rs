//! Which libraries a model means, and which definition of a name counts.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::lookup::{Found, describe_folders, find_as_written, find_file, text_from_bytes};
use super::materials::LibraryRef;
use super::mtl::{MAX_MATERIALS, MtlMaterial, parse_library, without_comment};
use crate::scene::LoadWarning;

/// No library is longer: a larger file is something else.
const MAX_BYTES: u64 = 256 << 20;
/// No model names more libraries: each costs looks into folders.
const MAX_LIBRARIES: usize = 1000;

/// A material with the library it stands in.
#[derive(Debug)]
pub(super) struct Definition {
    /// Its statements.
    pub material: MtlMaterial,
    /// The file.
    pub library: PathBuf,
}

/// How a name was matched with a definition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Match {
    /// Byte for byte, or but for a comment.
    Exact,
    /// In another letter case.
    OtherCase,
}

/// All materials of a model's libraries.
#[derive(Debug, Default)]
pub(super) struct Definitions {
    list: Vec<Definition>,
    by_name: HashMap<Vec<u8>, usize>,
    /// Without what may be a comment.
    by_bare_name: HashMap<Vec<u8>, usize>,
    /// The same in one letter case.
    by_lower_name: HashMap<String, usize>,
}

impl Definitions {
    /// Reads the libraries in order. Those that cannot be found or read cost a warning each.
    pub fn read(libraries: &[LibraryRef], warnings: &mut Vec<LoadWarning>) -> Self {
        let mut definitions = Self::default();
        let mut seen: Vec<PathBuf> = Vec::new();
        for library in libraries {
            if seen.len() >= MAX_LIBRARIES {
                let message = format!("more than {MAX_LIBRARIES} libraries; the rest is not read");
                warnings.push(LoadWarning {
                    file: library.model.clone(),
                    line: Some(library.line),
                    message,
                });
                break;
            }
            for path in files_of(library, warnings) {
                let identity = path.canonicalize().unwrap_or_else(|_| path.clone());
                if !seen.contains(&identity) {
                    seen.push(identity);
                    definitions.add_file(&path, warnings);
                }
            }
        }
        definitions
    }

    /// The definition of a name (without blanks around it).
    pub fn find(&self, name: &[u8]) -> Option<(&Definition, Match)> {
        if let Some(&i) = self.by_name.get(name) {
            return Some((&self.list[i], Match::Exact));
        }
        let bare = without_comment(name);
        if bare.is_empty() {
            return None;
        }
        if let Some(&i) = self.by_bare_name.get(bare) {
            return Some((&self.list[i], Match::Exact));
        }
        let &i = self.by_lower_name.get(&lower(bare))?;
        Some((&self.list[i], Match::OtherCase))
    }

    fn add_file(&mut self, path: &Path, warnings: &mut Vec<LoadWarning>) {
        let mut warn = |line, message| {
            warnings.push(LoadWarning {
                file: path.to_path_buf(),
                line,
                message,
            });
        };
        let library = match read_limited(path) {
            Ok(text) => parse_library(&text),
            Err(cause) => return warn(None, format!("library not read: {cause}")),
        };
        for note in library.notes {
            warn(Some(note.line), note.message);
        }
        for material in library.materials {
            if let Some(&first) = self.by_name.get(&material.name) {
                // The parser told about repeats within one file.
                let earlier = &self.list[first];
                if earlier.library != path {
                    let message = format!(
                        "material \"{}\" is defined in {} already; that definition counts",
                        text_from_bytes(&material.name),
                        earlier.library.display()
                    );
                    warn(Some(material.line), message);
                }
                continue;
            }
            if self.list.len() == MAX_MATERIALS {
                let message = format!("from here on: more than {MAX_MATERIALS} materials in all");
                warn(Some(material.line), message);
                break;
            }
            let index = self.list.len();
            self.by_name.insert(material.name.clone(), index);
            // The first of several counts.
            let bare = without_comment(&material.name);
            self.by_lower_name.entry(lower(bare)).or_insert(index);
            self.by_bare_name.entry(bare.to_vec()).or_insert(index);
            self.list.push(Definition {
                material,
                library: path.to_path_buf(),
            });
        }
    }
}

/// A name in the one letter case by which names are compared that differ in it.
fn lower(name: &[u8]) -> String {
    text_from_bytes(name).to_lowercase()
}

fn read_limited(path: &Path) -> Result<Vec<u8>, String> {
    let bytes = fs::metadata(path).map_err(|e| e.to_string())?.len();
    if bytes > MAX_BYTES {
        return Err(format!("{bytes} bytes are too many for a library"));
    }
    fs::read(path).map_err(|e| e.to_string())
}

/// The files that one `mtllib` statement names: all of it as one name with blanks, or several names.
fn files_of(library: &LibraryRef, warnings: &mut Vec<LoadWarning>) -> Vec<PathBuf> {
    let folder = library.model.parent().unwrap_or(Path::new(""));
    let mut warn = |message| {
        warnings.push(LoadWarning {
            file: library.model.clone(),
            line: Some(library.line),
            message,
        });
    };
    let whole = without_comment(&library.name).trim_ascii();
    if whole.is_empty() {
        warn("mtllib names no library".to_owned());
        return Vec::new();
    }
    if let Some(path) = find_as_written(whole, &[folder]) {
        return vec![path];
    }
    let mut files = Vec::new();
    for name in several_names(whole).into_iter().take(MAX_LIBRARIES) {
        let shown = text_from_bytes(name);
        match find_file(name, &[folder]) {
            Some(Found { path, fallback }) => {
                if let Some(how) = fallback {
                    warn(format!(
                        "library \"{shown}\" found {how}: {}",
                        path.display()
                    ));
                }
                files.push(path);
            }
            None => warn(format!(
                "library \"{shown}\" not found; looked in {}",
                describe_folders(&[folder])
            )),
        }
    }
    files
}

/// Cuts a list of names where a word ends in `.mtl`; words after the last such one are a name too.
fn several_names(list: &[u8]) -> Vec<&[u8]> {
    let mut names = Vec::new();
    let mut start = 0;
    let is_end = |at: usize| list.get(at).is_none_or(u8::is_ascii_whitespace);
    for at in 0..=list.len() {
        let head = &list[start..at];
        let ends_name = head.len() >= 4 && head[head.len() - 4..].eq_ignore_ascii_case(b".mtl");
        if is_end(at) && (ends_name || at == list.len()) {
            names.push(head.trim_ascii());
            start = at;
        }
    }
    names.retain(|n| !n.is_empty());
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_libraries_on_a_line() {
        assert_eq!(several_names(b"a.mtl b.MTL"), [&b"a.mtl"[..], b"b.MTL"]);
        assert_eq!(
            several_names(b"my a.mtl.mtl  c"),
            [&b"my a.mtl.mtl"[..], b"c"]
        );
        assert_eq!(several_names(b"one two"), [b"one two"]);
    }
}
