//! Amplitudes where files give none: a share of the tile's width on the model, or what a normal map shows.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::compare::compare;
use crate::geometry::{Normalization, TriangleAttributes, TriangleMesh};
use crate::shading::Material;
use crate::texture::{MapImage, MapRole, MapSlot};

/// Natural reliefs measure one to two hundredths of their tile; 0.05 already gives bricks near-vertical walls.
const DEFAULT_SHARE: f64 = 0.02;

/// Triangles that a thread takes at a time.
const PIECE: usize = 8192;

/// Fills in what a material's files leave open, once the mesh is there; says so in slots and in notes.
///
/// - `default_amplitude`, where it is 0 (not given): 2 % of the tile's median width on the material's
///   triangles, in world units (see below); 0 without usable texture coordinates.
/// - `baked_amplitude` of normal and slope slots, where it is `None`: the amplitude at which the material's
///   height map has the same slopes, if there is such a map and the two match; else the material's own or
///   default amplitude. Divided by the slot's strength. Stays `None` where that is 0.
///
/// A tile is one repeat of the picture, the slot's `uv_scale` counted in. Its width along u is `1/|∇u|` on a
/// triangle; of both directions the geometric mean counts, and of all triangles the median by area.
///
/// Returns a note for every material with a map of relief whose amplitude the files left open.
pub fn fill_default_amplitudes(
    materials: &mut [Material],
    images: &[MapImage],
    mesh: &TriangleMesh,
    normalization: &Normalization,
) -> Vec<String> {
    let widths = median_widths(materials.len(), mesh, normalization);
    let mut notes = Vec::new();
    for (material, width) in materials.iter_mut().zip(widths) {
        notes.extend(fill_default(material, width));
        fill_baked(material, images, width);
    }
    notes
}

fn fill_default(material: &mut Material, width: Option<f64>) -> Option<String> {
    if material.default_amplitude > 0.0 {
        return None;
    }
    let relief = [MapRole::Height, MapRole::Normal, MapRole::Slope];
    let slot = relief.into_iter().find_map(|role| material.map(role));
    let width = width.map(|w| slot.map_or(w, |slot| tile_width(w, slot)));
    let amplitude = width.map_or(0.0, |w| w * DEFAULT_SHARE);
    let has_relief = slot.is_some();
    material.default_amplitude = amplitude;
    let note = match width {
        Some(width) => format!(
            "material \"{}\": amplitude {amplitude:.4} is 2 % of its tile's median width, {width:.4}",
            material.name
        ),
        None => format!(
            "material \"{}\": no usable texture coordinates, so its relief has amplitude 0",
            material.name
        ),
    };
    (has_relief && material.amplitude.is_none()).then_some(note)
}

fn fill_baked(material: &mut Material, images: &[MapImage], width: Option<f64>) {
    let heights = material.map(MapRole::Height).cloned();
    let fallback = material
        .amplitude
        .filter(|&a| a > 0.0)
        .unwrap_or(material.default_amplitude);
    for slot in &mut material.maps {
        let open =
            matches!(slot.role, MapRole::Normal | MapRole::Slope) && slot.baked_amplitude.is_none();
        if !open {
            continue;
        }
        let estimate = heights
            .as_ref()
            .zip(width)
            .and_then(|(heights, width)| estimate(slot, heights, images, width));
        let (amplitude, source) = match estimate {
            Some(estimate) => (estimate, "estimated against the height map"),
            None => (fallback, "as nothing tells otherwise"),
        };
        let baked = amplitude / f64::from(slot.strength);
        if baked > 0.0 && baked.is_finite() {
            slot.baked_amplitude = Some(baked);
            if !slot.note.is_empty() {
                slot.note += "; ";
            }
            slot.note += &format!("baked for amplitude {baked:.4}, {source}");
        }
    }
}

/// World amplitude at which `heights` has the slopes of `normals`.
fn estimate(normals: &MapSlot, heights: &MapSlot, images: &[MapImage], width: f64) -> Option<f64> {
    let image = |slot: &MapSlot| images.get(slot.image);
    let pair = ((heights, image(heights)?), (normals, image(normals)?));
    let comparison = compare(pair.0, pair.1).filter(|c| c.is_telling())?;
    Some(comparison.amplitude * tile_width(width, normals))
}

