//! Float pictures of one channel, which the general decoder does not know: height maps of terrain and of
//! displacement bakes often are.

use std::io::{BufRead, Seek};

use exr::prelude::*;
use tiff::decoder::{Decoder, DecodingResult, Limits};

use super::picture::{PictureError, PictureLimits, check};
use crate::texture::{RawImage, Samples};

/// Channels of an OpenEXR file by their claim to be *the* channel; without any of these the first one is.
const NAMES: [&str; 4] = ["Y", "V", "Z", "R"];

/// One channel of the first layer of an OpenEXR file without red, green and blue. Not finite ones may be
/// among the samples.
pub(super) fn grey_exr<R: BufRead + Seek>(
    mut file: R,
    limits: &PictureLimits,
) -> std::result::Result<RawImage, PictureError> {
    let failed = |e: exr::error::Error| PictureError::new(&e);
    let meta = MetaData::read_from_buffered(&mut file, false).map_err(failed)?;
    let Some(header) = meta.headers.iter().find(|h| !h.deep) else {
        return Err(PictureError::new(&"it holds only deep data"));
    };
    let size = header.layer_size;
    let side = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let (width, height) = (side(size.width()), side(size.height()));
    // The reader holds all channels until it is done.
    let channels = header.channels.list.len() as u64;
    let bytes = u64::from(width) * u64::from(height) * 4 * channels;
    check((width, height), bytes, limits)?;
    file.rewind().map_err(|e| PictureError::new(&e))?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(file)
        .map_err(failed)?;
    let list = &image.layer_data.channel_data.list;
    let named = |name: &&str| list.iter().find(|c| c.name == **name);
    let chosen = NAMES.iter().find_map(named).or(list.first());
    let size = image.layer_data.size;
    let samples = chosen.map(|c| c.sample_data.values_as_f32().collect::<Vec<f32>>());
    // Subsampled channels have fewer samples than the picture has pixels.
    match samples {
        Some(samples) if samples.len() == size.area() => Ok(RawImage {
            width: side(size.width()),
            height: side(size.height()),
            channels: 1,
            samples: Samples::F32(samples),
        }),
        _ => Err(PictureError::new(&"it has no channel of full size")),
    }
}

/// A grey TIFF of floats (as stored; 64 bits become 32). Not finite ones may be among the samples.
pub(super) fn grey_tiff<R: BufRead + Seek>(
    file: R,
    limits: &PictureLimits,
) -> std::result::Result<RawImage, PictureError> {
    let failed = |e: tiff::TiffError| PictureError::new(&e);
    let mut tiff_limits = Limits::default();
    tiff_limits.decoding_buffer_size = usize::try_from(limits.max_bytes).unwrap_or(usize::MAX);
    let mut decoder = Decoder::new(file).map_err(failed)?.with_limits(tiff_limits);
    let (width, height) = decoder.dimensions().map_err(failed)?;
    let tiff::ColorType::Gray(bits) = decoder.colortype().map_err(failed)? else {
        return Err(PictureError::new(&"its colours are of an unknown kind"));
    };
    let bytes = u64::from(width) * u64::from(height) * u64::from(bits).div_ceil(8);
    check((width, height), bytes, limits)?;
    let samples: Vec<f32> = match decoder.read_image().map_err(failed)? {
        DecodingResult::F16(s) => s.into_iter().map(f32::from).collect(),
        DecodingResult::F32(s) => s,
        DecodingResult::F64(s) => s.into_iter().map(|x| x as f32).collect(),
        _ => return Err(PictureError::new(&"its samples are of an unknown kind")),
    };
    if samples.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(PictureError::new(&"its samples do not fill it"));
    }
    Ok(RawImage {
        width,
        height,
        channels: 1,
        samples: Samples::F32(samples),
    })
}
