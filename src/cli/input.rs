//! From an input and changes to it to something that can be rendered.

use std::path::Path;
use std::sync::Arc;

use super::error::CliError;
use super::options::SceneOptions;
use super::output;
use crate::render::Snapshot;
use crate::scene::file::apply_overrides;
use crate::scene::load::LoadOptions;
use crate::scene::{LoadedScene, open};

/// Size of a picture where neither the scene nor the user says one, pixels.
pub(super) const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// Reads an input; its warnings go to standard error.
pub(super) fn load(input: &Path, options: &LoadOptions) -> Result<LoadedScene, CliError> {
    let loaded = open(input, options)?;
    output::warn(&loaded.warnings);
    Ok(loaded)
}

/// Reads a scene and changes it. What has its own option goes before `--set`.
pub(super) fn load_changed(options: &SceneOptions) -> Result<LoadedScene, CliError> {
    let mut loaded = load(&options.input, &options.load)?;
    let told = loaded.warnings.len();
    apply_overrides(&mut loaded, &options.overrides)?;
    output::warn(&loaded.warnings[told..]);
    if let Some(method) = options.method {
        loaded.settings.mapping.method = method;
    }
    loaded.size = options.size.or(loaded.size);
    Ok(loaded)
}

/// What the renderer takes.
pub(super) fn snapshot(loaded: LoadedScene) -> Snapshot {
    Snapshot {
        size: loaded.size.unwrap_or(DEFAULT_SIZE),
        scene: loaded.scene,
        settings: Arc::new(loaded.settings),
    }
}
