//! What a scene file says, laid over what its model brings.

use std::path::Path;

use super::document::{
    CameraKeys, Document, MapKeys, MappingKeys, MaterialKeys, ShadingKeys, Which,
};
use super::fault::{Fault, Read, nearest};
use super::parse_material::simple_key;
use super::pictures::Pictures;
use crate::scene::{Camera, LoadedScene, ShadingSettings};
use crate::shading::Material;
use crate::surface::mapping::MappingSettings;
use crate::texture::{MapRole, MapSlot};

/// Lays `document` over `loaded`. Paths are relative to the folder `base`.
///
/// Returns what was doubtful. `loaded.scene` must not be shared if the document names new pictures.
pub(super) fn apply(
    document: &Document,
    loaded: &mut LoadedScene,
    base: &Path,
) -> Read<Vec<Fault>> {
    let settings = &mut loaded.settings;
    apply_camera(&document.camera, &mut settings.camera);
    if let Some(lights) = &document.lights {
        settings.lights.clone_from(lights);
    }
    apply_shading(&document.shading, &mut settings.shading);
    apply_mapping(&document.mapping, &mut settings.mapping);
    put(&mut settings.samples, document.samples);
    put(&mut loaded.display.exposure_ev, document.exposure_ev);
    loaded.size = document.size.or(loaded.size);

    let mut pictures = Pictures::new(base, &loaded.scene.images);
    let mut doubts = Vec::new();
    for keys in &document.materials {
        for index in chosen(&keys.which.value, &settings.materials) {
            let material = &mut settings.materials[index];
            apply_material(keys, material, &mut pictures, &mut doubts)?;
        }
        doubts.extend(unmatched(keys, &settings.materials));
    }
    let added = pictures.into_added();
    if !added.is_empty() {
        let scene = std::sync::Arc::get_mut(&mut loaded.scene).ok_or(Fault {
            at: None,
            message: "new pictures cannot be added to a scene that is in use".to_owned(),
        })?;
        scene.images.extend(added);
    }
    Ok(doubts)
}

fn put<T>(place: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *place = value;
    }
}

fn apply_camera(keys: &CameraKeys, camera: &mut Camera) {
    put(&mut camera.eye, keys.eye);
    put(&mut camera.target, keys.target);
    put(&mut camera.up, keys.up);
    put(&mut camera.vfov, keys.vfov_deg.map(f64::to_radians));
}

fn apply_shading(keys: &ShadingKeys, shading: &mut ShadingSettings) {
    put(&mut shading.model, keys.model);
    put(&mut shading.shadows, keys.shadows);
    put(&mut shading.max_bounces, keys.max_bounces);
    put(&mut shading.background, keys.background);
}

fn apply_mapping(keys: &MappingKeys, mapping: &mut MappingSettings) {
    put(&mut mapping.method, keys.method);
    put(&mut mapping.lookup, keys.lookup);
    put(&mut mapping.derivative, keys.derivative);
    put(&mut mapping.amplitude, keys.amplitude);
    put(&mut mapping.midlevel, keys.midlevel);
    put(&mut mapping.use_height, keys.use_height);
    put(&mut mapping.use_normal, keys.use_normal);
    put(&mut mapping.use_parallax, keys.use_parallax);
}

/// Indices of the materials that an entry means.
fn chosen(which: &Which, materials: &[Material]) -> Vec<usize> {
    let all = materials.iter().enumerate();
    let meant = all.filter(|(i, material)| match which {
        Which::Every => true,
        Which::Named(name) => material.name == *name,
        Which::Numbered(number) => i == number,
    });
    meant.map(|(i, _)| i).collect()
}

/// The doubt about an entry that means no material.
fn unmatched(keys: &MaterialKeys, materials: &[Material]) -> Option<Fault> {
    if !chosen(&keys.which.value, materials).is_empty() {
        return None;
    }
    let known = materials.iter().map(|m| m.name.as_str());
    let message = match &keys.which.value {
        Which::Every => return None,
        Which::Named(name) => {
            let advice = nearest(name, known)
                .map_or_else(String::new, |n| format!("; the nearest is \"{n}\""));
            format!(
                "`{}`: the model has no material \"{name}\"{advice}; the entry is ignored",
                keys.which.key
            )
        }
        Which::Numbered(_) => format!(
            "`{}`: the model has only {} materials; the entry is ignored",
            keys.which.key,
            materials.len()
        ),
    };
    Some(Fault::new(keys.which.at, message))
}

