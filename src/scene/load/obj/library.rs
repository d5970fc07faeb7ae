//! Which libraries an `mtllib` statement names.

use std::path::Path;

use super::lines::{Words, is_blank, trim};

/// Names of the libraries in what follows `mtllib`: one name if such a file lies beside the model.
pub(super) fn library_names<'a>(model: &Path, whole: &'a [u8]) -> Vec<&'a [u8]> {
    if exists_beside(model, whole) {
        vec![whole]
    } else {
        split_library_names(whole).collect()
    }
}

fn exists_beside(model: &Path, name: &[u8]) -> bool {
    std::str::from_utf8(name).is_ok_and(|name| {
        model
            .parent()
            .is_some_and(|folder| folder.join(name.replace('\\', "/")).is_file())
    })
}

/// Names of an `mtllib` that is no file as a whole: each ends with a word that ends in `.mtl`; where none
/// does, at every blank.
fn split_library_names(whole: &[u8]) -> impl Iterator<Item = &[u8]> {
    let has_extension =
        |word: &[u8]| word.len() >= 4 && word[word.len() - 4..].eq_ignore_ascii_case(b".mtl");
    let by_extension = Words(whole).any(has_extension);
    let mut rest = whole;
    std::iter::from_fn(move || {
        let text = trim(rest);
        let mut end = 0;
        while end < text.len() {
            end += text[end..].iter().position(|&b| !is_blank(b))?;
            end += text[end..]
                .iter()
                .position(|&b| is_blank(b))
                .unwrap_or(text.len() - end);
            if !by_extension || has_extension(&text[..end]) {
                break;
            }
        }
        let (name, after) = text.split_at(end);
        rest = after;
        (!name.is_empty()).then_some(name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn library_names_may_hold_spaces() {
        let split = |text: &'static str| -> Vec<_> {
            split_library_names(text.as_bytes())
                .map(|n| std::str::from_utf8(n).expect("ASCII"))
                .collect()
        };
        assert_eq!(split("a.mtl b.mtl"), ["a.mtl", "b.mtl"]);
        assert_eq!(split("my lib.mtl b.MTL"), ["my lib.mtl", "b.MTL"]);
        assert_eq!(split("a b"), ["a", "b"]);
        assert_eq!(split("a.mtl b"), ["a.mtl", "b"]);
    }
}
