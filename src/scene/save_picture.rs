//! Writes pictures: a file is there whole or not at all.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageBuffer, ImageFormat};
use tempfile::{Builder, NamedTempFile};

/// A picture that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The picture's file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The samples do not make a picture of that size, or the format cannot hold it.
    #[error("{}: {message}", path.display())]
    Encode {
        /// The picture's file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
}

/// Writes an 8-bit RGB PNG. `pixels` are sRGB-encoded, `size` is columns and rows, row 0 is on top.
///
/// Equal pixels give equal bytes. An existing file is replaced once the new one is complete.
///
/// # Errors
/// [`SaveError`] if the count of pixels does not fit `size`, or the file cannot be written.
pub fn write_png(path: &Path, size: [u32; 2], pixels: &[[u8; 3]]) -> Result<(), SaveError> {
    let buffer = ImageBuffer::from_raw(size[0], size[1], pixels.as_flattened().to_vec());
    let picture = checked(path, size, pixels.len(), buffer)?;
    write(path, &DynamicImage::ImageRgb8(picture), ImageFormat::Png)
}

/// The bytes of an 8-bit RGB PNG, to put it into another file; `None` if the count of pixels does not fit `size`.
#[must_use]
pub fn png_bytes(size: [u32; 2], pixels: &[[u8; 3]]) -> Option<Vec<u8>> {
    let fits = u64::from(size[0]) * u64::from(size[1]) == pixels.len() as u64;
    let samples = pixels.as_flattened().to_vec();
    let picture = ImageBuffer::from_raw(size[0], size[1], samples).filter(|_| fits)?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    let written = DynamicImage::ImageRgb8(picture).write_to(&mut bytes, ImageFormat::Png);
    written.ok().map(|()| bytes.into_inner())
}

/// Writes a 32-bit float RGB OpenEXR file. `pixels` are linear, `size` is columns and rows, row 0 is on top.
///
/// # Errors
/// [`SaveError`] if the count of pixels does not fit `size`, or the file cannot be written.
pub fn write_exr(path: &Path, size: [u32; 2], pixels: &[[f32; 3]]) -> Result<(), SaveError> {
    let buffer = ImageBuffer::from_raw(size[0], size[1], pixels.as_flattened().to_vec());
    let picture = checked(path, size, pixels.len(), buffer)?;
    write(
        path,
        &DynamicImage::ImageRgb32F(picture),
        ImageFormat::OpenExr,
    )
}

fn checked<T>(
    path: &Path,
    [width, height]: [u32; 2],
    count: usize,
    buffer: Option<T>,
) -> Result<T, SaveError> {
    // The buffer accepts more samples than it needs.
    let fits = width > 0 && height > 0 && u64::from(width) * u64::from(height) == count as u64;
    buffer.filter(|_| fits).ok_or_else(|| SaveError::Encode {
        path: path.to_path_buf(),
        message: format!("{count} pixels do not make a picture of {width}×{height}"),
    })
}

/// Encodes into a temporary file beside `path`, then renames it.
fn write(path: &Path, picture: &DynamicImage, format: ImageFormat) -> Result<(), SaveError> {
    let io = |source| SaveError::Io {
        path: path.to_path_buf(),
        source,
    };
    let file = temporary_beside(path).map_err(io)?;
    let mut writer = BufWriter::new(file.as_file());
    picture.write_to(&mut writer, format).map_err(|e| match e {
        image::ImageError::IoError(source) => io(source),
        other => SaveError::Encode {
            path: path.to_path_buf(),
            message: other.to_string(),
        },
    })?;
    writer.flush().map_err(io)?;
    drop(writer);
    file.persist(path).map_err(|e| io(e.error))?;
    Ok(())
}

/// A temporary file in the folder of `path`: a rename is atomic only within one file system.
pub(crate) fn temporary_beside(path: &Path) -> std::io::Result<NamedTempFile> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = Builder::new();
    builder.prefix(".reliefscope-");
    // Temporary files are private by default; a picture gets what the user's mask allows.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}