fn apply_material(
    keys: &MaterialKeys,
    material: &mut Material,
    pictures: &mut Pictures<'_>,
    doubts: &mut Vec<Fault>,
) -> Read<()> {
    put(&mut material.kd, keys.kd);
    put(&mut material.ks, keys.ks);
    put(&mut material.shininess, keys.shininess);
    put(&mut material.reflectivity, keys.reflectivity);
    put(&mut material.amplitude, keys.amplitude);
    put(&mut material.midlevel, keys.midlevel);
    if let Some(maps) = &keys.maps {
        let slots = maps.iter().map(|map| slot(map, pictures));
        material.maps = slots.collect::<Read<_>>()?;
    }
    for (role, path) in &keys.simple_maps {
        let image = (!path.value.is_empty())
            .then(|| pictures.index(path))
            .transpose()?;
        set_simple_map(material, *role, image);
    }
    // Last, so that it also holds for the maps just named.
    put(&mut material.default_amplitude, keys.default_amplitude);
    apply_normal_keys(keys, material, doubts);
    Ok(())
}

/// Gives the material this one map in the role, at the place of the first it had, or none.
fn set_simple_map(material: &mut Material, role: MapRole, image: Option<usize>) {
    let place = material.maps.iter().position(|slot| slot.role == role);
    material.maps.retain(|slot| slot.role != role);
    if let Some(image) = image {
        let mut slot = MapSlot::new(image, role);
        slot.note = format!("{} of the scene file", simple_key(role));
        let place = place
            .unwrap_or(material.maps.len())
            .min(material.maps.len());
        material.maps.insert(place, slot);
    }
}

fn apply_normal_keys(keys: &MaterialKeys, material: &mut Material, doubts: &mut Vec<Fault>) {
    let holds_slopes = |slot: &&mut MapSlot| matches!(slot.role, MapRole::Normal | MapRole::Slope);
    let mut found = false;
    for slot in material.maps.iter_mut().filter(holds_slopes) {
        found = true;
        put(
            &mut slot.flip_green,
            keys.normal_down.as_ref().map(|p| p.value),
        );
        put(
            &mut slot.baked_amplitude,
            keys.normal_amplitude.as_ref().map(|p| p.value),
        );
    }
    // For "*", some of the materials may well have no such map.
    if found || keys.which.value == Which::Every {
        return;
    }
    let places = [
        keys.normal_down.as_ref().map(|p| (p.at, &p.key)),
        keys.normal_amplitude.as_ref().map(|p| (p.at, &p.key)),
    ];
    for (at, key) in places.into_iter().flatten() {
        let message = format!(
            "`{key}` changes nothing: material \"{}\" has no normal or slope map",
            material.name
        );
        doubts.push(Fault::new(at, message));
    }
}

fn slot(keys: &MapKeys, pictures: &mut Pictures<'_>) -> Read<MapSlot> {
    let mut slot = MapSlot::new(pictures.index(&keys.image)?, keys.role);
    put(&mut slot.enabled, keys.enabled);
    put(&mut slot.channel, keys.channel);
    put(&mut slot.invert, keys.invert);
    put(&mut slot.flip_green, keys.flip_green);
    put(&mut slot.flip_v, keys.flip_v);
    put(&mut slot.wrap, keys.wrap);
    put(&mut slot.uv_scale, keys.uv_scale);
    put(&mut slot.uv_offset, keys.uv_offset);
    put(&mut slot.gain, keys.gain);
    put(&mut slot.bias, keys.bias);
    put(&mut slot.baked_amplitude, keys.baked_amplitude);
    slot.note = keys
        .note
        .clone()
        .unwrap_or_else(|| "map of the scene file".to_owned());
    Ok(slot)
}
