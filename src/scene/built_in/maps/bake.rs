//! From a pattern to pictures.

use super::dual::Dual;
use super::{Pattern, Texel};
use crate::texture::{RawImage, Samples};

/// The pictures of one material, all of the same size, row 0 at v = 1.
#[derive(Debug, Clone, PartialEq)]
pub struct MapSet {
    /// 16-bit grey, white is high.
    pub height: RawImage,
    /// 8-bit tangent-space normals, +Y up (OpenGL), with the baked amplitude in them.
    pub normal: RawImage,
    /// 8-bit sRGB.
    pub albedo: RawImage,
}

/// The texel in column `x`, row `y` of a picture of `size · size`, evaluated at its centre.
#[must_use]
pub fn texel_at(pattern: &dyn Pattern, [x, y]: [u32; 2], size: u32) -> Texel {
    let step = 1.0 / f64::from(size);
    let u = (f64::from(x) + 0.5) * step;
    let v = 1.0 - (f64::from(y) + 0.5) * step;
    pattern.texel(Dual::u(u), Dual::v(v))
}

/// Samples a pattern at texel centres. `amplitude` is the relief's depth from stored 0 to stored 1 as a
/// fraction of the tile; the normal map is `normalize(−a·∂h/∂u, −a·∂h/∂v, 1)` of the exact derivatives.
///
/// Bands of rows are shared among the processor's cores; each texel depends only on its place.
///
/// # Panics
/// If `size` is 0.
#[must_use]
pub fn bake(pattern: &dyn Pattern, size: u32, amplitude: f64) -> MapSet {
    assert!(size > 0, "a picture has at least one texel");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let rows_per_band = (size as usize).div_ceil(cores).max(1);
    let count = size as usize * size as usize;
    let mut heights = vec![0_u16; count];
    let mut normals = vec![[0_u8; 3]; count];
    let mut colors = vec![[0_u8; 3]; count];
    std::thread::scope(|scope| {
        let texels_per_band = rows_per_band * size as usize;
        let bands = heights
            .chunks_mut(texels_per_band)
            .zip(normals.chunks_mut(texels_per_band))
            .zip(colors.chunks_mut(texels_per_band));
        for (i, ((heights, normals), colors)) in bands.enumerate() {
            scope.spawn(move || {
                for (k, ((height, normal), color)) in
                    heights.iter_mut().zip(normals).zip(colors).enumerate()
                {
                    let place = i * texels_per_band + k;
                    let xy = [place as u32 % size, place as u32 / size];
                    let texel = texel_at(pattern, xy, size);
                    *height = (texel.height.value.clamp(0.0, 1.0) * 65_535.0 + 0.5) as u16;
                    *normal = encode_normal(texel.height, amplitude);
                    *color = texel.paint.to_bytes();
                }
            });
        }
    });
    let image = |channels, samples| RawImage {
        width: size,
        height: size,
        channels,
        samples,
    };
    MapSet {
        height: image(1, Samples::U16(heights)),
        normal: image(3, Samples::U8(normals.into_flattened())),
        albedo: image(3, Samples::U8(colors.into_flattened())),
    }
}

/// The normal of a height with its derivatives, as `255·(n + 1)/2` rounded.
fn encode_normal(height: Dual, amplitude: f64) -> [u8; 3] {
    let (x, y) = (-amplitude * height.du, -amplitude * height.dv);
    let scale = 1.0 / (x * x + y * y + 1.0).sqrt();
    [x, y, 1.0].map(|c| ((c * scale * 0.5 + 0.5) * 255.0 + 0.5) as u8)
}
