//! Opens a scene file: its text, its model, and what the one says about the other.

use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;

use super::apply::apply;
use super::document::{Document, ModelName};
use super::fault::{Fault, line_of};
use super::parse::parse;
use super::paths::folder;
use crate::scene::load::{LoadOptions, load_model};
use crate::scene::{LoadError, LoadWarning, LoadedScene, SceneSource, built_in, built_in_names};

/// No scene file is longer: its tables take up to a hundred times its length while it is read.
pub(super) const MAX_BYTES: u64 = 4 << 20;

/// Reads a scene file with its model and pictures.
///
/// What the file leaves out stays as the model brings it. Entries for materials that the model lacks become
/// warnings. A model is normalised if neither the options nor the file say otherwise. The source of a
/// generated scene stays [`SceneSource::BuiltIn`], that of a model becomes the scene file.
///
/// # Errors
/// [`LoadError::Invalid`] with line and key for a bad file; any error of the model.
pub fn read_scene(path: &Path, options: &LoadOptions) -> Result<LoadedScene, LoadError> {
    let text = read_text(path)?;
    let in_file = |fault: Fault| fault.in_file(path, &text);
    // The whole file is checked before anything slow begins.
    let document = parse(&text).map_err(in_file)?;
    let mut loaded = load_base(&document, path, &text, options)?;
    let doubts = apply(&document, &mut loaded, folder(path)).map_err(in_file)?;
    loaded
        .warnings
        .extend(doubts.into_iter().map(|doubt| LoadWarning {
            file: path.to_owned(),
            line: doubt.at.map(|at| line_of(&text, at)),
            message: doubt.message,
        }));
    if let Some(scene) = Arc::get_mut(&mut loaded.scene) {
        scene.name = path
            .file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy()
            .into_owned();
        if !matches!(scene.source, SceneSource::BuiltIn(_)) {
            scene.source = SceneSource::SceneFile(path.to_owned());
        }
    }
    Ok(loaded)
}

fn read_text(path: &Path) -> Result<String, LoadError> {
    let in_file = |source| LoadError::Io {
        path: path.to_owned(),
        source,
    };
    let file = std::fs::File::open(path).map_err(in_file)?;
    let mut bytes = Vec::new();
    let limited = &mut file.take(MAX_BYTES + 1);
    limited.read_to_end(&mut bytes).map_err(in_file)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(LoadError::Invalid {
            path: path.to_owned(),
            line: None,
            message: format!("more than {MAX_BYTES} bytes are too many for a scene file"),
        });
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..good]
            .iter()
            .filter(|&&b| b == b'\n')
            .count();
        LoadError::Invalid {
            path: path.to_owned(),
            line: Some(line),
            message: "not TOML: the text is not UTF-8".to_owned(),
        }
    })
}

/// The model or generated scene that the file is about.
fn load_base(
    document: &Document,
    path: &Path,
    text: &str,
    options: &LoadOptions,
) -> Result<LoadedScene, LoadError> {
    let options = LoadOptions {
        normalize: options.normalize && document.normalize.unwrap_or(true),
        monitor: Arc::clone(&options.monitor),
    };
    let at_key = |why: String| {
        let message = format!("`{}`: {why}", document.model.key);
        Fault::new(document.model.at, message).in_file(path, text)
    };
    match &document.model.value {
        ModelName::BuiltIn(name) => built_in::built_in(name, &options).ok_or_else(|| {
            let known = built_in_names().join(", ");
            at_key(format!(
                "there is no built-in scene \"{name}\"; there are {known}"
            ))
        }),
        ModelName::File(name) => {
            let model = folder(path).join(name);
            load_model(&model, &options).map_err(|error| match error {
                // A model that is not there is a fault of the scene file; a broken one is not.
                LoadError::Io { path, source } if path == model => {
                    at_key(format!("{}: {source}", path.display()))
                }
                other => other,
            })
        }
    }
}
