//! What can be wrong with a file of rays.

use std::path::PathBuf;

/// A file of rays, or of hits, that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RayFileError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The first line is not that of a file of rays.
    #[error("{}:1: {message}", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// The numbers are not what the first line says, or make no sense.
    #[error("{}: byte {offset}: {message}", path.display())]
    Data {
        /// The file.
        path: PathBuf,
        /// Place in the file, from 0.
        offset: u64,
        /// What is wrong.
        message: String,
    },
}
