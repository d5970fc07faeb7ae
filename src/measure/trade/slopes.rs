//! The slope map that a material lacks, made from its normal map: so that slopes stored in a file are measured, too.

use crate::scene::Scene;
use crate::shading::Material;
use crate::texture::{MapImage, MapRole, MapSlot, NormalSpace, RawImage, Samples};

/// Adds to each material with a normal map and no slope map one of the same relief, of as many bits.
///
/// Normals of an object, normals with gain or bias and pictures of fewer than three channels are left alone. Slopes
/// above 1 do not fit into such a file and are cut, as anybody's would be. Returns how many maps were added.
pub fn add_slope_maps(scene: &mut Scene, materials: &mut [Material]) -> usize {
    let mut added = 0;
    for material in materials {
        let normals = material.map(MapRole::Normal).filter(|slot| is_plain(slot));
        let Some(slot) = normals.filter(|_| material.map(MapRole::Slope).is_none()) else {
            continue;
        };
        let Some(image) = scene.images.get(slot.image) else {
            continue;
        };
        let Some(raw) = slopes(&image.raw) else {
            continue;
        };
        let slot = MapSlot {
            image: scene.images.len(),
            role: MapRole::Slope,
            note: "made from the normal map".to_owned(),
            ..slot.clone()
        };
        let name = format!("slopes of {}", image.name);
        scene.images.push(MapImage::new(name, None, raw));
        material.maps.push(slot);
        added += 1;
    }
    added
}

fn is_plain(slot: &MapSlot) -> bool {
    slot.space != NormalSpace::Object && (slot.gain, slot.bias) == (1.0, 0.0)
}

/// `R = (h_x + 1) / 2`, `G = (h_y + 1) / 2` of the slopes `h = −n / n_z` of each texel; the third channel means nothing.
fn slopes(normals: &RawImage) -> Option<RawImage> {
    if normals.channels < 3 {
        return None;
    }
    let places = (0..normals.height).flat_map(|y| (0..normals.width).map(move |x| (x, y)));
    let texel = |(x, y)| {
        let [nx, ny, nz] = [0, 1, 2].map(|c| 2.0 * normals.fraction(x, y, c) - 1.0);
        let slope = |n: f32| {
            let h = -n / nz.max(f32::MIN_POSITIVE);
            // Written so that NaN becomes no slope.
            (if h.is_nan() { 0.0 } else { h.clamp(-1.0, 1.0) } + 1.0) * 0.5
        };
        [slope(nx), slope(ny), 0.5]
    };
    let texels = places.flat_map(texel);
    let samples = match normals.samples {
        Samples::U8(_) => Samples::U8(texels.map(|c| (c * 255.0).round() as u8).collect()),
        Samples::U16(_) => Samples::U16(texels.map(|c| (c * 65_535.0).round() as u16).collect()),
        Samples::F32(_) => Samples::F32(texels.collect()),
    };
    Some(RawImage {
        channels: 3,
        samples,
        ..*normals
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_the_normals() {
        // Leaning by 3:4 against u; straight up; steeper than 1 along v.
        let normals = [[-0.6_f32, 0.0, 0.8], [0.0, 0.0, 1.0], [0.0, -0.9, 0.3]];
        let stored = normals.iter().flatten().map(|c| (c + 1.0) * 0.5);
        let image = RawImage {
            width: 3,
            height: 1,
            channels: 3,
            samples: Samples::F32(stored.collect()),
        };
        let made = slopes(&image).expect("three channels");
        let slope = |x| [0, 1].map(|c| 2.0 * made.fraction(x, 0, c) - 1.0);
        let near = |a: [f32; 2], b: [f32; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-6);
        assert!(near(slope(0), [0.75, 0.0]), "{:?}", slope(0));
        assert!(near(slope(1), [0.0, 0.0]), "{:?}", slope(1));
        assert!(near(slope(2), [0.0, 1.0]), "{:?}", slope(2));
    }
}
