//! Why a command could not run: one line each.

use std::path::PathBuf;

use crate::scene::LoadError;
use crate::scene::file::OverrideError;

/// Why a command could not run.
#[derive(Debug, thiserror::Error)]
pub(super) enum CliError {
    /// The input cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A `--set` cannot be done.
    #[error(transparent)]
    Override(#[from] OverrideError),
    /// The output's ending says no known format.
    #[error("{}: a picture is written as .png or .exr; which one, the name must say", .0.display())]
    UnknownFormat(PathBuf),
    /// There is no place for the output.
    #[error("{}: {message}", path.display())]
    NoPlace {
        /// The file.
        path: PathBuf,
        /// Why not.
        message: String,
    },
    /// The picture cannot be written.
    #[error(transparent)]
    Picture(#[from] crate::scene::save_picture::SaveError),
    /// Worker threads cannot be started.
    #[error("cannot start worker threads: {0}")]
    Threads(std::io::Error),
    /// The pixel is not in the picture.
    #[error("pixel {},{} is outside the picture of {} by {}", pixel[0], pixel[1], size[0], size[1])]
    OutsidePicture {
        /// Column and row.
        pixel: [u32; 2],
        /// Columns and rows of the picture.
        size: [u32; 2],
    },
    /// There is no relief to draw.
    #[error("--svg: {0}")]
    NoProfile(#[from] crate::render::NoProfile),
    /// Something cannot be timed.
    #[error(transparent)]
    Bench(#[from] crate::measure::bench::BenchError),
    /// Tests of the matrix of extremes fell short of their bars.
    #[error("{0} of the tests fell short")]
    FellShort(usize),
    /// A file of rays cannot be read or written.
    #[error(transparent)]
    Rays(#[from] crate::measure::bench::ray_file::RayFileError),
    /// Vector instructions that this machine does not have.
    #[error("--level: {0}")]
    Level(#[from] crate::geometry::simd::UnsupportedLevel),
    /// Nothing to do what was asked with.
    #[error("{}: {message}", path.display())]
    NothingToTime {
        /// What was given.
        path: PathBuf,
        /// What it lacks.
        message: String,
    },
    /// Nothing can be measured, or not on so many threads.
    #[error("{}: {source}", path.display())]
    Trade {
        /// What was to be measured.
        path: PathBuf,
        /// Why not.
        source: crate::measure::trade::TradeError,
    },
    /// A record that is not one.
    #[error("{}: {message}", path.display())]
    Record {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// Records that do not make one.
    #[error("--merge: {0}")]
    Merge(#[from] crate::measure::trade::MergeError),
    /// Cells are missing; what there is has been written.
    #[error("{0}")]
    Partial(String),
    /// Ctrl-C cannot be listened to.
    #[error("cannot listen for Ctrl-C: {0}")]
    Interrupt(#[from] ctrlc::Error),
    /// Arguments that do not go together, beyond what the parser sees.
    #[error("{0}")]
    Arguments(&'static str),
    /// No window; the line names what to do instead.
    #[error("{0}")]
    NoWindow(String),
    /// Standard output is not taking more, for another reason than that nobody reads it.
    #[error("cannot write to standard output: {0}")]
    Stdout(std::io::Error),
    /// Whoever read standard output has gone, as `head` does. That is nobody's fault.
    #[error("nobody reads standard output")]
    ReaderGone,
}
