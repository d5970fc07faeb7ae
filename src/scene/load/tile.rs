//! How large a map's tile is in the world, which gives a relief its natural amplitude.

use crate::geometry::{Normalization, TriangleMesh};
use crate::scene::LoadWarning;
use crate::shading::Material;
use crate::texture::{MapRole, MapSlot};
use std::path::Path;

/// Share of the tile's width that a relief is high where nothing gives its amplitude. 0.01–0.02 look
/// natural on most materials.
const NATURAL: f64 = 0.02;

/// Gives every material with a relief map but without an amplitude 2 % of its tile's median world width,
/// says so, and takes that amplitude for the one baked into its normal and slope maps unless known.
pub(super) fn settle_amplitudes(
    materials: &mut [Material],
    (mesh, normalization): (&TriangleMesh, &Normalization),
    model: &Path,
) -> Vec<LoadWarning> {
    let mut notes = Vec::new();
    let needs = |m: &Material| m.default_amplitude == 0.0 && relief(m).is_some();
    let mut widths = if materials.iter().any(needs) {
        widths(mesh, materials.len())
    } else {
        Vec::new()
    };
    for (index, material) in materials.iter_mut().enumerate() {
        let Some(slot) = relief(material) else {
            continue;
        };
        if material.default_amplitude == 0.0 {
            let [su, sv] = slot.uv_scale.map(f64::from);
            let tiles_per_uv = (su * sv).abs().sqrt();
            let width = median(&mut widths[index])
                .map(|width| f64::from(width) / normalization.scale / tiles_per_uv)
                .filter(|width| width.is_finite());
            // Without texture coordinates no map is looked up.
            let Some(width) = width else { continue };
            material.default_amplitude = NATURAL * width;
            notes.push(LoadWarning {
                file: model.to_owned(),
                line: None,
                message: format!(
                    "material '{}': no amplitude given for its relief; {:.4} taken, 2 % of its tile's median width",
                    material.name, material.default_amplitude
                ),
            });
        }
        let amplitude = material.amplitude.unwrap_or(material.default_amplitude);
        for slot in &mut material.maps {
            if matches!(slot.role, MapRole::Normal | MapRole::Slope) {
                slot.baked_amplitude.get_or_insert(amplitude);
            }
        }
    }
    notes
}

/// The map that carries the relief: heights first.
fn relief(material: &Material) -> Option<&MapSlot> {
    [MapRole::Height, MapRole::Normal, MapRole::Slope]
        .into_iter()
        .find_map(|role| material.map(role))
}

/// Internal width of one unit of uv on each triangle, by material: the root of the ratio of areas.
fn widths(mesh: &TriangleMesh, materials: usize) -> Vec<Vec<f32>> {
    let mut widths = vec![Vec::new(); materials];
    for (prim, attributes) in mesh.attributes.iter().enumerate() {
        let Some(list) = widths
            .get_mut(usize::from(attributes.material))
            .filter(|_| attributes.has_uv)
        else {
            continue;
        };
        let [p, q, r] = mesh.corners(prim as u32);
        let [a, b, c] = mesh.indices[prim].map(|i| mesh.uvs[i as usize]);
        let area = (q - p).cross(r - p).length();
        let uv_area = (b - a).perp_dot(c - a).abs();
        let width = (area / uv_area).sqrt();
        if width.is_finite() {
            list.push(width);
        }
    }
    widths
}

fn median(values: &mut [f32]) -> Option<f32> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::TriangleAttributes;
    use crate::math::LinearRgb;
    use glam::{DVec3, Vec2, Vec3};

    #[test]
    fn two_percent_of_the_tile() {
        // A 3 × 3 square in world units under 1.5 × 1.5 tiles: a tile is 2 wide.
        let normalization = Normalization {
            center: DVec3::ZERO,
            scale: 0.5,
        };
        let corners = [[0., 0.], [3., 0.], [3., 3.], [0., 3.]];
        let mesh = TriangleMesh {
            positions: corners
                .map(|[x, y]| normalization.internal_from_world(DVec3::new(x, y, 0.0)))
                .to_vec(),
            uvs: corners
                .map(|[x, y]| Vec2::new(x as f32, y as f32) * 0.5)
                .to_vec(),
            indices: vec![[0, 1, 2], [0, 2, 3]],
            attributes: vec![
                TriangleAttributes {
                    has_uv: true,
                    ..TriangleAttributes::default()
                };
                2
            ],
            normals: Vec::<Vec3>::new(),
        };
        let mut given = Material::matte("given", LinearRgb::WHITE);
        given.maps = vec![MapSlot::new(0, MapRole::Normal)];
        let mut plain = Material::matte("plain", LinearRgb::WHITE);
        let mut scaled = given.clone();
        scaled.maps[0].uv_scale = [4.0, 4.0];
        let settle = |m: &mut Material| {
            let model = Path::new("m.obj");
            settle_amplitudes(std::slice::from_mut(m), (&mesh, &normalization), model).len()
        };
        assert_eq!(settle(&mut given), 1);
        assert!((given.default_amplitude - 0.04).abs() < 1e-6);
        assert_eq!(given.maps[0].baked_amplitude, Some(given.default_amplitude));
        assert_eq!(settle(&mut scaled), 1);
        assert!((scaled.default_amplitude - 0.01).abs() < 1e-6);
        assert_eq!(settle(&mut plain), 0);
        let mut explicit = given.clone();
        explicit.default_amplitude = 0.3;
        explicit.maps[0].baked_amplitude = None;
        assert_eq!(settle(&mut explicit), 0);
        assert_eq!(explicit.maps[0].baked_amplitude, Some(0.3));
    }
}