/// Width of a slot's tile where one unit of uv measures `width`.
fn tile_width(width: f64, slot: &MapSlot) -> f64 {
    let [u, v] = slot.uv_scale.map(|s| f64::from(s).abs());
    let scale = (u * v).sqrt();
    if scale > 0.0 { width / scale } else { width }
}

/// For every material the median width of one unit of uv, world units.
fn median_widths(
    count: usize,
    mesh: &TriangleMesh,
    normalization: &Normalization,
) -> Vec<Option<f64>> {
    let mut samples: Vec<Vec<[f64; 2]>> = vec![Vec::new(); count];
    let pieces: Vec<Vec<_>> = mesh
        .attributes
        .par_chunks(PIECE)
        .enumerate()
        .map(|(piece, attributes)| {
            let with_uv = (piece * PIECE..)
                .zip(attributes)
                .filter(|(_, a)| a.has_uv && !mesh.uvs.is_empty());
            let sample = |(prim, a): (usize, &TriangleAttributes)| {
                width_and_area(mesh, prim).map(|sample| (usize::from(a.material), sample))
            };
            with_uv.filter_map(sample).collect()
        })
        .collect();
    for (material, sample) in pieces.into_iter().flatten() {
        if let Some(of_material) = samples.get_mut(material) {
            of_material.push(sample);
        }
    }
    samples
        .into_par_iter()
        .map(|s| weighted_median(s).map(|w| w / normalization.scale))
        .collect()
}

/// Width of one unit of uv on a triangle and the triangle's area, internal units; `None` where either the
/// triangle or its texture has no area.
fn width_and_area(mesh: &TriangleMesh, prim: usize) -> Option<[f64; 2]> {
    let corners = mesh.indices[prim].map(|i| i as usize);
    let [p0, p1, p2] = corners.map(|i| mesh.positions[i].as_dvec3());
    let [t0, t1, t2] = corners.map(|i| mesh.uvs[i].as_dvec2());
    let (e1, e2) = (p1 - p0, p2 - p0);
    let (d1, d2): (DVec2, DVec2) = (t1 - t0, t2 - t0);
    let normal = e1.cross(e2);
    let double_area_squared = normal.length_squared();
    // ∇u = (Δu₁ (e₂ × n) + Δu₂ (n × e₁)) / |n|², and likewise for v.
    let (across_1, across_2): (DVec3, DVec3) = (e2.cross(normal), normal.cross(e1));
    let gradient = |a: f64, b: f64| (across_1 * a + across_2 * b).length() / double_area_squared;
    let (grad_u, grad_v) = (gradient(d1.x, d2.x), gradient(d1.y, d2.y));
    let width = (grad_u * grad_v).sqrt().recip();
    let is_usable = d1.perp_dot(d2) != 0.0 && width.is_finite() && width > 0.0;
    is_usable.then(|| [width, double_area_squared.sqrt() * 0.5])
}

/// The value at which half of the weight is reached; `samples` are values and weights.
///
/// Hoare's selection with weights: large models have a sample for every triangle, and sorting them all
/// would take longer than finding them.
fn weighted_median(mut samples: Vec<[f64; 2]>) -> Option<f64> {
    let weight = |samples: &[[f64; 2]]| samples.iter().map(|s| s[1]).sum::<f64>();
    let half = weight(&samples) * 0.5;
    let (mut rest, mut below) = (&mut samples[..], 0.0);
    while rest.len() > 1 {
        let middle = rest.len() / 2;
        rest.select_nth_unstable_by(middle, |a, b| {
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
        });
        let (left, right) = rest.split_at_mut(middle);
        let with_left = below + weight(left);
        rest = if with_left >= half {
            left
        } else {
            below = with_left;
            right
        };
    }
    rest.first().map(|s| s[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_weight_is_at_the_median_or_below() {
        assert_eq!(weighted_median(Vec::new()), None);
        for count in 1..60_u32 {
            let sample = |i| [f64::from(i * 37 % 61 / 2), f64::from(1 + i * 11 % 7)];
            let samples: Vec<_> = (0..count).map(sample).collect();
            let mut sorted = samples.clone();
            sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let half = sorted.iter().map(|s| s[1]).sum::<f64>() * 0.5;
            let mut weight = 0.0;
            let expected = sorted.iter().find(|s| {
                weight += s[1];
                weight >= half
            });
            assert_eq!(weighted_median(samples), expected.map(|s| s[0]), "{count}");
        }
    }
}
