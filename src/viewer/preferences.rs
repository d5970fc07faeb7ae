//! What is remembered from one run to the next.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Most files in the list of recent ones.
const RECENT: usize = 8;

/// Kept in the window system's storage of the program.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Whether the panel is shown.
    pub panel: bool,
    /// Whether coarse previews may be shown while something moves.
    pub preview: bool,
    /// Files opened lately, newest first.
    pub recent: Vec<PathBuf>,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            panel: true,
            preview: true,
            recent: Vec::new(),
        }
    }
}

impl Preferences {
    const KEY: &'static str = "reliefscope";

    /// What was stored, or the defaults.
    #[must_use]
    pub fn load(storage: Option<&dyn eframe::Storage>) -> Self {
        storage
            .and_then(|storage| eframe::get_value(storage, Self::KEY))
            .unwrap_or_default()
    }

    /// Stores them.
    pub fn store(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, Self::KEY, self);
    }

    /// Puts a file at the top of the recent ones.
    pub fn note_opened(&mut self, path: &Path) {
        self.recent.retain(|other| other != path);
        self.recent.insert(0, path.to_owned());
        self.recent.truncate(RECENT);
    }
}
