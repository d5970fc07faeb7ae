//! The one door for picture decoding: files to raw samples, within limits, never a panic.

use std::collections::HashMap;
use std::fmt::Display;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::grey_floats::{grey_exr, grey_tiff};
use crate::texture::{MapImage, RawImage, Samples};

/// What a picture may cost before it is refused. Checked against the header, before samples are allocated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PictureLimits {
    /// Columns and rows at the most.
    pub max_side: u32,
    /// Bytes of decoded samples at the most.
    pub max_bytes: u64,
}

/// What a file may hold beside twice its samples: headers, colour profiles.
const SPARE_BYTES: u64 = 1 << 20;

impl Default for PictureLimits {
    /// 16384² pixels, 2 GiB: enough for four channels of 16 bits at full size.
    fn default() -> Self {
        Self {
            max_side: 16_384,
            max_bytes: 2 << 30,
        }
    }
}

/// A decoded file.
#[derive(Debug, Clone, PartialEq)]
pub struct DecodedPicture {
    /// The samples at the depth of the file; palettes and fewer than 8 bits are expanded to 8.
    pub image: RawImage,
    /// Samples of a float file that were infinite or not a number and became 0.
    pub replaced: usize,
}

/// Why a picture could not be used; says nothing of its path.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PictureError(String);

impl PictureError {
    /// With the words of a decoder.
    pub(super) fn new(cause: &dyn Display) -> Self {
        Self(cause.to_string())
    }
}

/// Decodes a picture: PNG, JPEG, TGA, BMP, TIFF, Radiance HDR, OpenEXR, WebP or GIF (first frame).
///
/// One-channel float TIFF and OpenEXR files are read too. The format is told from the content; the extension counts only where the content has no mark, as in
/// most TGA files. 16 bits stay 16 and floats stay floats. Colour profiles and gamma marks are ignored:
/// what samples mean is the caller's business.
///
/// # Errors
/// [`PictureError`] if the file cannot be read, is damaged, exceeds `limits` or crashes its decoder.
pub fn decode_picture(path: &Path, limits: &PictureLimits) -> Result<DecodedPicture, PictureError> {
    // Nothing outlives the closure but its result, so no broken state can be seen.
    catch_unwind(AssertUnwindSafe(|| decode(path, limits)))
        .unwrap_or_else(|_| Err(PictureError::new(&"its decoder crashed")))
}

fn decode(path: &Path, limits: &PictureLimits) -> Result<DecodedPicture, PictureError> {
    let io = |e: std::io::Error| PictureError::new(&e);
    // Asked before it is opened: opening a pipe would wait for whoever writes to it.
    let facts = std::fs::metadata(path).map_err(io)?;
    if !facts.is_file() {
        return Err(PictureError::new(&"not a plain file"));
    }
    // Decoders may hold all of it beside the samples.
    let most = limits
        .max_bytes
        .saturating_mul(2)
        .saturating_add(SPARE_BYTES);
    if facts.len() > most {
        let message = format!("a file of {} bytes; at most {most} are read", facts.len());
        return Err(PictureError(message));
    }
    let mut file = BufReader::new(File::open(path).map_err(io)?);
    let Some(format) = format_of(&mut file, path).map_err(io)? else {
        return Err(PictureError::new(&"not a picture of a known format"));
    };
    let general = decode_general(file, format, limits);
    if general.is_ok() || !matches!(format, ImageFormat::OpenExr | ImageFormat::Tiff) {
        return general;
    }
    let again = BufReader::new(File::open(path).map_err(io)?);
    let grey = match format {
        ImageFormat::OpenExr => grey_exr(again, limits),
        _ => grey_tiff(again, limits),
    };
    // If neither can read it, the general decoder knows best why.
    let mut image = grey.or_else(|_| general.map(|decoded| decoded.image))?;
    let replaced = image.make_finite();
    Ok(DecodedPicture { image, replaced })
}

fn decode_general(
    file: BufReader<File>,
    format: ImageFormat,
    limits: &PictureLimits,
) -> Result<DecodedPicture, PictureError> {
    let failed = |e: image::ImageError| PictureError::new(&e);
    let mut reader = ImageReader::with_format(file, format);
    let mut decoder_limits = Limits::no_limits();
    decoder_limits.max_alloc = Some(limits.max_bytes);
    reader.limits(decoder_limits);
    let decoder = reader.into_decoder().map_err(failed)?;
    check(decoder.dimensions(), decoder.total_bytes(), limits)?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(failed)?;
    Ok(raw_samples(decoded))
}

