//! Paths as a scene file writes them: relative to its folder where that is shorter than absolute.

use std::path::{Component, Path, PathBuf};

/// One spelling per file: links and dots resolved where the file exists, absolute otherwise.
pub(super) fn settled(path: &Path) -> PathBuf {
    // The empty path is the working folder, as in joins.
    let path = if path == Path::new("") {
        Path::new(".")
    } else {
        path
    };
    path.canonicalize()
        .or_else(|_| std::path::absolute(path))
        .unwrap_or_else(|_| path.to_owned())
}

/// The folder of a file; empty for a bare name, so that what is joined to it stays as short.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// `path` as seen from `base`; absolute if they share nothing but the root.
pub(super) fn relative(path: &Path, base: &Path) -> PathBuf {
    let (path, base) = (settled(path), settled(base));
    let shared = path
        .components()
        .zip(base.components())
        .take_while(|(a, b)| a == b)
        .collect::<Vec<_>>();
    let is_name = |c: &(Component<'_>, Component<'_>)| matches!(c.0, Component::Normal(_));
    if !shared.iter().any(is_name) {
        return path;
    }
    let up = base.components().skip(shared.len()).map(|_| "..");
    let down = path.components().skip(shared.len());
    up.map(PathBuf::from)
        .chain(down.map(|c| PathBuf::from(c.as_os_str())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_seen_from_the_folder() {
        let cases = [
            ("/a/b/c.obj", "/a/b", "c.obj"),
            ("/a/b/maps/c.png", "/a/b", "maps/c.png"),
            ("/a/x/c.obj", "/a/b", "../x/c.obj"),
            ("/z/c.obj", "/a/b", "/z/c.obj"),
        ];
        for (path, base, wanted) in cases {
            let found = relative(Path::new(path), Path::new(base));
            assert_eq!(found, Path::new(wanted), "{path} from {base}");
        }
    }
}
