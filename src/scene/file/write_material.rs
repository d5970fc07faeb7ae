//! `[[material]]` and `[[material.map]]` of a written scene file.

use std::path::Path;

use super::text::Text;
use super::write::{SaveError, SceneView, path_text};
use crate::texture::MapSlot;

/// Writes material `index` with all its maps.
pub(super) fn material(
    text: &mut Text,
    view: &SceneView<'_>,
    index: usize,
    base: &Path,
) -> Result<(), SaveError> {
    let materials = &view.settings.materials;
    let material = &materials[index];
    text.array_table("material", index);
    text.string("name", &material.name);
    let namesakes = materials.iter().filter(|m| m.name == material.name).count();
    if namesakes > 1 || material.name == "*" {
        text.raw("index", index);
    }
    text.color("kd", material.kd)?;
    text.color("ks", material.ks)?;
    text.single("shininess", material.shininess)?;
    text.single("reflectivity", material.reflectivity)?;
    text.or_default("amplitude", material.amplitude)?;
    text.or_default("midlevel", material.midlevel)?;
    text.double("default_amplitude", material.default_amplitude)?;
    if material.maps.is_empty() {
        text.raw("map", "[]");
    }
    for (i, slot) in material.maps.iter().enumerate() {
        text.sub_array_table("map", i);
        map(text, view, slot, base)?;
    }
    Ok(())
}

/// Writes what differs from the plainest use of the picture.
fn map(
    text: &mut Text,
    view: &SceneView<'_>,
    slot: &MapSlot,
    base: &Path,
) -> Result<(), SaveError> {
    let plain = MapSlot::new(slot.image, slot.role);
    let image = view.scene.images.get(slot.image);
    let name = match image.map(|image| (&image.path, &image.name)) {
        Some((Some(path), _)) => path_text(path, base)?,
        Some((None, name)) => name.clone(),
        None => String::new(),
    };
    text.string("image", &name);
    text.string("role", slot.role.name());
    if slot.enabled != plain.enabled {
        text.raw("enabled", slot.enabled);
    }
    if slot.channel != plain.channel {
        text.string("channel", slot.channel.name());
    }
    if slot.invert != plain.invert {
        text.raw("invert", slot.invert);
    }
    if slot.flip_green != plain.flip_green {
        text.raw("flip_green", slot.flip_green);
    }
    if slot.space != plain.space {
        text.string("space", slot.space.name());
    }
    if slot.axes != plain.axes {
        text.string("axes", &slot.axes.to_string());
    }
    if slot.destair != plain.destair {
        text.raw("destair", slot.destair);
    }
    if slot.flip_v != plain.flip_v {
        text.raw("flip_v", slot.flip_v);
    }
    if slot.wrap != plain.wrap {
        text.string("wrap", slot.wrap.name());
    }
    numbers(text, slot, &plain)?;
    text.string("note", &slot.note);
    Ok(())
}

fn numbers(text: &mut Text, slot: &MapSlot, plain: &MapSlot) -> Result<(), SaveError> {
    if slot.uv_scale != plain.uv_scale {
        text.singles("uv_scale", &slot.uv_scale)?;
    }
    if slot.uv_offset != plain.uv_offset {
        text.singles("uv_offset", &slot.uv_offset)?;
    }
    if slot.gain != plain.gain {
        text.single("gain", slot.gain)?;
    }
    if slot.bias != plain.bias {
        text.single("bias", slot.bias)?;
    }
    if slot.strength != plain.strength && slot.strength > 0.0 {
        text.single("strength", slot.strength)?;
    }
    if let Some(amplitude) = slot.baked_amplitude.filter(|&a| a > 0.0) {
        text.double("baked_amplitude", amplitude)?;
    }
    Ok(())
}