/// Refuses what is empty or too large, before its samples are asked for.
pub(super) fn check(
    (width, height): (u32, u32),
    bytes: u64,
    limits: &PictureLimits,
) -> Result<(), PictureError> {
    let side = limits.max_side;
    if width == 0 || height == 0 {
        return Err(PictureError::new(&"it has no pixels"));
    }
    if width > side || height > side {
        let message = format!("{width}×{height} pixels; at most {side}×{side} are read");
        return Err(PictureError(message));
    }
    if bytes > limits.max_bytes {
        let message = format!(
            "{width}×{height} pixels take {bytes} bytes; at most {} are read",
            limits.max_bytes
        );
        return Err(PictureError(message));
    }
    Ok(())
}

/// By the first bytes, then by the mark that version 2 of TGA puts at the end, then by extension.
fn format_of<R: BufRead + Seek>(file: &mut R, path: &Path) -> std::io::Result<Option<ImageFormat>> {
    let mut start = Vec::new();
    file.by_ref().take(16).read_to_end(&mut start)?;
    file.rewind()?;
    if let Ok(format) = image::guess_format(&start) {
        return Ok(Some(format));
    }
    let by_name = ImageFormat::from_path(path).ok();
    if by_name != Some(ImageFormat::Tga) && has_tga_footer(file)? {
        return Ok(Some(ImageFormat::Tga));
    }
    Ok(by_name)
}

fn has_tga_footer<R: BufRead + Seek>(file: &mut R) -> std::io::Result<bool> {
    const MARK: &[u8] = b"TRUEVISION-XFILE.\0";
    let mut end = Vec::new();
    // A file shorter than the mark cannot be wound back that far: it has none.
    if file.seek(SeekFrom::End(-(MARK.len() as i64))).is_ok() {
        file.read_to_end(&mut end)?;
    }
    file.rewind()?;
    Ok(end == MARK)
}

fn raw_samples(decoded: DynamicImage) -> DecodedPicture {
    let (width, height) = (decoded.width(), decoded.height());
    let mut channels = decoded.color().channel_count();
    let samples = match decoded {
        DynamicImage::ImageLuma8(b) => Samples::U8(b.into_raw()),
        DynamicImage::ImageLumaA8(b) => Samples::U8(b.into_raw()),
        DynamicImage::ImageRgb8(b) => Samples::U8(b.into_raw()),
        DynamicImage::ImageRgba8(b) => Samples::U8(b.into_raw()),
        DynamicImage::ImageLuma16(b) => Samples::U16(b.into_raw()),
        DynamicImage::ImageLumaA16(b) => Samples::U16(b.into_raw()),
        DynamicImage::ImageRgb16(b) => Samples::U16(b.into_raw()),
        DynamicImage::ImageRgba16(b) => Samples::U16(b.into_raw()),
        DynamicImage::ImageRgb32F(b) => Samples::F32(b.into_raw()),
        DynamicImage::ImageRgba32F(b) => Samples::F32(b.into_raw()),
        // The enum may grow; floats hold whatever comes.
        other => {
            channels = 4;
            Samples::F32(other.into_rgba32f().into_raw())
        }
    };
    let mut image = RawImage {
        width,
        height,
        channels,
        samples,
    };
    let replaced = image.make_finite();
    DecodedPicture { image, replaced }
}

/// Pictures of one scene: each file is decoded once, however many slots use it.
#[derive(Debug, Default)]
pub struct PictureStore {
    /// Decoded so far; slots index this list.
    pub images: Vec<MapImage>,
    limits: PictureLimits,
    by_file: HashMap<PathBuf, Result<usize, PictureError>>,
}

impl PictureStore {
    /// A store that already holds `images`; those that came from files are not decoded again.
    #[must_use]
    pub fn with_images(images: Vec<MapImage>) -> Self {
        let known = images.iter().enumerate();
        let by_file = known
            .filter_map(|(i, image)| Some((identity(image.path.as_deref()?), Ok(i))))
            .collect();
        Self {
            images,
            limits: PictureLimits::default(),
            by_file,
        }
    }

    /// Index of the picture at `path`, decoded on the first call. Two paths to one file give one picture.
    /// The remark, on the first call only, says how many samples were not finite.
    ///
    /// # Errors
    /// As [`decode_picture`]; a broken file is not read twice.
    pub fn load(&mut self, path: &Path) -> Result<(usize, Option<String>), PictureError> {
        let file = identity(path);
        if let Some(known) = self.by_file.get(&file) {
            return known.clone().map(|index| (index, None));
        }
        let decoded = decode_picture(path, &self.limits);
        let entry = decoded.as_ref().map(|_| self.images.len());
        self.by_file.insert(file, entry.map_err(Clone::clone));
        let DecodedPicture { image, replaced } = decoded?;
        let name = path
            .file_name()
            .map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        self.images
            .push(MapImage::new(name, Some(path.to_path_buf()), image));
        let remark =
            (replaced > 0).then(|| format!("{replaced} sample(s) were not finite and became 0"));
        Ok((self.images.len() - 1, remark))
    }
}

/// The file behind a path, whatever links and dots lead there.
fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}
