//! `inspect`: what an input holds.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::error::CliError;
use super::input::load;
use super::options::InspectOptions;
use super::output;
use crate::scene::{LoadedScene, Scene};
use crate::shading::Material;
use crate::texture::{Levels, MapImage, MapRole, MapSlot, NormalAxes, NormalSpace};

/// Runs the command.
pub(super) fn run(options: &InspectOptions) -> Result<(), CliError> {
    let loaded = load(&options.input, &options.load)?;
    if options.json {
        output::answer_json(&as_json(&loaded))
    } else {
        output::answer(&as_text(&loaded))
    }
}

fn as_json(loaded: &LoadedScene) -> Value {
    let scene = &loaded.scene;
    let facts = &scene.facts;
    let materials = loaded.settings.materials.iter();
    let warnings = loaded.warnings.iter();
    json!({
        "name": scene.name,
        "vertices": facts.vertices,
        "triangles": facts.triangles,
        "degenerate": facts.degenerate,
        "area": facts.area,
        "bbox": facts.bounds.map(|corners| corners.map(|p| p.to_array())),
        "materials": materials.map(|m| material_json(scene, m)).collect::<Vec<_>>(),
        "images": scene.images.iter().map(image_json).collect::<Vec<_>>(),
        "warnings": warnings.map(|w| json!({
            "file": w.file.to_string_lossy(),
            "line": w.line,
            "message": w.message,
        })).collect::<Vec<_>>(),
        "bvh": scene.bvh.stats(),
    })
}

fn material_json(scene: &Scene, material: &Material) -> Value {
    let maps = material.maps.iter();
    json!({
        "name": material.name,
        "kd": material.kd,
        "ks": material.ks,
        "shininess": material.shininess,
        "reflectivity": material.reflectivity,
        "amplitude": material.amplitude,
        "midlevel": material.midlevel,
        "default_amplitude": material.default_amplitude,
        "maps": maps.map(|slot| map_json(scene, slot)).collect::<Vec<_>>(),
    })
}

fn map_json(scene: &Scene, slot: &MapSlot) -> Value {
    json!({
        "role": slot.role,
        "image": image_name(scene, slot),
        "enabled": slot.enabled,
        "channel": slot.channel,
        "invert": slot.invert,
        "flip_green": slot.flip_green,
        "space": slot.space,
        "axes": slot.axes.to_string(),
        "destair": slot.destair,
        "levels": levels(scene, slot).map(|levels| levels.count),
        "flip_v": slot.flip_v,
        "wrap": slot.wrap,
        "uv_scale": slot.uv_scale,
        "uv_offset": slot.uv_offset,
        "gain": slot.gain,
        "bias": slot.bias,
        "baked_amplitude": slot.baked_amplitude,
        "note": slot.note,
    })
}

fn image_json(image: &MapImage) -> Value {
    json!({
        "name": image.name,
        "path": image.path.as_ref().map(|path| path.to_string_lossy()),
        "width": image.raw.width,
        "height": image.raw.height,
        "channels": image.raw.channels,
        "bits": image.raw.bits(),
    })
}

fn image_name<'a>(scene: &'a Scene, slot: &MapSlot) -> &'a str {
    scene.images.get(slot.image).map_or("", |image| &image.name)
}

/// The heights that a height map tells apart.
fn levels(scene: &Scene, slot: &MapSlot) -> Option<Levels> {
    let image = scene.images.get(slot.image)?;
    (slot.role == MapRole::Height).then(|| image.heights(slot.channel).levels())
}

fn as_text(loaded: &LoadedScene) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_text(&mut text, loaded);
    text
}

fn write_text(text: &mut String, loaded: &LoadedScene) -> std::fmt::Result {
    let scene = &loaded.scene;
    let facts = &scene.facts;
    writeln!(text, "{}", scene.name)?;
    writeln!(text, "  vertices    {}", facts.vertices)?;
    writeln!(text, "  triangles   {}", facts.triangles)?;
    if facts.degenerate > 0 {
        writeln!(text, "  degenerate  {} (not traced)", facts.degenerate)?;
    }
    writeln!(text, "  area        {}", short(facts.area))?;
    if let Some(corners) = facts.bounds {
        let [min, max] = corners.map(|p| p.to_array().map(short).join(" "));
        writeln!(text, "  from        {min}")?;
        writeln!(text, "  to          {max}")?;
    }
    for material in &loaded.settings.materials {
        write_material(text, scene, material)?;
    }
    let bvh = scene.bvh.stats();
    writeln!(
        text,
        "tree: {} nodes, {} leaves, {} triangles, {} deep, leaves {:.0} % full, expected cost {:.1}, {} KiB",
        bvh.nodes,
        bvh.leaves,
        bvh.triangles,
        bvh.max_depth,
        bvh.leaf_fill * 100.0,
        bvh.sah_cost,
        bvh.bytes.div_ceil(1024),
    )?;
    match loaded.warnings.len() {
        0 => writeln!(text, "no warnings"),
        1 => writeln!(text, "1 warning, on standard error"),
        n => writeln!(text, "{n} warnings, on standard error"),
    }
}

/// Seven digits are enough to read; JSON has them all.
fn short(x: f64) -> String {
    let rounded = format!("{x:.6e}").parse().unwrap_or(x);
    if rounded == 0.0 || (1e-5..1e12).contains(&f64::abs(rounded)) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

fn write_material(text: &mut String, scene: &Scene, material: &Material) -> std::fmt::Result {
    let rgb = |c: crate::math::LinearRgb| format!("{} {} {}", c.r, c.g, c.b);
    writeln!(
        text,
        "material \"{}\": kd {}, ks {}, shininess {}, reflectivity {}",
        material.name,
        rgb(material.kd),
        rgb(material.ks),
        material.shininess,
        material.reflectivity
    )?;
    match (material.amplitude, material.default_amplitude) {
        (Some(own), _) => writeln!(text, "  amplitude {} of its own", short(own))?,
        (None, default) if default > 0.0 => {
            writeln!(text, "  amplitude {} by default", short(default))?
        }
        (None, _) => {}
    }
    for slot in &material.maps {
        let off = if slot.enabled { "" } else { " (off)" };
        let name = image_name(scene, slot);
        write!(text, "  {:<8}{name}{off}", slot.role.name())?;
        if let Some(image) = scene.images.get(slot.image) {
            let raw = &image.raw;
            write!(text, ", {}x{}, {} bits", raw.width, raw.height, raw.bits())?;
        }
        if let Some(levels) = levels(scene, slot) {
            let more = if levels.is_many() { "more than " } else { "" };
            write!(text, ", {more}{} levels", levels.count.min(Levels::MOST))?;
        }
        if slot.destair {
            write!(text, ", de-staired")?;
        }
        if slot.space != NormalSpace::Tangent {
            write!(text, ", {} space", slot.space.name())?;
        }
        if slot.space == NormalSpace::Object && slot.axes != NormalAxes::FILE {
            write!(text, ", channels tell {}", slot.axes)?;
        }
        if let Some(baked) = slot.baked_amplitude {
            write!(text, ", baked for amplitude {}", short(baked))?;
        }
        let note = if slot.note.is_empty() { "" } else { "; " };
        writeln!(text, "{note}{}", slot.note)?;
    }
    Ok(())
}
