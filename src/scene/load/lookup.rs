//! Finds the file that an old model means: other separators, letter cases and folders included.

use std::collections::HashSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

use super::map_statement::unquoted;

/// Folders beside a library that commonly hold its pictures.
const USUAL_FOLDERS: [&str; 6] = ["textures", "texture", "tex", "maps", "images", "img"];
/// No longer name is looked for, in bytes: the longest path that Linux opens. What is longer is damage,
/// and each of its thousands of ends would be a question to the file system.
const LONGEST_NAME: usize = 4096;

/// A file and how it was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Found {
    /// Where it is.
    pub path: PathBuf,
    /// What had to be tried, if the name as written (with either separator, without quotes) did not lead there.
    pub fallback: Option<&'static str>,
}

/// Bytes of a file as text: UTF-8, or Latin-1 where they are not UTF-8. Never fails.
pub(super) fn text_from_bytes(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    }
}

/// Looks for `name`, relative to each of `folders` in turn.
///
/// Order: as written; in any letter case; then the end of the path, shorter and shorter down to the base
/// name, beside the library and in the usual picture folders there. A found path is a plain file.
pub(super) fn find_file(name: &[u8], folders: &[&Path]) -> Option<Found> {
    let spellings = spellings(unquoted(name));
    if let Some(path) = as_written(&spellings, folders) {
        return Some(Found {
            path,
            fallback: None,
        });
    }
    for (spelling, folder) in pairs(&spellings, folders) {
        if let Some(path) = ignoring_case(folder, spelling) {
            let fallback = Some("in other letter case");
            return Some(Found { path, fallback });
        }
    }
    for (spelling, folder) in pairs(&spellings, folders) {
        if let Some(path) = by_its_end(folder, spelling) {
            let fallback = Some("not where its path says");
            return Some(Found { path, fallback });
        }
    }
    None
}

/// The first step of [`find_file`] alone: `name` as written (with either separator, without quotes).
pub(super) fn find_as_written(name: &[u8], folders: &[&Path]) -> Option<PathBuf> {
    as_written(&spellings(unquoted(name)), folders)
}

fn as_written(spellings: &[PathBuf], folders: &[&Path]) -> Option<PathBuf> {
    pairs(spellings, folders)
        .map(|(spelling, folder)| folder.join(spelling))
        .find(|path| path.is_file())
}

/// The folders in which [`find_file`] looks, for messages.
pub(super) fn describe_folders(folders: &[&Path]) -> String {
    let names = folders.iter().map(|folder| {
        if folder.as_os_str().is_empty() {
            ".".to_owned()
        } else {
            folder.display().to_string()
        }
    });
    names.collect::<Vec<_>>().join(", ")
}

fn pairs<'a>(
    spellings: &'a [PathBuf],
    folders: &'a [&Path],
) -> impl Iterator<Item = (&'a Path, &'a Path)> {
    spellings
        .iter()
        .flat_map(move |s| folders.iter().map(move |&f| (s.as_path(), f)))
}

/// The paths that the bytes may mean, likeliest first; none for a name beyond [`LONGEST_NAME`].
fn spellings(name: &[u8]) -> Vec<PathBuf> {
    if name.len() > LONGEST_NAME {
        return Vec::new();
    }
    let slashed: Vec<u8> = name
        .iter()
        .map(|&b| if b == b'\\' { b'/' } else { b })
        .collect();
    let mut paths = Vec::new();
    for bytes in [name, &slashed] {
        for path in [
            native_path(bytes),
            Some(PathBuf::from(text_from_bytes(bytes))),
        ] {
            paths.extend(path.filter(|p| !p.as_os_str().is_empty()));
        }
    }
    let mut seen = HashSet::new();
    paths.retain(|p: &PathBuf| seen.insert(p.as_os_str().to_owned()));
    paths
}

#[cfg(unix)]
fn native_path(bytes: &[u8]) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStrExt;
    // A zero byte cannot be in a path.
    (!bytes.contains(&0)).then(|| PathBuf::from(std::ffi::OsStr::from_bytes(bytes)))
}

#[cfg(not(unix))]
fn native_path(_bytes: &[u8]) -> Option<PathBuf> {
    None
}

/// Walks `relative` from `folder` part by part, taking the part as written where it exists and else the
/// first in sorted order that differs only in letter case.
fn ignoring_case(folder: &Path, relative: &Path) -> Option<PathBuf> {
    let mut path = folder.to_path_buf();
    for component in relative.components() {
        match component {
            Component::Normal(part) => {
                let exact = path.join(part);
                path = if exact.exists() {
                    exact
                } else {
                    other_case(&path, &part.to_string_lossy().to_lowercase())?
                };
            }
            other => path.push(other),
        }
    }
    path.is_file().then_some(path)
}

fn other_case(folder: &Path, lower: &str) -> Option<PathBuf> {
    // An empty path means the working folder to every call but this one.
    let listed = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let names = fs::read_dir(listed).ok()?.flatten().map(|e| e.file_name());
    let name = names
        .filter(|n| n.to_string_lossy().to_lowercase() == lower)
        .min()?;
    Some(folder.join(name))
}

fn by_its_end(folder: &Path, path: &Path) -> Option<PathBuf> {
    let parts: Vec<_> = path
        .components()
        .filter(|c| matches!(c, Component::Normal(_)))
        .collect();
    let ends = (1..parts.len()).map(|skip| parts[skip..].iter().collect::<PathBuf>());
    if let Some(found) = ends.into_iter().find_map(|e| ignoring_case(folder, &e)) {
        return Some(found);
    }
    let base = Path::new(parts.last()?);
    let beside = ignoring_case(folder, base);
    let usual = || {
        USUAL_FOLDERS
            .iter()
            .find_map(|usual| ignoring_case(folder, &Path::new(usual).join(base)))
    };
    beside.or_else(usual)
}
