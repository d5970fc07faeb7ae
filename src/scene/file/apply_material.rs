//! `[[material]]` entries, laid over the materials that the model brings.

use std::path::Path;

use super::apply::put;
use super::document::{MapKeys, MaterialKeys, Placed, Which};
use super::fault::{Fault, Read, nearest};
use super::parse_material::simple_key;
use super::pictures::Pictures;
use crate::scene::load::fill_default_amplitudes;
use crate::scene::{RenderSettings, Scene};
use crate::shading::Material;
use crate::texture::{MapRole, MapSlot};

/// Lays all entries over the settings' materials; new pictures go behind the scene's. Returns what was
/// doubtful.
pub(super) fn apply_materials(
    entries: &[MaterialKeys],
    settings: &mut RenderSettings,
    scene: &mut Scene,
    base: &Path,
) -> Read<Vec<Fault>> {
    let mut pictures = Pictures::new(base, std::mem::take(&mut scene.images));
    let applied = apply_entries(entries, &mut settings.materials, &mut pictures);
    let (images, remarks) = pictures.into_images();
    scene.images = images;
    let mut doubts = applied?;
    doubts.extend(remarks);
    let notes = fill_amplitudes(entries, settings, scene);
    doubts.extend(notes.into_iter().map(|message| Fault { at: None, message }));
    Ok(doubts)
}

fn apply_entries(
    entries: &[MaterialKeys],
    materials: &mut [Material],
    pictures: &mut Pictures,
) -> Read<Vec<Fault>> {
    // Without a map of relief any default was for a plain tile, and the maps to come may be scaled: 0 asks
    // for a new one.
    let plain = materials.iter_mut().filter(|m| !has_relief(m));
    plain.for_each(|m| m.default_amplitude = 0.0);
    let mut doubts = Vec::new();
    for keys in entries {
        let chosen = chosen(&keys.which.value, materials);
        if chosen.is_empty() {
            doubts.extend(unmatched(keys, materials));
        }
        for index in chosen {
            apply_entry(keys, &mut materials[index], pictures, &mut doubts)?;
        }
    }
    Ok(doubts)
}

/// Fills in the amplitudes that neither files nor entries give; returns what there is to say about it.
fn fill_amplitudes(
    entries: &[MaterialKeys],
    settings: &mut RenderSettings,
    scene: &Scene,
) -> Vec<String> {
    let mut filled = settings.materials.clone();
    // A map without an amplitude of its own was baked for the one in force now: that may be `[mapping]`'s.
    let borrowers = filled.iter_mut().filter(|m| m.amplitude.is_none());
    borrowers.for_each(|m| m.amplitude = settings.mapping.amplitude);
    let notes = fill_default_amplitudes(
        &mut filled,
        &scene.images,
        &scene.mesh,
        &scene.normalization,
    );
    let flat = flat_by_choice(entries, &settings.materials);
    let places = settings.materials.iter_mut().zip(filled).enumerate();
    for (_, (place, filled)) in places.filter(|(i, _)| !flat.contains(i)) {
        let amplitude = place.amplitude;
        *place = Material {
            amplitude,
            ..filled
        };
    }
    notes
}

/// Materials whose entries ask for a default amplitude of 0, which otherwise would mean none is given.
fn flat_by_choice(entries: &[MaterialKeys], materials: &[Material]) -> Vec<usize> {
    let asks = entries
        .iter()
        .filter(|keys| keys.default_amplitude == Some(0.0));
    let asked = asks.flat_map(|keys| chosen(&keys.which.value, materials));
    asked
        .filter(|&i| materials[i].default_amplitude == 0.0)
        .collect()
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

fn apply_entry(
    keys: &MaterialKeys,
    material: &mut Material,
    pictures: &mut Pictures,
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
    apply_slot_keys(keys, material, doubts);
    Ok(())
}

fn has_relief(material: &Material) -> bool {
    let relief = [MapRole::Height, MapRole::Normal, MapRole::Slope];
    material.maps.iter().any(|slot| relief.contains(&slot.role))
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

/// Short forms for what stands in the material's slots.
fn apply_slot_keys(keys: &MaterialKeys, material: &mut Material, doubts: &mut Vec<Fault>) {
    let down = keys.normal_down.as_ref();
    let mut short = ShortForms {
        keys,
        material,
        doubts,
    };
    let slopes = (
        [MapRole::Normal, MapRole::Slope].as_slice(),
        "normal or slope",
    );
    short.put(down, slopes, |slot| &mut slot.flip_green);
    let amplitude = keys.normal_amplitude.as_ref();
    short.put(amplitude, slopes, |slot| &mut slot.baked_amplitude);
    let normals = ([MapRole::Normal].as_slice(), "normal");
    short.put(keys.normal_space.as_ref(), normals, |slot| &mut slot.space);
    short.put(keys.normal_axes.as_ref(), normals, |slot| &mut slot.axes);
    let heights = ([MapRole::Height].as_slice(), "height");
    short.put(keys.destair.as_ref(), heights, |slot| &mut slot.destair);
}

/// Keys of a material that mean its maps of some roles.
struct ShortForms<'a> {
    keys: &'a MaterialKeys,
    material: &'a mut Material,
    doubts: &'a mut Vec<Fault>,
}

impl ShortForms<'_> {
    /// Sets a field of all slots with one of the roles. It is doubtful if there are none.
    fn put<T: Copy>(
        &mut self,
        key: Option<&Placed<T>>,
        (roles, what): (&[MapRole], &str),
        field: impl Fn(&mut MapSlot) -> &mut T,
    ) {
        let Some(key) = key else {
            return;
        };
        let mut found = false;
        let slots = self.material.maps.iter_mut();
        for slot in slots.filter(|slot| roles.contains(&slot.role)) {
            found = true;
            *field(slot) = key.value;
        }
        // For "*", some of the materials may well have no such map.
        if found || self.keys.which.value == Which::Every {
            return;
        }
        let message = format!(
            "`{}` changes nothing: material \"{}\" has no {what} map",
            key.key, self.material.name
        );
        self.doubts.push(Fault::new(key.at, message));
    }
}

fn slot(keys: &MapKeys, pictures: &mut Pictures) -> Read<MapSlot> {
    let mut slot = MapSlot::new(pictures.index(&keys.image)?, keys.role);
    put(&mut slot.enabled, keys.enabled);
    put(&mut slot.channel, keys.channel);
    put(&mut slot.invert, keys.invert);
    put(&mut slot.flip_green, keys.flip_green);
    put(&mut slot.space, keys.space);
    put(&mut slot.axes, keys.axes);
    put(&mut slot.destair, keys.destair);
    put(&mut slot.flip_v, keys.flip_v);
    put(&mut slot.wrap, keys.wrap);
    put(&mut slot.uv_scale, keys.uv_scale);
    put(&mut slot.uv_offset, keys.uv_offset);
    put(&mut slot.gain, keys.gain);
    put(&mut slot.bias, keys.bias);
    put(&mut slot.strength, keys.strength);
    put(&mut slot.baked_amplitude, keys.baked_amplitude);
    slot.note = keys
        .note
        .clone()
        .unwrap_or_else(|| "map of the scene file".to_owned());
    Ok(slot)
}
