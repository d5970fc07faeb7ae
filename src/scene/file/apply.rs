//! What a scene file says, laid over what its model brings.

use std::path::Path;
use std::sync::Arc;

use super::apply_material::apply_materials;
use super::document::{CameraKeys, Document, MappingKeys, ShadingKeys};
use super::fault::{Fault, Read};
use crate::scene::{Camera, LoadedScene, ShadingSettings};
use crate::surface::mapping::MappingSettings;

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
    let (display, keys) = (&mut loaded.display, &document.display);
    put(&mut display.exposure_ev, keys.exposure_ev);
    put(&mut display.view, keys.view);
    put(&mut display.kernel, keys.kernel);
    put(&mut display.offset_rule, keys.offset_rule);
    loaded.size = document.size.or(loaded.size);

    if document.materials.is_empty() {
        return Ok(Vec::new());
    }
    let scene = Arc::get_mut(&mut loaded.scene).ok_or(Fault {
        at: None,
        message: "pictures cannot be added to a scene that is in use".to_owned(),
    })?;
    let known = &loaded.warnings;
    let mut doubts = apply_materials(&document.materials, settings, scene, base)?;
    doubts.retain(|doubt| known.iter().all(|warning| warning.message != doubt.message));
    Ok(doubts)
}

/// Sets what is given.
pub(super) fn put<T>(place: &mut T, value: Option<T>) {
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
    put(&mut shading.bent_normals, keys.bent_normals);
    put(&mut shading.filter, keys.filter);
    put(
        &mut shading.specular_antialiasing,
        keys.specular_antialiasing,
    );
    put(&mut shading.smooth_terminator, keys.smooth_terminator);
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
    put(&mut mapping.cut_at_border, keys.cut_at_border);
    put(&mut mapping.weld_seams, keys.weld_seams);
    put(&mut mapping.displacement_memory, keys.displacement_memory);
    let search = &mut mapping.search;
    put(&mut search.layers, keys.layers);
    put(&mut search.min_layers, keys.min_layers);
    put(&mut search.bisections, keys.bisections);
    put(&mut search.iterations, keys.iterations);
    put(&mut search.self_shadow, keys.self_shadow);
}
