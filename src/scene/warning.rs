//! What can be wrong with input.

use std::fmt;
use std::path::PathBuf;

/// Doubtful input that was read all the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoadWarning {
    /// The file.
    pub file: PathBuf,
    /// Line in it, from 1, where known.
    pub line: Option<usize>,
    /// What was found and what was done about it.
    pub message: String,
}

impl fmt::Display for LoadWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, "{line}:")?;
        }
        write!(f, " {}", self.message)
    }
}

/// Input that could not be read.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file could not be opened or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file was read but means nothing.
    #[error("{}:{} {message}", path.display(), line.map_or_else(String::new, |l| format!("{l}:")))]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Line in it, from 1, where known.
        line: Option<usize>,
        /// What is wrong.
        message: String,
    },
    /// Neither a file nor the name of a built-in scene.
    #[error("no such input: {0}")]
    Unknown(String),
    /// The user stopped the load.
    #[error("loading was cancelled")]
    Cancelled,
}
